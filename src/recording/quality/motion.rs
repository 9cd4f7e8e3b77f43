//! Checks of the channels against each other: units, signs, exchanged wheels.

use nalgebra::{DMatrix, DVector};

use super::super::Recording;
use super::window::Window;
use super::{Finding, Severity, WHEELS, quantile};
use crate::math::{fit, sgn};
use crate::robot::Robot;

/// Fewest windows of motion that a check is based on.
const FEWEST: usize = 10;
/// Ratio of speed to slope of the angle that is still taken as one.
const RATIO: f64 = 0.05;
/// Ratio beyond which results are wrong and not only inexact.
const WRONG: f64 = 0.2;
/// Correlation that says "the same signal".
const SAME: f64 = 0.98;
/// Fastest robot that is believed [m/s].
const FAST: f64 = 8.0;
/// How many standard errors a fitted inertia must be below zero.
const SURE: f64 = 5.0;

pub(super) fn findings(r: &Recording, windows: &[Window], robot: &Robot) -> Vec<Finding> {
    let mut out: Vec<Finding> = too_fast(windows, robot).into_iter().collect();
    let measured = r.measured();
    if measured.alpha && measured.omega {
        let found = speed_against_angle(windows, robot);
        let wrong = found.iter().any(|f| f.severity == Severity::Problem);
        out.extend(found);
        if wrong {
            return out; // with wrong speeds nothing can be said of the drive
        }
    }
    match exchanged_drive(windows) {
        Some(finding) => out.push(finding),
        None => out.extend((0..2).filter_map(|i| opposing_drive(windows, i))),
    }
    out
}

fn too_fast(windows: &[Window], robot: &Robot) -> Option<Finding> {
    let top = quantile(windows.iter().flat_map(|w| w.speed), 0.99);
    (top * robot.r() > FAST).then(|| {
        Finding::new(
            Severity::Warning,
            format!(
                "wheel speeds up to {top:.0} rad/s, {:.0} m/s on wheels of {} m",
                top * robot.r(),
                robot.r()
            ),
            "check their unit (rpm? deg/s?) and the wheel radius of [robot]",
        )
    })
}

fn speed_against_angle(windows: &[Window], robot: &Robot) -> Vec<Finding> {
    if let Some(finding) = exchanged_speeds(windows) {
        return vec![finding];
    }
    (0..2).filter_map(|i| ratio(windows, i, robot)).collect()
}

/// Windows without the jumps of an angle that wraps.
fn smooth(windows: &[Window]) -> Vec<&Window> {
    let limit = 3.0 * quantile(windows.iter().flat_map(|w| w.angle_rate), 0.9);
    windows.iter().filter(|w| w.angle_rate.iter().all(|a| a.abs() <= limit)).collect()
}

fn exchanged_speeds(windows: &[Window]) -> Option<Finding> {
    let windows = smooth(windows);
    let follows =
        |i: usize, j: usize| correlation(windows.iter().map(|w| (w.speed[i], w.angle_rate[j])));
    let crossed = follows(0, 1).abs() > SAME && follows(1, 0).abs() > SAME;
    let straight = follows(0, 0).abs() > 0.9 && follows(1, 1).abs() > 0.9;
    (windows.len() >= FEWEST && crossed && !straight).then(|| {
        Finding::new(
            Severity::Problem,
            "dalpha1 follows alpha2 and dalpha2 follows alpha1",
            "the wheels are exchanged in one pair of columns (wheel 1 is the right one); swap \
             them in `columns`",
        )
    })
}

fn correlation(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let n = pairs.clone().count().max(1) as f64;
    let (sx, sy) = pairs.clone().fold((0.0, 0.0), |(a, b), (x, y)| (a + x, b + y));
    let (mx, my) = (sx / n, sy / n);
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for (x, y) in pairs {
        xx += (x - mx) * (x - mx);
        yy += (y - my) * (y - my);
        xy += (x - mx) * (y - my);
    }
    if xx * yy > 0.0 { xy / (xx * yy).sqrt() } else { 0.0 }
}

/// The speed over the slope of the angle, and what a ratio other than one means.
fn ratio(windows: &[Window], i: usize, robot: &Robot) -> Option<Finding> {
    let fast = 0.2 * quantile(windows.iter().map(|w| w.angle_rate[i]), 0.95);
    let mut ratios: Vec<f64> = windows
        .iter()
        .filter(|w| w.angle_rate[i].abs() > fast && fast > 0.0)
        .map(|w| w.speed[i] / w.angle_rate[i])
        .collect();
    if ratios.len() < FEWEST {
        return None;
    }
    let middle = ratios.len() / 2;
    let ratio = *ratios.select_nth_unstable_by(middle, f64::total_cmp).1;
    if (ratio - 1.0).abs() <= RATIO {
        return None;
    }
    let what = format!("dalpha{0} is {ratio:.4} times the slope of alpha{0}", i + 1);
    let severity = if (ratio - 1.0).abs() > WRONG { Severity::Problem } else { Severity::Warning };
    Some(Finding::new(severity, what, meaning(ratio, i, robot)))
}

fn meaning(ratio: f64, i: usize, robot: &Robot) -> String {
    use std::f64::consts::{PI, TAU};
    let (degrees, minute) = (180.0 / PI, 60.0 / TAU);
    let (speed, angle) = (format!("dalpha{}", i + 1), format!("alpha{}", i + 1));
    let known = [
        (1.0, String::new()),
        (minute, format!("{speed} is in rpm")),
        (degrees, format!("{speed} is in deg/s, or t in a wrong unit")),
        (1.0 / TAU, format!("{speed} is in rev/s")),
        (robot.r(), format!("{speed} is in m/s")),
        (1.0 / degrees, format!("{angle} is in deg")),
        (TAU, format!("{angle} is in rev")),
        (1.0 / robot.r(), format!("{angle} is in m")),
        (1e3, "t is in ms".into()),
        (1e6, "t is in us".into()),
        (1e9, "t is in ns".into()),
    ];
    let size = ratio.abs();
    let unit = known.into_iter().find(|(factor, _)| (size / factor - 1.0).abs() < 0.03);
    let sign = if ratio < 0.0 {
        format!(
            "the sign of one of them is wrong (forward is positive for both wheels): scale = -1 on {speed} or {angle}"
        )
    } else {
        String::new()
    };
    let words = match unit {
        Some((_, words)) if !words.is_empty() => format!("{words}; say so in `columns`"),
        Some(_) => String::new(),
        None => "a unit, a gear ratio or the counts per turn are wrong; mend it with unit or scale in `columns`".into(),
    };
    [sign, words].into_iter().filter(|w| !w.is_empty()).collect::<Vec<_>>().join(", and ")
}

/// `M = c1 dω + c2 sgn(ω) + c3 ω` of one wheel's drive on one wheel's motion.
struct SimpleFit {
    inertia: f64,
    std_error: f64,
    /// Share of the drive that is not explained [1].
    rest: f64,
}

fn simple_fit(windows: &[Window], drive: usize, wheel: usize) -> Option<SimpleFit> {
    let slow = 0.05 * quantile(windows.iter().map(|w| w.speed[wheel]), 0.99);
    let used: Vec<&Window> = windows.iter().filter(|w| w.speed[wheel].abs() > slow).collect();
    if used.len() < 3 * FEWEST {
        return None;
    }
    let x = DMatrix::from_fn(used.len(), 3, |k, j| match j {
        0 => used[k].acceleration[wheel],
        1 => sgn(used[k].speed[wheel]),
        _ => used[k].speed[wheel],
    });
    let y = DVector::from_fn(used.len(), |k, _| used[k].moment[drive]);
    let total = y.norm_squared();
    let fitted = fit(&x, &y, None).ok()?;
    (total > 0.0 && fitted.rank == 3).then(|| SimpleFit {
        inertia: fitted.coefficients[0],
        std_error: fitted.std_errors[0],
        rest: fitted.residuals.norm_squared() / total,
    })
}

fn exchanged_drive(windows: &[Window]) -> Option<Finding> {
    let crossed = |i: usize| -> Option<bool> {
        let (own, other) = (simple_fit(windows, i, i)?, simple_fit(windows, i, 1 - i)?);
        Some(other.rest < 0.3 * own.rest && other.rest < 0.3)
    };
    (crossed(0)? && crossed(1)?).then(|| {
        Finding::new(
            Severity::Problem,
            "M1 moves wheel 2 and M2 moves wheel 1",
            "the drives are exchanged (wheel 1 is the right one); swap them in `columns`",
        )
    })
}

/// A drive against the acceleration that also takes energy out: its sign is wrong, since friction
/// and inertia need it put in.
fn opposing_drive(windows: &[Window], i: usize) -> Option<Finding> {
    let fit = simple_fit(windows, i, i)?;
    let work: f64 = windows.iter().map(|w| w.moment[i] * w.speed[i]).sum();
    (fit.inertia < -SURE * fit.std_error && work < 0.0).then(|| {
        Finding::new(
            Severity::Problem,
            format!("M{} pushes {} against its motion", i + 1, WHEELS[i]),
            format!("its sign is wrong: scale = -1 for M{} in `columns`", i + 1),
        )
    })
}
