//! Evidence between two non-nested models from their errors in every window.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::fit::WindowFit;
use super::windows::Windows;
use crate::compare::noisier_input;
use crate::recording::Recording;

/// Pairs of noise realisations: the remaining sampling error of a sum over all rows is below one per cent.
const DRAWS: usize = 4;

/// Evidence for the second of two models from what each leaves in every window.
///
/// ```text
/// z² = (Σ d)²/(Σ (d - mean d)² m/(m - 1)),   d: difference in each of m windows
/// ```
/// Source: Vuong, Econometrica 57 (1989), test of two models of which neither contains the other; z² in place of the
/// likelihood ratio, which takes the rows of a window for independent.
pub(super) fn evidence(one: &[f64], other: &[f64]) -> f64 {
    let d: Vec<f64> = one.iter().zip(other).map(|(a, b)| a - b).collect();
    let (m, sum) = (d.len() as f64, d.iter().sum::<f64>());
    let square: f64 = d.iter().map(|v| (v - sum / m).powi(2)).sum();
    if square > 0.0 { sum * sum / (square * m / (m - 1.0)) } else { 0.0 }
}

/// Squared innovations of a fit in every window, minus the contribution of noise of the recorded input.
pub(super) fn noiseless(windows: &Windows, fit: &WindowFit) -> Option<Vec<f64>> {
    without_noise(windows, |w| Some(w.innovations(&w.errors(&fit.model, &fit.p)?)))
}

/// The `squares` of every window minus the contribution of noise of the recorded input, which is estimated as
/// the increase when the same amount of noise is added again, in pairs of opposite sign so that linear terms
/// cancel.
///
/// Source: Cook and Stefanski, J. Am. Stat. Assoc. 89 (1994), simulation and extrapolation.
pub(super) fn without_noise(
    windows: &Windows,
    squares: impl Fn(&Windows) -> Option<Vec<f64>>,
) -> Option<Vec<f64>> {
    let plain = squares(windows)?;
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let mut out = plain.clone();
    let each = 1.0 / (2 * DRAWS) as f64;
    for _ in 0..DRAWS {
        let recordings = windows.recordings.iter();
        let noisy: Vec<Vec<[f64; 2]>> =
            recordings.map(|r| noisier_input(r, r.input_noise(), &mut rng)).collect();
        for sign in [1.0, -1.0] {
            let with = |(r, noisy): (&&Recording, &Vec<[f64; 2]>)| {
                let rows = r.torque().iter().zip(noisy);
                let moved = rows.map(|(m, n)| [0, 1].map(|i| m[i] + sign * (n[i] - m[i])));
                r.with_torque(moved.collect())
            };
            let moved: Vec<Recording> = windows.recordings.iter().zip(&noisy).map(with).collect();
            let moved = squares(&windows.with_recordings(moved.iter().collect()))?;
            out.iter_mut()
                .zip(moved.iter().zip(&plain))
                .for_each(|(o, (m, p))| *o -= each * (m - p));
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_evidence_of_a_worked_example_is_the_square_of_a_t_test() {
        // scipy.stats.ttest_1samp([ln 2, ln 4, ln 2, 0, ln 2, ln 4], 0) gives t = 3.7963, whose square is 14.4118
        let d = [2.0_f64, 4.0, 2.0, 1.0, 2.0, 4.0].map(f64::ln);
        assert!((evidence(&d, &[0.0; 6]) - 14.4118).abs() < 1e-3);
        assert_eq!(evidence(&d, &d), 0.0);
    }
}
