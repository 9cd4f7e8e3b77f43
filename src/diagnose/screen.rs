//! First-order estimate of the reduction of the errors of the windows by each candidate.
//!
//! A torque column moves the simulated speed by its integral over the inertia; the errors of the windows are
//! regressed on these integrals beside the derivatives of the simulation. At the full rate of the recording,
//! it detects effects that are too fast for the low-pass.

use nalgebra::{DMatrix, DVector};

use super::by_recording::{ByRecording, ratio};
use super::candidate::{Candidate, still_instant};
use super::windows::{Row, Windows, quadratic_of};
use crate::effects::{Motion, Terms};
use crate::math::{FILLED, add_products, eliminate, nonnegative};
use crate::model::{Model, inverse_mass, times};
use crate::robot::State;

/// Smallest share of a column's information that is independent of the base, for it to be evaluated.
const COLLINEAR: f64 = 1e-7;

/// The errors of the windows, with the regressors of the base model.
pub(super) struct Screen<'a> {
    model: &'a Model,
    windows: &'a Windows<'a>,
    rows: Vec<Rows>,
    mobility: Mobility,
    base: usize,
    information: DMatrix<f64>,
    score: DVector<f64>,
    square: f64,
    degrees: f64,
}

/// One window of a simulation, weighted.
struct Rows {
    weight: Vec<[f64; 2]>,
    /// Of each wheel, row by row: derivatives, error, and one as long as a constant of the window lasts, all times the
    /// weight, filled up to `width` numbers.
    weighted: [Vec<f64>; 2],
    width: usize,
    still: Vec<[bool; 2]>,
    /// One over the sum of the weights while the constant lasts, the start's among them.
    share: [f64; 2],
    /// Sums of `weighted` while the constant lasts.
    mean: [Vec<f64>; 2],
}

impl Rows {
    fn new(rows: Vec<Row>, weight: Vec<[f64; 2]>, start: [f64; 2], base: usize) -> Self {
        let width = (base + 2).next_multiple_of(FILLED);
        let mut weighted = [0, 1].map(|_| vec![0.0; width * rows.len()]);
        let mut mean = [vec![0.0; width], vec![0.0; width]];
        for i in 0..2 {
            let mut lasts = true;
            for (k, (row, out)) in rows.iter().zip(weighted[i].chunks_exact_mut(width)).enumerate()
            {
                lasts &= !row.still[i];
                let w = weight[k][i];
                // a row with zero weight is not used, whatever its values
                if w == 0.0 {
                    continue;
                }
                out.iter_mut().zip(&row.psi[i]).for_each(|(out, psi)| *out = w * psi);
                out[base] = w * row.error[i];
                if lasts {
                    out[base + 1] = w;
                    mean[i].iter_mut().zip(&*out).for_each(|(sum, value)| *sum += value);
                }
            }
        }
        let share = [0, 1].map(|i| 1.0 / (start[i] + mean[i][base + 1]));
        let still = rows.into_iter().map(|row| row.still).collect();
        Self { weight, weighted, width, still, share, mean }
    }
}

/// Contribution of a candidate to the information and the score: products of its columns with the base, with each
/// other and with the errors.
struct Products {
    by_base: DMatrix<f64>,
    own: DMatrix<f64>,
    score: DVector<f64>,
}

impl<'a> Screen<'a> {
    /// The errors of `windows` under `model` at `p`, with `degrees` independent values among them. `None`
    /// where it cannot be simulated.
    #[must_use]
    pub(super) fn new(
        model: &'a Model,
        p: &'a [f64],
        windows: &'a Windows<'a>,
        degrees: f64,
    ) -> Option<Self> {
        let free = model.free();
        let base = free.len();
        let rows = windows.rows(model, p, &free)?;
        let quadratic = quadratic_of(&windows.sums_of(&rows, base)?, base)?;
        let rows = rows.into_iter().zip(&windows.windows).map(|(rows, window)| {
            Rows::new(rows, windows.weights(window), Windows::start_weight(window), base)
        });
        Some(Self {
            model,
            windows,
            rows: rows.collect(),
            mobility: Mobility::of(&terms(model, p).mass),
            base,
            information: quadratic.hessian,
            score: -quadratic.gradient,
            square: 2.0 * quadratic.cost,
            degrees,
        })
    }

    /// The products of a candidate's columns over the windows of the recordings that `of` takes.
    fn products(&self, candidate: &Candidate, of: impl Fn(usize) -> bool) -> Products {
        let (base, own) = (self.base, candidate.columns());
        let mut sums = Products {
            by_base: DMatrix::zeros(own, base),
            own: DMatrix::zeros(own, own),
            score: DVector::zeros(own),
        };
        let mut heavy = Vec::new();
        let windows = self.rows.iter().zip(&self.windows.windows);
        for (rows, window) in windows.filter(|(_, window)| of(window.recording)) {
            let moved = self.integrals(candidate, window.recording, window.rows.start, rows);
            let (width, beside) = (rows.width, own.next_multiple_of(FILLED));
            for i in 0..2 {
                let columns = (&moved[i][..], own);
                let mut by_row = vec![0.0; own * width];
                add_products(columns, (&rows.weighted[i], width), &mut by_row);
                // the columns times the weight
                heavy.clear();
                heavy.resize(beside * rows.weight.len(), 0.0);
                let each = heavy.chunks_exact_mut(beside).zip(moved[i].chunks_exact(own));
                for ((out, columns), weight) in each.zip(&rows.weight) {
                    out.iter_mut().zip(columns).for_each(|(out, value)| *out = weight[i] * value);
                }
                let mut among = vec![0.0; own * beside];
                add_products(columns, (&heavy, beside), &mut among);
                // the part explained by a constant of the window
                let constant = |c: usize| rows.share[i] * by_row[c * width + base + 1];
                let mean = &rows.mean[i];
                for c in 0..own {
                    let by_row_of = |b: usize| by_row[c * width + b] - constant(c) * mean[b];
                    (0..base).for_each(|b| sums.by_base[(c, b)] += by_row_of(b));
                    sums.score[c] += by_row_of(base);
                    for d in 0..=c {
                        let explained = constant(c) * by_row[d * width + base + 1];
                        sums.own[(c, d)] += among[c * beside + d] - explained;
                    }
                }
            }
        }
        sums.own.fill_upper_triangle_with_lower_triangle();
        sums
    }

    /// Change of the simulated speed of each wheel since the start of the window by a unit coefficient of each
    /// column; columns of row k from place `k columns` on.
    fn integrals(
        &self,
        candidate: &Candidate,
        recording: usize,
        first: usize,
        rows: &Rows,
    ) -> [Vec<f64>; 2] {
        let count = candidate.columns();
        let r = self.windows.recordings[recording];
        let (t, motion) = (r.t(), r.local_motion());
        let mut before = vec![[0.0; 2]; count];
        let mut speed = vec![[0.0; 2]; count];
        let mut out = [0, 1].map(|_| Vec::with_capacity(rows.still.len() * count));
        let at = |k: usize| still_instant(self.model, r, k, &motion[k]);
        let (mut k, last) = (first, first + rows.still.len());
        candidate.torque_at_rows(recording, (first..last).map(at), |now| {
            if k > first {
                let (still, h) = (rows.still[k - first], t[k] - t[k - 1]);
                let mobility = self.mobility.with_rest(still);
                for (speed, (before, now)) in speed.iter_mut().zip(before.iter().zip(now)) {
                    let mean = [0.5 * (before[0] + now[0]), 0.5 * (before[1] + now[1])];
                    let rate = times(&mobility, &mean);
                    *speed = [speed[0] + h * rate[0], speed[1] + h * rate[1]];
                }
                for i in (0..2).filter(|&i| still[i]) {
                    speed.iter_mut().for_each(|speed| speed[i] = 0.0);
                }
            }
            for (i, out) in out.iter_mut().enumerate() {
                out.extend(speed.iter().map(|speed| speed[i]));
            }
            before.copy_from_slice(now);
            k += 1;
        });
        out
    }

    /// Information and score over the base and columns that have nothing in common with each other.
    fn completed(&self, of: &[Products]) -> (DMatrix<f64>, DVector<f64>) {
        let base = self.base;
        let n = base + of.iter().map(|products| products.score.len()).sum::<usize>();
        let (mut h, mut g) = (DMatrix::zeros(n, n), DVector::zeros(n));
        h.view_mut((0, 0), (base, base)).copy_from(&self.information);
        g.rows_mut(0, base).copy_from(&self.score);
        let mut first = base;
        for products in of {
            let own = products.score.len();
            h.view_mut((first, 0), (own, base)).copy_from(&products.by_base);
            h.view_mut((0, first), (base, own)).copy_from(&products.by_base.transpose());
            h.view_mut((first, first), (own, own)).copy_from(&products.own);
            g.rows_mut(first, own).copy_from(&products.score);
            first += own;
        }
        (h, g)
    }

    /// Information of the windows of each recording on a candidate's columns.
    pub(super) fn by_recording(&self, candidate: &Candidate) -> ByRecording {
        let recordings = 0..self.windows.recordings.len();
        let all: Vec<Products> =
            recordings.map(|r| self.products(candidate, |of| of == r)).collect();
        let (h, g) = self.completed(&all);
        let base: Vec<usize> = (0..self.base).collect();
        let own: Vec<usize> = (self.base..h.nrows()).collect();
        let (information, score) = eliminate(&h, &g, &base, &own);
        ByRecording { information, score, square: self.square, degrees: self.degrees }
    }

    /// Twice the log-likelihood ratio of a candidate to first order, and the estimates of its columns.
    ///
    /// ```text
    /// LR = n ln(S0/S1),   S: squared error of the windows
    /// ```
    #[must_use]
    pub(super) fn ratio(&self, candidate: &Candidate) -> (f64, Vec<f64>) {
        let count = candidate.columns();
        let (h, g) = self.completed(&[self.products(candidate, |_| true)]);
        let base: Vec<usize> = (0..self.base).collect();
        let own: Vec<usize> = (self.base..self.base + count).collect();
        let none = (0.0, vec![0.0; count]);
        let (information, score) = eliminate(&h, &g, &base, &own);
        let seen = |n: usize| information[(n, n)] > COLLINEAR * h[(own[n], own[n])];
        if !(0..count).all(seen) {
            return none;
        }
        let bounded: Vec<bool> = (0..count).map(|n| candidate.not_negative(n)).collect();
        let (estimate, gain) = nonnegative(&information, &score, &bounded);
        (ratio(self.degrees, self.square, gain), estimate)
    }
}

/// The accelerations due to torques on wheels of which none or one is at rest.
struct Mobility {
    both: [f64; 3],
    alone: [f64; 2],
}

impl Mobility {
    fn of(mass: &[f64; 3]) -> Self {
        let both = inverse_mass(mass).unwrap_or([0.0; 3]);
        Self { both, alone: [1.0 / mass[0], 1.0 / mass[2]] }
    }

    /// The inverse mass matrix (m11, m12, m22) while these wheels rest.
    fn with_rest(&self, still: [bool; 2]) -> [f64; 3] {
        match still {
            [false, false] => self.both,
            [false, true] => [self.alone[0], 0.0, 0.0],
            [true, false] => [0.0, 0.0, self.alone[1]],
            [true, true] => [0.0; 3],
        }
    }
}

fn terms(model: &Model, p: &[f64]) -> Terms<f64> {
    let State { alpha, omega } = State::default();
    model.terms(&Motion { t: 0.0, alpha, omega, variance: [0.0; 4], robot: model.robot() }, p)
}
