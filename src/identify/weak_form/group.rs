//! Windows of the weak form with the noise that their rows share.

use nalgebra::{DMatrix, DVector};

use crate::identify::Task;
use crate::identify::regressor::Regressor;
use crate::identify::weak::{Window, motion_at};
use crate::math::BandedCholesky;
use crate::recording::Recording;

/// Added to the covariance of the rows, as a share of its mean: overlapping test functions are nearly
/// dependent.
const RIDGE: f64 = 1e-10;

/// The windows of a recording, with derivatives of their rows by the speeds.
pub(super) struct Group {
    pub(super) x: DMatrix<f64>,
    pub(super) y: DVector<f64>,
    /// The change of `x` by adding the same noise once more.
    pub(super) change: DMatrix<f64>,
    pub(super) windows: Vec<Window>,
    /// Derivatives of row `2 window + wheel` by the speeds, `[row][column][sample of window]`;
    /// the last column is what is not linear.
    pub(super) slopes: Vec<Vec<Vec<[f64; 2]>>>,
    /// Variances of the speeds, and of the input of each wheel.
    pub(super) variance: [f64; 2],
    pub(super) input_variance: [f64; 2],
    /// Block of each window.
    pub(super) block: Vec<usize>,
}

impl Group {
    /// Derivative of row `row` of R θ by the speeds of its window.
    fn slope(&self, row: usize, values: &DVector<f64>) -> Vec<[f64; 2]> {
        let columns = &self.slopes[row];
        let mut out = columns[values.len()].clone();
        for (c, value) in values.iter().enumerate() {
            for (sum, slope) in out.iter_mut().zip(&columns[c]) {
                sum[0] += value * slope[0];
                sum[1] += value * slope[1];
            }
        }
        out
    }

    /// Covariance of the residuals. Windows that do not overlap share no noise, so it is banded.
    pub(super) fn covariance(&self, values: &DVector<f64>) -> Option<BandedCholesky> {
        let n = self.y.len();
        let slopes: Vec<_> = (0..n).map(|row| self.slope(row, values)).collect();
        let shared = |i: usize, k: usize| self.shared(&slopes, i, k);
        let ridge = RIDGE * (0..n).map(|i| shared(i, i)).sum::<f64>() / n as f64;
        let with_ridge = |i, k| shared(i, k) + if i == k { ridge } else { 0.0 };
        BandedCholesky::new(n, self.band(), with_ridge)
    }

    /// Rows before a row whose windows overlap its own, at most.
    fn band(&self) -> usize {
        let windows = &self.windows;
        let first = |n: usize| {
            let start = windows[n].samples.start;
            windows[..n].partition_point(|w| w.samples.end <= start)
        };
        (0..windows.len()).map(|n| 2 * (n - first(n)) + 1).max().unwrap_or(0)
    }

    /// Covariance of the residuals of two rows.
    fn shared(&self, slopes: &[Vec<[f64; 2]>], i: usize, k: usize) -> f64 {
        let (a, b) = (&self.windows[i / 2], &self.windows[k / 2]);
        let from = a.samples.start.max(b.samples.start);
        let to = a.samples.end.min(b.samples.end);
        if to <= from {
            return 0.0;
        }
        let of_speeds = slopes[i][from - a.samples.start..to - a.samples.start]
            .iter()
            .zip(&slopes[k][from - b.samples.start..])
            .fold([0.0; 2], |sum, (e, f)| [sum[0] + e[0] * f[0], sum[1] + e[1] * f[1]]);
        let of_speeds = self.variance[0] * of_speeds[0] + self.variance[1] * of_speeds[1];
        if i % 2 != k % 2 {
            return of_speeds;
        }
        let of_input: f64 = a.weight[from - a.samples.start..to - a.samples.start]
            .iter()
            .zip(&b.weight[from - b.samples.start..])
            .map(|(e, f)| e * f)
            .sum();
        of_speeds + self.input_variance[i % 2] * of_input
    }

    /// Adds to the columns the expectation of their noise given the residual, `(∂R_c/∂ω) S E' V⁻¹ r`.
    pub(super) fn correct(
        &self,
        values: &DVector<f64>,
        weighed: &DVector<f64>,
        left: &mut DMatrix<f64>,
    ) {
        let first = self.windows[0].samples.start;
        let last = self.windows.iter().map(|w| w.samples.end).max().unwrap_or(first);
        let mut expected = vec![[0.0; 2]; last - first];
        for (row, weight) in weighed.iter().enumerate() {
            let start = self.windows[row / 2].samples.start - first;
            for (s, e) in self.slope(row, values).iter().enumerate() {
                for l in 0..2 {
                    expected[start + s][l] += self.variance[l] * e[l] * weight;
                }
            }
        }
        for row in 0..weighed.len() {
            let start = self.windows[row / 2].samples.start - first;
            for c in 0..values.len() {
                let slopes = self.slopes[row][c].iter().zip(&expected[start..]);
                left[(row, c)] += slopes.map(|(d, z)| d[0] * z[0] + d[1] * z[1]).sum::<f64>();
            }
        }
    }
}

/// Derivatives of the rows of consecutive windows by the speeds.
pub(super) fn slopes(
    task: &Task,
    regressor: &Regressor,
    recording: &Recording,
    windows: &[Window],
) -> Vec<Vec<Vec<[f64; 2]>>> {
    let width = regressor.width();
    let first = windows[0].samples.start;
    let last = windows.iter().map(|w| w.samples.end).max().unwrap_or(first);
    let mut work = regressor.work();
    let instants: Vec<_> = (first..last)
        .map(|k| {
            let motion = motion_at(task, recording, k, recording.omega()[k]);
            (regressor.at(&motion).mass, regressor.slopes(&motion, &mut work))
        })
        .collect();
    let mut out = Vec::with_capacity(2 * windows.len());
    for window in windows {
        for wheel in 0..2 {
            let column = |c: usize| -> Vec<[f64; 2]> {
                let along = window.weight.iter().zip(&window.slope);
                let at = window.samples.clone().zip(along);
                at.map(|(k, (weight, slope))| {
                    let (mass, torque) = &instants[k - first];
                    let [m11, m12, m22] = mass[c];
                    let mass = if wheel == 0 { [m11, m12] } else { [m12, m22] };
                    [0, 1].map(|l| weight * torque[c][wheel][l] - slope * mass[l])
                })
                .collect()
            };
            out.push((0..=width).map(column).collect());
        }
    }
    out
}
