//! Recorded inputs with additional simulated noise.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::recording::{Recording, SlowNoise};

/// The recorded input plus white noise with standard deviations `sigma` [N m], independent for each row and
/// wheel.
pub fn noisier_input(
    recording: &Recording,
    sigma: [f64; 2],
    rng: &mut ChaCha8Rng,
) -> Vec<[f64; 2]> {
    let single = recording.is_single_axis();
    let rows = recording.torque().iter().map(|m| {
        let draws = draws(single, rng);
        [0, 1].map(|i| m[i] + sigma[i] * draws[i])
    });
    rows.collect()
}

/// The recorded input plus a realisation of its slow noise ([`Recording::slow_input_noise`]).
///
/// ```text
/// n_k = ρ n_(k-1) + √(1 - ρ²) σ e_k,   ρ = exp(-(t_k - t_(k-1))/τ),   e ~ N(0, 1)
/// ```
pub(super) fn slowly_noisier_input(recording: &Recording, rng: &mut ChaCha8Rng) -> Vec<[f64; 2]> {
    let (t, noise) = (recording.t(), recording.slow_input_noise());
    let single = recording.is_single_axis();
    let mut slow = [0.0; 2];
    let rows = recording.torque().iter().enumerate().map(|(k, m)| {
        let draws = draws(single, rng);
        let since = if k == 0 { f64::INFINITY } else { t[k] - t[k - 1] };
        for i in 0..2 {
            let SlowNoise { sigma, time_s } = noise[i];
            let keeps = if time_s > 0.0 { (-since / time_s).exp() } else { 0.0 };
            slow[i] = keeps * slow[i] + (1.0 - keeps * keeps).sqrt() * sigma * draws[i];
        }
        [0, 1].map(|i| m[i] + slow[i])
    });
    rows.collect()
}

/// One draw per wheel; the same draw for a `single` axis mapped to both wheels.
fn draws(single: bool, rng: &mut ChaCha8Rng) -> [f64; 2] {
    let first = normal(rng);
    [first, if single { first } else { normal(rng) }]
}

/// A draw of the standard normal distribution.
pub(super) fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{Channels, DriveUnit};
    use rand::SeedableRng;

    #[test]
    fn slow_noise_has_its_deviation_and_its_correlation() {
        let t: Vec<f64> = (0..20_000).map(|k| 0.01 * f64::from(k)).collect();
        let omega = t.iter().map(|t| [t.sin(), t.cos()]).collect();
        let channels =
            Channels { torque: vec![[0.0; 2]; t.len()], alpha: None, omega: Some(omega), t };
        let mut recording = Recording::new("x", channels, DriveUnit::NewtonMetre).unwrap();
        let noise = [SlowNoise { sigma: 0.3, time_s: 0.1 }, SlowNoise::default()];
        recording.set_slow_input_noise(noise);
        let n = slowly_noisier_input(&recording, &mut ChaCha8Rng::seed_from_u64(1));
        let mean = |lag: usize| {
            let products = n.iter().zip(&n[lag..]).map(|(a, b)| a[0] * b[0]);
            products.sum::<f64>() / (n.len() - lag) as f64
        };
        // 200 s of 0.1 s: a variance has a relative error of √(2·0.1/200), 3 %
        assert!((mean(0) / 0.09 - 1.0).abs() < 0.1, "{}", mean(0));
        assert!((mean(10) / mean(0) - (-1.0_f64).exp()).abs() < 0.06);
        assert!(n.iter().all(|n| n[1] == 0.0));
    }
}
