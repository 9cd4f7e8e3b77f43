//! Noise of the channels of a recording, estimated from the recording alone.

use super::channels::MostNoise;
use super::one_step::most_noise;
use super::{DriveUnit, MotionNoise, Noise, Recording};
use crate::math::{median_high, noise};

/// Length of a block for one estimate \[s\].
const BLOCK: f64 = 0.5;
/// Smallest number of blocks whose median is dominated by noise and not by motion: a test of two seconds
/// accelerates in most of its blocks.
const BLOCKS: f64 = 20.0;
/// Smallest number of samples of a block.
const SHORTEST: usize = 12;

/// Replaces the noise levels of short recordings by those of the longer ones if the latter are lower: the
/// median of each channel over recordings of 10 s and more. All recordings must be from the same sensors.
pub fn share_noise(recordings: &mut [&mut Recording]) {
    let long = |r: &Recording| r.covered() >= BLOCKS * BLOCK;
    let noises: Vec<Noise> = recordings.iter().filter(|r| long(r)).map(|r| r.noise()).collect();
    if noises.is_empty() {
        return;
    }
    let median = |value: &dyn Fn(&Noise) -> f64| median_high(noises.iter().map(value));
    let most = Noise {
        alpha: [0, 1].map(|i| median(&|n| n.alpha[i])),
        omega: [0, 1].map(|i| median(&|n| n.omega[i])),
        torque: [f64::INFINITY; 2],
    };
    for recording in recordings.iter_mut().filter(|r| !long(r)) {
        recording.set_most_noise(most);
    }
}

impl Recording {
    /// Noise of every channel from fourth differences, which remove smooth motion.
    ///
    /// ```text
    /// sigma^2 = median over blocks of mean (∇⁴v)² / C(8,4) / m,   blocks of 0.5 s
    /// ```
    /// with m the bias of a median, [`noise::white_noise_variance`].
    /// The median over blocks is insensitive to starts and reversals. A quantised channel has at least the
    /// noise of its steps, q / sqrt(12). The noise of a sensor is limited by [`Recording::set_most_noise`];
    /// an interpolated input has the noise of its rows, without the part of its differences that is not noise
    /// ([`Recording::set_noise_of_jumps`]).
    #[must_use]
    pub fn noise(&self) -> Noise {
        let MotionNoise { alpha, omega } = self.motion_noise();
        Noise { alpha, omega, torque: self.input_noise() }
    }

    /// Angles and speeds of [`Recording::noise`]; speeds that were computed from angles have at least the noise of the
    /// difference of two angles. Computed once; copies of the recording with another input
    /// share it.
    #[must_use]
    pub fn motion_noise(&self) -> MotionNoise {
        *self.kept().motion_noise.get_or_init(|| self.estimate_motion_noise())
    }

    fn estimate_motion_noise(&self) -> MotionNoise {
        let channel = |values: &[[f64; 2]]| [0, 1].map(|i| self.channel_noise(values, i, true));
        let (alpha, mut omega) = (channel(self.alpha()), channel(self.omega()));
        if self.measured().omega {
            let most = self.most_by_one_step().omega;
            omega = [0, 1].map(|i| match most[i] < omega[i] {
                true => omega[i].min(most[i].max(quantum(self.omega(), i) / 12.0_f64.sqrt())),
                false => omega[i],
            });
        }
        if !self.measured().omega {
            // fourth differences of such speeds show six tenths of their variance, since neighbours share an angle, and
            // less where counts that pass slowly repeat
            let slow = self.repeats_readings();
            let rows = if slow { self.rows_per_refresh() } else { self.reach() };
            let over = 2.0 * rows as f64 * self.step();
            omega = [0, 1].map(|i| omega[i].max(2.0_f64.sqrt() * alpha[i] / over));
        }
        let lower = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].min(b[1])];
        self.most_noise().map_or(MotionNoise { alpha, omega }, |most| MotionNoise {
            alpha: lower(alpha, most.alpha),
            omega: lower(omega, most.omega),
        })
    }

    fn most_by_one_step(&self) -> MostNoise {
        *self.kept().most_noise.get_or_init(|| most_noise(self))
    }

    /// Noise of the input, right wheel first [unit of the input]: the torque of [`Recording::noise`].
    #[must_use]
    pub fn input_noise(&self) -> [f64; 2] {
        self.input_jumps().map(|jumps| self.noise_of_jumps() * jumps)
    }

    /// Standard deviation of the differences of the input from row to row [unit of the input], which are noise or
    /// changes of the input itself, as far as the speeds do not follow them. Computed once; copies of the recording
    /// with the same input share it.
    #[must_use]
    pub fn input_jumps(&self) -> [f64; 2] {
        let known = self.interpolated().map(|recorded| recorded.noise);
        known.unwrap_or_else(|| *self.kept_jumps().get_or_init(|| self.estimate_input_jumps()))
    }

    fn estimate_input_jumps(&self) -> [f64; 2] {
        let jumps = [0, 1].map(|i| self.channel_noise(self.torque(), i, false));
        if jumps == [0.0; 2] || !self.measured().omega {
            return jumps;
        }
        let most = self.most_by_one_step().input;
        [0, 1].map(|i| jumps[i].min(most[i]))
    }

    /// `sensed`: rows that only repeat a slow sensor contain no information on its noise.
    fn channel_noise(&self, values: &[[f64; 2]], i: usize, sensed: bool) -> f64 {
        let step = if sensed { self.covered() / self.readings() as f64 } else { self.step() };
        let block = ((BLOCK / step) as usize).max(SHORTEST);
        // blocks without counts of a coarse encoder contain no information on its noise; a held input has
        // none
        let keep = |variance: f64| variance > 0.0 || !sensed;
        let runs = self.runs(values, i, sensed);
        let rounding = |step: f64| step / 12.0_f64.sqrt();
        // the steps of an input with few levels are commands, not rounding; voltages in a few levels are exact, however
        // often they change
        let few = !sensed && is_of_few_levels(values, i);
        if few && self.drive_unit() == DriveUnit::Volt {
            return 0.0;
        }
        match noise::white_noise_variance(&runs, block, SHORTEST, keep) {
            Some(variance) if few => variance.sqrt(),
            Some(variance) => variance.sqrt().max(rounding(quantum(values, i))),
            None if few => 0.0,
            None => rounding(noise::smallest_change(&column(values, i)).unwrap_or(0.0)),
        }
    }

    /// One channel of every piece without gaps; for `sensed` channels only rows with a new reading.
    fn runs(&self, values: &[[f64; 2]], i: usize, sensed: bool) -> Vec<Vec<f64>> {
        let new = |&k: &usize| !sensed || self.is_reading(k);
        self.pieces()
            .iter()
            .map(|p| p.clone().filter(new).map(|k| values[k][i]).collect())
            .collect()
    }

    /// Whether the speeds were smoothed by the logger, or computed from the angles: the correlation of
    /// neighbouring fourth differences is then not the -0.8 of white noise.
    #[must_use]
    pub fn speeds_are_smoothed(&self) -> bool {
        let runs: Vec<_> =
            [0, 1].into_iter().flat_map(|i| self.runs(self.omega(), i, true)).collect();
        noise::fourth_difference_correlation(&runs).is_some_and(|correlation| correlation > SMOOTH)
    }
}

/// Correlation of neighbouring fourth differences above which speeds count as smoothed.
const SMOOTH: f64 = -0.6;

/// Number of levels up to which an input is a sequence of commands: rounding is white noise of q/sqrt(12)
/// only if the signal crosses many levels (Widrow and Kollar, Quantization Noise, 2008).
pub(crate) const FEW_LEVELS: usize = 16;

/// Whether a channel has only a few different values.
fn is_of_few_levels(values: &[[f64; 2]], i: usize) -> bool {
    let mut levels: Vec<f64> = Vec::new();
    for v in values {
        if !levels.contains(&v[i]) {
            levels.push(v[i]);
        }
        if levels.len() > FEW_LEVELS {
            return false;
        }
    }
    true
}

fn column(values: &[[f64; 2]], i: usize) -> Vec<f64> {
    values.iter().map(|v| v[i]).collect()
}

/// The step of a quantised channel; zero where the channel is not quantised.
pub(super) fn quantum(values: &[[f64; 2]], i: usize) -> f64 {
    noise::quantum(&column(values, i)).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::super::{Channels, DriveUnit, Recording, share_noise};
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn the_noise_of_a_moving_channel_is_found_within_its_own_error() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let t: Vec<f64> = (0..4000).map(|k| 0.01 * k as f64).collect();
        let omega = t.iter().map(|t| [3.0 * t.sin() + 0.05 * normal(), 0.02 * normal()]).collect();
        let torque = t.iter().map(|t| [0.2 * (2.0 * t).cos() + 0.004 * normal(), 0.0]).collect();
        let channels = Channels { t, alpha: None, omega: Some(omega), torque };
        let noise = Recording::new("a", channels, DriveUnit::NewtonMetre).unwrap().noise();
        // 80 blocks of 46 differences each: 2 % standard error of the median of variances
        assert!((noise.omega[0] / 0.05 - 1.0).abs() < 0.06, "{noise:?}");
        assert!((noise.omega[1] / 0.02 - 1.0).abs() < 0.06, "{noise:?}");
        assert!((noise.torque[0] / 0.004 - 1.0).abs() < 0.06, "{noise:?}");
        assert_eq!(noise.torque[1], 0.0);
    }

    #[test]
    fn another_input_has_its_own_noise() {
        let t: Vec<f64> = (0..400).map(|k| 0.01 * k as f64).collect();
        let rough = |k: usize| ((k * k) as f64).sin();
        let torque = |size: f64| (0..400).map(|k| [size * rough(k), 0.0]).collect::<Vec<_>>();
        let omega = (0..400).map(|k| [rough(k + 7), rough(k + 9)]).collect();
        let channels = Channels { t, alpha: None, omega: Some(omega), torque: torque(0.01) };
        let recording = Recording::new("a", channels, DriveUnit::NewtonMetre).unwrap();
        let [first, _] = recording.input_jumps();
        // differences are linear in the input
        let [other, _] = recording.with_torque(torque(0.02)).input_jumps();
        assert!(first > 0.0 && (other / first - 2.0).abs() < 1e-9, "{first} {other}");
        assert_eq!(recording.input_jumps()[0], first);
    }

    #[test]
    fn steps_of_a_command_are_no_noise() {
        let t: Vec<f64> = (0..2000).map(|k| 0.005 * k as f64).collect();
        let torque =
            t.iter().map(|t| [if *t > 1.0 { 7.0 } else { 0.0 }, (t * 0.8).floor()]).collect();
        let omega = t.iter().map(|t| [t.sin(), t.cos()]).collect();
        let channels = Channels { t, alpha: None, omega: Some(omega), torque };
        let noise = Recording::new("a", channels, DriveUnit::Volt).unwrap().noise();
        assert_eq!(noise.torque, [0.0, 0.0]);
    }

    #[test]
    fn speeds_from_angles_have_the_noise_of_the_difference_of_two_angles() {
        let (h, sigma) = (0.01, 1e-3);
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let mut noise = |s: f64| -> f64 {
            let drawn: f64 = StandardNormal.sample(&mut rng);
            s * drawn
        };
        let t: Vec<f64> = (0..6000).map(|k| h * f64::from(k)).collect();
        let alpha = t.iter().map(|t| [t.sin(), t.cos()].map(|v| v + noise(sigma))).collect();
        let torque = vec![[0.0; 2]; t.len()];
        let c = Channels { t, alpha: Some(alpha), omega: None, torque };
        let found = Recording::new("x", c, DriveUnit::NewtonMetre).unwrap().noise();
        // (a(k + 1) - a(k - 1))/(2 h)
        let expected = 2.0_f64.sqrt() * sigma / (2.0 * h);
        for i in 0..2 {
            assert!((found.omega[i] / expected - 1.0).abs() < 0.06, "{found:?}");
        }
    }

    #[test]
    fn a_coarse_encoder_has_the_noise_of_its_steps() {
        let t: Vec<f64> = (0..2000).map(|k| 0.01 * k as f64).collect();
        let alpha = t.iter().map(|t| [(3.0 * t.sin() / 0.05).round() * 0.05, 0.0]).collect();
        let channels =
            Channels { torque: vec![[0.1; 2]; 2000], alpha: Some(alpha), omega: None, t };
        let noise = Recording::new("a", channels, DriveUnit::NewtonMetre).unwrap().noise();
        // between q/sqrt(12) and what fourth differences of a signal in steps give
        assert!(noise.alpha[0] > 0.0144 && noise.alpha[0] < 0.03, "{noise:?}");
    }

    #[test]
    fn a_short_quick_test_takes_the_noise_of_the_longer_ones() {
        let recorded = |seconds: usize, rate: f64| {
            let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
            let mut noise = |sigma: f64| -> f64 {
                let drawn: f64 = StandardNormal.sample(&mut rng);
                sigma * drawn
            };
            let t: Vec<f64> = (0..100 * seconds).map(|k| 0.01 * k as f64).collect();
            let rows = |sigma: f64, noise: &mut dyn FnMut(f64) -> f64| -> Vec<[f64; 2]> {
                t.iter()
                    .map(|t| [(rate * t).sin(), (rate * t).cos()].map(|v| v + noise(sigma)))
                    .collect()
            };
            let (alpha, omega) = (rows(1e-3, &mut noise), rows(0.02, &mut noise));
            let torque = rows(0.0, &mut noise);
            let c = Channels { t, alpha: Some(alpha), omega: Some(omega), torque };
            Recording::new("x", c, DriveUnit::NewtonMetre).unwrap()
        };
        // at 120 rad/s and 100 Hz the fourth differences are of the motion; the speeds are those of a linear model
        let (mut long, mut short) = (recorded(30, 1.0), recorded(2, 120.0));
        assert!(short.noise().alpha[0] > 0.04, "{:?}", short.noise());
        let before = long.noise();
        share_noise(&mut [&mut long, &mut short]);
        assert_eq!(long.noise(), before);
        assert!((0..2).all(|i| short.noise().omega[i] <= before.omega[i]));
        assert_eq!(short.noise().alpha, before.alpha);
    }
}
