//! An upper limit of the noise of the speeds, from a linear model of one row.

use nalgebra::{DMatrix, DVector};

use super::Recording;
use crate::math::least_squares::fit_above;
use crate::math::{sgn, trimmed_mean_square};

/// Number of coefficients of a wheel.
const COLUMNS: usize = 9;
/// Fewest rows per coefficient, and number of rows that is sufficient for a variance.
const FEWEST: usize = 10;
const ENOUGH: usize = 5000;
/// Largest relative difference of a step in time from the median.
const EVEN: f64 = 0.1;
/// Largest share of a speed that is left after a row: ten rows per time constant.
const MEMORY: f64 = 0.9;
/// Relative size of singular values that are rounding: the columns of a single axis are equal.
const RANK: f64 = 1e-8;

/// Upper limit of the standard deviation of the noise of the speeds, right wheel first [rad/s]: the residual of
///
/// ```text
/// ω(k+1) = Φ ω(k) + Γ0 M(k) + Γ1 M(k+1) - C sgn ω(k) + c,   Var = (1 + φ'φ) σ² + what the model lacks
/// ```
/// Fourth differences take the response to steps of the input for noise if a log is slow compared with the robot; this model,
/// exact for linear dynamics and an input that is held or linear between rows, does not. The noise of ω(k+1) is
/// independent of the columns, so the residual is not below it. One row in 20 is left out (stops, reversals).
/// Infinite for sensors slower than the rows, for too few rows, and for a model with a memory of more than ten rows
/// (`Φ` near 1), as in most logs: there fourth differences are accurate, and filtered noise would be predicted.
pub(super) fn most_noise_of_speeds(recording: &Recording) -> [f64; 2] {
    let (omega, torque, t) = (recording.omega(), recording.torque(), recording.t());
    let step = recording.step();
    let even = |k: &usize| ((t[k + 1] - t[*k]) / step - 1.0).abs() < EVEN;
    let pairs = recording.pieces().iter().flat_map(|p| p.start..p.end.saturating_sub(1));
    let pairs: Vec<usize> = pairs.filter(even).collect();
    let unlimited = [f64::INFINITY; 2];
    if recording.rows_per_refresh() > 1 || pairs.len() < FEWEST * COLUMNS {
        return unlimited;
    }
    let pairs: Vec<usize> = pairs.iter().copied().step_by(pairs.len().div_ceil(ENOUGH)).collect();
    let row = |n: usize, j: usize| {
        let k = pairs[n];
        let i = j % 2;
        match j / 2 {
            0 => omega[k][i],
            1 => torque[k][i],
            2 => torque[k + 1][i],
            3 => sgn(omega[k][i]),
            _ => 1.0,
        }
    };
    let x = DMatrix::from_fn(pairs.len(), COLUMNS, row);
    [0, 1].map(|i| {
        let y = DVector::from_iterator(pairs.len(), pairs.iter().map(|&k| omega[k + 1][i]));
        let fit = fit_above(RANK, &x, &y, None).ok().filter(|fit| fit.coefficients[i] < MEMORY);
        let squares = fit.map(|fit| fit.residuals.iter().map(|r| r * r).collect());
        squares.map_or(f64::INFINITY, |squares| trimmed_mean_square(squares).sqrt())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::recording::{Channels, DriveUnit};
    use crate::robot::{Robot, State};
    use crate::simulate::{Hold, Input, simulate};
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn steps_of_the_input_are_not_taken_for_noise_in_a_slow_log() {
        let model = Model::base(Robot::amigobot()).add("back_emf").unwrap();
        let mut p = model.initial();
        // a time constant of 150 ms, recorded at 10 Hz, with steps every second
        p[5] = (p[0] + p[1]) / 0.15;
        let t: Vec<f64> = (0..600).map(|k| 0.1 * f64::from(k)).collect();
        let level = |k: usize| 0.4 + 1.5 * ((k / 10 * 7919) % 13) as f64 / 13.0;
        let torque: Vec<[f64; 2]> = (0..t.len()).map(|k| [level(k), level(k + 40)]).collect();
        let input = Input { t: &t, torque: &torque, hold: Hold::Constant };
        let motion = simulate(&model, &p, &input, State::default()).unwrap();
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let mut noisy = |w: f64| -> f64 {
            let draw: f64 = StandardNormal.sample(&mut rng);
            w + 0.05 * draw
        };
        let omega = motion.iter().map(|s| s.omega.map(&mut noisy)).collect();
        let channels = Channels { t, alpha: None, omega: Some(omega), torque };
        let recording = Recording::new("slow", channels, DriveUnit::Volt).unwrap();
        // sqrt(1 + φ²) = 1.12 with φ = exp(-0.1/0.15); 600 rows determine it to 3 %
        for most in most_noise_of_speeds(&recording) {
            assert!((0.05..0.064).contains(&most), "{most}");
        }
        for noise in recording.motion_noise().omega {
            assert!((0.045..0.064).contains(&noise), "{noise}");
        }
    }
}
