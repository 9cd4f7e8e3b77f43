//! Errors over the recordings on which an experiment judges its models.

use super::{Performance, RecordingStudy, Role};

/// The recordings on which errors are judged: validation, or train where there is none.
#[derive(Clone, Copy, Debug)]
pub struct Judged<'a>(&'a [RecordingStudy]);

impl<'a> Judged<'a> {
    /// Among all recordings of an experiment.
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

    /// Whether they were held out from the fit.
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

    /// Root mean square 2 s simulation error of a model, whose `performance` has one entry a recording of the
    /// experiment [rad/s]; not a number where it has none.
    #[must_use]
    pub fn window_rms(self, performance: &[Performance]) -> f64 {
        self.pooled(|r| performance.get(r).map_or(f64::NAN, |p| p.window_rms))
    }

    /// Root mean square 2 s simulation error of the noise floor [rad/s].
    #[must_use]
    pub fn floor(self) -> f64 {
        self.pooled(|r| self.0[r].floor.window_rms)
    }

    /// The noise floor with the most that the input may have done between its rows, as [`Self::floor`] [rad/s].
    #[must_use]
    pub fn floor_most(self) -> f64 {
        self.pooled(|r| self.0[r].floor.window_most)
    }

    /// What slow noise of the input has in the noise floor, as [`Self::floor`] [rad/s].
    #[must_use]
    pub fn floor_slow(self) -> f64 {
        self.pooled(|r| self.0[r].floor.window_slow)
    }

    /// Summed quality index of a model, whose `performance` has one entry a recording of the experiment
    /// [rad^2/s]; not a number where it has none.
    #[must_use]
    pub fn ise(self, performance: &[Performance]) -> f64 {
        let one = |r: &usize| performance.get(*r).map_or(f64::NAN, |p| p.ise[0] + p.ise[1]);
        self.numbers().iter().map(one).sum()
    }

    /// Root of the mean of squares over the samples of all judged recordings.
    fn pooled(self, rms: impl Fn(usize) -> f64) -> f64 {
        let numbers = self.numbers();
        let samples: f64 = numbers.iter().map(|&r| self.0[r].samples as f64).sum();
        let sum: f64 = numbers.iter().map(|&r| self.0[r].samples as f64 * rms(r).powi(2)).sum();
        (sum / samples).sqrt()
    }
}
