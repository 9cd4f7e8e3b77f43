//! Windows in which an error of the initial state grows.

use std::sync::Arc;

use super::errors::Errors;
use super::several::errors_of_several;
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
        let [right, left] = [0, 1].map(|i| {
            let mut moved = self.clone();
            for window in &mut moved.windows {
                window.start.omega[i] += self.step_of_start(window, i);
            }
            moved
        });
        let Some([whole, right, left]) = errors_of_several([&self, &right, &left], model, p) else {
            return self;
        };
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

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::model::base::{A3, A4};
    use crate::recording::{Channels, DriveUnit, Recording};
    use crate::robot::{Robot, State};
    use crate::simulate::{Hold, Input, simulate};

    /// 8 s at 100 Hz on a straight line, in pieces of 1 s that begin with a yaw rate of the noise of the sensor.
    fn straight(model: &Model, p: &[f64], speed: f64) -> Vec<Recording> {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let mut noise = || -> f64 { 0.02 * Distribution::<f64>::sample(&StandardNormal, &mut rng) };
        let t: Vec<f64> = (0..100).map(|k| 0.01 * f64::from(k)).collect();
        let torque = vec![[p[A4], p[A4 + 1]].map(|m: f64| m.copysign(speed)); t.len()];
        let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
        let run = |n: usize| {
            let off = noise();
            let start = State { omega: [speed + off, speed - off], ..State::default() };
            let motion = simulate(model, p, &input, start).unwrap();
            let omega = motion.iter().map(|s| s.omega.map(|w| w + noise())).collect();
            let channels =
                Channels { t: t.clone(), alpha: None, omega: Some(omega), torque: torque.clone() };
            Recording::new(format!("straight {n}"), channels, DriveUnit::NewtonMetre).unwrap()
        };
        (0..8).map(run).collect()
    }

    #[test]
    fn a_yaw_that_grows_is_explained_by_the_start() {
        let model = Model::base(Robot::amigobot());
        let mut p = model.initial();
        // growth by exp(4) in a second at 20 rad/s
        p[A3] = 0.1 * (p[0] - p[1]);
        for (speed, grows) in [(20.0, true), (-20.0, false)] {
            let recordings = straight(&model, &p, speed);
            let all = Windows::weighted(recordings.iter().collect(), Hold::Linear, &model, &p);
            let found = all.windows.iter().filter(|w| w.growing.is_some()).count();
            assert_eq!(found, if grows { all.windows.len() } else { 0 }, "{speed}");
            let sum = |windows: &Windows| -> f64 {
                windows.squares(&model, &p).unwrap().iter().sum::<f64>() / windows.values() as f64
            };
            // 1600 values: 3.5 % of the sum of their squares
            assert!((sum(&all) - 1.0).abs() < 0.2, "{speed}: {}", sum(&all));
            let mut constant = all.clone();
            constant.windows.iter_mut().for_each(|w| w.growing = None);
            assert_eq!(sum(&constant) > 2.0, grows, "{speed}: {}", sum(&constant));
            let sums = all.sums(&model, &p, &[0, 1]).unwrap();
            let squares = all.squares(&model, &p).unwrap();
            assert!(sums.iter().zip(&squares).all(|(s, q)| (s.square / q - 1.0).abs() < 1e-9));
        }
    }
}
