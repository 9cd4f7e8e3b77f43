//! A measured input with fewer samples than rows: repeated by the logger, or held by a controller.
//!
//! The two cases look the same in the input column, but not in the motion: over an interval from one new
//! value M_a to the next M_b a held input accelerates the wheel uniformly, one that varies between its
//! samples accelerates it more in the second half if M_b is larger.
//!
//! ```text
//! y = (w_b - w_m) - (w_m - w_a)          m: middle of the interval
//! z = c tau (M_b - M_a)/2                c: response of the wheel to its input, tau: half the interval
//! y = rho z + e                          rho = 0: held,  1: the line between the samples
//! ```

use super::align::{Cells, align, new_in};
use super::cells::columns;
use super::finding::Channel;
use super::input::speeds;
use super::signal::{column, median_high, pieces};
use super::spikes::answer;
use super::thresholds::INPUTS;
use super::{Conditioned, Context, Settings};
use crate::math::cumulative_trapezoid;
use crate::recording::refreshed;

/// Brings the recording to the rows of an input that was sampled more slowly than the sensors.
pub(super) fn sampled(work: &mut Conditioned, settings: &Settings, context: &Context) {
    if !settings.rows || context.commanded {
        return;
    }
    let c = &work.channels;
    let [right, left] = [0, 1].map(|i| new_in(&c.t, &column(&c.torque, i)));
    let count = |of: &dyn Fn(usize) -> bool| (0..c.t.len()).filter(|k| of(*k)).count() as f64;
    let rows = c.t.len() as f64;
    let fresh = refreshed(c);
    let repeated = count(&|k| !right[k]);
    let alone = count(&|k| !right[k] && fresh[k]);
    if repeated == 0.0
        || 2.0 * alone < repeated
        || count(&|k| right[k] == left[k]) < INPUTS.new_together * rows
    {
        return;
    }
    let Some((rho, error)) = goes_on(work, &right) else { return };
    if rho - INPUTS.held < INPUTS.held_errors * error {
        return;
    }
    let cells: Vec<Cells> = columns(&work.channels)
        .into_iter()
        .filter(|(channel, _)| *channel != Channel::Time)
        .map(|(channel, values)| match channel {
            Channel::Input(_) => (channel, right.clone()),
            _ => (channel, vec![true; values.len()]),
        })
        .collect();
    align(work, &cells, |(channel, _)| matches!(channel, Channel::Input(_)), false);
}

/// rho with its standard error, over both wheels.
fn goes_on(work: &Conditioned, new: &[bool]) -> Option<(f64, f64)> {
    let (c, omega) = (&work.channels, speeds(work)?);
    let samples: Vec<usize> = (0..new.len()).filter(|&k| new[k]).collect();
    let usual = median_high(samples.windows(2).map(|w| (w[1] - w[0]) as f64)) as usize;
    let pieces = pieces(&c.t);
    let piece = |k: usize| pieces.partition_point(|p| p.end <= k);
    let half = usual / 2;
    let (mut zz, mut zy, mut yy, mut n) = (0.0, 0.0, 0.0, 0.0_f64);
    for i in 0..2 {
        let (input, speed) = (column(&c.torque, i), column(&omega, i));
        let integral = cumulative_trapezoid(&c.t, |k| input[k]);
        let (answer, its_error) = answer(&c.t, &integral, &speed, &[]);
        if answer < INPUTS.held_errors * its_error {
            return None;
        }
        for w in samples.windows(2) {
            let (a, b) = (w[0], w[1]);
            // where the wheel reverses, its friction does too
            let turns = speed[a] * speed[b] <= 0.0;
            if b - a != usual || piece(a) != piece(b) || turns || half == 0 {
                continue;
            }
            let share = 1.0 - half as f64 / usual as f64;
            let z = answer * (c.t[a + half] - c.t[a]) * share * (input[b] - input[a]);
            let y = (speed[b] - speed[b - half]) - (speed[a + half] - speed[a]);
            (zz, zy, yy, n) = (zz + z * z, zy + z * y, yy + y * y, n + 1.0);
        }
    }
    let rho = zy / zz;
    let variance = (yy - rho * zy).max(0.0) / (n - 1.0).max(1.0);
    (zz > 0.0).then(|| (rho, (variance / zz).sqrt()))
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::super::condition;
    use super::*;
    use crate::recording::Channels;

    /// Wheels of 0.03 kg m^2 in rows of 5 ms; the input is new every second row, and acts as `acting` makes it
    /// of its two neighbours.
    fn wheels(acting: fn(f64, f64) -> [f64; 2]) -> Channels {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(2);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let h = 0.005;
        let wave = |k: usize, i: usize| {
            let t = h * k as f64;
            0.2 * (2.0 * t + i as f64).sin() + 0.3 * (17.0 * t).sin()
        };
        let (mut omega, mut torque) = (vec![[-3.0; 2]], vec![[wave(0, 0), wave(0, 1)]]);
        for k in 1..8000_usize {
            let sample = k - k % 2;
            let before = (k - 1) - (k - 1) % 2;
            let step = |i: usize| {
                let halves = acting(wave(before, i), wave(before + 2, i));
                omega[k - 1][i] + h / 0.03 * halves[(k - 1) % 2]
            };
            omega.push([step(0), step(1)]);
            torque.push([wave(sample, 0), wave(sample, 1)]);
        }
        omega.iter_mut().for_each(|w| *w = w.map(|x| x + 0.005 * normal()));
        let t = (0..omega.len()).map(|k| h * k as f64).collect();
        Channels { t, alpha: None, omega: Some(omega), torque }
    }

    #[test]
    fn a_sampled_input_is_distinguished_from_a_held_one_by_the_wheels() {
        let run =
            |acting| condition(wheels(acting), &Settings::default(), &Context::default()).unwrap();
        // means of the line over the halves of the interval
        let sampled = run(|a, b| [0.75 * a + 0.25 * b, 0.25 * a + 0.75 * b]);
        assert_eq!(sampled.channels.t.len(), 4000, "{:?}", sampled.findings);
        let held = run(|a, _| [a, a]);
        assert_eq!(held.channels.t.len(), 8000, "{:?}", held.findings);
    }
}
