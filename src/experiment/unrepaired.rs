//! Errors of sensors and loggers in recordings that are read block by block, which conditioning does not correct.

use std::mem::discriminant;
use std::ops::Range;

use rayon::prelude::*;

use super::error::{Meaning, words};
use crate::conditioning::{Action, Channel, Context, Finding, Kind, Settings, Stated, condition};
use crate::recording::{Channels, LongRecording, Recording};

/// Rows of a window that are conditioned, to limit the time.
const ROWS: usize = 20_000;
/// Time between new values of a sensor in rows, beyond which rows in between repeat it.
const SLOW: f64 = 1.5;
/// Share of the windows in which an error is found that single windows may show by chance (judgement).
const MOST: f64 = 0.5;
/// Rows to which the limit that holds all of them is rounded up.
const ROUND: usize = 100_000;
/// Memory for a million rows that are held \[GB\] (docs/robustness.md).
const GIGABYTES: f64 = 1.1;

/// Whether the rows must be held in memory, because the finding is an error that only conditioning removes.
pub(super) fn is_needed(finding: &Finding, step_s: f64) -> bool {
    let is_sensor = !matches!(finding.channel, Channel::Input(_));
    match (finding.action, finding.kind) {
        // rows in disorder and without a number are left out, or refused, while the blocks are read
        (_, Kind::TimeRows { .. } | Kind::MissingValues { .. }) => false,
        (Action::Corrected(_), _) => true,
        (_, Kind::Refresh { period_s }) => is_sensor && period_s > SLOW * step_s,
        _ => false,
    }
}

/// Number of rows to be held in order to condition a recording of `rows` rows, and the memory for it \[GB\].
pub(super) fn limit(rows: usize) -> (usize, f64) {
    let limit = (rows + 1).div_ceil(ROUND) * ROUND;
    (limit, GIGABYTES * 1e-6 * limit as f64)
}

/// Checks that the windows of a long recording show no error that conditioning would correct.
///
/// # Errors
/// What they show, with the keys to be written.
pub(super) fn check(
    windows: &Recording,
    long: &LongRecording,
    settings: &Settings,
    context: &Context,
) -> Result<(), Meaning> {
    let settings = Settings { refuse: false, ..*settings };
    let of_window = |piece: &Range<usize>| {
        let rows = piece.start..piece.end.min(piece.start + ROWS);
        condition(part(windows, rows), &settings, context).map(|done| done.findings)
    };
    let found: Vec<Vec<Finding>> =
        windows.pieces().par_iter().filter_map(|piece| of_window(piece).ok()).collect();
    let Some(error) = error(&found, windows.step()) else { return Ok(()) };
    let (limit, gigabytes) = limit(long.samples);
    let otherwise = match error.action {
        Action::Corrected(key) => {
            format!("; or {key} = false under [conditioning], to use the rows as they are")
        }
        _ => String::new(),
    };
    Err(words(format!(
        "{}: {}. Its {} rows are more than hold_rows and are read block by block, where this is not corrected. Write \
         hold_rows = {limit} under [recordings], which holds all rows ({gigabytes:.1} GB){otherwise}",
        windows.name(),
        Stated::of(&error).what(),
        long.samples
    )))
}

/// The first error that one window shows for certain, or most of them.
fn error(found: &[Vec<Finding>], step_s: f64) -> Option<Finding> {
    let needed = || found.iter().flatten().filter(|finding| is_needed(finding, step_s));
    let is_one = |finding: &&Finding| {
        let has_it = |window: &&Vec<Finding>| window.iter().any(|other| is_alike(finding, other));
        let count = found.iter().filter(has_it).count();
        is_certain(&finding.kind) || count as f64 > MOST * found.len() as f64
    };
    needed().find(is_one).copied()
}

/// Whether two findings are of one kind on one channel.
fn is_alike(a: &Finding, b: &Finding) -> bool {
    a.channel == b.channel && discriminant(&a.kind) == discriminant(&b.kind)
}

/// Whether one window is enough: what values themselves show, without a comparison of noisy signals.
fn is_certain(kind: &Kind) -> bool {
    matches!(kind, Kind::Wrapped { .. } | Kind::Reset { .. } | Kind::Spikes { .. })
}

/// The channels of some rows as they were measured.
fn part(recording: &Recording, rows: Range<usize>) -> Channels {
    let measured = recording.measured();
    let of = |values: &[[f64; 2]]| values[rows.clone()].to_vec();
    Channels {
        t: recording.t()[rows.clone()].to_vec(),
        alpha: measured.alpha.then(|| of(recording.alpha())),
        omega: measured.omega.then(|| of(recording.omega())),
        torque: of(recording.torque()),
    }
}
