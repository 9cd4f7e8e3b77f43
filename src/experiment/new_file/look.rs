//! A first look at recordings with the columns as detected.

use std::path::{Path, PathBuf};

use super::kind::Kind;
use crate::conditioning::{
    self, Channel, ConditioningError, Context, Finding, Settings, Stated, condition, stated,
};
use crate::experiment::error::ExperimentError;
use crate::experiment::guess::{About, Guess, Guessed, in_a_line};
use crate::experiment::remarks::repeated;
use crate::experiment::unrepaired::is_needed;
use crate::io::{Column, ColumnMap, foreign_encoding, preview, read_channels, uneven_rows};
use crate::recording::{DriveUnit, Recording, shows_no_motion};
use crate::report::format::hertz;

/// Text for a recording that cannot be read with the columns as detected; the question gives the reason.
const UNREAD: &str = "can be read when the questions below are answered";

/// What recordings show at a first look.
#[derive(Default)]
pub(super) struct Looked {
    /// The recordings, without those that have the samples of an earlier one.
    pub(super) recordings: Vec<PathBuf>,
    /// The movement of each; `None` if it cannot be read.
    pub(super) kinds: Vec<Option<Kind>>,
    /// Length, rate, movement and findings of each.
    pub(super) words: Vec<String>,
    /// Encodings other than UTF-8, and recordings that are left out.
    pub(super) notes: Vec<String>,
    /// Why the first one that cannot be read cannot.
    pub(super) unread: Option<String>,
    /// Rows of the longest one with errors that are corrected in memory only.
    pub(super) corrected_rows: usize,
}

impl Looked {
    /// Reads all `recordings`; what they show is entered into the guess.
    ///
    /// # Errors
    /// A recording without the columns that were found in the first one.
    pub(super) fn at(recordings: &[PathBuf], guess: &mut Guess) -> Result<Self, ExperimentError> {
        let mut out = Self::default();
        let mut read: Vec<(&PathBuf, Recording)> = Vec::new();
        for path in recordings {
            let name = path.to_string_lossy();
            if let Some(encoding) = foreign_encoding(path) {
                out.notes.push(in_a_line(&format!("{name}: text in {encoding}")));
            }
            if let Some(uneven) = uneven_rows(path) {
                out.notes.push(in_a_line(&format!("{name}: {uneven}")));
            }
            let (words, kind) = match look(path, guess) {
                Ok((recording, findings, rows)) => {
                    let is_same = |(_, r): &&(_, Recording)| !repeated(&[r, &recording]).is_empty();
                    if let Some((other, _)) = read.iter().find(is_same) {
                        let other = other.to_string_lossy();
                        let note = format!("{name}: the samples of {other} again, left out");
                        out.notes.push(in_a_line(&note));
                        continue;
                    }
                    take_units(guess, &findings);
                    take_magnitudes(guess, &findings, path);
                    if findings.iter().any(|f| is_needed(f, recording.step())) {
                        out.corrected_rows = out.corrected_rows.max(rows);
                    }
                    let kind = Kind::of(&recording);
                    let words = seen(&recording, &findings, kind);
                    read.push((path, recording));
                    (words, Some(kind))
                }
                Err(reason) => {
                    has_columns_of(&recordings[0], path, guess)?;
                    out.unread.get_or_insert_with(|| about(path, reason));
                    (vec![UNREAD.to_owned()], None)
                }
            };
            out.words.extend(words.into_iter().map(|w| in_a_line(&format!("{name}: {w}"))));
            out.kinds.push(kind);
            out.recordings.push(path.clone());
        }
        if guess.one_axis {
            guess.ask_all(one_wheel_each(recordings));
        }
        Ok(out)
    }
}

/// The question about two files that, by their names, have one wheel each.
fn one_wheel_each(recordings: &[PathBuf]) -> Option<String> {
    let name = |path: &Path| path.file_name().map(|n| n.to_string_lossy().to_lowercase());
    let names: Vec<String> = recordings.iter().filter_map(|path| name(path)).collect();
    let left = names.iter().find(|n| {
        n.contains("left") && names.iter().any(|other| *other == n.replace("left", "right"))
    })?;
    let right = left.replace("left", "right");
    Some(format!(
        "`{left}` and `{right}` have one wheel each, but a recording needs both: write the columns of both wheels into one \
         file, at the same times, and give that one. If each is a test of a single motor, remove this line"
    ))
}

/// A reason with the recording that it is about, unless it names its file.
fn about(path: &Path, reason: String) -> String {
    let file = path.file_name().map(|name| name.to_string_lossy().into_owned());
    let is_named = file.is_some_and(|file| reason.contains(&file));
    if is_named { reason } else { format!("{}: {reason}", path.to_string_lossy()) }
}

/// A recording read with the guessed columns, the findings of conditioning, and its number of rows; or the reason why
/// it cannot be read. The direction of the motion does not depend on counts per turn and radius; findings on angles do.
fn look(path: &Path, guess: &Guess) -> Result<(Recording, Vec<Finding>, usize), String> {
    if guess.period.is_none() && !guess.columns.iter().any(|c| c.key == "t" && !c.scale_open) {
        return Err("the sampling period is not known".into());
    }
    let is_scaled = !guess.columns.iter().any(|c| c.needs_per_turn() || c.is_in_metres());
    let mut columns = ColumnMap::new(guess.drive_unit, (!is_scaled).then_some(1.0));
    if guess.period.is_some() {
        let rows = Column { period: guess.period, ..Column::new("") };
        columns.put("t", rows).map_err(|e| e.to_string())?;
    }
    for one in &guess.columns {
        let column = Column {
            unit: one.unit.clone(),
            per_turn: one.per_turn.or(one.needs_per_turn().then_some(std::f64::consts::TAU)),
            scale: one.scale.unwrap_or(1.0),
            offset: one.offset.unwrap_or(0.0),
            nanoseconds: one.nanoseconds.clone(),
            sum: one.sum,
            plus: one.plus.clone(),
            times: one.times.clone(),
            sign: one.sign.clone(),
            backward: one.backward.clone(),
            ..Column::new(&one.name)
        };
        columns.put(one.key, column).map_err(|e| e.to_string())?;
    }
    let mut raw = read_channels(path, &columns).map_err(|e| e.to_string())?;
    let commanded = guess.drive_unit == DriveUnit::Volt;
    let context = Context { commanded, ..Context::default() };
    let settings = Settings { refuse: false, ..Settings::default() };
    let mut channels = std::mem::take(&mut raw.channels);
    let mut findings = conditioning::repair_factors(&mut channels, &raw.factors, &settings);
    let rows = channels.t.len();
    let done = condition(channels, &settings, &context).map_err(|e| e.to_string())?;
    raw.channels = done.channels;
    let recording = raw.recording(guess.drive_unit).map_err(|e| e.to_string())?;
    if (0..2).any(|i| shows_no_motion(&recording, i)) {
        let raw = read_channels(path, &columns).map_err(|e| e.to_string())?;
        if let Err(dead @ ConditioningError::Dead { .. }) =
            condition(raw.channels, &Settings::default(), &context)
        {
            return Err(dead.to_string());
        }
    }
    findings.extend(done.findings);
    // the sign of an input does not depend on the scale of the motion
    findings.retain(|f| is_scaled || matches!(f.kind, conditioning::Kind::Magnitude));
    Ok((recording, findings, rows))
}

/// Enters units determined by comparing speeds and angles into the file.
fn take_units(guess: &mut Guess, findings: &[Finding]) {
    for finding in findings {
        if let Finding {
            channel: Channel::Speed(0),
            kind: conditioning::Kind::Gear { ratio },
            ..
        } = *finding
        {
            ask_gear(guess, ratio);
        }
        let conditioning::Kind::Unit { unit, .. } = finding.kind else { continue };
        let key = finding.channel.name();
        let open = guess.columns.iter_mut().find(|c| c.key == key && c.unit.is_none());
        // files have no unit for half a turn; conditioning converts it
        if let Some(one) = open.filter(|_| unit != "half-turns") {
            let answered = About::Unit(one.name.clone());
            (one.unit, one.unit_open) = (Some(unit.into()), false);
            one.evidence.push(Stated::of(finding).what());
            guess.answer(&answered);
        }
    }
}

/// Asks for the sign of inputs that conditioning refuses as magnitudes.
fn take_magnitudes(guess: &mut Guess, findings: &[Finding], path: &Path) {
    let is_one = |key: &str| {
        let of = |f: &Finding| {
            matches!(f.kind, conditioning::Kind::Magnitude) && f.channel.name() == key
        };
        findings.iter().any(of)
    };
    let is_new = |c: &Guessed| is_one(c.key) && c.sign.is_none() && !c.sign_open;
    let names: Vec<String> =
        guess.columns.iter().filter(|c| is_new(c)).map(|c| format!("`{}`", c.name)).collect();
    if names.is_empty() {
        return;
    }
    let (verb, them) =
        if names.len() == 1 { ("changes its", "it") } else { ("change their", "them") };
    guess.ask(format!(
        "{} never {verb} sign in {} although the wheels are driven both ways: a magnitude? Write the column with the \
         direction as sign, or another input as M1 and M2 (the commanded voltage); or remove sign and write \
         sign_from_speed = true under [conditioning], which gives {them} the sign of the speed (wrong while braking)",
        names.join(" and "),
        path.to_string_lossy()
    ));
    guess
        .columns
        .iter_mut()
        .filter(|c| is_one(c.key) && c.sign.is_none())
        .for_each(|c| c.sign_open = true);
}

/// Asks for the gear ratio between the shafts of speeds and angles, and opens the factor of the faster one.
fn ask_gear(guess: &mut Guess, ratio: f64) {
    let (key, other, scale) =
        if ratio > 1.0 { ("dalpha", "alpha", 1.0 / ratio) } else { ("alpha", "dalpha", ratio) };
    let of = |key: &str| guess.columns.iter().find(|c| c.key.strip_prefix(key) == Some("1"));
    let (Some(fast), Some(slow)) = (of(key), of(other)) else { return };
    if [fast, slow].iter().any(|c| c.unit_open || c.scale_open || c.scale.is_some()) {
        return;
    }
    guess.ask(format!(
        "the speeds are {ratio:.4} times the derivative of the angles: is there a gear between `{}` (motor) and `{}` (wheel)? If so, write scale = {scale:.6} in {key}1 and {key}2 (with \"-\" if it reverses the direction); otherwise correct the units",
        fast.name, slow.name
    ));
    let wheels =
        guess.columns.iter_mut().filter(|c| c.key.strip_prefix(key).is_some_and(|k| k.len() == 1));
    wheels.for_each(|c| c.scale_open = true);
}

fn seen(r: &Recording, findings: &[Finding], kind: Kind) -> Vec<String> {
    let mut out = vec![format!(
        "{} samples, {:.1} s at {} Hz, {} gaps, {}",
        r.len(),
        r.duration(),
        hertz(1.0 / r.step()),
        r.pieces().len() - 1,
        kind.words()
    )];
    let remarkable = findings.iter().copied().filter(Finding::is_remarkable);
    let remarkable = stated(&remarkable.collect::<Vec<_>>());
    out.extend(remarkable.iter().map(ToString::to_string));
    out
}

/// Checks that a recording has the columns that were found in the first one.
///
/// # Errors
/// The first that is missing, with the names that are there.
fn has_columns_of(first: &Path, path: &Path, guess: &Guess) -> Result<(), ExperimentError> {
    let names: Vec<String> = preview(path)?.into_iter().map(|column| column.name).collect();
    let Some(missing) = guess.columns.iter().find(|c| !names.contains(&c.name)) else {
        return Ok(());
    };
    let (missing, first, names) = (&missing.name, first.to_string_lossy(), names.join(", "));
    Err(ExperimentError::Meaning {
        file: path.display().to_string(),
        message: format!(
            "there is no column `{missing}`, which {first} has; its columns are {names}. All recordings of an \
             experiment have the same columns. If the files hold different signals of one run, as those of one topic \
             each, join them by time into one table and give that one (pandas: merge_asof on their times); if they hold \
             the same signals under other names, rename the columns"
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_files_of_one_wheel_each_are_asked_about() {
        let of = |names: &[&str]| {
            let paths: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
            one_wheel_each(&paths)
        };
        let asked = of(&["runs/Run1_left.csv", "runs/Run1_right.csv"]).unwrap();
        assert!(asked.contains("`run1_left.csv` and `run1_right.csv`"), "{asked}");
        assert!(of(&["left.csv", "right.csv"]).is_some());
        assert_eq!(of(&["left_turn.csv", "straight.csv"]), None);
        assert_eq!(of(&["run1.csv", "run2.csv"]), None);
    }
}
