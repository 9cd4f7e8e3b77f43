//! Two copies of a recording with independent noise.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::recording::{Recording, differentiate};

/// The recording with noise added to its speeds, and with the same noise subtracted.
///
/// ```text
/// y± = y ± e,   e ~ N(0, σ²),   σ the noise of y:   cov(y+, y-) = σ² - σ² = 0
/// ```
/// (data fission of a Gaussian variable: Leiner, Duan, Wasserman and Ramdas 2023). If the speeds are computed
/// from measured angles, the noise is added to the angles before the derivative; the angles themselves are
/// unchanged. Noise that is not white is not split.
#[must_use]
pub(super) fn with_split_noise(recording: &Recording, seed: u64) -> [Recording; 2] {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let noise = recording.motion_noise();
    let is_of_angles = !recording.measured().omega;
    let (signal, sigma) = match is_of_angles {
        true => (recording.alpha(), noise.alpha),
        false => (recording.omega(), noise.omega),
    };
    let added: Vec<[f64; 2]> = signal
        .iter()
        .map(|_| {
            sigma.map(|sigma| {
                let draw: f64 = StandardNormal.sample(&mut rng);
                sigma * draw
            })
        })
        .collect();
    [1.0, -1.0].map(|sign| {
        let sum = |(v, e): (&[f64; 2], &[f64; 2])| [0, 1].map(|i| v[i] + sign * e[i]);
        let changed: Vec<[f64; 2]> = signal.iter().zip(&added).map(sum).collect();
        recording.with_omega(match is_of_angles {
            true => {
                let reach = recording.reach();
                differentiate(recording.t(), &changed, recording.pieces(), reach)
            }
            false => changed,
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::correlation;
    use crate::recording::{Channels, DriveUnit};

    #[test]
    fn the_noises_of_the_halves_do_not_correlate() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
        let n = 4000;
        let noise: Vec<[f64; 2]> = (0..n).map(|_| [0.05 * draw(), 0.02 * draw()]).collect();
        let t: Vec<f64> = (0..n).map(|k| 0.01 * f64::from(k)).collect();
        let smooth = |t: f64| [4.0 * t.sin(), 3.0 * (0.7 * t).cos()];
        let omega: Vec<[f64; 2]> =
            t.iter().zip(&noise).map(|(t, e)| [0, 1].map(|i| smooth(*t)[i] + e[i])).collect();
        let torque = vec![[1.0, 0.5]; omega.len()];
        let channels = Channels { alpha: None, omega: Some(omega), torque, t: t.clone() };
        let recording = Recording::new("noise", channels, DriveUnit::NewtonMetre).unwrap();
        let halves = with_split_noise(&recording, 1);
        for i in 0..2 {
            let rest = |r: &Recording| -> Vec<f64> {
                t.iter().zip(r.omega()).map(|(t, w)| w[i] - smooth(*t)[i]).collect()
            };
            let (first, second) = (rest(&halves[0]), rest(&halves[1]));
            // of 4000 pairs the correlation has a standard error of 0.016
            let r = correlation(first.iter().copied().zip(second.iter().copied()));
            assert!(r.abs() < 0.05, "{r}");
            let variance = first.iter().map(|e| e * e).sum::<f64>() / f64::from(n);
            assert!((variance / [0.05_f64, 0.02][i].powi(2) / 2.0 - 1.0).abs() < 0.1, "{variance}");
        }
    }
}
