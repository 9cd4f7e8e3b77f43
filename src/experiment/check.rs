//! `experiment check`: the settings of a file and the quality of its recordings, without fitting.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::error::ExperimentError;
use super::execute::{is_toml, load, load_recordings};
use super::plan::{DiagnosisPlan, MeasuredRecording, Plan};
use crate::conditioning::{Stated, stated};
use crate::diagnose::Untimed;
use crate::identify::start::start;
use crate::identify::{IdentifyError, Task};
use crate::io::exists;
use crate::recording::StatedIssue;
use crate::report::format::hertz;
use crate::report::{dead_time, dead_time_advice, no_dead_time};
use crate::robot::Robot;
use crate::study::Role;

/// Validates experiment files and their recordings and describes each experiment. Recordings are described
/// together, as the experiment that `experiment new` would write for them.
///
/// # Errors
/// Each with the errors in the file or its recordings.
#[must_use]
pub fn check(files: &[PathBuf], set: &[String]) -> Vec<Result<String, ExperimentError>> {
    let is_recording = |file: &&PathBuf| !is_toml(file) && exists(file);
    let recordings: Vec<PathBuf> = files.iter().filter(is_recording).cloned().collect();
    let written = files.iter().filter(|file| !is_recording(file));
    let mut out: Vec<_> = written.map(|file| Ok(described(&load(file, set)?, file))).collect();
    if let Some(first) = recordings.first() {
        out.push(load_recordings(&recordings, set).map(|plan| described(&plan, first)));
    }
    out
}

fn described(plan: &Plan, file: &Path) -> String {
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
    plan.recordings.iter().for_each(|measured| recording(measured, &mut out));
    for sum in &plan.sums {
        let _ = writeln!(out, "  input       {sum}");
    }
    if let Some(units) = &plan.assumed {
        let _ = writeln!(out, "  units       {units}");
    }
    conditioning(plan, &mut out);
    let robot = plan.model.robot();
    for warning in plan.remarks_and_findings() {
        let _ = writeln!(out, "  warning     {warning}");
    }
    for (names, note) in plan.grouped(|m| notes(m, robot), StatedIssue::join) {
        let _ = writeln!(out, "  note        {names}: {note}");
    }
    if let Err(reason) = initial_values(plan) {
        let _ = writeln!(out, "  warning     {reason}");
    }
    let methods: Vec<&str> = plan.methods.iter().map(|m| m.name.as_str()).collect();
    let _ = writeln!(out, "  methods     {}", methods.join(", "));
    let diagnosis = plan.diagnosis.as_ref().map_or("none".into(), diagnosis);
    let _ = writeln!(out, "  diagnosis   {diagnosis}");
    if let Some(grid) = &plan.grid {
        let _ = writeln!(out, "  grid        {} combinations: {}", grid.cells(), grid.words());
    }
    let _ = writeln!(out, "  next        experiment {}", file.display());
    out
}

/// Whether the training recordings give initial values of the parameters, from which the methods start.
fn initial_values(plan: &Plan) -> Result<(), IdentifyError> {
    let train = plan.of(Role::Train);
    let task = Task { model: &plan.model, train: &train, hold: plan.hold, seed: plan.seed };
    if train.is_empty() { Ok(()) } else { start(&task, "initial values").map(drop) }
}

fn recording(measured: &MeasuredRecording, out: &mut String) {
    let r = &measured.recording;
    let _ = writeln!(
        out,
        "  {:<11} {}: {} samples, {:.1} s, {} Hz, {}",
        measured.role.name(),
        r.name(),
        measured.samples(),
        measured.duration(),
        hertz(1.0 / r.step()),
        match &measured.long {
            None => format!("{} gaps", r.pieces().len() - 1),
            Some(long) => format!("{} windows held", long.windows),
        }
    );
}

/// The candidates of a diagnosis and its false-alarm rate.
fn diagnosis(DiagnosisPlan { settings, .. }: &DiagnosisPlan) -> String {
    let own: Vec<String> = settings.own.iter().map(|e| e.id()).collect();
    let named = match (&settings.candidates[..], &own[..]) {
        ([], []) => "all effects".to_string(),
        ([], own) => format!("all effects and the formulas {}", own.join(", ")),
        (named, _) => named.join(", "),
    };
    format!("{named}, false-alarm rate {} %", 100.0 * settings.false_alarm)
}

/// Findings of conditioning, grouped by recordings, and the dead time.
fn conditioning(plan: &Plan, out: &mut String) {
    for (names, found) in plan.grouped(|m| stated(&m.conditioning), Stated::join) {
        let _ = writeln!(out, "  signal      {names}: {found}");
    }
    let words = plan.timing.map(|timing| {
        let advice = match timing.is_late() {
            false => String::new(),
            true if plan.diagnosis.is_some() => ": the diagnosis determines its cause".to_owned(),
            true => format!(": {}", dead_time_advice()),
        };
        dead_time(&timing) + &advice
    });
    match words {
        Err(Untimed::NotSought) => {}
        words => {
            let words = words.unwrap_or_else(|reason| no_dead_time(&reason));
            let _ = writeln!(out, "  dead time   {words}");
        }
    }
}

/// The notes of the quality check.
fn notes(measured: &MeasuredRecording, robot: &Robot) -> Vec<StatedIssue> {
    super::quality::notes(measured, robot).into_iter().map(|note| note.issue.stated()).collect()
}
