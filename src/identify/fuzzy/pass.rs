//! One run of the emulator over a piece of a recording: wheel speeds alone, Runge-Kutta 4, with
//! the derivative of that very scheme where it is asked for.

use std::convert::Infallible;

use nalgebra::DMatrix;

use crate::math::runge_kutta_step;
use crate::recording::Recording;
use crate::simulate::{Hold, Structure, TakagiSugeno};

/// Longest step of the integrator in fitting [s].
const LONGEST_STEP: f64 = 0.01;
/// A wheel speed beyond which a trial has left all bounds [rad/s].
const LIMIT: f64 = 1e3;

/// A stretch of a recording without a gap.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    t: Vec<f64>,
    /// Measured speeds [rad/s].
    pub(super) omega: Vec<[f64; 2]>,
    /// G u [rad/s²].
    drive: Vec<[f64; 2]>,
    hold: Hold,
    /// Standard deviation of the measured speeds [rad/s].
    sigma: [f64; 2],
}

/// What acts between two samples, in straight lines.
#[derive(Clone, Copy)]
struct Between {
    omega: [[f64; 2]; 2],
    drive: [[f64; 2]; 2],
}

impl Between {
    fn at(ends: &[[f64; 2]; 2], c: f64) -> [f64; 2] {
        [0, 1].map(|i| ends[0][i] + c * (ends[1][i] - ends[0][i]))
    }
}

impl Piece {
    /// All pieces of a recording, with the input turned into accelerations.
    pub(super) fn all(recording: &Recording, gain: &[[f64; 2]; 2], hold: Hold) -> Vec<Self> {
        let sigma = recording.noise().omega;
        let accelerate = |u: &[f64; 2]| [0, 1].map(|i| gain[i][0] * u[0] + gain[i][1] * u[1]);
        let pieces = recording.pieces().iter().cloned();
        pieces
            .map(|piece| Self {
                t: recording.t()[piece.clone()].to_vec(),
                omega: recording.omega()[piece.clone()].to_vec(),
                drive: recording.moment()[piece].iter().map(accelerate).collect(),
                hold,
                sigma,
            })
            .collect()
    }

    /// ∫ sigma1² + sigma2² dt [rad²/s].
    pub(super) fn noise_floor(&self) -> f64 {
        let length = self.t[self.t.len() - 1] - self.t[0];
        length * self.sigma.iter().map(|s| s * s).sum::<f64>()
    }

    /// Weight of sample k in the trapezoid rule [s].
    fn weight(&self, k: usize) -> f64 {
        let before = if k > 0 { self.t[k] - self.t[k - 1] } else { 0.0 };
        let after = if k + 1 < self.t.len() { self.t[k + 1] - self.t[k] } else { 0.0 };
        0.5 * (before + after)
    }

    /// (number of steps, their length [s]) from sample k - 1 to k, and what acts between.
    fn interval(&self, k: usize) -> (usize, f64, Between) {
        let dt = self.t[k] - self.t[k - 1];
        let steps = ((dt / LONGEST_STEP - 1e-6).ceil() as usize).max(1);
        let last = if self.hold == Hold::Linear { k } else { k - 1 };
        let between = Between {
            omega: [self.omega[k - 1], self.omega[k]],
            drive: [self.drive[k - 1], self.drive[last]],
        };
        (steps, dt / steps as f64, between)
    }
}

/// ISE of one piece; `None` where the emulator diverges.
pub(super) fn pass(
    system: &TakagiSugeno,
    piece: &Piece,
    structure: Structure,
    gain: f64,
) -> Option<f64> {
    let mut w = piece.omega[0];
    let mut cost = 0.0;
    for k in 1..piece.t.len() {
        let (steps, h, between) = piece.interval(k);
        for step in 0..steps {
            let rate = |c: f64, w: &[f64; 2]| {
                let c = (step as f64 + c) / steps as f64;
                let (y, u) = (Between::at(&between.omega, c), Between::at(&between.drive, c));
                let f = system.output(if structure == Structure::Parallel { w } else { &y });
                Ok::<_, Infallible>([0, 1].map(|i| f[i] + u[i] + gain * (y[i] - w[i])))
            };
            let Ok(after) = runge_kutta_step(&w, h, rate);
            w = after;
        }
        if !w.iter().all(|w| w.abs() < LIMIT) {
            return None;
        }
        let e = [0, 1].map(|i| piece.omega[k][i] - w[i]);
        cost += piece.weight(k) * (e[0] * e[0] + e[1] * e[1]);
    }
    Some(cost)
}

/// The same with the derivative of the scheme to all consequents (and premises); the rows go to
/// `rows`. False where the emulator diverges.
///
/// ```text
/// S' = (∂fhat/∂what - K) S + ∂fhat/∂theta      (serial-parallel: without ∂fhat/∂what)
/// ```
pub(super) fn pass_with_sensitivities(
    system: &TakagiSugeno,
    piece: &Piece,
    structure: Structure,
    gain: f64,
    premises: bool,
    rows: &mut Rows,
) -> bool {
    const STAGES: [(f64, f64); 4] = [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)];
    let p = rows.columns();
    let n = system.parameters().len() / 2;
    let mut w = piece.omega[0];
    // both rows of S, one behind the other
    let (mut s, mut slope, mut total) = (vec![0.0; 2 * p], vec![0.0; 2 * p], vec![0.0; 2 * p]);
    let mut stage = vec![0.0; 2 * p];
    let mut basis = vec![0.0; n];
    for k in 1..piece.t.len() {
        let (steps, h, between) = piece.interval(k);
        for step in 0..steps {
            let (mut rate, mut sum) = ([0.0; 2], [0.0; 2]);
            slope.fill(0.0);
            total.fill(0.0);
            for (at, weight) in STAGES {
                let c = (step as f64 + at) / steps as f64;
                let (y, u) = (Between::at(&between.omega, c), Between::at(&between.drive, c));
                let x = [0, 1].map(|i| w[i] + at * h * rate[i]);
                let argument = if structure == Structure::Parallel { x } else { y };
                let (f, mut jacobian) = system.output_and_gradient(&argument);
                if structure == Structure::SerialParallel {
                    jacobian = [[0.0; 2]; 2];
                }
                rate = [0, 1].map(|i| f[i] + u[i] + gain * (y[i] - x[i]));
                for i in 0..2 {
                    jacobian[i][i] -= gain;
                    sum[i] += weight * rate[i];
                }
                for ((stage, s), slope) in stage.iter_mut().zip(&s).zip(&slope) {
                    *stage = s + at * h * slope;
                }
                let (top, bottom) = stage.split_at(p);
                for (i, row) in slope.chunks_exact_mut(p).enumerate() {
                    for ((slope, a), b) in row.iter_mut().zip(top).zip(bottom) {
                        *slope = jacobian[i][0] * a + jacobian[i][1] * b;
                    }
                }
                system.basis(&argument, &mut basis);
                for (j, b) in basis.iter().enumerate() {
                    slope[j] += b;
                    slope[p + n + j] += b;
                }
                if premises {
                    for (j, d) in system.premise_gradient(&argument).iter().enumerate() {
                        slope[2 * n + j] += d[0];
                        slope[p + 2 * n + j] += d[1];
                    }
                }
                for (total, slope) in total.iter_mut().zip(&slope) {
                    *total += weight * slope;
                }
            }
            w = [0, 1].map(|i| w[i] + h / 6.0 * sum[i]);
            for (s, total) in s.iter_mut().zip(&total) {
                *s += h / 6.0 * total;
            }
        }
        if !w.iter().all(|w| w.abs() < LIMIT) {
            return false;
        }
        for i in 0..2 {
            rows.push(&s[i * p..(i + 1) * p], &[piece.omega[k][i] - w[i]], piece.weight(k));
        }
    }
    true
}

/// The serial-parallel structure, linear in the consequents: Psi of one output is that of the
/// other, so one row serves the two errors.
pub(super) fn pass_closed(system: &TakagiSugeno, piece: &Piece, gain: f64, rows: &mut Rows) {
    let n = rows.columns();
    let mut w = piece.omega[0];
    let mut psi = vec![0.0; n];
    let mut basis = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
    for k in 1..piece.t.len() {
        let (steps, h, between) = piece.interval(k);
        // Runge-Kutta 4 of x' = -K x + b(t): x(1 - z + z²/2 - z³/6 + z⁴/24) + weights of b
        let z = gain * h;
        let decay = 1.0 - z + z * z / 2.0 - z * z * z / 6.0 + z * z * z * z / 24.0;
        let first = h / 6.0 * (1.0 - z + z * z / 2.0 - z * z * z / 4.0);
        let middle = h / 6.0 * (4.0 - 2.0 * z + z * z / 2.0);
        for step in 0..steps {
            let mut forcing = [[0.0; 2]; 3];
            for (s, c) in [0.0, 0.5, 1.0].into_iter().enumerate() {
                let c = (step as f64 + c) / steps as f64;
                let (y, u) = (Between::at(&between.omega, c), Between::at(&between.drive, c));
                let f = system.output(&y);
                forcing[s] = [0, 1].map(|i| f[i] + u[i] + gain * y[i]);
                system.basis(&y, &mut basis[s]);
            }
            let [a, b, c] = forcing;
            w = [0, 1].map(|i| decay * w[i] + first * a[i] + middle * b[i] + h / 6.0 * c[i]);
            for (j, psi) in psi.iter_mut().enumerate() {
                *psi = decay * *psi
                    + first * basis[0][j]
                    + middle * basis[1][j]
                    + h / 6.0 * basis[2][j];
            }
        }
        let e = [0, 1].map(|i| piece.omega[k][i] - w[i]);
        rows.push(&psi, &e, piece.weight(k));
    }
}

/// Normal equations gathered row by row, in blocks so that the products are fast.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    /// ∫ S'S dt.
    pub(super) h: DMatrix<f64>,
    /// ∫ S'e dt, one column an error.
    pub(super) g: DMatrix<f64>,
    /// ∫ e² dt.
    pub(super) cost: f64,
    block: Vec<f64>,
}

/// Rows of a block.
const BLOCK: usize = 256;

impl Rows {
    pub(super) fn new(columns: usize, errors: usize) -> Self {
        Self {
            h: DMatrix::zeros(columns, columns),
            g: DMatrix::zeros(columns, errors),
            cost: 0.0,
            block: Vec::with_capacity(BLOCK * columns),
        }
    }

    fn columns(&self) -> usize {
        self.h.nrows()
    }

    fn push(&mut self, row: &[f64], errors: &[f64], weight: f64) {
        for (j, e) in errors.iter().enumerate() {
            self.cost += weight * e * e;
            for (g, x) in self.g.column_mut(j).iter_mut().zip(row) {
                *g += weight * e * x;
            }
        }
        let root = weight.sqrt();
        self.block.extend(row.iter().map(|x| root * x));
        if self.block.len() == BLOCK * self.columns() {
            self.flush();
        }
    }

    fn flush(&mut self) {
        let rows = self.block.len() / self.columns();
        if rows == 0 {
            return;
        }
        let x = DMatrix::from_column_slice(self.columns(), rows, &self.block);
        self.h.gemm(1.0, &x, &x.transpose(), 1.0);
        self.block.clear();
    }

    pub(super) fn finished(mut self) -> Self {
        self.flush();
        self
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.h += &other.h;
        self.g += &other.g;
        self.cost += other.cost;
    }
}
