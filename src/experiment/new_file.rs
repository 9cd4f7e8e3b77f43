//! `experiment new`: from recordings to a commented experiment file.

mod kind;
mod look;

use std::path::{Path, PathBuf};

use self::kind::{Kind, split};
use self::look::Looked;
use super::error::ExperimentError;
use super::file::hold_rows;
use super::guess::{
    Lengths, Written, add_recording, file_text, guess, in_a_line, is_direction, mark_varying,
};
use super::no_motion::NoMotion;
use super::unrepaired::limit;
use crate::io::{IoError, parts, preview, stated_period, write_whole};
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
    let mut columns = preview(&recordings[0])?;
    // a recording that cannot be read is refused below
    let others = || recordings[1..].iter().flat_map(|r| preview(r));
    if columns.iter().any(is_direction) {
        // a recording may drive in one direction alone
        others().for_each(|r| add_recording(&mut columns, &r));
    }
    let mut guess = guess(&columns);
    if !guess.has_input() && recordings.len() > 1 {
        // an input may be constant in every recording and differ between them
        others().for_each(|r| mark_varying(&mut columns, &r));
        guess = self::guess(&columns);
    }
    let mut remarks = vec![];
    if let Some((period, comment)) = stated_period(&recordings[0])
        && guess.take_period(&columns, period)
    {
        remarks.push(in_a_line(&format!("`{comment}`: a row every {period} s")));
    }
    let Looked { recordings, kinds, words, notes, unread, corrected_rows } =
        Looked::at(&recordings, &mut guess)?;
    let lengths = Lengths::of(&recordings, &guess);
    let notes: Vec<String> = notes.into_iter().chain(lengths.words()).collect();
    let hold = (corrected_rows > hold_rows()).then(|| limit(corrected_rows));
    remarks.extend(words.iter().chain(&notes).cloned());
    let without_motion = without_motion(&kinds);
    guess.ask_all(without_motion.map(|none| none.to_string()));
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
        lengths: &lengths,
        hold,
    };
    let mut text = file_text(&written);
    if folder.join(SCHEMA).is_file() {
        text = format!("#:schema ./{SCHEMA}\n\n{text}");
    }
    let is_open = text.contains("\"?\"") || unread.is_some() || without_motion.is_some();
    let notes: String = notes.iter().map(|note| format!("  {note}\n")).collect();
    Ok(Draft { is_open, text, words: guess.words() + &notes })
}

/// Why none of the recordings shows a motion.
fn without_motion(kinds: &[Option<Kind>]) -> Option<NoMotion> {
    let each = kinds.iter().map(|kind| match kind {
        Some(Kind::Without(none)) => Some(*none),
        _ => None,
    });
    let each = each.collect::<Option<Vec<_>>>()?;
    let is_steady = each.contains(&NoMotion::Steady);
    Some(if is_steady { NoMotion::Steady } else { NoMotion::Rest })
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
    fn a_dead_encoder_is_asked_about() {
        let row = |t: f64| {
            format!("{t},0,{},{},{}", 5.0 * (1.3 * t).sin(), (1.3 * t).cos(), (1.3 * t).cos())
        };
        let found = drafted("dead.csv", "t,w_r,w_l,tau_r,tau_l", row, 2000);
        assert!(
            found.is_open && found.words.contains("the right wheel never moves"),
            "{}",
            found.words
        );
        assert!(found.text.contains("columns of the other wheel may be used"), "{}", found.text);
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
    fn wheels_at_rest_are_reported_as_at_rest() {
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
    fn words_below_empty_cells_are_listed_and_the_unit_of_a_speed_may_be_metres() {
        let row = |t: f64| {
            let ground = if t < 2.0 { "" } else { "grass" };
            format!("{t},{0},{0},{1},{1},{ground}", 0.47 * t.sin(), t.cos())
        };
        let found = drafted("ground.csv", "t,velR,velL,curR,curL,ground", row, 400);
        assert!(
            found.words.contains("0.00 as deg/s, 0.15 as rev/s, 0.47 as m/s)"),
            "{}",
            found.words
        );
        assert!(!found.text.contains("no cells for"), "{}", found.text);
        assert!(found.text.contains("\"grass\", \"grass\""), "{}", found.text);
        // rows of 0.01 s
        assert!(found.text.contains("at 100 Hz"), "{}", found.text);
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
