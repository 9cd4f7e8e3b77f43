//! `experiment check`: what a file would do, without doing it.

use std::fmt::Write as _;
use std::path::Path;

use super::error::ExperimentError;
use super::execute::load;
use super::plan::DiagnosisPlan;
use crate::study::grouped;

/// Validates a file and its recordings and says what would be done.
///
/// # Errors
/// Whatever is wrong with file or recordings.
pub fn check(file: &Path, set: &[String]) -> Result<String, ExperimentError> {
    let plan = load(file, set)?;
    let mut out = String::new();
    let _ = writeln!(out, "{}: {}", file.display(), plan.title);
    let _ = writeln!(out, "  robot       {}", plan.model.robot().name);
    let added = plan.model.added_ids();
    let effects = if added.is_empty() {
        "base model".into()
    } else {
        format!("base + {}", added.join(" + "))
    };
    let _ = writeln!(out, "  model       {effects}: {}", plan.model.symbols().join(", "));
    for measured in &plan.recordings {
        let r = &measured.recording;
        let _ = writeln!(
            out,
            "  {:<11} {}: {} samples, {:.1} s, {:.0} Hz, {} gaps",
            measured.role.name(),
            r.name(),
            r.len(),
            r.duration(),
            1.0 / r.step(),
            r.pieces().len() - 1
        );
    }
    let robot = plan.model.robot();
    let notes: Vec<(&str, String)> = plan
        .recordings
        .iter()
        .map(|m| &m.recording)
        .flat_map(|r| super::quality::notes(r, robot).into_iter().map(|note| (r.name(), note)))
        .collect();
    for warning in plan.warnings() {
        let _ = writeln!(out, "  warning     {warning}");
    }
    let notes = notes.iter().map(|(name, note)| (*name, note.as_str()));
    for (names, note) in grouped(notes, plan.recordings.len()) {
        let _ = writeln!(out, "  note        {names}: {note}");
    }
    let methods: Vec<&str> = plan.methods.iter().map(|m| m.name.as_str()).collect();
    let _ = writeln!(out, "  methods     {}", methods.join(", "));
    let diagnosis = match &plan.diagnosis {
        None => "none".to_string(),
        Some(DiagnosisPlan { settings, .. }) => {
            let own: Vec<String> = settings.own.iter().map(|e| e.id()).collect();
            let named = match (&settings.candidates[..], &own[..]) {
                ([], []) => "all effects".to_string(),
                ([], own) => format!("all effects and the formulas {}", own.join(", ")),
                (named, _) => named.join(", "),
            };
            format!("{named}, false-alarm rate {} %", 100.0 * settings.false_alarm)
        }
    };
    let _ = writeln!(out, "  diagnosis   {diagnosis}");
    if let Some(grid) = &plan.grid {
        let _ = writeln!(out, "  grid        {} combinations: {}", grid.cells(), grid.words());
    }
    let _ = writeln!(out, "  next        experiment {}", file.display());
    Ok(out)
}
