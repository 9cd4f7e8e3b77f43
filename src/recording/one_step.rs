//! Upper limits of the noise of speeds and input, from a linear model of one row.

use nalgebra::{DMatrix, DVector};

use super::Recording;
use super::channels::MostNoise;
use crate::math::least_squares::fits_above;
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
/// Share of the top speed below which a wheel may have rested within a row (chosen by judgement).
const SLOW: f64 = 0.05;
/// Relative size of singular values that are rounding: the columns of a single axis are equal.
const RANK: f64 = 1e-8;

/// Upper limits of the noise of the speeds and of the input: from the residual of
///
/// ```text
/// ω(k+1) = Φ ω(k) + Γ0 M(k) + Γ1 M(k+1) - C sgn ω(k) + c,   Var = (1 + φ'φ) σ_ω² + γ'γ σ_M² + what the model lacks
/// σ_ω² ≤ Var/(1 + φ'φ),   σ_M² ≤ Var/γ'γ
/// ```
/// over rows in which no wheel rests or reverses. Fourth differences take the response to steps of the input, and in a
/// slow log the steps, for noise; this model, exact for linear dynamics and an input that is held or linear between
/// rows, does not. Noise of a column makes its coefficient smaller by a factor λ, and the residual contains `γ'γ
/// σ_M²/λ` of the smaller one, so that the limits hold. One row in 20 is left out. Both inputs are assumed to have
/// equal noise, and have the lower limit of both. Infinite for sensors slower than the rows, for too few rows, and for
/// a model with a memory of more than ten rows (`Φ` near 1), as in most logs: there fourth differences are accurate,
/// and filtered noise would be predicted.
pub(super) fn most_noise(recording: &Recording) -> MostNoise {
    let pairs = pairs(recording);
    let unlimited = [f64::INFINITY; 2];
    if recording.rows_per_refresh() > 1 || pairs.len() < FEWEST * COLUMNS {
        return MostNoise { omega: unlimited, input: unlimited };
    }
    let (omega, torque) = (recording.omega(), recording.torque());
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
    let next =
        |i: usize| DVector::from_iterator(pairs.len(), pairs.iter().map(|&k| omega[k + 1][i]));
    let fits = fits_above(RANK, &x, [next(0), next(1)]).ok();
    let limit = |i: usize| {
        let fit = fits.as_ref().map(|fits| &fits[i]).filter(|fit| fit.coefficients[i] < MEMORY)?;
        let residual = trimmed_mean_square(fit.residuals.iter().map(|r| r * r).collect()).sqrt();
        let [by_speeds, by_inputs] = [(0, 2), (2, 4)].map(|(j, n)| fit.coefficients.rows(j, n));
        Some((residual / (1.0 + by_speeds.norm_squared()).sqrt(), residual / by_inputs.norm()))
    };
    let limits = [limit(0), limit(1)];
    let of =
        |value: fn((f64, f64)) -> f64| limits.map(|limits| limits.map_or(f64::INFINITY, value));
    let input = of(|(_, input)| input).into_iter().fold(f64::INFINITY, f64::min);
    MostNoise { omega: of(|(omega, _)| omega), input: [input; 2] }
}

/// At most [`ENOUGH`] rows with a successor after an even step in time: those in which both wheels turn, in one
/// direction; any, if they are too few.
fn pairs(recording: &Recording) -> Vec<usize> {
    let (omega, t, step) = (recording.omega(), recording.t(), recording.step());
    let slow = SLOW * recording.top_speed();
    let even = |k: &usize| ((t[k + 1] - t[*k]) / step - 1.0).abs() < EVEN;
    let turns = |k: &usize| {
        let (now, next) = (omega[*k], omega[k + 1]);
        (0..2).all(|i| now[i] * next[i] > 0.0 && now[i].abs().min(next[i].abs()) > slow)
    };
    let all = recording.pieces().iter().flat_map(|p| p.start..p.end.saturating_sub(1));
    let all: Vec<usize> = all.filter(even).collect();
    let turning: Vec<usize> = all.iter().copied().filter(turns).collect();
    let some = if turning.len() < FEWEST * COLUMNS { all } else { turning };
    some.iter().copied().step_by(some.len().div_ceil(ENOUGH).max(1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::model::base::{A1, A2, COUNT};
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
        p[COUNT] = (p[A1] + p[A2]) / 0.15;
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
        // 600 rows determine it to 3 %; the coefficients of noisy columns are smaller, the limit higher
        for noise in recording.motion_noise().omega {
            assert!((0.045..0.058).contains(&noise), "{noise}");
        }
        // fourth differences take the steps in every tenth row for noise of about 1 V; that which the speeds do not
        // follow would move them by less than the residual, with a gain of (1 - φ)/k_e for φ = exp(-0.1/0.15)
        let remains = (-0.1_f64 / 0.15).exp();
        let limit = 0.05 * (1.0 + remains * remains).sqrt() * p[COUNT] / (1.0 - remains);
        for noise in recording.input_jumps() {
            assert!(noise < 1.1 * limit, "{noise} {limit}");
        }
    }
}
