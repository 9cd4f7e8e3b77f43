//! Isolated wrong samples.
//!
//! A sample is compared with the line between its neighbours (repeated values of a slow sensor
//! count once), and its deviation with those of the samples around it:
//!
//! ```text
//! z_k = v_k - line(v_(k-1), v_(k+1)),  s_k = 1.4826 median |z| around k      Hampel (1974)
//! wrong where |z_k| > 18 s_k and v_k lies beyond both neighbours by as much
//! ```
//! Normal noise practically never reaches 18 s, noise with exponential tails once in 10^8 samples. A
//! wheel cannot jump and return, so such a sample of a sensor is an error. An input can; a sample of
//! it is an error if the wheel does not respond to it as to the rest of the input.
//! Samples far beyond all others (`far_out.rs`) are replaced first: they would be the measure for the others.

use std::ops::Range;

use nalgebra::Vector3;

use super::angles::excursions;
use super::far_out::{Spike, are_felt, far_out, in_order, without};
use super::finding::{Channel, Finding, Kind};
use super::magnitude::acting;
use super::signal::{column, pieces, quantile};
use super::thresholds::SAMPLES;
use super::{Conditioned, Context, Settings};
use crate::math::noise::quantum;
use crate::math::{NormalEquations, cumulative_trapezoid, interpolate, robust_deviation};
use crate::recording::{refreshed, steps_before};

/// Number of samples to either side for the usual deviation.
const AROUND: usize = 12;

/// Angles and speeds; after a step of the input a wheel that is fast against the rows may overshoot for a single row,
/// which its angle does not.
pub(super) fn sensors(work: &mut Conditioned, settings: &Settings) {
    let fresh = refreshed(&work.channels);
    let samples: Vec<usize> = (0..fresh.len()).filter(|&k| fresh[k]).collect();
    let steps: Vec<bool> = {
        let steps = steps_before(&work.channels.torque);
        (0..fresh.len()).map(steps).collect()
    };
    for i in 0..2 {
        for name in [Channel::Angle(i), Channel::Speed(i)] {
            let values = match name {
                Channel::Angle(_) => work.channels.alpha.as_ref(),
                _ => work.channels.omega.as_ref(),
            };
            let Some(values) = values.map(|v| column(v, i)) else { continue };
            let t = &work.channels.t;
            let found = match name {
                // wraps would be taken for wrong samples
                Channel::Angle(_) if settings.unwrap => of_angle(t, values, &samples),
                _ => {
                    let far = far_out(t, &values);
                    let mut found = spikes(t, &without(values, &far), &samples);
                    found.retain(|spike| !steps[spike.rows.start]);
                    in_order(far, found)
                }
            };
            correct(work, settings, name, &found);
        }
    }
}

/// Inputs; commands are recorded as sent, so that only samples far beyond all others are wrong.
pub(super) fn inputs(work: &mut Conditioned, settings: &Settings, context: &Context) {
    for i in 0..2 {
        let values = column(&work.channels.torque, i);
        let t = &work.channels.t;
        let mut far = far_out(t, &values);
        if are_felt(work, &far, i) {
            far.clear();
        }
        let values = without(values, &far);
        let rows: Vec<usize> = (0..values.len()).collect();
        let found = match context.commanded {
            true => vec![],
            false => {
                unfelt(work, &acting(work, &values, i, settings), spikes(t, &values, &rows), i)
            }
        };
        correct(work, settings, Channel::Input(i), &in_order(far, found));
    }
}

fn correct(work: &mut Conditioned, settings: &Settings, channel: Channel, found: &[Spike]) {
    let Some(kind) = Kind::spikes(found.iter().map(|s| (s.rows.start, s.out))) else { return };
    work.findings.push(Finding::corrected(channel, kind, "spikes", settings.spikes));
    if !settings.spikes {
        return;
    }
    let (rows, i) = match channel {
        Channel::Angle(i) => (work.channels.alpha.as_mut(), i),
        Channel::Speed(i) => (work.channels.omega.as_mut(), i),
        Channel::Input(i) => (Some(&mut work.channels.torque), i),
        Channel::Time | Channel::Sensors | Channel::Factor(_) => return,
    };
    let Some(rows) = rows else { return };
    for spike in found {
        rows[spike.rows.clone()].iter_mut().for_each(|v| v[i] = spike.value);
    }
}

/// The wrong samples of an angle: a few in a row that are far from the others, and single ones.
fn of_angle(t: &[f64], mut values: Vec<f64>, samples: &[usize]) -> Vec<Spike> {
    let pieces = pieces(t);
    let within = |rows: &Range<usize>| {
        pieces.iter().any(|piece| piece.start < rows.start && rows.end < piece.end)
    };
    let mut out = Vec::new();
    for rows in excursions(&values).into_iter().filter(within) {
        let (before, after) = (rows.start - 1, rows.end);
        for k in rows {
            let value = interpolate([t[before], t[after]], [values[before], values[after]], t[k]);
            out.push(Spike { rows: k..k + 1, value, out: values[k] - value });
            values[k] = value;
        }
    }
    if out.len() as f64 > SAMPLES.isolated * samples.len() as f64 {
        return vec![];
    }
    out.extend(spikes(t, &values, samples));
    out.sort_by_key(|spike| spike.rows.start);
    out
}

/// The wrong samples of a channel that is new in the rows `samples`.
pub(super) fn spikes(t: &[f64], values: &[f64], samples: &[usize]) -> Vec<Spike> {
    let pieces = pieces(t);
    let piece = |k: usize| pieces.partition_point(|p| p.end <= k);
    let out: Vec<f64> = samples
        .windows(3)
        .map(|w| {
            let line = interpolate([t[w[0]], t[w[2]]], [values[w[0]], values[w[2]]], t[w[1]]);
            if piece(w[0]) == piece(w[2]) { values[w[1]] - line } else { 0.0 }
        })
        .collect();
    let sizes: Vec<f64> = out.iter().map(|z| z.abs()).collect();
    // around a standstill nothing stands out, though the noise of motion does not end there
    let changes = samples.windows(2).map(|w| (values[w[1]] - values[w[0]]).abs());
    let step = quantile(changes.filter(|d| *d > 0.0), 0.02).max(quantum(values).unwrap_or(0.0));
    let floor = robust_deviation(sizes.iter().copied().filter(|z| *z > 0.0)).max(step);
    let mut found = Vec::new();
    for k in 0..out.len() {
        let (before, here, after) = (samples[k], samples[k + 1], samples[k + 2]);
        let beyond = [values[here] - values[before], values[here] - values[after]];
        if beyond[0] * beyond[1] <= 0.0 || sizes[k] <= SAMPLES.spike * floor {
            continue;
        }
        let near = k.saturating_sub(AROUND)..(k + AROUND + 1).min(sizes.len());
        let usual = robust_deviation(sizes[near].iter().copied());
        let least = beyond[0].abs().min(beyond[1].abs());
        if least > SAMPLES.spike * usual.max(floor) && is_alone(&out, k) {
            let value = values[here] - out[k];
            found.push(Spike { rows: here..after, value, out: out[k] });
        }
    }
    let many = found.len() as f64 > SAMPLES.isolated * samples.len() as f64 && found.len() > 1;
    if many { vec![] } else { found }
}

/// Whether a sample is a single outlier: the two lines that end in it then deviate by half as much to the
/// other side. A sharp turn of the motion does not show this.
fn is_alone(out: &[f64], k: usize) -> bool {
    let beside = [k.checked_sub(1), Some(k + 1)].into_iter().flatten().filter_map(|j| out.get(j));
    beside.into_iter().all(|z| (z + 0.5 * out[k]).abs() < SAMPLES.spike_alone * out[k].abs())
}

/// The samples of the input without a response of the wheel.
///
/// ```text
/// r_k = 3 (w_(k+1) - w_(k-1)) - (w_(k+3) - w_(k-3))     which a change that goes on leaves at zero
/// x_k = the same of the input's integral;   r = c x + e
/// ```
/// c for the samples in question, at a delay of up to ten rows, is compared with the response of the robot to
/// its input over stretches of the recording without them. If a wheel stops or reverses, its friction absorbs
/// any pulse, so no spike is reported there.
fn unfelt(work: &Conditioned, input: &[f64], found: Vec<Spike>, i: usize) -> Vec<Spike> {
    let (t, Some(speed)) = (&work.channels.t, super::input::speeds(work)) else { return vec![] };
    let speed = column(&speed, i);
    let slow = SAMPLES.stopping * quantile(speed.iter().map(|w| w.abs()), 0.95);
    let moves = |k: usize| {
        let near = &speed[k.saturating_sub(NEAR)..(k + NEAR + 1).min(speed.len())];
        near.iter().all(|w| *w > slow) || near.iter().all(|w| *w < -slow)
    };
    let found: Vec<Spike> = found.into_iter().filter(|s| moves(s.rows.start)).collect();
    let integral = cumulative_trapezoid(t, |k| input[k]);
    let bend = |v: &[f64], k: usize| 3.0 * (v[k + 1] - v[k - 1]) - (v[k + 3] - v[k - 3]);
    let rows = 3..t.len().saturating_sub(3 + SAMPLES.response_rows);
    let at: Vec<usize> = found.iter().map(|s| s.rows.start).filter(|k| rows.contains(k)).collect();
    let size: f64 = at.iter().map(|&k| bend(&integral, k).powi(2)).sum();
    let noise = robust_deviation(rows.map(|k| bend(&speed, k)));
    let error = noise / size.sqrt().max(f64::MIN_POSITIVE);
    let there = |delay: usize| {
        at.iter().map(|&k| bend(&integral, k) * bend(&speed, k + delay)).sum::<f64>() / size
    };
    let strongest = (0..=SAMPLES.response_rows).map(there).fold(f64::NEG_INFINITY, f64::max);
    let (usual, its_error) = answer(t, &integral, &speed, &found);
    let known = size > 0.0 && usual > SAMPLES.spike_errors * its_error;
    let felt = strongest > SAMPLES.spike_errors * error
        || strongest + SAMPLES.spike_errors * error >= 0.5 * usual;
    if known && !felt { found } else { vec![] }
}

/// Change of speed per integral of the input, with its standard error, beside friction and a trend:
/// `w_b - w_a = c1 int M dt - c2 int sgn(w) dt + c3 (b - a)` over stretches of ten rows.
pub(super) fn answer(t: &[f64], integral: &[f64], speed: &[f64], found: &[Spike]) -> (f64, f64) {
    let near =
        |a: usize, b: usize| found.iter().any(|s| s.rows.end + 2 > a && s.rows.start < b + 2);
    let pairs = (0..t.len().saturating_sub(STRETCH)).step_by(STRETCH).map(|a| (a, a + STRETCH));
    let row = |(a, b): (usize, usize)| {
        let sign: f64 = (a..b).map(|k| (t[k + 1] - t[k]) * crate::math::sgn(speed[k])).sum();
        (Vector3::new(integral[b] - integral[a], sign, t[b] - t[a]), speed[b] - speed[a])
    };
    let fit = NormalEquations::of(pairs.filter(|(a, b)| !near(*a, *b)).map(row)).solve();
    fit.map_or((0.0, f64::INFINITY), |fit| (fit.values[0], fit.std_error(0)))
}

/// Rows of a stretch.
const STRETCH: usize = 10;
/// Rows around a pulse in which a wheel must be faster than one that stops.
const NEAR: usize = 4;

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::super::condition;
    use super::*;
    use crate::recording::Channels;

    /// A wheel of 0.03 kg m^2 under a noisy torque with pulses of one row; the robot feels `acting`.
    fn wheel(seed: u64, acting: &[usize], wrong: &[usize]) -> (Channels, Vec<f64>) {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let h = 0.01;
        let t: Vec<f64> = (0..3000).map(|k| h * f64::from(k)).collect();
        let mut real: Vec<f64> = t.iter().map(|t| 0.3 * (2.0 * t).sin()).collect();
        acting.iter().for_each(|&k| real[k] += 1.5);
        let mut omega = vec![[0.0; 2]; t.len()];
        for k in 1..t.len() {
            omega[k] = [omega[k - 1][0] + h * 0.5 * (real[k] + real[k - 1]) / 0.03; 2];
        }
        omega.iter_mut().for_each(|w| *w = w.map(|x| x + 0.02 * normal()));
        let mut torque: Vec<[f64; 2]> =
            real.iter().map(|m| [m + 0.004 * normal(), m + 0.004 * normal()]).collect();
        let clean = torque.iter().map(|m| m[0]).collect();
        wrong.iter().for_each(|&k| torque[k][0] += 1.5);
        (Channels { t, alpha: None, omega: Some(omega), torque }, clean)
    }

    #[test]
    fn torques_that_the_wheel_does_not_feel_are_wrong_and_those_that_it_feels_stay() {
        let at = [400, 900, 1500, 2250];
        for seed in 0..5 {
            let (channels, clean) = wheel(seed, &[], &at);
            let done = condition(channels, &Settings::default(), &Context::default()).unwrap();
            assert!(
                matches!(
                    done.findings[..],
                    [Finding {
                        channel: Channel::Input(0),
                        kind: Kind::Spikes { count: 4, first: 401, .. },
                        ..
                    }]
                ),
                "{:?}",
                done.findings
            );
            for k in at {
                // noise of the sample and of the line through its neighbours: 1.22 * 0.004
                assert!((done.channels.torque[k][0] - clean[k]).abs() < 5.0 * 1.22 * 0.004);
            }
            let (channels, _) = wheel(seed, &at, &[]);
            let before = channels.torque.clone();
            let done = condition(channels, &Settings::default(), &Context::default()).unwrap();
            assert!(done.channels.torque == before, "{:?}", done.findings);
        }
    }

    #[test]
    fn a_sensor_that_jumps_and_returns_is_corrected_also_where_rows_repeat_it() {
        for repeat in [1, 4] {
            let (mut channels, _) = wheel(1, &[], &[]);
            let omega = channels.omega.as_mut().unwrap();
            let held: Vec<[f64; 2]> = (0..omega.len()).map(|k| omega[k - k % repeat]).collect();
            *omega = held.clone();
            omega[800..800 + repeat].iter_mut().for_each(|w| w[1] = 40.0);
            let done = condition(channels, &Settings::default(), &Context::default()).unwrap();
            let kind = done.findings[0].kind;
            assert!(matches!(kind, Kind::Spikes { count: 1, first: 801, .. }), "{kind:?}");
            let omega = done.channels.omega.unwrap();
            assert!((omega[801][1] - held[801][1]).abs() < 1.0);
        }
    }

    #[test]
    fn heavy_noise_steps_and_starts_are_no_spikes() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(4);
        let t: Vec<f64> = (0..20_000).map(|k| 0.01 * f64::from(k)).collect();
        // noise with exponential tails, steps, rest
        let values: Vec<f64> = t
            .iter()
            .map(|t| {
                let e: f64 = rand_distr::Exp1.sample(&mut rng);
                let s: f64 = StandardNormal.sample(&mut rng);
                let on = if t % 7.0 < 3.0 { 2.0 } else { 0.0 };
                on + 0.05 * e * s.signum()
            })
            .collect();
        let rows: Vec<usize> = (0..t.len()).collect();
        assert!(spikes(&t, &values, &rows).is_empty());
        let steps: Vec<f64> = t.iter().map(|t| if t % 7.0 < 3.0 { 7.0 } else { 0.0 }).collect();
        assert!(spikes(&t, &steps, &rows).is_empty());
        // a sharp turn of the motion
        let turn = |t: &f64| 3.0 - (0.5 * ((t - 50.0) / 0.03).powi(2)).min(3.0);
        assert!(spikes(&t, &t.iter().map(turn).collect::<Vec<_>>(), &rows).is_empty());
    }
}
