//! How noisy the channels of a recording are, from the recording alone.

use super::Recording;

/// Standard deviations of white noise, right wheel first.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Noise {
    /// Angles [rad].
    pub alpha: [f64; 2],
    /// Speeds [rad/s].
    pub omega: [f64; 2],
    /// Drive [drive unit].
    pub moment: [f64; 2],
}

/// Length of a block over which one estimate is taken [s].
const BLOCK: f64 = 0.5;
/// Fewest samples of a block.
const SHORTEST: usize = 12;

impl Recording {
    /// Noise of every channel from fourth differences, which remove any smooth motion.
    ///
    /// ```text
    /// sigma^2 = median over blocks of mean (∇⁴v)² / C(8,4),   blocks of 0.5 s
    /// ```
    /// The median over blocks is immune to starts and reversals. A quantised channel has at least
    /// the noise of its steps, q / sqrt(12).
    #[must_use]
    pub fn noise(&self) -> Noise {
        // rows that only repeat a slow sensor say nothing of its noise
        let channel = |values: &[[f64; 2]], sensed: bool| {
            [0, 1].map(|i| self.channel_noise(values, i, sensed))
        };
        Noise {
            alpha: channel(self.alpha(), true),
            omega: channel(self.omega(), true),
            moment: channel(self.moment(), false),
        }
    }

    fn channel_noise(&self, values: &[[f64; 2]], i: usize, sensed: bool) -> f64 {
        let fresh = self.fresh().iter().filter(|f| **f).count().max(1);
        let step = if sensed { self.duration() / fresh as f64 } else { self.step() };
        let block = ((BLOCK / step) as usize).max(SHORTEST);
        let mut variances = Vec::new();
        for piece in self.pieces() {
            let column: Vec<f64> = piece
                .clone()
                .filter(|&k| !sensed || self.fresh()[k])
                .map(|k| values[k][i])
                .collect();
            for part in column.chunks(block).filter(|part| part.len() >= SHORTEST) {
                variances.push(fourth_difference_variance(part));
            }
        }
        // blocks in which a coarse encoder does not move at all say nothing of its noise; a drive
        // that holds its value has none
        variances.retain(|v| *v > 0.0 || !sensed);
        if variances.is_empty() {
            return smallest_step(values, i) / 12.0_f64.sqrt();
        }
        let middle = variances.len() / 2;
        let variance = *variances.select_nth_unstable_by(middle, f64::total_cmp).1;
        variance.sqrt().max(quantum(values, i) / 12.0_f64.sqrt())
    }
}

impl Recording {
    /// Whether the speeds were smoothed by the logger, or computed from the angles: their fourth
    /// differences are then not those of white noise, whose neighbours correlate by -0.8.
    #[must_use]
    pub fn speeds_are_smoothed(&self) -> bool {
        let (mut product, mut square) = (0.0, 0.0);
        for piece in self.pieces() {
            for i in 0..2 {
                let v: Vec<f64> = piece
                    .clone()
                    .filter(|&k| self.fresh()[k])
                    .map(|k| self.omega()[k][i])
                    .collect();
                let d: Vec<f64> = v
                    .windows(5)
                    .map(|w| w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4])
                    .collect();
                product += d.windows(2).map(|w| w[0] * w[1]).sum::<f64>();
                square += d.iter().map(|x| x * x).sum::<f64>();
            }
        }
        square > 0.0 && product / square > SMOOTH
    }
}

/// Correlation of neighbouring fourth differences above which speeds count as smoothed.
const SMOOTH: f64 = -0.6;

fn fourth_difference_variance(v: &[f64]) -> f64 {
    let squares: f64 =
        v.windows(5).map(|w| (w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]).powi(2)).sum();
    squares / (v.len() - 4) as f64 / 70.0 // C(8,4)
}

/// The smallest non-zero change between neighbours; zero if the channel is constant.
fn smallest_step(values: &[[f64; 2]], i: usize) -> f64 {
    let steps = values.windows(2).map(|w| (w[1][i] - w[0][i]).abs()).filter(|d| *d > 0.0);
    steps.min_by(f64::total_cmp).unwrap_or(0.0)
}

/// The step of a quantised channel: many neighbours are equal and all others differ by multiples
/// of one step; zero where the channel is not quantised.
fn quantum(values: &[[f64; 2]], i: usize) -> f64 {
    let equal = values.windows(2).filter(|w| w[1][i] == w[0][i]).count();
    let step = smallest_step(values, i);
    if equal * 20 < values.len() || step == 0.0 {
        return 0.0;
    }
    let multiple = |w: &[[f64; 2]]| {
        let ratio = (w[1][i] - w[0][i]).abs() / step;
        (ratio - ratio.round()).abs() < 0.02 * ratio.max(1.0)
    };
    let fits = values.windows(2).filter(|w| multiple(w)).count();
    if fits * 20 > values.len() * 19 { step } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::{Channels, DriveUnit, Recording};
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn the_noise_of_a_moving_channel_is_found_within_its_own_error() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let t: Vec<f64> = (0..4000).map(|k| 0.01 * k as f64).collect();
        let omega = t.iter().map(|t| [3.0 * t.sin() + 0.05 * normal(), 0.02 * normal()]).collect();
        let moment = t.iter().map(|t| [0.2 * (2.0 * t).cos() + 0.004 * normal(), 0.0]).collect();
        let channels = Channels { t, alpha: None, omega: Some(omega), moment };
        let noise = Recording::new("a", channels, DriveUnit::NewtonMetre).unwrap().noise();
        // 80 blocks of 46 differences each: 2 % standard error of the median of variances
        assert!((noise.omega[0] / 0.05 - 1.0).abs() < 0.06, "{noise:?}");
        assert!((noise.omega[1] / 0.02 - 1.0).abs() < 0.06, "{noise:?}");
        assert!((noise.moment[0] / 0.004 - 1.0).abs() < 0.06, "{noise:?}");
        assert_eq!(noise.moment[1], 0.0);
    }

    #[test]
    fn a_coarse_encoder_has_the_noise_of_its_steps() {
        let t: Vec<f64> = (0..2000).map(|k| 0.01 * k as f64).collect();
        let alpha = t.iter().map(|t| [(3.0 * t.sin() / 0.05).round() * 0.05, 0.0]).collect();
        let channels =
            Channels { moment: vec![[0.1; 2]; 2000], alpha: Some(alpha), omega: None, t };
        let noise = Recording::new("a", channels, DriveUnit::NewtonMetre).unwrap().noise();
        // between q/sqrt(12) and what fourth differences of a staircase give
        assert!(noise.alpha[0] > 0.0144 && noise.alpha[0] < 0.03, "{noise:?}");
    }
}
