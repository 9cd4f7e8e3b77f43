//! Low-pass-filtered regression of the input torque, used for screening and for a first estimate of
//! the dead time.
//!
//! The torque that a model leaves unexplained on the smoothed motion is regressed on the columns of
//! candidates, all of them low-passed alike and without a phase shift.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::by_recording::{ByRecording, ratio};
use super::candidate::{Candidate, still_instant};
use super::input_timing::Shifted;
use super::smoothed::{Smooth, Smoothed};
use crate::compare::{FilterBuffer, REST, WIDTH, filter_together, filtered};
use crate::effects::{Motion, along};
use crate::math::{FILLED, Real, add_products, least_squares, nonnegative, orthonormal};
use crate::model::{Linearisation, Model};
use crate::recording::{LocalMotion, Recording};

/// Rows that are kept per cycle of the cut-off.
const KEPT: f64 = 8.0;
/// Smallest share of a column that is independent of the base, for it to be evaluated.
const COLLINEAR: f64 = 1e-4;
/// Smallest singular value of the columns of the base, as a share of the largest, that is a direction of its own.
const DEPENDENT: f64 = 1e-8;
/// Shifts whose sums are formed together: as many as hide the time of an addition.
const SHIFTS: usize = 8;

/// The rows of all recordings on which candidates are regressed.
pub(super) struct Regression<'a> {
    model: &'a Model,
    p: &'a [f64],
    speed: f64,
    smoothed: Smoothed<'a>,
    /// Rows that are kept: recording, row, wheel.
    rows: Vec<(usize, usize, usize)>,
    /// Columns of the free parameters [N m per unit], and an orthonormal basis of them.
    base: DMatrix<f64>,
    basis: DMatrix<f64>,
    /// Torque that the model at `p` leaves unexplained [N m].
    torque: DVector<f64>,
    /// Residual torque after the base [N m].
    residual: DVector<f64>,
    /// The basis and, after it, the residual torque, row by row, padded to `width` numbers.
    beside: Vec<f64>,
    width: usize,
    /// Independent values among the rows.
    pub(super) degrees: f64,
}

/// Memory for the columns of a candidate, to be used again for the next one.
#[derive(Default)]
pub(super) struct Buffers {
    signals: Vec<Vec<[f64; 2]>>,
    filter: FilterBuffer,
    rows: Vec<f64>,
}

impl<'a> Regression<'a> {
    /// The regression of `smoothed` recordings on the free parameters of `model` around `p`; speeds below a share of
    /// `speed` [rad/s] count as rest. `None` if no rows are left.
    #[must_use]
    pub(super) fn new(
        model: &'a Model,
        p: &'a [f64],
        smoothed: &Smoothed<'a>,
        speed: f64,
    ) -> Option<Self> {
        let mut this = Self {
            model,
            p,
            speed,
            smoothed: smoothed.clone(),
            rows: vec![],
            base: DMatrix::zeros(0, 0),
            basis: DMatrix::zeros(0, 0),
            torque: DVector::zeros(0),
            residual: DVector::zeros(0),
            beside: vec![],
            width: 0,
            degrees: 0.0,
        };
        this.choose_rows();
        let (columns, residual) = this.base_columns();
        if this.rows.len() < 4 * columns.ncols().max(4) {
            return None;
        }
        this.basis = orthonormal(columns.clone(), DEPENDENT);
        this.residual = &residual - &this.basis * this.basis.tr_mul(&residual);
        (this.base, this.torque) = (columns, residual);
        this.set_beside();
        Some(this)
    }

    fn set_beside(&mut self) {
        let base = self.basis.ncols();
        self.width = (base + 1).next_multiple_of(FILLED);
        self.beside = vec![0.0; self.rows.len() * self.width];
        for (row, out) in self.beside.chunks_exact_mut(self.width).enumerate() {
            (0..base).for_each(|b| out[b] = self.basis[(row, b)]);
            out[base] = self.residual[row];
        }
    }

    /// One of so many rows is kept.
    fn every(&self, r: &Recording) -> usize {
        (1.0 / (KEPT * self.smoothed.cutoff * r.step())).floor().max(1.0) as usize
    }

    /// Rows on which a wheel moves, thinned to independent ones after the low-pass.
    fn choose_rows(&mut self) {
        let mut moving = 0.0;
        for (index, smooth) in self.smoothed.recordings.iter().enumerate() {
            let r = smooth.recording;
            let (every, wheels) = (self.every(r), r.wheels());
            for piece in r.pieces() {
                for k in piece.clone() {
                    for i in wheels.clone() {
                        if smooth.motion[k].omega[i].abs() <= REST * self.speed {
                            continue;
                        }
                        moving += r.step();
                        if (k - piece.start) % every == 0 {
                            self.rows.push((index, k, i));
                        }
                    }
                }
            }
        }
        self.degrees = 2.0 * self.smoothed.cutoff * moving;
    }

    /// Columns of the free parameters and the residual torque at `p`, low-passed, at the rows.
    fn base_columns(&self) -> (DMatrix<f64>, DVector<f64>) {
        let free = self.model.free();
        let mut work = Linearisation::new(self.p.len());
        let mut columns = DMatrix::zeros(self.rows.len(), free.len());
        let mut residual = DVector::zeros(self.rows.len());
        for smooth in self.smoothed.recordings.iter() {
            let r = smooth.recording;
            let (acting, by_input) = self.model.input_derivatives_of(r, r.torque(), self.p);
            let mut signals = vec![vec![[0.0; 2]; r.len()]; free.len() + 1];
            // the input is filtered twice; all other columns are computed from motion that is already
            // filtered once
            let input = filtered(r, self.smoothed.cutoff, &acting);
            for k in 0..r.len() {
                let m = &smooth.motion[k];
                let x = self.motion(smooth, k);
                let sign = self.signs(m);
                self.model.linearise(&x, self.p, &m.acceleration, &sign, &mut work);
                let needed = work.terms.total_torque(&m.acceleration, &sign);
                signals[free.len()][k] = [0, 1].map(|i| input[k][i] - needed[i]);
                for (n, &j) in free.iter().enumerate() {
                    let by = by_input[j].get(k).copied().unwrap_or([0.0; 2]);
                    signals[n][k] = [0, 1].map(|i| work.by_parameter[j][i] - by[i]);
                }
            }
            filter_together(r, self.smoothed.cutoff, &mut signals, &mut FilterBuffer::default());
            for (row, k, i) in self.rows_of(smooth) {
                (0..free.len()).for_each(|n| columns[(row, n)] = signals[n][k][i]);
                residual[row] = signals[free.len()][k][i];
            }
        }
        (columns, residual)
    }

    /// Rows of a recording: number among all, row of the recording, wheel.
    fn rows_of(&self, smooth: &Smooth) -> impl Iterator<Item = (usize, usize, usize)> {
        let own = self.numbers_of(smooth);
        own.clone().zip(&self.rows[own]).map(|(row, (_, k, i))| (row, *k, *i))
    }

    /// The numbers of the rows of a recording.
    fn numbers_of(&self, smooth: &Smooth) -> Range<usize> {
        let before = |index: usize| self.rows.partition_point(|row| row.0 < index);
        before(smooth.index)..before(smooth.index + 1)
    }

    fn motion<'b>(&'b self, smooth: &Smooth, k: usize) -> Motion<'b, f64> {
        let (m, t) = (&smooth.motion[k], smooth.recording.t());
        let (alpha, omega, robot) = (m.alpha, m.omega, self.model.robot());
        Motion::at(t[k] - t[0], alpha, omega, robot)
    }

    fn signs(&self, m: &LocalMotion) -> [f64; 4] {
        let width = WIDTH * self.speed;
        std::array::from_fn(|j| Real::erf(along(j, &m.omega) / width))
    }

    /// Time over which [`Regression::squares_at_shifts`] hardly changes \[s\]: an eighth of the period of a square of
    /// what the low-pass leaves.
    #[must_use]
    pub(super) fn smooth_over(&self) -> f64 {
        1.0 / (16.0 * self.smoothed.cutoff)
    }

    /// Residual sum of squares of the base.
    #[must_use]
    pub(super) fn residual_square(&self) -> f64 {
        self.residual.norm_squared()
    }

    /// Residual sums of squares of the base with the input so many seconds later each, which changes the torques by c.
    ///
    /// ```text
    /// |r + (I - QQ')c|² = |r|² + 2 r'c + |c|² - |Q'c|²,   Q'r = 0
    /// ```
    #[must_use]
    pub(super) fn squares_at_shifts(&self, shifts: &[f64]) -> Vec<f64> {
        shifts.chunks(SHIFTS).flat_map(|some| self.squares_side_by_side(some)).collect()
    }

    /// The same of a few shifts, whose sums are formed together: one alone waits for each of its additions.
    fn squares_side_by_side(&self, shifts: &[f64]) -> Vec<f64> {
        let (count, base) = (shifts.len(), self.basis.ncols());
        let changes = self.changes(shifts);
        let mut squares = vec![0.0; count];
        for row in changes.chunks_exact(count) {
            squares.iter_mut().zip(row).for_each(|(square, change)| *square += change * change);
        }
        let mut products = vec![0.0; count * self.width];
        add_products((&changes, count), (&self.beside, self.width), &mut products);
        let of_one = |(square, products): (f64, &[f64])| {
            let by_base: f64 = products[..base].iter().map(|product| product * product).sum();
            (self.residual_square() + 2.0 * products[base] + square - by_base).max(0.0)
        };
        squares.into_iter().zip(products.chunks_exact(self.width)).map(of_one).collect()
    }

    /// How the torque of every row changes with the input so many seconds later each, row by row.
    fn changes(&self, shifts: &[f64]) -> Vec<f64> {
        let count = shifts.len();
        let mut changes = vec![0.0; self.rows.len() * count];
        for smooth in self.smoothed.recordings.iter() {
            let mut later = Shifted::new(smooth.recording, &smooth.input, shifts);
            // both wheels of a row follow each other
            let (mut last, mut torques) = (usize::MAX, [[0.0; 2]; SHIFTS]);
            for number in self.numbers_of(smooth) {
                let (_, k, i) = self.rows[number];
                if k != last {
                    last = k;
                    later.at(k, |n, torque| torques[n] = torque);
                }
                let now = smooth.input[k][i];
                let row = changes[number * count..][..count].iter_mut();
                row.zip(&torques).for_each(|(change, torque)| *change = torque[i] - now);
            }
        }
        changes
    }

    /// Twice the log-likelihood ratio of a candidate, and the estimates of its columns.
    ///
    /// ```text
    /// LR = n ln(RSS0/RSS1),   n = 2 fc T
    /// ```
    #[must_use]
    pub(super) fn ratio(&self, candidate: &Candidate, memory: &mut Buffers) -> (f64, Vec<f64>) {
        let (count, base) = (candidate.columns(), self.basis.ncols());
        let none = (0.0, vec![0.0; count]);
        let Products { among, beside } = self.products(candidate, memory);
        let before = beside.columns(0, base);
        // in an orthonormal basis, products of residuals are differences of products
        let h = &among - before * before.transpose();
        let left = |n: usize| h[(n, n)].max(0.0).sqrt();
        if !(0..count).all(|n| left(n) > COLLINEAR * among[(n, n)].sqrt()) {
            return none;
        }
        // columns of a candidate are on the side of the input, those of the base on that of the motion
        let g = -beside.column(base);
        let bounded: Vec<bool> = (0..count).map(|n| candidate.not_negative(n)).collect();
        let (solution, gain) = nonnegative(&h, &g, &bounded);
        (ratio(self.degrees, self.residual_square(), gain), solution)
    }

    /// Initial values of a fit with the candidate: the free parameters of the model and the linear ones of
    /// the candidate that together explain the input torque. The regression has no stiction, which can trap a
    /// simulation that starts from wrong values.
    #[must_use]
    pub(super) fn start(&self, candidate: &Candidate) -> Option<(Vec<f64>, Vec<f64>)> {
        let (rows, count) = (self.rows.len(), candidate.columns());
        let base = self.base.ncols();
        let mut all = DMatrix::zeros(rows, base + count);
        all.columns_mut(0, base).copy_from(&self.base);
        self.each_recording(candidate, &mut Buffers::default(), |numbers, width, rows| {
            for (number, row) in numbers.zip(rows.chunks_exact(width)) {
                (0..count).for_each(|n| all[(number, base + n)] = -row[n]);
            }
        });
        let values = least_squares::fit(&all, &self.torque, None).ok()?.coefficients;
        let free = self.model.free();
        let mut p = self.p.to_vec();
        free.iter().zip(&values).for_each(|(&j, v)| p[j] += v);
        Some((p, values.as_slice()[base..].to_vec()))
    }

    /// The products of a candidate's columns over all rows.
    fn products(&self, candidate: &Candidate, memory: &mut Buffers) -> Products {
        let (count, base) = (candidate.columns(), self.basis.ncols());
        let none = Products {
            among: DMatrix::zeros(count, count),
            beside: DMatrix::zeros(count, base + 1),
        };
        self.products_by_recording(candidate, memory).into_iter().fold(none, |sum, one| Products {
            among: sum.among + one.among,
            beside: sum.beside + one.beside,
        })
    }

    /// The same over the rows of each recording.
    fn products_by_recording(&self, candidate: &Candidate, memory: &mut Buffers) -> Vec<Products> {
        let (count, base, beside) = (candidate.columns(), self.basis.ncols(), self.width);
        let own = own_width(count);
        let mut out = Vec::with_capacity(self.smoothed.recordings.len());
        self.each_recording(candidate, memory, |numbers, width, rows| {
            let (mut by_own, mut by_beside) = (vec![0.0; count * own], vec![0.0; count * beside]);
            let others = &self.beside[numbers.start * beside..numbers.end * beside];
            add_products((rows, width), (others, beside), &mut by_beside);
            add_products((rows, width), (rows, width), &mut by_own);
            out.push(Products {
                among: DMatrix::from_fn(count, count, |n, m| by_own[n * own + m]),
                beside: DMatrix::from_fn(count, base + 1, |n, b| by_beside[n * beside + b]),
            });
        });
        out
    }

    /// Calls `see` for every recording with the numbers of its rows and the columns of a candidate at them, low-passed:
    /// so many numbers per row, filled up with zeros.
    fn each_recording(
        &self,
        candidate: &Candidate,
        memory: &mut Buffers,
        mut see: impl FnMut(Range<usize>, usize, &[f64]),
    ) {
        let count = candidate.columns();
        let width = own_width(count);
        let Buffers { signals, filter, rows } = memory;
        signals.resize_with(count.max(signals.len()), Vec::new);
        let signals = &mut signals[..count];
        for smooth in self.smoothed.recordings.iter() {
            let r = smooth.recording;
            signals.iter_mut().for_each(Vec::clear);
            let at = |k: usize| still_instant(self.model, r, k, &smooth.motion[k]);
            candidate.torque_at_rows(smooth.index, (0..r.len()).map(at), |torque| {
                signals.iter_mut().zip(torque).for_each(|(signal, value)| signal.push(*value));
            });
            filter_together(r, self.smoothed.cutoff, signals, filter);
            let numbers = self.numbers_of(smooth);
            rows.clear();
            rows.resize(numbers.len() * width, 0.0);
            for (row, (_, k, i)) in rows.chunks_exact_mut(width).zip(self.rows_of(smooth)) {
                row.iter_mut().zip(&*signals).for_each(|(out, signal)| *out = signal[k][i]);
            }
            see(numbers, width, rows);
        }
    }

    /// Information of the low-passed torques of each recording on a candidate's columns.
    pub(super) fn by_recording(&self, candidate: &Candidate, memory: &mut Buffers) -> ByRecording {
        let each = self.products_by_recording(candidate, memory);
        let count = candidate.columns();
        let base = each.first().map_or(0, |products| products.beside.ncols() - 1);
        let size = each.len() * count;
        let mut among = DMatrix::zeros(size, size);
        let mut beside = DMatrix::zeros(size, base + 1);
        for (r, products) in each.into_iter().enumerate() {
            among.view_mut((r * count, r * count), (count, count)).copy_from(&products.among);
            beside.rows_mut(r * count, count).copy_from(&products.beside);
        }
        let by_base = beside.columns(0, base);
        ByRecording {
            information: among - by_base * by_base.transpose(),
            // columns of a candidate are on the side of the input, those of the base on that of the motion
            score: -beside.column(base),
            square: self.residual_square(),
            degrees: self.degrees,
        }
    }
}

/// Products of a candidate's columns with each other, and with the basis and, in the last column, the residual torque.
struct Products {
    among: DMatrix<f64>,
    beside: DMatrix<f64>,
}

/// Padded width of a row with `count` columns.
fn own_width(count: usize) -> usize {
    count.next_multiple_of(FILLED)
}
