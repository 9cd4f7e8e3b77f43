//! One recording: wheel angles, wheel speeds and input over time.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use super::channels::{Channels, Measured, Noise, SlowNoise};
use super::check::check;
use super::derived::{integrate, reach, slopes};
use super::gaps::pieces;
use super::interpolated::Interpolated;
use super::kept::Kept;
use super::{DriveUnit, RecordingError};
use crate::math::median_step;

/// A checked recording: finite values, strictly increasing time, both angles and speeds. Copies share the rows.
#[derive(Clone, Debug)]
pub struct Recording {
    name: Arc<str>,
    t: Arc<[f64]>,
    alpha: Arc<[[f64; 2]]>,
    omega: Arc<[[f64; 2]]>,
    torque: Arc<[[f64; 2]]>,
    measured: Measured,
    drive_unit: DriveUnit,
    pieces: Arc<[Range<usize>]>,
    fresh: Arc<[bool]>,
    /// Median step in time \[s\].
    step: f64,
    /// Rows to either side over which speeds are computed from angles.
    reach: usize,
    /// Upper bound of the sensor noise, from other recordings of the same sensors.
    most_noise: Option<Noise>,
    /// What is kept of the recorded input, if it has been interpolated since.
    interpolated: Option<Interpolated>,
    /// Share of the differences of the input from row to row that is noise.
    noise_of_jumps: f64,
    /// Autocorrelated noise of the input, right wheel first.
    slow_input_noise: [SlowNoise; 2],
    /// Standard error of the time of the input \[s\].
    input_time_error: f64,
    /// What is computed from angles and speeds on first use; copies with the same motion share it.
    kept: Arc<Kept>,
    /// [`Recording::input_jumps`], computed on first use; copies with the same motion and input share it.
    kept_jumps: Arc<OnceLock<[f64; 2]>>,
}

impl Recording {
    /// Checks the columns and computes the missing ones.
    ///
    /// Missing angles are integrated from the speeds (trapezoidal rule), missing speeds are the slope of the
    /// parabola through three angles: neighbours, or, of counts in fast rows, as many rows apart as resolve the speed;
    /// neither crosses a gap.
    ///
    /// # Errors
    /// [`RecordingError`], with the row counted from 1.
    pub fn new(
        name: impl Into<String>,
        channels: Channels,
        drive_unit: DriveUnit,
    ) -> Result<Self, RecordingError> {
        let name = name.into();
        let Channels { t, alpha, omega, torque } = channels;
        check(&name, &t, alpha.as_deref(), omega.as_deref(), &torque)?;
        let measured = Measured { alpha: alpha.is_some(), omega: omega.is_some() };
        let channels = Channels { t, alpha, omega, torque };
        let fresh = super::refresh::refreshed(&channels);
        let Channels { t, alpha, omega, torque } = channels;
        let pieces = pieces(&t);
        let step = median_step(&t);
        let angles_alone = alpha.as_ref().filter(|_| omega.is_none());
        let reach = angles_alone.map_or(1, |alpha| reach(alpha, &fresh, step));
        let (alpha, omega) = match (alpha, omega) {
            (Some(alpha), Some(omega)) => (alpha, omega),
            (Some(alpha), None) => {
                let omega = slopes(&t, &alpha, &pieces, &fresh, reach);
                (alpha, omega)
            }
            (None, Some(omega)) => (integrate(&t, &omega), omega),
            (None, None) => return Err(RecordingError::NoMotion { name }),
        };
        let columns = [("dalpha", &omega[..]), ("M", &torque[..]), ("alpha", &alpha[..])];
        super::limits::check(&name, &t, step, columns)?;
        Ok(Self {
            name: name.into(),
            t: t.into(),
            alpha: alpha.into(),
            omega: omega.into(),
            torque: torque.into(),
            measured,
            drive_unit,
            pieces: pieces.into(),
            fresh: fresh.into(),
            step,
            reach,
            most_noise: None,
            interpolated: None,
            noise_of_jumps: 1.0,
            slow_input_noise: [SlowNoise::default(); 2],
            input_time_error: 0.0,
            kept: Arc::default(),
            kept_jumps: Arc::default(),
        })
    }

    /// Its name, usually that of the file.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }
    /// Time \[s\].
    #[must_use]
    pub fn t(&self) -> &[f64] {
        &self.t
    }
    /// Wheel angles \[rad\].
    #[must_use]
    pub fn alpha(&self) -> &[[f64; 2]] {
        &self.alpha
    }
    /// Wheel speeds [rad/s].
    #[must_use]
    pub fn omega(&self) -> &[[f64; 2]] {
        &self.omega
    }
    /// Recorded input [`DriveUnit`].
    #[must_use]
    pub fn torque(&self) -> &[[f64; 2]] {
        &self.torque
    }
    /// Which channels were measured.
    #[must_use]
    pub fn measured(&self) -> Measured {
        self.measured
    }
    /// Unit of the input.
    #[must_use]
    pub fn drive_unit(&self) -> DriveUnit {
        self.drive_unit
    }
    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.t.len()
    }
    /// Never true: an empty recording is refused.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }
    /// Index ranges without a gap in time, in order.
    #[must_use]
    pub fn pieces(&self) -> &[Range<usize>] {
        &self.pieces
    }
    /// The piece that contains a row.
    #[must_use]
    pub fn piece_of(&self, row: usize) -> Option<&Range<usize>> {
        self.pieces.iter().find(|piece| piece.contains(&row))
    }
    /// Whether both wheels have identical values: a single axis mapped to both wheels. Parameters that
    /// describe differences of the wheels are then not identifiable.
    #[must_use]
    pub fn is_single_axis(&self) -> bool {
        let same = |rows: &[[f64; 2]]| rows.iter().all(|r| r[0] == r[1]);
        same(&self.alpha) && same(&self.omega) && same(&self.torque)
    }
    /// The wheels with values of their own: a single axis mapped to both wheels counts once.
    #[must_use]
    pub fn wheels(&self) -> Range<usize> {
        if self.is_single_axis() { 0..1 } else { 0..2 }
    }
    /// Time covered by the pieces, without the gaps between them \[s\].
    #[must_use]
    pub fn covered(&self) -> f64 {
        self.pieces.iter().map(|piece| self.t[piece.end - 1] - self.t[piece.start]).sum()
    }
    /// [`Recording::is_reading`] of each row: loggers that are faster than their sensors repeat the last value.
    #[must_use]
    pub(crate) fn fresh(&self) -> &[bool] {
        &self.fresh
    }
    /// Number of rows to either side over which speeds are computed from angles; one where they are measured.
    #[must_use]
    pub(crate) fn reach(&self) -> usize {
        self.reach
    }
    /// The 99 % quantile of the speed of the faster wheel [rad/s]: the speed scale of this recording. Computed once.
    #[must_use]
    pub fn top_speed(&self) -> f64 {
        *self.kept.top_speed.get_or_init(|| {
            let faster = self.omega.iter().map(|w| w[0].abs().max(w[1].abs()));
            let mut speeds: Vec<f64> = faster.collect();
            let place = (speeds.len() - 1) * 99 / 100;
            speeds.select_nth_unstable_by(place, f64::total_cmp).1.max(1e-9)
        })
    }
    /// From the first to the last sample \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.t[self.t.len() - 1] - self.t[0]
    }
    /// Median step in time \[s\].
    #[must_use]
    pub fn step(&self) -> f64 {
        self.step
    }

    /// The same recording with another input, for example after an effect on the input.
    ///
    /// # Panics
    /// If the length differs.
    #[must_use]
    pub fn with_torque(&self, torque: Vec<[f64; 2]>) -> Self {
        assert_eq!(torque.len(), self.len(), "one row of the input a sample");
        // that of the recorded input, whichever copy asks first
        self.response();
        let interpolated = self.interpolated.as_ref().map(Interpolated::of_other_input);
        Self { torque: torque.into(), interpolated, kept_jumps: Arc::default(), ..self.clone() }
    }

    /// What is kept of the recorded input, if it has been interpolated since.
    pub(super) fn interpolated(&self) -> Option<&Interpolated> {
        self.interpolated.as_ref()
    }

    /// The same recording with an input of which this is kept.
    pub(super) fn with_interpolated(self, interpolated: Interpolated) -> Self {
        Self { interpolated: Some(interpolated), ..self }
    }

    /// The same recording with other speeds; angles that were not measured are integrated from them.
    ///
    /// # Panics
    /// If the length differs.
    #[must_use]
    pub fn with_omega(&self, omega: Vec<[f64; 2]>) -> Self {
        assert_eq!(omega.len(), self.len(), "one row of speeds a sample");
        let measured = self.measured.alpha;
        let alpha = if measured { self.alpha.clone() } else { integrate(&self.t, &omega).into() };
        Self { alpha, omega: omega.into(), ..self.anew() }
    }

    /// The same recording with angles shifted by `later` \[rad\].
    #[must_use]
    pub fn with_later_angles(&self, later: [f64; 2]) -> Self {
        let moved = |a: &[f64; 2]| [a[0] + later[0], a[1] + later[1]];
        let alpha = self.alpha.iter().map(moved).collect();
        Self { alpha, ..self.anew() }
    }

    /// Sets the share (0 to 1, of the standard deviation) of the differences of the input from row to row,
    /// [`Recording::input_jumps`], that is noise.
    pub fn set_noise_of_jumps(&mut self, share: f64) {
        self.noise_of_jumps = share;
    }

    /// Share of the standard deviation of the input's differences that is noise.
    #[must_use]
    pub fn noise_of_jumps(&self) -> f64 {
        self.noise_of_jumps
    }

    /// Sets the autocorrelated noise of the recorded input that does not act on the robot.
    pub fn set_slow_input_noise(&mut self, noise: [SlowNoise; 2]) {
        self.slow_input_noise = noise;
    }

    /// Autocorrelated noise of the input, right wheel first; zero unless set by
    /// [`Recording::set_slow_input_noise`].
    #[must_use]
    pub fn slow_input_noise(&self) -> [SlowNoise; 2] {
        self.slow_input_noise
    }

    /// Sets the standard error of the time at which the recorded input acts \[s\].
    pub fn set_input_time_error(&mut self, error: f64) {
        self.input_time_error = error;
    }

    /// Standard error of the time at which the recorded input acts \[s\]; zero unless set by
    /// [`Recording::set_input_time_error`].
    #[must_use]
    pub fn input_time_error(&self) -> f64 {
        self.input_time_error
    }

    /// The input, shared.
    pub(super) fn shared_torque(&self) -> Arc<[[f64; 2]]> {
        self.torque.clone()
    }

    /// Sets an upper bound for the noise of angles and speeds.
    pub fn set_most_noise(&mut self, noise: Noise) {
        self.most_noise = Some(noise);
        // local motion and standstill depend on the noise
        *self = self.anew();
    }

    /// A copy of which everything that is computed on first use is computed again.
    fn anew(&self) -> Self {
        Self { kept: Arc::default(), kept_jumps: Arc::default(), ..self.clone() }
    }

    pub(super) fn kept_jumps(&self) -> &OnceLock<[f64; 2]> {
        &self.kept_jumps
    }

    pub(super) fn kept(&self) -> &Kept {
        &self.kept
    }

    pub(super) fn most_noise(&self) -> Option<Noise> {
        self.most_noise
    }

    /// The samples of an index range as a separate recording.
    ///
    /// # Errors
    /// If fewer than ten samples remain.
    pub fn cut(&self, range: Range<usize>) -> Result<Self, RecordingError> {
        let channels = Channels {
            t: self.t[range.clone()].to_vec(),
            alpha: self.measured.alpha.then(|| self.alpha[range.clone()].to_vec()),
            omega: self.measured.omega.then(|| self.omega[range.clone()].to_vec()),
            torque: self.torque[range.clone()].to_vec(),
        };
        let cut = Self::new(&*self.name, channels, self.drive_unit)?;
        let interpolated = self.interpolated.as_ref().map(|i| i.cut(range));
        let Self { noise_of_jumps, slow_input_noise, input_time_error, .. } = *self;
        Ok(Self { interpolated, noise_of_jumps, slow_input_noise, input_time_error, ..cut })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channels(n: usize) -> Channels {
        let t: Vec<f64> = (0..n).map(|k| 0.01 * k as f64).collect();
        let omega = t.iter().map(|&t| [t.sin(), 2.0 * t]).collect();
        Channels { torque: vec![[0.1, 0.2]; n], alpha: None, omega: Some(omega), t }
    }

    #[test]
    fn missing_angles_are_integrated_from_the_speeds() {
        let r = Recording::new("a", channels(200), DriveUnit::NewtonMetre).unwrap();
        let (t, a) = (r.t()[199], r.alpha()[199]);
        // trapezoid: h^2/12 T max|w''| = 1.7e-5
        assert!((a[0] - (1.0 - t.cos())).abs() < 2e-5 && (a[1] - t * t).abs() < 1e-12);
        assert!(!r.measured().alpha && r.measured().omega);
    }

    #[test]
    fn missing_speeds_are_exact_for_parabolas_even_where_sampling_is_uneven() {
        let t: Vec<f64> = (0..50).map(|k| 0.01 * k as f64 + 0.003 * (k % 3) as f64).collect();
        let alpha = t.iter().map(|&t| [t * t, 3.0 * t]).collect();
        let c = Channels { torque: vec![[0.0; 2]; 50], alpha: Some(alpha), omega: None, t };
        let r = Recording::new("a", c, DriveUnit::NewtonMetre).unwrap();
        for k in 1..49 {
            assert!((r.omega()[k][0] - 2.0 * r.t()[k]).abs() < 1e-12);
            assert!((r.omega()[k][1] - 3.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_gap_in_time_splits_the_recording_and_is_not_differenced_across() {
        let mut c = channels(40);
        for t in &mut c.t[20..] {
            *t += 1.0;
        }
        let r = Recording::new("a", c, DriveUnit::NewtonMetre).unwrap();
        assert_eq!(r.pieces(), [0..20, 20..40]);
    }

    #[test]
    fn bad_values_are_named_with_row_and_column() {
        let mut c = channels(20);
        c.t[7] = c.t[6];
        let e = Recording::new("run1.csv", c, DriveUnit::NewtonMetre).unwrap_err().to_string();
        assert!(e.starts_with("run1.csv, row 8: t = 0.06 s does not exceed 0.06 s"), "{e}");
        let mut c = channels(20);
        c.torque[3][1] = f64::NAN;
        let e = Recording::new("run1.csv", c, DriveUnit::NewtonMetre).unwrap_err().to_string();
        assert!(e.starts_with("run1.csv, row 4: M2 is NaN"), "{e}");
        let e = Recording::new("x", channels(2), DriveUnit::NewtonMetre).unwrap_err().to_string();
        assert!(e.contains("2 samples; at least 10"), "{e}");
    }
}
