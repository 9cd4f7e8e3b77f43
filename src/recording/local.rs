//! The local motion around each sample, by smoothing without a model.

mod agreement;
mod corner;
mod response;
mod source;

use std::ops::Range;

use wide::f64x2;

use self::agreement::{Agreement, Fit, Fits};
use self::corner::{Corner, Corners, around};
use self::source::Source;
use super::response::Neighbourhoods;
use super::{LocalMotion, Measured, MotionNoise, Recording};

/// Half width of the widest neighbourhood \[s\], and its limits in samples.
const HALF_WIDTH: f64 = 0.06;
const FEWEST: usize = 3;
const MOST: usize = 30;
/// Ratio of the widths of successive neighbourhoods.
const WIDER: f64 = 1.6;

impl Recording {
    /// The local motion around every sample: weighted least squares of `alpha = c0 + c1 τ + ½ c2 τ²` and
    /// `omega = c1 + c2 τ` over at most ± 0.06 s (at least three samples to either side, fewer at the ends of
    /// a piece), each channel weighted by its noise.
    ///
    /// Angle and speed are taken from the widest neighbourhood whose interval of two standard errors
    /// intersects those of all narrower ones, because the parabola is not valid across reversals (friction)
    /// or steps of a slowly held input; the acceleration is taken from the widest neighbourhood. The
    /// narrowest is the measured speed of the row itself. For angles alone it is a pair of parabolas with
    /// different curvature that meet at the row; if their residual exceeds the noise, it is included in the
    /// variance of the speed.
    ///
    /// Source: intersection of confidence intervals, Goldenshluger and Nemirovski, Math. Methods Stat. 6
    /// (1997); Katkovnik, IEEE Trans. Signal Process. 47 (1999).
    ///
    /// Computed once; copies of the recording with another input share it.
    #[must_use]
    pub fn local_motion(&self) -> &[LocalMotion] {
        self.kept().local_motion.get_or_init(|| self.parabolas_of_all())
    }

    fn parabolas_of_all(&self) -> Vec<LocalMotion> {
        let (source, around) = (Source::measured(self), Neighbourhoods::of(self));
        let mut out = vec![LocalMotion::default(); self.len()];
        for piece in self.pieces() {
            around.parabolas(&source, piece, piece.clone(), &mut out[piece.clone()]);
        }
        out
    }

    /// [`Recording::local_motion`] for sample `k` only.
    #[must_use]
    pub fn local_motion_at(&self, k: usize) -> LocalMotion {
        let mut out = [LocalMotion::default()];
        if let Some(piece) = self.piece_of(k) {
            let source = Source::measured(self);
            Neighbourhoods::of(self).parabolas(&source, piece, k..k + 1, &mut out);
        }
        out[0]
    }

    /// Variance of the speeds around sample `k` in the widest neighbourhood [rad^2/s^2], for the given noise
    /// of the channels; a channel with infinite noise is not used.
    #[must_use]
    pub fn local_speed_variance(&self, k: usize, noise: &MotionNoise) -> [f64; 2] {
        let Some(piece) = self.piece_of(k) else { return [0.0; 2] };
        let mut out = LocalMotion::default();
        let source = Source::measured(self);
        let mut parabolas = Parabolas::new(&source, k, &weights(self, noise));
        parabolas.widen(around(piece, k, half_width(self, self.rows_per_refresh())));
        let fits = parabolas.fit();
        [0, 1].into_iter().for_each(|i| fits.write(i, &mut out));
        out.omega_variance
    }
}

impl Neighbourhoods {
    fn of(recording: &Recording) -> Self {
        // it counts the rows
        let refresh = recording.rows_per_refresh();
        let (narrower, widest) = half_widths(recording, refresh);
        let noise = recording.motion_noise();
        let alone = !recording.measured().omega && refresh == 1 && recording.reach() == 1;
        let angles_alone = alone.then_some(noise.alpha);
        Self { narrower, widest, weights: weights(recording, &noise), angles_alone }
    }

    /// The motion at `rows` of a piece.
    fn parabolas(
        &self,
        source: &Source,
        piece: &Range<usize>,
        rows: Range<usize>,
        out: &mut [LocalMotion],
    ) {
        let corners = self
            .angles_alone
            .map(|sigma| [0, 1].map(|i| (Corners::of(source, piece, rows.clone(), i), sigma[i])));
        for (k, out) in rows.zip(out) {
            let of = |corners: &[(Corners, f64); 2]| [0, 1].map(|i| corners[i].0.at(k).copied());
            let at_row = corners.as_ref().map_or([None; 2], of);
            self.parabola(piece, Parabolas::new(source, k, &self.weights), at_row, out);
            for (i, (corners, sigma)) in corners.iter().flatten().enumerate() {
                out.omega_variance[i] += corners.roughness(k, *sigma);
            }
        }
    }

    /// Angle and speed of both wheels, each from the widest neighbourhood that agrees with all narrower ones, and their
    /// accelerations from the widest of all. Returns the estimate of the square of what is left of the error of each speed
    /// by the shape of the motion, [`Agreement::curvature`].
    fn parabola(
        &self,
        piece: &Range<usize>,
        mut parabolas: Parabolas,
        corners: [Option<Corner>; 2],
        out: &mut LocalMotion,
    ) -> [Option<f64>; 2] {
        let k = parabolas.sample;
        let agreement = |i: usize| {
            let corner = || Some(parabolas.at_corner(i, corners[i].as_ref()?));
            Agreement::new(i, parabolas.at_row(i).or_else(corner))
        };
        // not by `map`, which copies all widths of each
        let mut agreements = [agreement(0), agreement(1)];
        for half in &self.narrower {
            if !agreements.iter().any(|agreement| agreement.goes_on) {
                break;
            }
            parabolas.widen(around(piece, k, *half));
            let fits = parabolas.fit();
            agreements.iter_mut().for_each(|agreement| agreement.see(&fits, *half));
        }
        parabolas.widen(around(piece, k, self.widest));
        let fits = parabolas.fit();
        for (i, agreement) in agreements.iter_mut().enumerate() {
            agreement.see(&fits, self.widest);
            fits.write(i, out);
            agreement.write(out);
        }
        [0, 1].map(|i| agreements[i].curvature())
    }
}

/// Half width of the widest neighbourhood in rows, with `refresh` rows per new value.
fn half_width(recording: &Recording, refresh: usize) -> usize {
    let step = recording.step() * refresh as f64;
    let rows = ((HALF_WIDTH / step).round() as usize).clamp(FEWEST, MOST) * refresh;
    rows.max(recording.reach())
}

/// Half widths of the neighbourhoods, ascending, and that of the widest one.
fn half_widths(recording: &Recording, refresh: usize) -> (Vec<usize>, usize) {
    let widest = half_width(recording, refresh);
    let narrowest = if recording.measured().omega { 1 } else { 2 } * refresh;
    // over fewer rows the counts of an encoder do not show the speed
    let first = narrowest.max(recording.reach());
    let wider = |half: &usize| Some(((*half as f64 * WIDER).round() as usize).max(half + 1));
    let all = std::iter::successors(Some(first), wider);
    (all.take_while(|half| *half < widest).collect(), widest)
}

/// Reciprocals of the variances of angle and speed, wheel by wheel; zero for a channel that was not measured.
fn weights(recording: &Recording, noise: &MotionNoise) -> [f64x2; 2] {
    let Measured { alpha, omega } = recording.measured();
    let weight = |measured: bool, sigma: [f64; 2]| {
        let of = |sigma: f64| 1.0 / (sigma.max(1e-9) * sigma.max(1e-9));
        f64x2::from(if measured { sigma.map(of) } else { [0.0; 2] })
    };
    [weight(alpha, noise.alpha), weight(omega, noise.omega)]
}

/// Sums over a neighbourhood of a sample that grows to both sides: powers of the time τ relative to the
/// sample, and their products with angle and speed, both wheels side by side.
struct Parabolas<'a> {
    source: &'a Source<'a>,
    sample: usize,
    /// See [`weights`].
    weight: [f64x2; 2],
    range: Range<usize>,
    /// Σ τ^j, j = 0..4.
    powers: [f64; 5],
    /// Σ τ^j (α - α_k), j = 0..2, and Σ τ^j ω, j = 0..1.
    alpha: [f64x2; 3],
    omega: [f64x2; 2],
}

impl<'a> Parabolas<'a> {
    fn new(source: &'a Source<'a>, sample: usize, weight: &[f64x2; 2]) -> Self {
        let (alpha, omega) = ([f64x2::ZERO; 3], [f64x2::ZERO; 2]);
        let (range, powers) = (sample..sample, [0.0; 5]);
        Self { source, sample, weight: *weight, range, powers, alpha, omega }
    }

    /// The row itself, if the speed of wheel `i` was measured.
    fn at_row(&self, i: usize) -> Option<Fit> {
        let (source, k) = (self.source, self.sample);
        let [a, w] = self.weight.map(|weight| weight.to_array()[i]);
        if !(w > 0.0 && source.recording.is_reading(k)) {
            return None;
        }
        let alpha_variance = if a > 0.0 { 1.0 / a } else { 0.0 };
        let (alpha, omega) = (source.alpha(k)[i], source.omega(k)[i]);
        Some(Fit { alpha, omega, alpha_variance, omega_variance: 1.0 / w })
    }

    /// The same of a corner of the angles.
    fn at_corner(&self, i: usize, corner: &Corner) -> Fit {
        let variance = 1.0 / self.weight[0].to_array()[i];
        let [alpha_variance, omega_variance] = corner.variance.map(|v| v * variance);
        Fit { alpha: corner.alpha, omega: corner.omega, alpha_variance, omega_variance }
    }

    /// Adds the rows of a wider range to the sums.
    fn widen(&mut self, to: Range<usize>) {
        let (r, k) = (self.source.recording, self.sample);
        let (now, angle) = (r.t()[k], f64x2::from(self.source.alpha(k)));
        for rows in [to.start..self.range.start, self.range.end..to.end] {
            let channels = self.source.channels(rows.clone());
            let stamps = r.t()[rows.clone()].iter().zip(&r.fresh()[rows]);
            for ((t, fresh), (alpha, omega)) in stamps.zip(channels) {
                // a row that repeats the last value is not a measurement
                if *fresh {
                    self.add(t - now, f64x2::from(*alpha) - angle, f64x2::from(*omega));
                }
            }
        }
        self.range = to;
    }

    #[inline]
    fn add(&mut self, tau: f64, alpha: f64x2, omega: f64x2) {
        let square = tau * tau;
        let powers = [1.0, tau, square, square * tau, square * square];
        self.powers.iter_mut().zip(powers).for_each(|(sum, power)| *sum += power);
        self.alpha[0] += alpha;
        self.alpha[1] += alpha * f64x2::splat(tau);
        self.alpha[2] += alpha * f64x2::splat(square);
        self.omega[0] += omega;
        self.omega[1] += omega * f64x2::splat(tau);
    }

    /// The motion of the wheels; the sample itself for a wheel whose neighbourhood does not determine it.
    ///
    /// ```text
    /// rows (1, τ, ½ τ²) of the angle and (0, 1, τ) of the speed; the inverse by cofactors
    /// ```
    fn fit(&self) -> Fits {
        let ([a, w], [s0, s1, s2, s3, s4]) = (self.weight, self.powers.map(f64x2::splat));
        let half = f64x2::splat(0.5);
        // without angles their constant is left out
        let measured = a.to_array().map(|a| a > 0.0);
        let count = (a * s0).to_array();
        let count = [0, 1].map(|i| if measured[i] { count[i] } else { 1.0 });
        let (m00, m01, m02) = (f64x2::from(count), a * s1, half * a * s2);
        let (m11, m12) = (a * s2 + w * s0, half * a * s3 + w * s1);
        let m22 = half * half * a * s4 + w * s2;
        let [c00, c01, c02] = [m11 * m22 - m12 * m12, m02 * m12 - m01 * m22, m01 * m12 - m02 * m11];
        let [c11, c12, c22] = [m00 * m22 - m02 * m02, m01 * m02 - m00 * m12, m00 * m11 - m01 * m01];
        let determinant = m00 * c00 + m01 * c01 + m02 * c02;
        let share = f64x2::ONE / determinant;
        let [v0, v1, v2] = self.alpha;
        let right = [a * v0, a * v1 + w * self.omega[0], half * a * v2 + w * self.omega[1]];
        let times =
            |row: [f64x2; 3]| (row[0] * right[0] + row[1] * right[1] + row[2] * right[2]) * share;
        let (alpha, omega) = (times([c00, c01, c02]), times([c01, c11, c12]));
        let (rows, angle) = (self.rows_per_count(), self.source.alpha(self.sample));
        let variance = (c00 * share * rows).to_array();
        Fits {
            row: (angle, self.source.omega(self.sample)),
            determinant: determinant.to_array(),
            alpha: (f64x2::from(angle) + alpha).to_array(),
            omega: omega.to_array(),
            acceleration: times([c02, c12, c22]).to_array(),
            alpha_variance: [0, 1].map(|i| if measured[i] { variance[i].max(0.0) } else { 0.0 }),
            omega_variance: (c11 * share * rows).to_array().map(|v| v.max(0.0)),
        }
    }

    /// Rows of the neighbourhood for each of its counts where the counts of an encoder hide the speed, otherwise one:
    /// the errors of rows with the same count are not independent, so that together they determine the motion like one
    /// row.
    fn rows_per_count(&self) -> f64x2 {
        let (r, rows) = (self.source.recording, &self.range);
        if r.reach() == 1 {
            return f64x2::ONE;
        }
        let pairs = || r.alpha()[rows.clone()].windows(2);
        let changes = |i: usize| pairs().filter(|w| w[0][i] != w[1][i]).count();
        f64x2::from([0, 1].map(|i| rows.len() as f64 / (1 + changes(i)) as f64))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Channels, DriveUnit, Noise, Recording};

    #[test]
    fn a_parabola_is_found_exactly() {
        let t: Vec<f64> = (0..60).map(|k| 0.01 * f64::from(k) + 0.002 * f64::from(k % 2)).collect();
        let alpha = t.iter().map(|t| [1.0 + 2.0 * t + 1.5 * t * t, -t]).collect();
        let omega = t.iter().map(|t| [2.0 + 3.0 * t, -1.0]).collect();
        let torque = vec![[0.0; 2]; 60];
        let c = Channels { t, alpha: Some(alpha), omega: Some(omega), torque };
        let r = Recording::new("a", c, DriveUnit::NewtonMetre).unwrap();
        for (k, m) in r.local_motion().iter().enumerate() {
            let t = r.t()[k];
            assert!((m.omega[0] - (2.0 + 3.0 * t)).abs() < 1e-6, "{k} {m:?}");
            assert!((m.acceleration[0] - 3.0).abs() < 1e-5, "{k} {m:?}");
            assert!((m.alpha[1] + t).abs() < 1e-6);
            assert_eq!(*m, r.local_motion_at(k));
        }
    }

    /// A wheel accelerated and braked in turn by the steps of a held input, at 20 Hz.
    fn stepped(alpha: bool, omega: bool) -> (Recording, Vec<f64>) {
        let (h, mut at, mut w) = (0.05, 0.0, 3.0);
        let (mut angles, mut speeds) = (vec![], vec![]);
        for k in 0..40 {
            angles.push([at; 2]);
            speeds.push(w);
            let a = 30.0 * f64::from(k).sin().signum();
            (at, w) = (at + h * w + 0.5 * h * h * a, w + h * a);
        }
        let t = (0..40).map(|k| h * f64::from(k)).collect();
        let omega = omega.then(|| speeds.iter().map(|w| [*w; 2]).collect());
        let torque = vec![[0.0; 2]; 40];
        let c = Channels { t, alpha: alpha.then_some(angles), omega, torque };
        let mut r = Recording::new("steps", c, DriveUnit::NewtonMetre).unwrap();
        r.set_most_noise(Noise { alpha: [1e-4; 2], omega: [1e-3; 2], torque: [0.0; 2] });
        (r, speeds)
    }

    #[test]
    fn speeds_between_the_steps_of_a_held_input_lie_within_their_errors() {
        for (alpha, omega) in [(true, false), (false, true), (true, true)] {
            let (r, truth) = stepped(alpha, omega);
            for (k, m) in r.local_motion().iter().enumerate().skip(2).take(36) {
                let error = m.omega_variance[0].sqrt();
                assert!((m.omega[0] - truth[k]).abs() < 1e-6 + 2.0 * error, "{k} {m:?}");
                assert!(!omega || error < 4e-3, "{error}");
            }
        }
    }

    #[test]
    fn copies_share_one_motion_until_the_noise_of_the_sensors_is_set() {
        let t: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        let rough = |k: usize| 0.01 * ((k * k) as f64).sin();
        let omega = t.iter().enumerate().map(|(k, t)| [t.sin() + rough(k), -t + rough(k + 7)]);
        let (omega, torque) = (Some(omega.collect()), vec![[0.0; 2]; 200]);
        let c = Channels { t, alpha: None, omega, torque };
        let r = Recording::new("a", c, DriveUnit::NewtonMetre).unwrap();
        let other = r.with_torque(vec![[1.0; 2]; 200]);
        assert!(std::ptr::eq(r.local_motion(), other.local_motion()));
        let mut quiet = r.clone();
        let Noise { alpha, torque, .. } = r.noise();
        quiet.set_most_noise(Noise { alpha, omega: [1e-4; 2], torque });
        // less noise: narrower neighbourhoods agree
        assert_ne!(quiet.local_motion(), r.local_motion());
        assert_eq!(quiet.local_motion()[70], quiet.local_motion_at(70));
    }
}
