//! Windows in which an error of the initial state grows.

use std::sync::Arc;

use super::errors::Errors;
use super::window::Window;
use super::{Windows, rounding};
use crate::diagnose::thresholds::THRESHOLDS;
use crate::model::Model;

/// Response of the speed of each wheel to the initial speeds, by row and wheel.
type Responses = Vec<[[f64; 2]; 2]>;

impl Windows<'_> {
    /// The same windows, with the response of `model` at `p` to their initial speeds where an error of these grows: a
    /// robot whose centre of mass is behind the axle turns away from a straight line.
    ///
    /// ```text
    /// S = (w(w0 + s) - w(w0))/s,   s: standard deviation of the initial speed of a wheel
    /// yaw: growth exp(2 a3 w t/(a1 - a2)) at wheel speed w
    /// ```
    /// The constant by which a window is corrected otherwise leaves the grown error, which any effect that damps the yaw
    /// would lower. Only windows in which both wheels move throughout are considered: where a wheel comes to rest, errors
    /// of its start end.
    #[must_use]
    pub(super) fn growing(mut self, model: &Model, p: &[f64]) -> Self {
        let Some(whole) = self.errors(model, p) else { return self };
        let moved = [0, 1].map(|i| {
            let mut other = self.clone();
            for window in &mut other.windows {
                window.start.omega[i] += self.step_of_start(window, i);
            }
            other.errors(model, p)
        });
        let [Some(right), Some(left)] = moved else { return self };
        let responses: Vec<Option<Responses>> = (0..self.windows.len())
            .map(|n| {
                let window = &self.windows[n];
                let steps = [0, 1].map(|i| self.step_of_start(window, i));
                response(&whole[n], [&right[n], &left[n]], steps)
            })
            .collect();
        for (window, response) in self.windows.iter_mut().zip(responses) {
            window.growing = response.map(Arc::from);
        }
        self
    }

    /// Standard deviation of the initial speed of a wheel, at least rounding \[rad/s\].
    fn step_of_start(&self, window: &Window, i: usize) -> f64 {
        window.variance[i].sqrt().max(rounding(self.recordings[window.recording]))
    }
}

/// The responses of a window from its errors without and with `steps` of the initial speeds, if an error of the start
/// grows.
fn response(whole: &Errors, moved: [&Errors; 2], steps: [f64; 2]) -> Option<Responses> {
    let rows = whole.error.len();
    let moves = |errors: &Errors| errors.moving.iter().all(|end| *end == rows);
    if ![whole, moved[0], moved[1]].into_iter().all(moves) {
        return None;
    }
    // the error is measured less simulated speed
    let of = |k: usize, wheel: usize, i: usize| {
        (whole.error[k][wheel] - moved[i].error[k][wheel]) / steps[i]
    };
    let responses: Responses =
        (0..rows).map(|k| [0, 1].map(|wheel| [of(k, wheel, 0), of(k, wheel, 1)])).collect();
    let largest = responses.iter().flatten().flatten().fold(0.0, |most: f64, s| most.max(s.abs()));
    (largest > THRESHOLDS.grown_start && largest.is_finite()).then_some(responses)
}
