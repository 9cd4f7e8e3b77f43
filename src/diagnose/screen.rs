//! How much each candidate could take off the error of the windows, to first order.
//!
//! A torque column moves the simulated speed by its integral over the inertia; the errors of the windows
//! are regressed on these integrals beside the derivatives of the simulation. It sees what is too fast for
//! a low-pass, at the full rate of the recording.

use nalgebra::{DMatrix, DVector};

use super::candidate::{Candidate, still_instant};
use super::nonnegative;
use super::windows::Windows;
use crate::compare::project;
use crate::effects::{Motion, Terms};
use crate::model::{Model, solve_mass};
use crate::recording::LocalMotion;
use crate::robot::State;

/// Share of a column's information that the base must leave for it to be looked at.
const COLLINEAR: f64 = 1e-7;

/// The errors of the windows with everything that candidates are regressed beside.
pub struct Screen<'a> {
    model: &'a Model,
    windows: &'a Windows<'a>,
    rows: Vec<Rows>,
    mass: [f64; 3],
    base: usize,
    information: DMatrix<f64>,
    score: DVector<f64>,
    square: f64,
    degrees: f64,
}

/// One window: error, derivatives and rest of the simulation.
struct Rows {
    weight: Vec<[f64; 2]>,
    error: Vec<[f64; 2]>,
    /// Derivatives of row k and wheel i, from place `(2 k + i) base` on.
    psi: Vec<f64>,
    still: Vec<[bool; 2]>,
    start: [f64; 2],
}

/// Sums over rows, for the lower rows of the information alone: those above are known.
struct Sums {
    /// First row that is summed, and number of columns.
    first: usize,
    columns: usize,
    /// Rows `first..columns`, one after the other.
    information: Vec<f64>,
    score: Vec<f64>,
    square: f64,
}

impl Sums {
    fn new(first: usize, columns: usize) -> Self {
        let information = vec![0.0; (columns - first) * columns];
        Self { first, columns, information, score: vec![0.0; columns], square: 0.0 }
    }

    /// Adds `weight` times the products of a row `psi` and its error.
    fn add(&mut self, weight: f64, error: f64, psi: &[f64]) {
        self.square += weight * error * error;
        let lower = self.information.chunks_exact_mut(self.columns);
        for (a, row) in (self.first..).zip(lower) {
            let weighted = weight * psi[a];
            self.score[a] += weighted * error;
            row[..=a].iter_mut().zip(psi).for_each(|(sum, value)| *sum += weighted * value);
        }
    }
}

impl<'a> Screen<'a> {
    /// The errors of `windows` under `model` at `p`, with `degrees` independent values among them. `None`
    /// where it cannot be simulated.
    #[must_use]
    pub fn new(
        model: &'a Model,
        p: &'a [f64],
        windows: &'a Windows<'a>,
        degrees: f64,
    ) -> Option<Self> {
        let free = model.free();
        let rows = windows.rows(model, p, &free)?;
        let rows: Vec<Rows> = rows
            .into_iter()
            .zip(&windows.windows)
            .map(|(row, window)| Rows {
                weight: windows.weights(window),
                error: row.iter().map(|r| r.error).collect(),
                still: row.iter().map(|r| r.still).collect(),
                psi: row.into_iter().flat_map(|r| r.psi).flatten().collect(),
                start: Windows::start_weight(window),
            })
            .collect();
        let mut this = Self {
            model,
            windows,
            rows,
            mass: terms(model, p).mass,
            base: free.len(),
            information: DMatrix::zeros(0, 0),
            score: DVector::zeros(0),
            square: 0.0,
            degrees,
        };
        (this.information, this.score, this.square) = this.sums(None);
        Some(this)
    }

    /// Information, score and squared error over the base and the columns of a candidate.
    fn sums(&self, candidate: Option<&Candidate>) -> (DMatrix<f64>, DVector<f64>, f64) {
        let (base, own) = (self.base, candidate.map_or(0, Candidate::columns));
        let n = base + own;
        // the base among itself is known but for the first time
        let mut sums = Sums::new(if own == 0 { 0 } else { base }, n);
        for (rows, window) in self.rows.iter().zip(&self.windows.windows) {
            let moved = candidate
                .map_or(vec![], |c| self.integrals(c, window.recording, window.rows.start, rows));
            for i in 0..2 {
                let mut psi = vec![0.0; n];
                let (mut weights, mut error, mut mean) = (rows.start[i], 0.0, vec![0.0; n]);
                let mut lasts = true;
                for k in 0..rows.error.len() {
                    lasts &= !rows.still[k][i];
                    let w = rows.weight[k][i];
                    if w == 0.0 {
                        continue;
                    }
                    psi[..base].copy_from_slice(&rows.psi[(2 * k + i) * base..][..base]);
                    let columns = moved.iter().skip(k * own).map(|column| column[i]);
                    psi[base..].iter_mut().zip(columns).for_each(|(p, column)| *p = column);
                    let e = rows.error[k][i];
                    sums.add(w, e, &psi);
                    if lasts {
                        weights += w;
                        error += w * e;
                        mean.iter_mut().zip(&psi).for_each(|(m, p)| *m += w * p);
                    }
                }
                // what a constant of the window explains
                let share = 1.0 / weights;
                mean.iter_mut().for_each(|m| *m *= share);
                sums.add(-weights, error * share, &mean);
            }
        }
        self.completed(sums)
    }

    /// The whole information and score.
    fn completed(&self, sums: Sums) -> (DMatrix<f64>, DVector<f64>, f64) {
        let n = sums.columns;
        let (mut h, mut g) = (DMatrix::zeros(n, n), DVector::from_vec(sums.score));
        for (a, row) in (sums.first..).zip(sums.information.chunks_exact(n)) {
            (0..=a).for_each(|b| h[(a, b)] = row[b]);
        }
        if sums.first > 0 {
            h.view_mut((0, 0), (self.base, self.base)).copy_from(&self.information);
            g.rows_mut(0, self.base).copy_from(&self.score);
        }
        h.fill_upper_triangle_with_lower_triangle();
        (h, g, sums.square)
    }

    /// What a torque of one in each column adds to the simulated speeds since the window's start, columns of
    /// row k from place `k columns` on.
    fn integrals(
        &self,
        candidate: &Candidate,
        recording: usize,
        first: usize,
        rows: &Rows,
    ) -> Vec<[f64; 2]> {
        let count = candidate.columns();
        let r = self.windows.recordings[recording];
        let motion: &[LocalMotion] = &self.windows.motions[recording];
        let t = r.t();
        let mut before = vec![[0.0; 2]; count];
        let mut now = vec![[0.0; 2]; count];
        let mut speed = vec![[0.0; 2]; count];
        let mut out = Vec::with_capacity(rows.still.len() * count);
        for (n, still) in rows.still.iter().enumerate() {
            let k = first + n;
            let at = still_instant(self.model, r, k, &motion[k]);
            candidate.torque_at_row(recording, &at, &mut now);
            if n > 0 {
                let h = t[k] - t[k - 1];
                for c in 0..count {
                    let mean = [0, 1].map(|i| 0.5 * (before[c][i] + now[c][i]));
                    let rate = self.accelerate(mean, *still);
                    let moving = |i: usize| if still[i] { 0.0 } else { speed[c][i] + h * rate[i] };
                    speed[c] = [0, 1].map(moving);
                }
            }
            out.extend_from_slice(&speed);
            std::mem::swap(&mut before, &mut now);
        }
        out
    }

    /// The acceleration that a torque gives wheels of which some rest.
    fn accelerate(&self, torque: [f64; 2], still: [bool; 2]) -> [f64; 2] {
        match still {
            [false, false] => solve_mass(&self.mass, &torque).unwrap_or([0.0; 2]),
            [false, true] => [torque[0] / self.mass[0], 0.0],
            [true, false] => [0.0, torque[1] / self.mass[2]],
            [true, true] => [0.0; 2],
        }
    }

    /// Twice the log-likelihood ratio of a candidate to first order, and the estimates of its columns.
    ///
    /// ```text
    /// LR = n ln(S0/S1),   S: squared error of the windows
    /// ```
    #[must_use]
    pub fn ratio(&self, candidate: &Candidate) -> (f64, Vec<f64>) {
        let count = candidate.columns();
        let (h, g, _) = self.sums(Some(candidate));
        let base: Vec<usize> = (0..self.base).collect();
        let own: Vec<usize> = (self.base..self.base + count).collect();
        let none = (0.0, vec![0.0; count]);
        let (information, score) = project(&h, &g, &base, &own);
        let seen = |n: usize| information[(n, n)] > COLLINEAR * h[(own[n], own[n])];
        if !(0..count).all(seen) {
            return none;
        }
        let bounded: Vec<bool> = (0..count).map(|n| candidate.not_negative(n)).collect();
        let (estimate, gain) = nonnegative::solve(&information, &score, &bounded);
        let after = (self.square - gain).max(1e-12 * self.square);
        (self.degrees * (self.square / after).ln(), estimate)
    }
}

fn terms(model: &Model, p: &[f64]) -> Terms<f64> {
    let State { alpha, omega } = State::default();
    model.terms(&Motion { t: 0.0, alpha, omega, variance: [0.0; 4], robot: model.robot() }, p)
}
