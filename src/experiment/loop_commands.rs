//! `experiment add`.

use std::path::Path;

use super::custom::add;
use super::error::ExperimentError;
use super::execute::{execute, load};
use super::index::write_index;
use super::options::{Done, RunOptions};
use super::plan::Plan;
use crate::io::{check_writable, read_text, write_whole};

/// Adds an effect to the model of a file, keeping comments and layout, runs it, and reports the error before
/// and after.
///
/// # Errors
/// An unknown effect, one that is already in the model, or a run that fails; the file is then unchanged.
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
        .ok_or_else(|| wrong("model is not a table".into()))?
        .entry("effects")
        .or_insert(toml_edit::value(toml_edit::Array::new()));
    let effects =
        effects.as_array_mut().ok_or_else(|| wrong("model.effects is not a list".into()))?;
    effects.push(effect);
    let options = RunOptions {
        out: out.to_path_buf(),
        set: vec![],
        resume: false,
        shard: None,
        progress: false,
    };
    let had_delay =
        before.diagnosis.is_none() && before.late().is_some() && shifts(&before, effect);
    write_whole(file, document.to_string().as_bytes())?;
    let (first, second, alike) = match both(before, effect, file, &options) {
        Ok(done) => done,
        Err(e) => {
            write_whole(file, text.as_bytes())?;
            return Err(e);
        }
    };
    write_index(&[], out)?;
    let (before, after) = (first.error, second.error);
    Ok(format!(
        "added {effect} to {}\n2 s simulation error {before:.4} -> {after:.4} rad/s ({}), noise floor {:.4} \
         rad/s\n{}{}\nreport: {}\n",
        file.display(),
        if had_delay { in_place_of_delay(effect) } else { change(effect, before, after) },
        second.floor,
        if alike { read_with(effect) } else { String::new() },
        second.verdict,
        second.report.display()
    ))
}

/// The runs without and with the effect that `file` now contains, and whether the first one uses the recordings as they
/// are read for the second: conditioning compares models of sensors by how well the motion is explained, and what a
/// model lacks may look like a filter of a sensor. Errors on recordings that are read differently are not comparable.
fn both(
    mut before: Plan,
    effect: &str,
    file: &Path,
    options: &RunOptions,
) -> Result<(Done, Done, bool), ExperimentError> {
    let after = load(file, &[])?;
    // the time of the input is divided between logging and an effect that shifts it
    let alike = !shifts(&before, effect) && !are_read_alike(&before, &after);
    if alike {
        (before.hold, before.timing) = (after.hold, after.timing);
        before.recordings.clone_from(&after.recordings);
    }
    Ok((execute(before, options).result?, execute(after, options).result?, alike))
}

/// Whether the recordings of two plans are those of the same files with the same corrections.
fn are_read_alike(a: &Plan, b: &Plan) -> bool {
    let pairs = a.recordings.iter().zip(&b.recordings);
    a.hold == b.hold && pairs.into_iter().all(|(a, b)| a.conditioning == b.conditioning)
}

/// How the recordings of both runs are read.
fn read_with(effect: &str) -> String {
    format!(
        "both on the recordings as corrected with {effect} in the model; without it the corrections differ\n"
    )
}

/// Whether an effect shifts the input in time.
fn shifts(plan: &Plan, effect: &str) -> bool {
    add(&plan.model, effect, &plan.own).is_ok_and(|model| model.shifts_input())
}

/// The change by an effect that replaces the delay of the earlier fit.
fn in_place_of_delay(effect: &str) -> String {
    format!(
        "the earlier fit contained an input delay for the dead time, which {effect} now replaces"
    )
}

/// The change of the error by the added effect.
fn change(effect: &str, before: f64, after: f64) -> String {
    let percent = 100.0 * (after - before) / before;
    if percent < -LEAST {
        format!("{:.1} % less", -percent)
    } else if percent < LEAST {
        format!(
            "unchanged: these recordings give no evidence for {effect}; remove it from the model"
        )
    } else if percent.is_finite() {
        format!("{percent:.1} % more: {effect} does not improve this model; remove it")
    } else {
        "not comparable".into()
    }
}

/// Smallest relevant change of the error [%].
const LEAST: f64 = 0.5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_change_of_the_error_is_stated_with_its_sense() {
        assert_eq!(change("slope", 0.6, 0.0534), "91.1 % less");
        assert!(change("slope", 0.0543, 0.0571).starts_with("5.2 % more: slope does not improve"));
        assert!(change("slope", 0.0543, 0.0542).starts_with("unchanged: "));
        assert_eq!(change("slope", 0.05, f64::INFINITY), "not comparable");
    }
}
