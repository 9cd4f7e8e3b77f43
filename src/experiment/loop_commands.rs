//! `experiment new` and `experiment add`: how a user starts, and how he goes on.

use std::path::{Path, PathBuf};

use super::custom::add;
use super::error::ExperimentError;
use super::execute::{execute, load};
use super::options::RunOptions;
use crate::io::{ColumnMap, check_writable, headers, read_recording, read_text, write_whole};
use crate::robot::Robot;

/// The file beside an experiment file by which an editor checks it: what `experiment schema` prints.
const SCHEMA: &str = "experiment.schema.json";

/// Looks at recordings and writes a commented experiment file.
///
/// # Errors
/// Recordings that cannot be read, and a file that is there already.
pub fn new_file(recordings: &[PathBuf], output: Option<&Path>) -> Result<String, ExperimentError> {
    let first = &recordings[0];
    let output = output.map_or_else(|| first.with_extension("toml"), Path::to_path_buf);
    if output.exists() {
        return Err(ExperimentError::Meaning {
            file: output.display().to_string(),
            message: "is there already; name another file with -o".into(),
        });
    }
    let names = headers(first)?.names;
    let guess = super::guess::guess(&names);
    let mut columns = ColumnMap::new(guess.drive_unit, Some(Robot::amigobot().r()));
    for (key, name, unit) in &guess.columns {
        columns.set(key, name, unit.as_deref(), 1.0)?;
    }
    let mut said = Vec::new();
    for path in recordings {
        let (r, _) = read_recording(path, &columns, guess.drive_unit)?;
        said.push(format!(
            "#   {}: {} samples, {:.1} s at {:.0} Hz, {} gaps",
            in_a_line(path),
            r.len(),
            r.duration(),
            1.0 / r.step(),
            r.pieces().len() - 1
        ));
    }
    let folder = output.parent().unwrap_or_else(|| Path::new(""));
    let mut text = super::guess::file_text(recordings, folder, &guess, &said);
    if folder.join(SCHEMA).is_file() {
        text = format!("#:schema ./{SCHEMA}\n\n{text}");
    }
    write_whole(&output, text.as_bytes())?;
    Ok(format!(
        "wrote {}\n{}next: experiment {}\n",
        output.display(),
        guess.words(),
        output.display()
    ))
}

/// Adds an effect to a file's model, keeping its comments and layout, runs it, and says the error
/// before and after.
///
/// # Errors
/// An unknown effect, one that is there already, or a run that fails; the file is then unchanged.
pub fn add_effect(effect: &str, file: &Path, out: &Path) -> Result<String, ExperimentError> {
    check_writable(out)?;
    let text = read_text(file)?;
    let wrong =
        |message: String| ExperimentError::Meaning { file: file.display().to_string(), message };
    let before = load(file, &[])?;
    add(&before.model, effect, &before.own).map_err(|e| wrong(e.to_string()))?;
    let mut document: toml_edit::DocumentMut =
        text.parse().map_err(|e: toml_edit::TomlError| wrong(e.to_string()))?;
    let model = document.entry("model").or_insert_with(toml_edit::table);
    let effects = model
        .as_table_like_mut()
        .ok_or_else(|| wrong("model is no table".into()))?
        .entry("effects")
        .or_insert(toml_edit::value(toml_edit::Array::new()));
    let effects = effects.as_array_mut().ok_or_else(|| wrong("model.effects is no list".into()))?;
    effects.push(effect);
    let options = RunOptions {
        out: out.to_path_buf(),
        set: vec![],
        resume: false,
        shard: None,
        progress: false,
    };
    let first = execute(before, &options).result?;
    write_whole(file, document.to_string().as_bytes())?;
    let second = load(file, &[]).and_then(|plan| execute(plan, &options).result);
    let second = match second {
        Ok(done) => done,
        Err(e) => {
            write_whole(file, text.as_bytes())?;
            return Err(e);
        }
    };
    let (before, after) = (first.window_rms.0, second.window_rms.0);
    Ok(format!(
        "added {effect} to {}\nwindow error {before:.4} -> {after:.4} rad/s ({}), noise floor {:.4} \
         rad/s\n{}\nreport: {}\n",
        file.display(),
        change(effect, before, after),
        second.window_rms.1,
        second.verdict,
        second.report.display()
    ))
}

/// What adding an effect did to the error.
fn change(effect: &str, before: f64, after: f64) -> String {
    let percent = 100.0 * (after - before) / before;
    if percent < -LEAST {
        format!("{:.1} % less", -percent)
    } else if percent < LEAST {
        format!("as before: these recordings do not need {effect}, so take it out again")
    } else if percent.is_finite() {
        format!("{percent:.1} % more: {effect} does not belong in this model, so take it out again")
    } else {
        "not comparable".into()
    }
}

/// Changes of the error below this say nothing [%].
const LEAST: f64 = 0.5;

/// A path in a comment, which a line break in it would end.
fn in_a_line(path: &Path) -> String {
    path.to_string_lossy().replace(char::is_control, "\u{fffd}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_change_of_the_error_is_said_with_its_sense() {
        assert_eq!(change("slope", 0.6, 0.0534), "91.1 % less");
        assert!(change("slope", 0.0543, 0.0571).starts_with("5.2 % more: slope does not belong"));
        assert!(change("slope", 0.0543, 0.0542).starts_with("as before: "));
        assert_eq!(change("slope", 0.05, f64::INFINITY), "not comparable");
    }
}
