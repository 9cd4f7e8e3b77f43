//! Errors of a model in windows, and sums of them.

use rayon::prelude::*;

use super::Windows;
use super::compared::Compared;
use super::sums::{Start, TINY};
use super::window::Window;
use crate::model::Model;
use crate::recording::Recording;
use crate::robot::State;
use crate::simulate::{Input, simulate_windows};

/// Errors of one window.
pub struct Errors {
    /// Measured less simulated wheel speeds [rad/s].
    pub error: Vec<[f64; 2]>,
    /// Number of rows that were compared; the errors of the others are zero.
    pub compared: usize,
    /// Rows until each wheel comes to rest in the simulation, up to which an error of the initial
    /// state persists.
    pub moving: [usize; 2],
}

impl Errors {
    /// Those of a window from its simulated states; `None` if one is not finite.
    pub(super) fn of(recording: &Recording, window: &Window, states: &[State]) -> Option<Self> {
        let (mut rows, mut compared) = (Compared::new(recording, window), 0);
        let error = |(k, state): (usize, &State)| {
            let row = rows.row(k, state);
            compared += usize::from(row.mean_over.is_none_or(f64::is_finite));
            row.error
        };
        let error: Vec<[f64; 2]> = states.iter().enumerate().map(error).collect();
        let moving = [0, 1].map(|i| rows_until_rest(states, i));
        let finite = error.iter().flatten().all(|e| e.is_finite());
        finite.then_some(Self { error, compared, moving })
    }

    /// Mean square difference of the simulated speeds of two models, by wheel [rad^2/s^2].
    pub(super) fn apart(&self, other: &Self) -> [f64; 2] {
        let pairs = self.error.iter().zip(&other.error);
        self.mean_of(pairs.map(|(a, b)| [a[0] - b[0], a[1] - b[1]]))
    }

    /// Mean square error of each wheel [rad^2/s^2].
    pub(super) fn mean_squares(&self) -> [f64; 2] {
        self.mean_of(self.error.iter().copied())
    }

    fn mean_of(&self, values: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
        let sum = values.fold([0.0; 2], |s, v| [s[0] + v[0] * v[0], s[1] + v[1] * v[1]]);
        sum.map(|s| s / self.compared.max(1) as f64)
    }
}

/// Rows before the simulated wheel rests.
fn rows_until_rest(states: &[State], wheel: usize) -> usize {
    states.iter().position(|s| s.omega[wheel] == 0.0).unwrap_or(states.len())
}

impl Windows<'_> {
    /// Errors of a model in every window: measured less simulated speed, one row per sample; `None` where
    /// the model cannot move or diverges.
    #[must_use]
    pub fn errors(&self, model: &Model, p: &[f64]) -> Option<Vec<Errors>> {
        let acting: Vec<_> =
            self.recordings.par_iter().map(|r| model.input_of(r, r.torque(), p)).collect();
        // without a second body a window does not depend on the rows before it
        let coupled = model.is_coupled();
        let place = |w: &Window| {
            (w.recording, self.recordings[w.recording].piece_of(w.rows.start).map(|p| p.start))
        };
        let together = |a: &Window, b: &Window| coupled && place(a) == place(b);
        let groups: Vec<&[Window]> = self.windows.chunk_by(together).collect();
        let by_group: Vec<Vec<Errors>> = groups
            .into_par_iter()
            .map(|group| self.errors_of(group, &acting[group[0].recording], model, p))
            .collect::<Option<_>>()?;
        Some(by_group.into_iter().flatten().collect())
    }

    /// The errors of windows of one recording, which follow each other, under its acting input.
    fn errors_of(
        &self,
        group: &[Window],
        acting: &[[f64; 2]],
        model: &Model,
        p: &[f64],
    ) -> Option<Vec<Errors>> {
        let recording = self.recordings[group[0].recording];
        let input = Input { t: recording.t(), torque: acting, hold: self.hold };
        let windows: Vec<_> = group.iter().map(|w| (w.rows.clone(), w.start)).collect();
        let states = simulate_windows(model, p, &input, input.t[0], &windows).ok()?;
        let one = |(window, states): (&Window, &Vec<State>)| Errors::of(recording, window, states);
        group.iter().zip(&states).map(one).collect()
    }

    /// `Σ e²/s²` of every window, without the part that its start explains.
    #[must_use]
    pub fn squares(&self, model: &Model, p: &[f64]) -> Option<Vec<f64>> {
        Some(self.squares_of(&self.errors(model, p)?))
    }

    /// [`Windows::squares`] of given errors.
    pub(in crate::diagnose) fn squares_of(&self, errors: &[Errors]) -> Vec<f64> {
        self.windows.iter().zip(errors).map(|(w, e)| self.square(w, e)).collect()
    }

    /// How well each window distinguishes two models: `D/(D + n)`, with D the sum of squared differences of their
    /// simulated speeds in variances of the error, and n the number of values.
    pub(in crate::diagnose) fn contrast(&self, one: &[Errors], other: &[Errors]) -> Vec<f64> {
        let of = |((window, a), b): ((&Window, &Errors), &Errors)| {
            let (apart, count) = self.apart(window, a, b);
            if apart > 0.0 { apart / (apart + count) } else { 0.0 }
        };
        self.windows.iter().zip(one).zip(other).map(of).collect()
    }

    /// Sum of squared differences of two simulations of a window in variances of the error, and number of values.
    fn apart(&self, window: &Window, one: &Errors, other: &Errors) -> (f64, f64) {
        let (mut apart, mut count) = (0.0, 0.0);
        for (k, (a, b)) in one.error.iter().zip(&other.error).enumerate() {
            for i in 0..2 {
                let w = self.weight(window, k, i);
                apart += w * (a[i] - b[i]).powi(2);
                count += f64::from(u8::from(w > 0.0));
            }
        }
        (apart, count)
    }

    /// Share of the squared change by omitting every other row of the input that the errors of a model allow the unknown
    /// input between all rows to have, at most one: no more than noise leaves of them.
    ///
    /// ```text
    /// (Σ e²/s² - n + 2 √(2 n)) / mean over both ways of Σ (e_half - e)²/s²
    /// ```
    /// n values, whose sum of squares scatters by √(2 n). A controller that answers to each row, even to noise, makes the
    /// input jump from row to row: the other rows then contain nothing about those that are omitted.
    pub(in crate::diagnose) fn allowed_sampling(&self, model: &Model, p: &[f64]) -> Option<f64> {
        let [whole, even, odd] = self.errors_by_halves(model, p)?;
        let (mut predicted, mut count) = (0.0, 0.0);
        for errors in [even, odd] {
            for ((window, a), b) in self.windows.iter().zip(&whole).zip(&errors) {
                let (apart, values) = self.apart(window, a, b);
                predicted += 0.5 * apart;
                count += 0.5 * values;
            }
        }
        let square: f64 = self.squares_of(&whole).iter().sum();
        let left = (square - count).max(0.0) + 2.0 * (2.0 * count).sqrt();
        Some(if predicted > left { left / predicted } else { 1.0 })
    }

    fn square(&self, window: &Window, errors: &Errors) -> f64 {
        let (mut square, mut by_start, mut products) = (0.0, [0.0; 2], [0.0; 3]);
        for (k, e) in errors.error.iter().enumerate() {
            for (i, e) in e.iter().enumerate() {
                let w = self.weight(window, k, i);
                let [right, left] = window.response(k, i, k >= errors.moving[i]);
                square += w * e * e;
                by_start = [by_start[0] + w * e * right, by_start[1] + w * e * left];
                let [a, b, c] = products;
                products = [a + w * right * right, b + w * right * left, c + w * left * left];
            }
        }
        let start = Start::new(|i, j| products[i + j], &window.variance);
        square - start.explains(by_start, by_start)
    }

    /// `Σ e²/S` of every window with whitened errors: noise of the input makes the error of a speed a random walk,
    /// whose prediction by a local-level filter is subtracted.
    ///
    /// ```text
    /// P += q Δt,   S = P + s²,   e = error - level,   level += P e/S,   P = P s²/S
    /// ```
    /// q: growth of the variance of a speed by noise of the input, s²: variance of the sensor.
    pub(in crate::diagnose) fn innovations(&self, errors: &[Errors]) -> Vec<f64> {
        self.windows.iter().zip(errors).map(|(w, e)| self.innovation(w, e)).collect()
    }

    fn innovation(&self, window: &Window, errors: &Errors) -> f64 {
        let recording = self.recordings[window.recording];
        let t = recording.t();
        let mut total = 0.0;
        for i in 0..2 {
            let (q, r) = (self.growth[window.recording][i], self.noise[window.recording][i]);
            let (mut level, mut variance) = (0.0, window.variance[i].max(TINY));
            for (k, e) in errors.error.iter().enumerate() {
                let row = window.rows.start + k;
                if k > 0 {
                    variance += q * (t[row] - t[row - 1]);
                }
                if self.weight(window, k, i) == 0.0 {
                    continue;
                }
                let s = variance + r;
                let innovation = e[i] - level;
                total += innovation * innovation / s;
                level += variance / s * innovation;
                variance *= r / s;
            }
        }
        total
    }

    /// Half of `Σ e²/s²` over all windows.
    #[must_use]
    pub fn cost(&self, model: &Model, p: &[f64]) -> Option<f64> {
        Some(0.5 * self.squares(model, p)?.iter().sum::<f64>())
    }
}
