//! Checks of the channels against each other: units, signs, exchanged wheels.

use super::super::Recording;
use super::consistency::{
    FEWEST, exchanged_input, exchanged_speeds, is_sign_untested, opposing_input,
};
use super::window::{Window, short_windows};
use super::{Finding, Issue, Severity, quantile};
use crate::math::median_high;
use crate::robot::Robot;

/// Deviation from one of the ratio of speed to derivative of the angle that is tolerated.
const RATIO: f64 = 0.05;
/// Standard errors of the ratio by which it must deviate: in rows that are slow against the motion a mean speed is not the
/// slope of the angle, and single windows scatter.
const SURE: f64 = 5.0;
/// Deviation above which results are wrong and not only inaccurate.
const WRONG: f64 = 0.2;
/// Highest realistic speed of a robot [m/s].
const FAST: f64 = 8.0;

pub(super) fn findings(r: &Recording, windows: &[Window], robot: &Robot) -> Vec<Finding> {
    let mut out: Vec<Finding> = too_fast(windows, robot).into_iter().collect();
    let measured = r.measured();
    if measured.alpha && measured.omega {
        let found = speed_against_angle(windows, robot);
        let wrong = found.iter().any(|f| f.severity == Severity::Problem);
        out.extend(found);
        if wrong {
            return out; // wrong speeds do not determine whether the input is right
        }
    }
    if exchanged_input(windows) {
        out.push(Finding::new(Severity::Problem, Issue::ExchangedInput));
    } else {
        let windows = &short_windows(r);
        let opposing = (0..2).filter(|i| opposing_input(windows, *i));
        let finding = |i| Finding::new(Severity::Problem, Issue::OpposingInput(i));
        out.extend(opposing.map(finding));
        let untested = (0..2).filter(|i| is_sign_untested(windows, *i));
        out.extend(untested.map(|i| Finding::new(Severity::Note, Issue::SignUntested(i))));
    }
    out
}

fn too_fast(windows: &[Window], robot: &Robot) -> Option<Finding> {
    let top = quantile(windows.iter().flat_map(|w| w.speed), 0.99);
    let issue = Issue::TooFast { top, radius: robot.r() };
    (top * robot.r() > FAST).then(|| Finding::new(Severity::Warning, issue))
}

fn speed_against_angle(windows: &[Window], robot: &Robot) -> Vec<Finding> {
    if exchanged_speeds(windows) {
        return vec![Finding::new(Severity::Problem, Issue::ExchangedSpeeds)];
    }
    (0..2).filter_map(|i| ratio(windows, i, robot)).collect()
}

/// Ratio of the speed to the derivative of the angle, and its interpretation.
fn ratio(windows: &[Window], i: usize, robot: &Robot) -> Option<Finding> {
    let fast = 0.2 * quantile(windows.iter().map(|w| w.angle_rate[i]), 0.95);
    let ratios: Vec<f64> = windows
        .iter()
        .filter(|w| w.angle_rate[i].abs() > fast && fast > 0.0)
        .map(|w| w.speed[i] / w.angle_rate[i])
        .collect();
    if ratios.len() < FEWEST {
        return None;
    }
    let ratio = median_high(ratios.iter().copied());
    let spread = median_high(ratios.iter().map(|r| (r - ratio).abs()));
    // for a normal distribution 1.48 median deviations are one standard deviation, and 1.25 of these over the root of
    // their number the standard error of a median
    let std_error = 1.48 * 1.25 * spread / (ratios.len() as f64).sqrt();
    if (ratio - 1.0).abs() <= RATIO.max(SURE * std_error) {
        return None;
    }
    let severity = if (ratio - 1.0).abs() > WRONG { Severity::Problem } else { Severity::Warning };
    Some(Finding::new(severity, Issue::Ratio { wheel: i, ratio, radius: robot.r() }))
}
