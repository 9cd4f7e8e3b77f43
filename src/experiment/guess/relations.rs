//! Relations between columns without a clear name: a speed is the derivative of its angle.

use super::guessed::Guess;
use super::values::is_constant;
use crate::io::PreviewColumn;

/// Largest number of columns that are compared in pairs.
const MOST: usize = 40;
/// Smallest number of rows, since columns of fewer are correlated by chance, and largest number of
/// sentences.
const ROWS: usize = 30;
const QUESTIONS: usize = 3;
/// Windows that a recording is cut into.
const WINDOWS: usize = 200;
/// Smallest correlation over the windows for "the slope of": an angle and its speed reach it unless noise
/// or coarse steps are a tenth of the motion in a window.
const SAME: f64 = 0.99;

/// Sentences on open columns that are the slope of another one, if angles or speeds are not yet found; only for those
/// that match exactly one, in recordings that are long enough.
pub(super) fn hints(columns: &[PreviewColumn], guess: &Guess) -> Vec<String> {
    let known = |key: &str| guess.columns.iter().find(|c| c.key == key);
    let time = known("t").and_then(|t| columns.iter().find(|c| c.name == t.name));
    let (Some(time), None, None) = (time, known("alpha1"), known("dalpha1")) else { return vec![] };
    let used = |name: &str| guess.columns.iter().any(|c| c.name == name);
    let open: Vec<&PreviewColumn> =
        columns.iter().filter(|c| !used(&c.name) && is_signal(c, time)).collect();
    if open.len() > MOST || time.values.len() < ROWS {
        return vec![];
    }
    let pairs = open.iter().flat_map(|angle| open.iter().map(move |speed| (*angle, *speed)));
    let found: Vec<(&PreviewColumn, &PreviewColumn)> = pairs
        .filter(|(angle, speed)| angle.name != speed.name)
        .filter(|(angle, speed)| is_slope(&time.values, &angle.values, &speed.values))
        .collect();
    let is_one = |(angle, speed): &&(&PreviewColumn, &PreviewColumn)| {
        let shared = found.iter().filter(|(a, s)| {
            a.name == angle.name
                || s.name == speed.name
                || a.name == speed.name
                || s.name == angle.name
        });
        shared.count() == 1
    };
    let questions = found.iter().filter(is_one).map(|(angle, speed)| {
        format!("`{}` is the slope of `{}`: a speed and its angle?", speed.name, angle.name)
    });
    questions.take(QUESTIONS).collect()
}

/// Whether a column may be a motion: a single value is a setting, and its integral would correlate with any
/// row counter.
fn is_signal(column: &PreviewColumn, time: &PreviewColumn) -> bool {
    column.values.len() == time.values.len() && !is_constant(&column.values)
}

/// Whether the change of one column over windows correlates with the integral of another.
pub(super) fn is_slope(t: &[f64], angle: &[f64], speed: &[f64]) -> bool {
    let length = (t.len() / WINDOWS).max(4);
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for from in (0..t.len().saturating_sub(length)).step_by(length) {
        let change = angle[from + length] - angle[from];
        let way: f64 = (from..from + length)
            .map(|k| 0.5 * (t[k + 1] - t[k]) * (speed[k] + speed[k + 1]))
            .sum();
        if change.is_finite() && way.is_finite() {
            (xx, yy, xy) = (xx + change * change, yy + way * way, xy + change * way);
        }
    }
    xx * yy > 0.0 && xy > SAME * (xx * yy).sqrt()
}
