//! `experiment new`: from recordings to a commented experiment file.

mod kind;

use std::path::{Path, PathBuf};

use self::kind::{Kind, split};
use super::error::ExperimentError;
use super::guess::{About, Guess, Guessed, Written, file_text, guess};
use super::remarks::repeated;
use crate::conditioning::{self, Channel, Context, Finding, Settings, Stated, condition, stated};
use crate::io::{
    Column, ColumnMap, IoError, foreign_encoding, parts, preview, read_channels, stated_period,
    write_whole,
};
use crate::recording::{DriveUnit, Recording};
use crate::study::shell_word;

/// The schema file next to an experiment file, as printed by `experiment schema`.
const SCHEMA: &str = "experiment.schema.json";

/// Analyses recordings and writes a commented experiment file.
///
/// # Errors
/// Recordings that cannot be read, and a file that already exists.
pub fn new_file(recordings: &[PathBuf], output: Option<&Path>) -> Result<String, ExperimentError> {
    let first = &recordings[0];
    let output = output.map_or_else(|| first.with_extension("toml"), Path::to_path_buf);
    if output.exists() {
        return Err(ExperimentError::Meaning {
            file: output.display().to_string(),
            message: "is there already; name another file with -o".into(),
        });
    }
    let draft = draft(recordings, output.parent().unwrap_or_else(|| Path::new("")))?;
    write_whole(&output, draft.text.as_bytes())?;
    let file = output.display();
    let typed = shell_word(&file.to_string());
    let next = if draft.is_open {
        format!("to be completed in {file}: the questions above; then: experiment check {typed}")
    } else {
        format!("next: experiment {typed}")
    };
    Ok(format!("wrote {file}\n{}{next}\n", draft.words))
}

/// Text for a recording that cannot be read with the columns as detected; the question gives the reason.
const UNREAD: &str = "can be read when the questions below are answered";

/// A file that has not been written yet.
pub(super) struct Draft {
    pub(super) text: String,
    /// Description of the detected columns.
    pub(super) words: String,
    /// Whether it contains values that must be filled in or changed before it can be run.
    pub(super) is_open: bool,
}

/// The experiment file of recordings, for a file in this folder.
///
/// # Errors
/// Recordings that cannot be read.
pub(super) fn draft(recordings: &[PathBuf], folder: &Path) -> Result<Draft, ExperimentError> {
    let recordings = with_parts(recordings)?;
    let columns = preview(&recordings[0])?;
    let mut guess = guess(&columns);
    let (mut remarks, mut kinds, mut unread) = (vec![], vec![], None);
    if let Some((period, comment)) = stated_period(&recordings[0])
        && guess.take_period(period)
    {
        remarks.push(in_a_line(&format!("`{comment}`: a row every {period} s")));
    }
    let (mut read, mut copies, mut notes): (Vec<(usize, Recording)>, _, _) =
        (vec![], vec![], vec![]);
    for (k, path) in recordings.iter().enumerate() {
        let name = path.to_string_lossy();
        if let Some(encoding) = foreign_encoding(path) {
            notes.push(in_a_line(&format!("{name}: text in {encoding}")));
        }
        let (words, kind) = match look(path, &guess) {
            Ok((recording, findings)) => {
                let is_same = |(_, r): &&(usize, Recording)| !repeated(&[r, &recording]).is_empty();
                if let Some((other, _)) = read.iter().find(is_same) {
                    let other = recordings[*other].to_string_lossy();
                    notes.push(in_a_line(&format!(
                        "{name}: the samples of {other} again, left out"
                    )));
                    copies.push(k);
                    continue;
                }
                take_units(&mut guess, &findings);
                take_magnitudes(&mut guess, &findings, path);
                let kind = Kind::of(&recording);
                let words = seen(&recording, &findings, kind);
                read.push((k, recording));
                (words, Some(kind))
            }
            Err(reason) => {
                has_columns_of(&recordings[0], path, &guess)?;
                let file = path.file_name().map(|name| name.to_string_lossy().into_owned());
                let is_named = file.is_some_and(|file| reason.contains(&file));
                let of = if is_named { String::new() } else { format!("{name}: ") };
                unread.get_or_insert(format!("{of}{reason}"));
                (vec![UNREAD.to_owned()], None)
            }
        };
        remarks.extend(words.into_iter().map(|w| in_a_line(&format!("{name}: {w}"))));
        kinds.push(kind);
    }
    remarks.extend(notes.iter().cloned());
    let mut places = 0..recordings.len();
    let mut recordings = recordings;
    recordings.retain(|_| places.next().is_none_or(|k| !copies.contains(&k)));
    let is_still = kinds.iter().all(|kind| *kind == Some(Kind::Still));
    if is_still {
        guess.ask(super::remarks::NO_MOTION);
    }
    let is_asked = guess.is_open();
    let unread: Option<String> = unread.filter(|_| !is_asked);
    guess.ask_all(unread.iter().map(|reason| {
        format!("what is to be changed? The recording cannot be read with these columns: {reason}")
    }));
    let (validation, split) = split(&kinds);
    remarks.extend(split);
    let recordings: Vec<(PathBuf, bool)> = recordings.into_iter().zip(validation).collect();
    let written = Written {
        recordings: &recordings,
        folder,
        guess: &guess,
        remarks: &remarks,
        columns: &columns,
    };
    let mut text = file_text(&written);
    if folder.join(SCHEMA).is_file() {
        text = format!("#:schema ./{SCHEMA}\n\n{text}");
    }
    let is_open = text.contains("\"?\"") || unread.is_some() || is_still;
    let notes: String = notes.iter().map(|note| format!("  {note}\n")).collect();
    Ok(Draft { is_open, text, words: guess.words() + &notes })
}

/// The recordings, with each test of a SysId file as a separate one.
fn with_parts(recordings: &[PathBuf]) -> Result<Vec<PathBuf>, IoError> {
    let mut out = Vec::new();
    for path in recordings {
        let parts = if path.is_file() { parts(path)? } else { vec![] };
        let of = |part: &String| PathBuf::from(format!("{}#{part}", path.display()));
        match parts.len() {
            0 | 1 => out.push(path.clone()),
            _ => out.extend(parts.iter().map(of)),
        }
    }
    Ok(out)
}

/// A recording read with the guessed columns, and the findings of conditioning; or the reason why it cannot
/// be read. The direction of the motion does not depend on counts per turn and radius; findings on angles do.
fn look(path: &Path, guess: &Guess) -> Result<(Recording, Vec<Finding>), String> {
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
    let channels = std::mem::take(&mut raw.channels);
    let done = condition(channels, &settings, &context).map_err(|e| e.to_string())?;
    raw.channels = done.channels;
    let recording = raw.recording(guess.drive_unit).map_err(|e| e.to_string())?;
    let mut findings = done.findings;
    // the sign of an input does not depend on the scale of the motion
    findings.retain(|f| is_scaled || matches!(f.kind, conditioning::Kind::Magnitude));
    Ok((recording, findings))
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
        "{} samples, {:.1} s at {:.0} Hz, {} gaps, {}",
        r.len(),
        r.duration(),
        1.0 / r.step(),
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
             experiment have the same columns: write an experiment of its own for it, or rename its columns"
        ),
    })
}

/// Text for a comment, without line breaks.
fn in_a_line(text: &str) -> String {
    text.replace(char::is_control, "\u{fffd}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The draft for a log with these rows, with wheels that turn in both directions.
    fn drafted(name: &str, header: &str, row: impl Fn(f64) -> String, rows: u32) -> Draft {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        let body: Vec<String> = (0..rows).map(|k| row(0.01 * f64::from(k))).collect();
        write_whole(&path, format!("{header}\n{}\n", body.join("\n")).as_bytes()).unwrap();
        draft(&[path], folder.path()).unwrap()
    }

    #[test]
    fn what_keeps_a_recording_from_being_read_is_asked() {
        let row = |t: f64| format!("{t},{},{},{},{}", t.sin(), t.sin(), t.cos(), t.cos());
        let few = drafted("few.csv", "t,w_r,w_l,tau_r,tau_l", row, 5);
        assert!(few.is_open && few.words.contains("5 samples; at least 10"), "{}", few.words);
        assert!(few.text.contains("#   - what is to be changed?"), "{}", few.text);
        let many = drafted("many.csv", "t,w_r,w_l,tau_r,tau_l", row, 400);
        assert!(!many.is_open && !many.text.contains("what is to be changed?"), "{}", many.text);
    }

    #[test]
    fn a_magnitude_is_asked_for_by_the_rule_that_refuses_it() {
        // inertia alone: the input is large while the speed rises and while it falls
        let row = |t: f64| {
            let (speed, input) = (8.0 * (1.3 * t).sin(), (0.4 * (1.3 * t).cos()).abs());
            format!("{t},{speed},{speed},{input},{input}")
        };
        let found = drafted("mag.csv", "t,w_r,w_l,i_r [A],i_l [A]", row, 2000);
        assert!(
            found.is_open
                && found.words.contains("`i_r [A]` and `i_l [A]` never change their sign")
        );
        assert!(found.text.contains("M1 = { name = \"i_r [A]\", sign = \"?\" }"), "{}", found.text);
    }

    #[test]
    fn wheels_at_rest_are_said_to_be_at_rest() {
        let noise = |t: f64, by: f64| 0.02 * (1e4 * (t + by) * (t + 2.0 * by)).sin();
        let row = |t: f64| {
            format!("{t},{},{},{},{}", noise(t, 1.0), noise(t, 2.0), 0.5 + 0.1 * t.sin(), 0.5)
        };
        let found = drafted("still.csv", "t,w_r,w_l,i_r [A],i_l [A]", row, 2000);
        assert!(found.is_open && found.words.contains("the wheels do not move"), "{}", found.words);
        assert!(found.text.contains("at rest throughout"), "{}", found.text);
        assert!(!found.words.contains("never changes its sign"), "{}", found.words);
    }

    #[test]
    fn a_recording_with_other_columns_is_refused_with_their_names() {
        let folder = tempfile::tempdir().unwrap();
        let row = |t: f64| format!("{t},{},{},{},{}", t.sin(), t.sin(), t.cos(), t.cos());
        let body: Vec<String> = (0..400).map(|k| row(0.01 * f64::from(k))).collect();
        let paths = ["t,w_r,w_l,tau_r,tau_l", "time,a,b,c,d"].map(|header| {
            let path = folder.path().join(format!("{}.csv", &header[..2].replace(',', "_")));
            let text = format!("{header}\n{}\n", body.join("\n"));
            write_whole(&path, text.as_bytes()).unwrap();
            path
        });
        let error = draft(&paths, folder.path()).err().unwrap().to_string();
        assert!(error.contains("there is no column `t`, which "), "{error}");
        assert!(error.contains("its columns are time, a, b, c, d"), "{error}");
    }

    #[test]
    fn a_copy_of_a_recording_is_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let row = |t: f64| format!("{t},{},{},{},{}", t.sin(), t.sin(), t.cos(), t.cos());
        let body: Vec<String> = (0..400).map(|k| row(0.01 * f64::from(k))).collect();
        let text = format!("t,w_r,w_l,tau_r,tau_l\n{}\n", body.join("\n"));
        let paths = ["a.csv", "b.csv"].map(|name| folder.path().join(name));
        paths.iter().for_each(|path| write_whole(path, text.as_bytes()).unwrap());
        let again = folder.path().join("./a.csv");
        let found = draft(&[&paths[..], &[again]].concat(), folder.path()).unwrap();
        assert!(found.text.contains("train      = [\"a.csv\"]"), "{}", found.text);
        assert!(found.text.contains("validation = []"), "{}", found.text);
        assert!(found.words.contains("b.csv: the samples of "), "{}", found.words);
    }

    #[test]
    fn a_gear_between_speeds_and_angles_is_asked() {
        let row = |t: f64| {
            let (angle, speed) = (5.0 * (1.0 - t.cos()), 100.0 * t.sin());
            format!("{t},{speed},{speed},{angle},{angle},{},{}", 0.2 * t.cos(), 0.2 * t.cos())
        };
        let header = "t,motor_r_rad_s,motor_l_rad_s,angle_r_rad,angle_l_rad,tau_r,tau_l";
        let found = drafted("gear.csv", header, row, 2000);
        assert!(
            found.is_open && found.words.contains("is there a gear between"),
            "{}",
            found.words
        );
        assert!(found.text.contains("name = \"motor_r_rad_s\", scale = \"?\""), "{}", found.text);
    }

    #[test]
    fn the_period_in_a_comment_stands_for_a_column_of_the_time() {
        let row = |t: f64| format!("{},{},{},{}", t.sin(), t.sin(), t.cos(), t.cos());
        let found = drafted("fs.csv", "# fs: 100 Hz\nw_r,w_l,tau_r,tau_l", row, 400);
        assert!(!found.is_open && found.text.contains("t = { period = 0.01 }"), "{}", found.text);
        assert!(found.text.contains("`# fs: 100 Hz`: a row every 0.01 s"), "{}", found.text);
    }
}
