//! Errors over the recordings on which the models of an experiment are judged.

use super::{Performance, RecordingStudy, Role};

/// The recordings on which errors are judged: validation, or training if there is none.
#[derive(Clone, Copy, Debug)]
pub struct Judged<'a>(&'a [RecordingStudy]);

impl<'a> Judged<'a> {
    /// Selects them among all recordings of an experiment.
    #[must_use]
    pub fn of(recordings: &'a [RecordingStudy]) -> Self {
        Self(recordings)
    }

    /// Their numbers, ascending.
    #[must_use]
    pub fn numbers(self) -> Vec<usize> {
        let with = |role: Role| -> Vec<usize> {
            (0..self.0.len()).filter(|&r| self.0[r].role == role).collect()
        };
        let validation = with(Role::Validation);
        if validation.is_empty() { with(Role::Train) } else { validation }
    }

    /// Whether they were not used in the fit.
    #[must_use]
    pub fn are_held_out(self) -> bool {
        self.0.iter().any(|r| r.role == Role::Validation)
    }

    /// Largest measured speed of a wheel [rad/s].
    #[must_use]
    pub fn top_speed(self) -> f64 {
        let numbers = self.numbers().into_iter();
        let speeds = numbers.flat_map(|r| self.0[r].omega.iter().flatten());
        speeds.filter(|w| w.is_finite()).fold(0.0, |top: f64, w| top.max(w.abs()))
    }

    /// RMS 2 s simulation error of a model with one `performance` entry per recording of the experiment
    /// [rad/s]; NaN without entries.
    #[must_use]
    pub fn window_rms(self, performance: &[Performance]) -> f64 {
        self.pooled(|r| performance.get(r).map_or(f64::NAN, |p| p.window_rms))
    }

    /// RMS 2 s simulation error of the noise floor [rad/s].
    #[must_use]
    pub fn floor(self) -> f64 {
        self.pooled(|r| self.0[r].floor.window_rms)
    }

    /// The noise floor with the largest possible effect of the unknown input between the rows, as
    /// [`Self::floor`] [rad/s].
    #[must_use]
    pub fn floor_most(self) -> f64 {
        self.pooled(|r| self.0[r].floor.window_most)
    }

    /// Contribution of slow noise of the input to the noise floor, as [`Self::floor`] [rad/s].
    #[must_use]
    pub fn floor_slow(self) -> f64 {
        self.pooled(|r| self.0[r].floor.window_slow)
    }

    /// Summed quality index of a model with one `performance` entry per recording of the experiment
    /// [rad^2/s]; NaN without entries.
    #[must_use]
    pub fn ise(self, performance: &[Performance]) -> f64 {
        let one = |r: &usize| performance.get(*r).map_or(f64::NAN, |p| p.ise[0] + p.ise[1]);
        self.numbers().iter().map(one).sum()
    }

    /// Root of the mean square over the samples of all judged recordings.
    fn pooled(self, rms: impl Fn(usize) -> f64) -> f64 {
        let numbers = self.numbers();
        let samples: f64 = numbers.iter().map(|&r| self.0[r].samples as f64).sum();
        let sum: f64 = numbers.iter().map(|&r| self.0[r].samples as f64 * rms(r).powi(2)).sum();
        (sum / samples).sqrt()
    }
}
