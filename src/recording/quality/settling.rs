//! Rows that last longer than the motion takes to settle.
//!
//! ```text
//! w_(k+1) = phi w_k + phi' w'_k + b M_k + b' M'_k + c sgn w_k + e,   h/tau = -ln phi      (w', M': the other wheel)
//! ```
//! over rows in which the wheel turns one way. The speeds of row k are replaced by their projection on those and the
//! inputs of row k - 1 (two-stage least squares): the noise of a sensor would lower phi.

use nalgebra::{DMatrix, DVector};

use super::super::Recording;
use super::{Finding, Issue, Severity};
use crate::math::fit;
use crate::math::least_squares::{RANK_TOLERANCE, fits_above};

/// Fewest pairs of rows: ten per coefficient.
const ROWS: usize = 50;
/// Standard errors by which phi must be below that of one time constant.
const SURE: f64 = 2.0;
/// Largest standard error of a phi that is known: constant inputs do not show it.
const KNOWN: f64 = 0.1;
/// Share of the change of the speeds that the equation must explain; noise alone has no time constant.
const EXPLAINED: f64 = 0.5;
/// Smallest phi that is distinguished from zero: three time constants in a row.
const SMALLEST: f64 = 0.05;

/// The finding on a wheel that settles within a row.
pub(super) fn finding(r: &Recording) -> Option<Finding> {
    if !r.measured().omega || r.is_single_axis() {
        return None;
    }
    let settles = [0, 1].map(|i| phi(r, i));
    let fastest = settles.into_iter().flatten().min_by(f64::total_cmp)?;
    let step_s = r.step();
    let constant_s = -step_s / fastest.max(SMALLEST).ln();
    Some(Finding::new(Severity::Warning, Issue::Settles { step_s, constant_s }))
}

/// phi of wheel `i` if a row is longer than its time constant.
fn phi(r: &Recording, i: usize) -> Option<f64> {
    let (w, m, j) = (r.omega(), r.torque(), 1 - i);
    let rows: Vec<usize> = r
        .pieces()
        .iter()
        .flat_map(|piece| piece.start + 1..piece.end.saturating_sub(1))
        .filter(|&k| w[k - 1][i] * w[k][i] > 0.0 && w[k][i] * w[k + 1][i] > 0.0)
        .collect();
    if rows.len() < ROWS {
        return None;
    }
    let n = rows.len();
    let known = |k: usize, c: usize| match c {
        0 => m[k][i],
        1 => m[k][j],
        _ => w[k][i].signum(),
    };
    let before = |k: usize, c: usize| match c {
        0 => w[k - 1][i],
        1 => w[k - 1][j],
        2 => m[k - 1][i],
        _ => m[k - 1][j],
    };
    let x =
        DMatrix::from_fn(
            n,
            7,
            |row, c| {
                if c < 4 { before(rows[row], c) } else { known(rows[row], c - 4) }
            },
        );
    let speeds = [i, j].map(|wheel| DVector::from_fn(n, |row, _| w[rows[row]][wheel]));
    let stages = fits_above(RANK_TOLERANCE, &x, speeds).ok()?;
    let [own, other] = stages.map(|stage| &x * stage.coefficients);
    let y = DVector::from_fn(n, |row, _| w[rows[row] + 1][i]);
    let x = DMatrix::from_fn(n, 5, |row, c| match c {
        0 => own[row],
        1 => other[row],
        _ => known(rows[row], c - 2),
    });
    let last = fit(&x, &y, None).ok()?;
    let rest = (&y - &x * &last.coefficients).norm_squared();
    let mean = y.mean();
    let all: f64 = y.iter().map(|v| (v - mean).powi(2)).sum();
    let (value, error) = (last.coefficients[0], last.std_errors[0]);
    // a negative value of more than its error is no decay
    let is_known = error < KNOWN && value > -SURE * error;
    let is_fast = value + SURE * error < (-1.0_f64).exp();
    let is_one = is_known && is_fast && rest < (1.0 - EXPLAINED) * all;
    is_one.then_some(value)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::recording::{Channels, DriveUnit};

    /// Wheels with this time constant under a voltage that changes every `hold` rows, with noise of the sensor.
    fn log(rate: f64, tau: f64, hold: usize, noise: f64) -> Option<Finding> {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
        let (step, inner) = (1.0 / rate, 200);
        let (mut omega, mut w, mut m) = (vec![], [0.0; 2], [0.0; 2]);
        let mut torque = vec![];
        for k in 0..1500 {
            if k % hold == 0 {
                m = [3.0 * draw(), 3.0 * draw()];
            }
            omega.push([w[0] + noise * draw(), w[1] + noise * draw()]);
            torque.push(m);
            for _ in 0..inner {
                let rate_of = |i: usize| (2.0 * m[i] - w[i]) / tau;
                w = [0, 1].map(|i| w[i] + step / f64::from(inner) * rate_of(i));
            }
        }
        let t = (0..1500).map(|k| step * f64::from(k)).collect();
        let channels = Channels { t, alpha: None, omega: Some(omega), torque };
        finding(&Recording::new("log", channels, DriveUnit::Volt).unwrap())
    }

    #[test]
    fn rows_longer_than_the_time_constant_are_reported_and_others_are_not() {
        let found = log(20.0, 0.02, 3, 0.05).unwrap();
        let Issue::Settles { step_s, constant_s } = found.issue else { panic!("{found:?}") };
        // a time constant from the 8 % of a step that are left after a row, under noise of 1 % of a step
        assert!((step_s - 0.05).abs() < 1e-12 && (constant_s - 0.02).abs() < 0.003, "{found:?}");
        assert_eq!(log(20.0, 0.1, 3, 0.05), None);
        // noise as large as a third of the speeds does not shorten the time constant
        assert_eq!(log(100.0, 0.05, 20, 2.0), None);
    }
}
