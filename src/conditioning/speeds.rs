//! The speeds on the time base of the angles.
//!
//! A speed that is recorded late by lambda integrates to the angle when it is read later:
//!
//! ```text
//! Omega(b + lambda) - Omega(a + lambda) = g (alpha(b) - alpha(a)) + e,   Omega = integral of the speed
//! ```
//! over short windows (a, b); lambda and g minimise the sum of e^2 (Gauss-Newton from the best of a
//! grid). The noise of the speeds at a and b enters both e and its derivative, with opposite signs,
//! so that it leaves no bias. Speeds that are differences of the angles share their noise:
//!
//! ```text
//! omega_k = (alpha_k - alpha_(k-m)) / (t_k - t_(k-m)) + e_k,   var e << var of the speeds' own noise
//! ```
//! So do those that any other linear filter made of them (`of_angle.rs`). Beside angles that determine the speed as well,
//! speeds that are late by more than a row and a half are used if they are only delayed, and not if they are filtered
//! (`delayed.rs`).

mod advance;
mod delayed;
mod lag;
mod low_passed;
mod of_angle;

use nalgebra::Vector2;

use self::lag::pooled;
pub use self::lag::{Lag, SpeedLag, common_lag, lags_differ};
pub use self::of_angle::common_share;
use super::finding::{Channel, Finding, Kind};
use super::signal::{changes, column, median_step, noise_variance, pieces};
use super::thresholds::SPEEDS;
use super::{Conditioned, Context, Settings};
use crate::math::{
    NormalEquations, cumulative_trapezoid, interpolate, quantile, robust_deviation,
    trimmed_mean_square,
};
use crate::recording::RESOLVED;

/// Window \[s\] and its samples at least: motion changes within a few tenths of a second.
const WINDOW: (f64, usize) = (0.1, 4);
/// Lags that are looked for \[s\], and in samples: filters of speeds reach back up to so far.
const LONGEST: (f64, f64) = (0.25, 10.0);
/// Longest difference of angles that is looked for \[samples\].
const SPAN: usize = 16;
/// Quantile of the speeds that is the top speed.
const FAST: f64 = 0.99;

/// A wheel's samples: the rows in which its sensors gave something new.
struct Samples {
    t: Vec<f64>,
    alpha: Vec<f64>,
    omega: Vec<f64>,
    pieces: Vec<std::ops::Range<usize>>,
    step: f64,
    /// Whether every row is a sample.
    all: bool,
}

pub(super) fn timing(work: &mut Conditioned, settings: &Settings, context: &Context) {
    let Some(samples) =
        [samples(work, 0), samples(work, 1)].into_iter().collect::<Option<Vec<_>>>()
    else {
        return;
    };
    // the second wheel is not read where the first shows none
    let first = span(&samples[0]);
    let second = first.and_then(|_| span(&samples[1]));
    // angles that come more slowly than the rows give poor speeds: then the late ones are moved instead
    let full_rate = samples.iter().all(|s| s.all);
    if let (Some(a), Some(b)) = (first, second)
        && a == b
        && full_rate
    {
        let lag_s = 0.5 * a as f64 * samples[0].step;
        leave_out(work, settings, Kind::Differences { samples: a, lag_s });
        return;
    }
    if let Some(share) = full_rate.then(|| computed(&samples, context.speeds_of_angles)).flatten() {
        leave_out(work, settings, Kind::OfAngle { share });
        return;
    }
    let others = match context.speed_lag {
        SpeedLag::Known(lags) => Some(lags),
        _ => None,
    };
    let Some(lags) = lags(&samples, others) else { return };
    let step = samples[0].step;
    let late: Vec<(&Samples, f64)> = samples
        .iter()
        .zip(lags.map(|lag| lag.value))
        .filter(|(_, lag)| lag.abs() > SPEEDS.skew * step)
        .collect();
    // that of a row or less shows no motion, which changes over windows
    let over = |lag: f64| if late.is_empty() { WINDOW.0 } else { lag.abs() };
    let spare =
        full_rate && samples.iter().zip(lags).all(|(s, lag)| angles_suffice(s, over(lag.value)));
    let is_filtered = || match late.is_empty() {
        true => low_passed::are_low_passed(samples.iter().zip(lags.map(|lag| lag.value))),
        false => late.iter().any(|(s, lag)| !delayed::is_delayed(s, *lag)),
    };
    if spare && is_filtered() {
        state(work, settings, lags, |lag_s, std_error_s| Kind::Filtered { lag_s, std_error_s });
        if settings.speeds {
            work.channels.omega = None;
        }
    } else if context.speed_lag == SpeedLag::Disputed {
        let noted = Settings { speeds: false, ..*settings };
        state(work, &noted, lags, |lag_s, std_error_s| Kind::LagsDiffer { lag_s, std_error_s });
    } else {
        state(work, settings, lags, |lag_s, std_error_s| Kind::Lag { lag_s, std_error_s });
        if settings.speeds {
            advance::advance(work, lags.map(|lag| lag.value), full_rate);
        }
    }
}

/// Reports the lag of every wheel that has one.
fn state(
    work: &mut Conditioned,
    settings: &Settings,
    lags: [Lag; 2],
    kind: impl Fn(f64, f64) -> Kind,
) {
    for (i, lag) in lags.iter().enumerate().filter(|(_, lag)| lag.value != 0.0) {
        let kind = kind(lag.value, lag.std_error);
        work.findings.push(Finding::corrected(Channel::Speed(i), kind, "speeds", settings.speeds));
    }
}

/// The lag of each wheel's speed, zero for one in time; `None` if both are. That of both wheels together, unless they
/// differ: one sensor is read like the other as a rule, and both show it better. A recording that does not show one takes
/// that of the `others` of its log, unless it contradicts it.
fn lags(samples: &[Samples], others: Option<[Lag; 2]>) -> Option<[Lag; 2]> {
    let step = samples[0].step;
    let own: Vec<Option<(Lag, bool)>> = samples.iter().map(lag).collect();
    let sure = |lag: Option<Lag>| lag.filter(|l| l.is_sure(step));
    if let [Some((a, _)), Some((b, _))] = own[..]
        && a.differs_from(&b, step)
    {
        return Some([a, b].map(|lag| sure(Some(lag)).unwrap_or_default()));
    }
    let of = |exact: bool| own.iter().flatten().filter(move |l| l.1 || !exact).map(|l| l.0);
    let [exact, any] = [true, false].map(|exact| pooled(&of(exact).collect::<Vec<_>>()));
    let both = |lag: Option<Lag>| Some([sure(lag)?; 2]);
    both(exact).or_else(|| shared(&own, any, others)).or_else(|| both(any))
}

/// The lags of other recordings, unless this one contradicts them: with both wheels together, or each of them if they
/// have lags of their own.
fn shared(
    own: &[Option<(Lag, bool)>],
    any: Option<Lag>,
    others: Option<[Lag; 2]>,
) -> Option<[Lag; 2]> {
    let agrees = |own: Option<Lag>, other: &Lag| {
        own.is_none_or(|own| {
            (own.value - other.value).abs()
                < SPEEDS.lag_errors * own.std_error.hypot(other.std_error)
        })
    };
    let alike = |[a, b]: &[Lag; 2]| a.value == b.value;
    others.filter(|others| match alike(others) {
        true => agrees(any, &others[0]),
        false => others.iter().zip(own).all(|(other, own)| agrees(own.map(|own| own.0), other)),
    })
}

/// What is left of speeds that were computed from the angles of both wheels, as a share of the angle's
/// noise; that of other recordings where these do not show it and do not contradict it.
fn computed(samples: &[Samples], others: Option<f64>) -> Option<f64> {
    let mut left = vec![];
    for wheel in samples {
        let own = of_angle::left(wheel);
        // without other recordings both wheels must show it
        if others.is_none() && own.is_none_or(|left| !left.is_computed()) {
            return None;
        }
        left.push(own);
    }
    let shown: Vec<_> = left.iter().flatten().filter(|l| l.is_computed()).collect();
    if shown.len() == samples.len() {
        return shown.iter().map(|l| l.share()).max_by(f64::total_cmp);
    }
    others.filter(|_| !left.iter().flatten().any(|l| l.is_measured()))
}

fn leave_out(work: &mut Conditioned, settings: &Settings, kind: Kind) {
    for i in 0..2 {
        work.findings.push(Finding::corrected(Channel::Speed(i), kind, "speeds", settings.speeds));
    }
    if settings.speeds {
        work.channels.omega = None;
    }
}

fn samples(work: &Conditioned, i: usize) -> Option<Samples> {
    let c = &work.channels;
    let (alpha, omega) = (column(c.alpha.as_ref()?, i), column(c.omega.as_ref()?, i));
    let moves = |v: &[f64]| changes(v).len();
    let new = |k: usize| k == 0 || alpha[k] != alpha[k - 1] || omega[k] != omega[k - 1];
    let rows: Vec<usize> = (0..c.t.len()).filter(|&k| new(k)).collect();
    // where most rows repeat both; else every row is a sample
    let all = 2 * rows.len() > c.t.len() || moves(&alpha) < SPEEDS.fewest_moves;
    let rows = if all { (0..c.t.len()).collect() } else { rows };
    let t: Vec<f64> = rows.iter().map(|&k| c.t[k]).collect();
    let of = |v: &[f64]| rows.iter().map(|&k| v[k]).collect();
    let step = median_step(&t);
    Some(Samples { alpha: of(&alpha), omega: of(&omega), pieces: pieces(&t), step, t, all })
}

/// Over how many samples the speeds are differences of the angles.
fn span(s: &Samples) -> Option<usize> {
    let own = noise_variance(&s.omega);
    let rest = |m: usize| {
        let inside = s.pieces.iter().flat_map(|p| p.start + m..p.end.max(p.start + m));
        let error = |k: usize| s.omega[k] - (s.alpha[k] - s.alpha[k - m]) / (s.t[k] - s.t[k - m]);
        trimmed_mean_square(inside.map(|k| error(k).powi(2)).collect())
    };
    let spans = (1..=SPAN.min(s.t.len() / 4)).map(|m| (m, rest(m)));
    let (m, least) = spans.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (own > 0.0 && least < SPEEDS.shared_noise * own).then_some(m)
}

/// Lag of a wheel's speed, and whether it is exact. Where the windows far off the others are those in which the speed
/// changes, it is found from all of them, to the sampling instant within a row: few windows decide, in which no
/// trapezoid is exact.
fn lag(s: &Samples) -> Option<(Lag, bool)> {
    let way = integral(s);
    let windows = windows(s);
    if windows.len() < SPEEDS.lag_windows {
        return None;
    }
    let found = |far: f64| minimum(s, |lag| solve(s, &way, &windows, lag, far));
    let (lag, is_exact) = match found(SPEEDS.jumps) {
        Some((lag, informed)) if informed > SPEEDS.informed => (lag, true),
        _ => {
            let Lag { value, std_error } = found(f64::INFINITY)?.0;
            match low_passed::time(s, value) {
                Some(lag) => (lag, true),
                None => {
                    (Lag { value, std_error: std_error.hypot(SPEEDS.lag_rows * s.step) }, false)
                }
            }
        }
    };
    // read after the angle, a speed leads it by less than a row
    let is_possible = lag.value > -s.step - SPEEDS.lag_errors * lag.std_error;
    is_possible.then_some((lag, is_exact))
}

/// The lag of the least sum of squares, and the share of the changes of the speed that it was found from.
fn minimum(s: &Samples, solve: impl Fn(f64) -> Option<Step>) -> Option<(Lag, f64)> {
    let longest = LONGEST.0.min(LONGEST.1 * s.step);
    let count = (2.0 * longest / s.step).ceil() as i32;
    let starts = (-count..=count).map(|j| 0.5 * f64::from(j) * s.step);
    let cost = |lag: f64| solve(lag).map_or(f64::INFINITY, |f| f.cost);
    let start = starts.map(|l| (cost(l), l)).min_by(|a, b| a.0.total_cmp(&b.0))?.1;
    let mut value = start;
    let mut last = solve(value)?;
    for _ in 0..20 {
        value += last.step.clamp(-s.step, s.step);
        last = solve(value)?;
        if last.step.abs() < 1e-3 * last.std_error {
            break;
        }
    }
    let near = (value - start).abs() <= s.step && last.std_error.is_finite();
    near.then_some((Lag { value, std_error: last.std_error }, last.informed))
}

/// Rows between which the motion is compared.
fn windows(s: &Samples) -> Vec<(usize, usize)> {
    let length = ((WINDOW.0 / s.step).round() as usize).max(WINDOW.1);
    let starts = |p: &std::ops::Range<usize>| {
        let (from, to) = (p.start, p.end);
        (from..to).step_by(length).filter(move |a| a + length < to).map(move |a| (a, a + length))
    };
    s.pieces.iter().flat_map(starts).collect()
}

/// Integral of the speed up to each sample, by trapezoids.
fn integral(s: &Samples) -> Vec<f64> {
    cumulative_trapezoid(&s.t, |k| s.omega[k])
}

struct Step {
    /// Mean square at this lag, with the best g.
    cost: f64,
    /// Gauss-Newton step of the lag \[s\].
    step: f64,
    std_error: f64,
    /// Share of the squared changes of the speed in the windows that are not left out: only they show a lag.
    informed: f64,
}

/// Sum of squares at a lag, with the best g; windows off by more than `far` deviations are left out.
fn solve(s: &Samples, way: &[f64], windows: &[(usize, usize)], lag: f64, far: f64) -> Option<Step> {
    let at = |t: f64, k: usize| read(s, way, t, k);
    let row = |(a, b): &(usize, usize)| {
        let (from, to) = (at(s.t[*a] + lag, *a)?, at(s.t[*b] + lag, *b)?);
        Some((
            to.0 - from.0 - (s.alpha[*b] - s.alpha[*a]),
            to.1 - from.1,
            s.alpha[*b] - s.alpha[*a],
        ))
    };
    let rows: Vec<(f64, f64, f64)> = windows.iter().filter_map(row).collect();
    let limit = far * robust_deviation(rows.iter().map(|(e, ..)| *e));
    let used = rows.iter().filter(|(e, ..)| limit.is_nan() || limit <= 0.0 || e.abs() <= limit);
    let sums = NormalEquations::of(used.map(|(e, slope, way)| (Vector2::new(*slope, -way), *e)));
    let fit = sums.solve()?;
    let of_g = sums.right[1] * sums.right[1] / sums.matrix[(1, 1)];
    let cost = (sums.squares - of_g) / sums.rows.max(1) as f64;
    let slopes: f64 = rows.iter().map(|(_, slope, _)| slope * slope).sum();
    let informed = sums.matrix[(0, 0)] / slopes;
    Some(Step { cost, step: -fit.values[0], std_error: fit.std_error(0), informed })
}

/// Integral and speed at a time near sample `k`.
fn read(s: &Samples, way: &[f64], t: f64, k: usize) -> Option<(f64, f64)> {
    let piece = s.pieces.iter().find(|p| p.contains(&k))?;
    let next = s.t[piece.clone()].partition_point(|x| *x <= t) + piece.start;
    let j = next.checked_sub(1).filter(|j| *j >= piece.start && next < piece.end)?;
    let (h, share) = (s.t[next] - s.t[j], (t - s.t[j]) / (s.t[next] - s.t[j]));
    let omega = interpolate([s.t[j], s.t[next]], [s.omega[j], s.omega[next]], t);
    Some((way[j] + 0.5 * share * h * (s.omega[j] + omega), omega))
}

/// Whether the angle determines the speed over a time as accurately as its own channel, or to within what angles alone are
/// used with. The noise that a filter leaves on a speed is no measure of its accuracy.
fn angles_suffice(s: &Samples, time: f64) -> bool {
    let (angle, speed) = (noise_variance(&s.alpha).sqrt(), noise_variance(&s.omega).sqrt());
    let top = quantile(s.omega.iter().map(|w| w.abs()), FAST);
    angle * 2.0_f64.sqrt() / time < (SPEEDS.as_accurate * speed).max(RESOLVED * top)
}

#[cfg(test)]
mod tests;
