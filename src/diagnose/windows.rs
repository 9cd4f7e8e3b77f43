//! The simulation error over short windows as a cost, with its derivatives.
//!
//! A window is simulated in open loop from the smoothed state at its first row. The error component
//! due to the uncertain initial state is profiled out, so that short windows cause no bias.

mod compared;
mod errors;
mod growing;
mod linear;
mod several;
mod sums;
mod window;

use std::ops::Range;

use nalgebra::DVector;
use rayon::prelude::*;

use self::compared::{Compared, every, is_new, variance};
pub(super) use self::errors::Errors;
use self::linear::Linear;
use self::sums::{Accumulator, TINY};
pub(super) use self::sums::{Sums, quadratic_of};
use self::window::{See, Window, cut};
use super::input_timing::input_derivatives;
use super::thresholds::THRESHOLDS;
use crate::effects::{Motion, Scale};
use crate::math::descent::Quadratic;
use crate::math::median;
use crate::model::{Model, inverse_mass};
use crate::recording::{Recording, Start};
use crate::robot::State;
use crate::simulate::{ActingInput, Asked, BETWEEN_ROWS, Follower, Hold, LANES, halved};

/// Recordings cut into windows.
#[derive(Clone)]
pub struct Windows<'a> {
    /// The recordings that are cut into windows.
    pub recordings: Vec<&'a Recording>,
    /// Every window, in order.
    pub windows: Vec<Window>,
    /// The input between the rows.
    pub hold: Hold,
    /// Variance of the measured speeds of each recording and wheel [rad^2/s^2].
    noise: Vec<[f64; 2]>,
    /// Variance that noise of the input adds to a speed, per second of simulation [rad^2/s^3].
    growth: Vec<[f64; 2]>,
}

impl<'a> Windows<'a> {
    /// Cuts `recordings` into windows of about 1 s. The [`mobility`] of `model` at `p` decides how noise of the
    /// recorded input spreads into the simulated speed.
    #[must_use]
    pub fn new(recordings: Vec<&'a Recording>, hold: Hold, model: &Model, p: &[f64]) -> Self {
        let rows: Vec<_> = recordings.iter().map(|r| r.pieces().to_vec()).collect();
        Self::of_rows(recordings, hold, (model, p), &rows)
    }

    /// The same over parts of the recordings only, the ranges `rows` of each; each range lies in one piece.
    pub(super) fn of_rows(
        recordings: Vec<&'a Recording>,
        hold: Hold,
        (model, p): (&Model, &[f64]),
        rows: &[Vec<Range<usize>>],
    ) -> Self {
        let mobility = mobility(model, p);
        let mut windows = Vec::new();
        for (r, (recording, rows)) in recordings.iter().zip(rows).enumerate() {
            for piece in rows {
                windows.extend(cut(recording, piece).map(|rows| {
                    let Start { state: start, omega_square_error: variance } =
                        recording.start_at(rows.start);
                    Window { recording: r, rows, start, variance, share: [1.0; 2], growing: None }
                }));
            }
        }
        let levels = recordings.iter().map(|r| r.input_noise());
        let (noise, growth) = levels
            .zip(&recordings)
            .map(|(noise, r)| {
                let rounding = rounding(r);
                let speed = [0, 1].map(|i| variance(r, i).max(rounding * rounding));
                let input = noise.map(|s| (s * mobility).powi(2) * r.step());
                let most = |i: usize| THRESHOLDS.most_growth * speed[i] / THRESHOLDS.window_s;
                (speed, [0, 1].map(|i| input[i].min(most(i))))
            })
            .unzip();
        Self { recordings, windows, hold, noise, growth }
    }

    /// [`Windows::new`] with the weights of [`Windows::sampled`] and the responses to growing errors of the start, all of
    /// `model` at `p`.
    #[must_use]
    pub fn weighted(recordings: Vec<&'a Recording>, hold: Hold, model: &Model, p: &[f64]) -> Self {
        Self::new(recordings, hold, model, p).sampled(model, p).growing(model, p)
    }

    /// The same windows, with weights that include errors of `model` at `p` other than noise. First, the
    /// unknown input between the rows: a third of the change by omitting every other row, zero for a held
    /// input. A window in which a wheel comes to rest or breaks away a row earlier or later has errors far
    /// above noise for any parameters, and would otherwise dominate the fit. Second, errors of the model: if
    /// they are larger than noise, all windows have the same weight, also those of recordings with less
    /// noise.
    ///
    /// ```text
    /// weight × (σ_r²/σ²) (σ² + m²)/(σ_r² + m² + d²/9)
    /// ```
    /// d: change by every other row, m: median error of all windows, σ_r: noise of the recording, σ: mean noise.
    #[must_use]
    pub fn sampled(mut self, model: &Model, p: &[f64]) -> Self {
        let (whole, halves) = if self.hold == Hold::Constant {
            let Some(whole) = self.errors(model, p) else { return self };
            (whole, vec![])
        } else {
            let Some([whole, even, odd]) = self.errors_by_halves(model, p) else { return self };
            (whole, vec![even, odd])
        };
        let mut changed = vec![[0.0; 2]; self.windows.len()];
        for errors in halves {
            for ((sum, a), b) in changed.iter_mut().zip(&errors).zip(&whole) {
                let square = b.apart(a);
                *sum = [0, 1].map(|i| sum[i] + 0.5 * BETWEEN_ROWS.powi(2) * square[i]);
            }
        }
        let own = median(whole.iter().flat_map(Errors::mean_squares));
        let noise = &self.noise;
        let mean = noise.iter().flatten().sum::<f64>() / (2 * noise.len()) as f64;
        for (window, changed) in self.windows.iter_mut().zip(changed) {
            let own_noise = noise[window.recording];
            window.share = [0, 1]
                .map(|i| own_noise[i] / mean * (mean + own) / (own_noise[i] + own + changed[i]));
        }
        self
    }

    /// The recordings with only every other row of the input.
    pub(super) fn halved(&self, phase: usize) -> Vec<Recording> {
        self.recordings.iter().map(|r| halved(r, phase)).collect()
    }

    /// The windows whose number `keep` takes, of the same recordings.
    pub(super) fn only(&self, keep: impl Fn(usize) -> bool) -> Self {
        let windows = self.windows.iter().enumerate().filter(|(n, _)| keep(*n));
        Self { windows: windows.map(|(_, w)| w.clone()).collect(), ..self.clone() }
    }

    /// The same windows, with the same weights, of recordings that differ in their input alone.
    pub(super) fn with_recordings<'b>(&self, recordings: Vec<&'b Recording>) -> Windows<'b>
    where
        'a: 'b,
    {
        Windows { recordings, ..self.clone() }
    }

    /// Number of speeds in all windows.
    pub(super) fn values(&self) -> usize {
        let speeds = |w: &Window| 2 * w.rows.len() / every(self.recordings[w.recording]);
        self.windows.iter().map(speeds).sum()
    }

    /// The fold of a window, 0 or 1: thirds of the rows of each recording in turn, every other recording
    /// starting with the other fold. Thirds of the time may be empty, where the logger paused.
    pub(super) fn fold(&self, n: usize) -> usize {
        let window = &self.windows[n];
        let rows = self.recordings[window.recording].len();
        (3 * window.rows.start / rows + window.recording) % 2
    }

    /// One over the variance of the speed error of a wheel, at each row of a window; zero in rows
    /// without a new value.
    fn weight(&self, window: &Window, row: usize, wheel: usize) -> f64 {
        let (r, k) = (window.recording, window.rows.start + row);
        let recording = self.recordings[r];
        let known = row > 0 || recording.measured().omega;
        if !(is_new(recording, k, row) && known) {
            return 0.0;
        }
        let t = recording.t();
        let since = t[k] - t[window.rows.start];
        window.share[wheel] / (self.noise[r][wheel] + self.growth[r][wheel] * since)
    }

    /// The sums of every window over the columns `free` of the parameters.
    #[must_use]
    pub fn sums(&self, model: &Model, p: &[f64], free: &[usize]) -> Option<Vec<Sums>> {
        let sum = |window: &Window, follow: Follow| {
            let mut sums = Accumulator::new(free.len(), window.rows.len());
            follow(&mut |k, i, e, psi, still| {
                sums.add((window, k, i), e, psi, self.weight(window, k, i), still)
            })?;
            sums.finish(&window.variance)
        };
        self.each(model, p, free, sum)
    }

    /// The sums of every window from its `rows`, which hold derivatives by `columns` parameters.
    pub(super) fn sums_of(&self, rows: &[Vec<Row>], columns: usize) -> Option<Vec<Sums>> {
        let sum = |(rows, window): (&Vec<Row>, &Window)| {
            let mut sums = Accumulator::new(columns, window.rows.len());
            for (k, row) in rows.iter().enumerate() {
                for i in 0..2 {
                    let weight = self.weight(window, k, i);
                    let of = (window, k, i);
                    sums.add(of, row.error[i], &row.psi[i], weight, row.still[i]);
                }
            }
            sums.finish(&window.variance)
        };
        rows.iter().zip(&self.windows).map(sum).collect()
    }

    /// Error, derivatives and rest of every row of every window.
    pub(super) fn rows(&self, model: &Model, p: &[f64], free: &[usize]) -> Option<Vec<Vec<Row>>> {
        let keep = |window: &Window, follow: Follow| {
            let mut rows = vec![Row::default(); window.rows.len()];
            follow(&mut |k, i, e, psi, still| {
                let row = &mut rows[k];
                (row.error[i], row.still[i]) = (e, still);
                row.psi[i] = psi.to_vec();
            })?;
            Some(rows)
        };
        self.each(model, p, free, keep)
    }

    /// Calls `make` for every window with a function that visits its rows, in parallel.
    fn each<T: Send>(
        &self,
        model: &Model,
        p: &[f64],
        free: &[usize],
        make: impl Fn(&Window, Follow) -> Option<T> + Sync,
    ) -> Option<Vec<T>> {
        if model.is_coupled() {
            return self.each_by_differences(model, p, free, make);
        }
        let sizes = sizes(model, p, free);
        let acting: Vec<_> =
            self.recordings.par_iter().map(|r| input_derivatives(model, r, p)).collect();
        let stride = (p.len() + 4).next_multiple_of(LANES);
        let begin = |r: &&Recording| Follower::new(model, p, r.t()[0], Asked::Parameters);
        let followers: Vec<Follower> = self.recordings.iter().map(begin).collect();
        let first_ones = free.iter().enumerate().all(|(n, &j)| n == j);
        self.windows
            .par_iter()
            .map(|window| {
                let (r, rows) = (window.recording, window.rows.clone());
                let recording = self.recordings[r];
                let (input, derivatives) = &acting[r];
                let (t, hold) = (recording.t(), self.hold);
                let input = ActingInput { t, acting: input, derivatives, hold };
                let linear = Linear::new(&sizes, recording.top_speed());
                make(window, &mut |see| {
                    let see = &mut linear.see(see);
                    let mut psi = Vec::with_capacity(free.len());
                    let mut compared = Compared::new(recording, window);
                    let mut before = [0, 1].map(|_| vec![0.0; free.len()]);
                    let visit = &mut |k: usize, state: &State, d: &[f64]| {
                        let row = compared.row(k, state);
                        let of = |signal: usize, j: usize| d[signal * stride + j];
                        for i in 0..2 {
                            let still = state.omega[i] == 0.0;
                            if row.mean_over.is_none() && first_ones {
                                let psi = &d[(2 + i) * stride..][..free.len()];
                                see(k, i, row.error[i], psi, still);
                                continue;
                            }
                            psi.clear();
                            match row.mean_over {
                                None => psi.extend(free.iter().map(|&j| of(2 + i, j))),
                                Some(time) => {
                                    let rise = |(&j, b): (&usize, &f64)| (of(i, j) - b) / time;
                                    psi.extend(free.iter().zip(&before[i]).map(rise));
                                }
                            }
                            if row.mean_over.is_some_and(f64::is_finite) {
                                before[i].clear();
                                before[i].extend(free.iter().map(|&j| of(i, j)));
                            }
                            see(k, i, row.error[i], &psi, still);
                        }
                        true
                    };
                    let part = (rows.clone(), window.start);
                    followers[r].clone().follow(&input, part, visit).ok()
                })
            })
            .collect()
    }

    /// The same by forward differences, for models with a second body.
    fn each_by_differences<T: Send>(
        &self,
        model: &Model,
        p: &[f64],
        free: &[usize],
        make: impl Fn(&Window, Follow) -> Option<T> + Sync,
    ) -> Option<Vec<T>> {
        let middle = self.errors(model, p)?;
        let sizes = sizes(model, p, free);
        let by: Vec<(Vec<Errors>, f64)> = free
            .par_iter()
            .map(|&j| {
                let h = DIFFERENCE * size(model, p, j);
                let mut q = p.to_vec();
                q[j] += h;
                Some((self.errors(model, &q)?, h))
            })
            .collect::<Option<_>>()?;
        self.windows
            .par_iter()
            .enumerate()
            .map(|(n, window)| {
                let top = self.recordings[window.recording].top_speed();
                let linear = Linear::new(&sizes, top);
                make(window, &mut |see| {
                    let see = &mut linear.see(see);
                    let mut psi = Vec::with_capacity(free.len());
                    for k in 0..window.rows.len() {
                        for i in 0..2 {
                            psi.clear();
                            // the error is measured less simulated, so its derivative changes sign
                            let now = middle[n].error[k][i];
                            psi.extend(by.iter().map(|(up, h)| (now - up[n].error[k][i]) / h));
                            let still = k >= middle[n].moving[i];
                            see(k, i, middle[n].error[k][i], &psi, still);
                        }
                    }
                    Some(())
                })
            })
            .collect()
    }

    /// Cost, gradient and curvature over all windows.
    #[must_use]
    pub fn quadratic(&self, model: &Model, p: &[f64], free: &[usize]) -> Option<Quadratic> {
        quadratic_of(&self.sums(model, p, free)?, free.len())
    }

    /// Weights, by row and wheel, of the errors that are regressed on the columns of a screening,
    /// see [`super::screen`].
    pub(super) fn weights(&self, window: &Window) -> Vec<[f64; 2]> {
        (0..window.rows.len()).map(|k| [0, 1].map(|i| self.weight(window, k, i))).collect()
    }

    /// One over the variance of the start's speeds.
    pub(super) fn start_weight(window: &Window) -> [f64; 2] {
        window.variance.map(|v| 1.0 / v.max(TINY))
    }
}

/// Relative step of forward differences: the root of the precision to which a window is simulated (1e-12).
const DIFFERENCE: f64 = 1e-6;

/// Visits all rows of a window; `None` where the simulation fails.
type Follow<'a> = &'a mut dyn FnMut(See) -> Option<()>;

/// A row of a window.
#[derive(Clone, Debug, Default)]
pub(super) struct Row {
    /// Measured less simulated speeds [rad/s].
    pub(super) error: [f64; 2],
    /// Derivatives of the simulated speed of each wheel.
    pub(super) psi: [Vec<f64>; 2],
    /// Whether the simulated wheel rests.
    pub(super) still: [bool; 2],
}

/// Rounding of a speed \[rad/s\], which a channel without visible noise still has.
fn rounding(recording: &Recording) -> f64 {
    1e-6 * recording.top_speed()
}

/// Magnitude of parameter `j`; of one near zero a thousandth of the typical value.
fn size(model: &Model, p: &[f64], j: usize) -> f64 {
    p[j].abs().max(1e-3 * model.parameters()[j].spec.typical.abs())
}

fn sizes(model: &Model, p: &[f64], free: &[usize]) -> Vec<f64> {
    free.iter().map(|&j| size(model, p, j)).collect()
}

/// The acceleration of a wheel per unit torque on it [1/(kg m²)], of a model at parameters `p`.
#[must_use]
pub fn mobility(model: &Model, p: &[f64]) -> f64 {
    let x = Motion::at(0.0, [0.0; 2], [0.0; 2], model.robot());
    inverse_mass(&model.terms(&x, p).mass).map_or(0.0, |inverse| inverse[0])
}

/// Lower and upper bounds of the parameters `free` on recordings of that scale.
#[must_use]
pub(super) fn bounds(model: &Model, scale: &Scale, free: &[usize]) -> [DVector<f64>; 2] {
    let limits: Vec<(f64, f64)> =
        model.effects().iter().flat_map(|effect| effect.limits(scale)).collect();
    let lower = free.iter().map(|&j| limits[j].0);
    let upper = free.iter().map(|&j| limits[j].1);
    [DVector::from_iterator(free.len(), lower), DVector::from_iterator(free.len(), upper)]
}
