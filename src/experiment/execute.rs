//! Load, run, write: an experiment file to its result folder.

use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::error::ExperimentError;
use super::file::ExperimentFile;
use super::grid;
use super::options::{Done, RunOptions, THUMBNAIL};
use super::origin::{not_of_another, origin};
use super::plan::Plan;
use super::remark::Remark;
use super::remarks::remarks;
use super::resolve::resolve;
use super::run::{Unfitted, run_in_stages};
use super::stages::Stages;
use crate::identify::Note;
use crate::io::{ResultFolder, check_writable, exists, read_text, write_csv};
use crate::report::{not_determined, results, sentence, sign_of_speed, simulation_error};
use crate::study::{Invocation, Judged, Study, Version};

/// Result of an experiment.
#[derive(Debug)]
pub struct Outcome {
    /// Name of its folder.
    pub name: String,
    /// Heading.
    pub title: String,
    /// The result, or the reason of the failure.
    pub result: Result<Done, ExperimentError>,
}

/// Loads and checks all files before any of them is run.
///
/// # Errors
/// All errors, one entry per file.
pub fn load_all(
    files: &[PathBuf],
    options: &RunOptions,
) -> Result<Vec<Plan>, Vec<ExperimentError>> {
    let mut plans: Vec<Plan> = Vec::new();
    let mut errors = Vec::new();
    if let Err(e) = check_writable(&options.out) {
        errors.push(e.into());
    }
    let (files, recordings): (Vec<&PathBuf>, Vec<&PathBuf>) =
        files.iter().partition(|f| is_toml(f));
    if !recordings.is_empty() {
        let recordings: Vec<PathBuf> = recordings.into_iter().cloned().collect();
        let of_its_own = |plan: Plan| not_of_another(&plan, &options.out).map(|()| plan);
        match load_recordings(&recordings, &options.set).and_then(of_its_own) {
            Ok(plan) => plans.push(plan),
            Err(e) => errors.push(e),
        }
    }
    for file in files {
        match load(file, &options.set) {
            Ok(plan) if plans.iter().any(|p| p.name == plan.name) => {
                let message = format!(
                    "another file of this run is called {} too; results go into a folder of that \
                     name, so rename one",
                    plan.name
                );
                errors.push(ExperimentError::Meaning { file: file.display().to_string(), message });
            }
            Ok(plan) if options.shard.is_some() && plan.grid.is_none() => {
                let message = "has no [grid], so there are no combinations to share among \
                               machines; leave --shard out"
                    .to_string();
                errors.push(ExperimentError::Meaning { file: file.display().to_string(), message });
            }
            Ok(plan) => match not_of_another(&plan, &options.out) {
                Ok(()) => plans.push(plan),
                Err(e) => errors.push(e),
            },
            Err(e) => errors.push(e),
        }
    }
    if errors.is_empty() { Ok(plans) } else { Err(errors) }
}

pub(super) fn is_toml(file: &Path) -> bool {
    file.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

/// Loads one file with its recordings.
///
/// # Errors
/// Errors in the file or its recordings.
pub fn load(file: &Path, set: &[String]) -> Result<Plan, ExperimentError> {
    if !is_toml(file) && exists(file) {
        let message = format!(
            "is not an experiment file (.toml). If it is a recording, `experiment {0}` runs it and `experiment new \
             {0}` writes an experiment file",
            file.display()
        );
        return Err(ExperimentError::Meaning { file: file.display().to_string(), message });
    }
    load_text(file, read_text(file)?, set)
}

/// An experiment on recordings, from the file that `experiment new` would write.
///
/// # Errors
/// Recordings that cannot be read, and questions that only the user can answer.
pub fn load_recordings(recordings: &[PathBuf], set: &[String]) -> Result<Plan, ExperimentError> {
    let Some(first) = recordings.first() else {
        let message = "none is given; at least one is needed to fit".into();
        return Err(ExperimentError::Meaning { file: "recordings".into(), message });
    };
    let draft = super::new_file::draft(recordings, Path::new(""))?;
    let file = first.file_stem().map_or_else(|| "experiment".into(), PathBuf::from);
    let file = file.with_extension("toml");
    let name = file.display().to_string();
    if draft.is_open && ExperimentFile::parse(&name, &draft.text, set).is_err() {
        let typed = |path: &PathBuf| path.display().to_string();
        let run = Invocation {
            file: typed(&file),
            recordings: recordings.iter().map(typed).collect(),
            out: None,
        };
        return Err(ExperimentError::Meaning {
            file: first.display().to_string(),
            message: format!(
                "the columns do not determine everything that is needed.\n{}Answer it in a file: {}",
                draft.words,
                run.new_file().unwrap_or_default()
            ),
        });
    }
    // the file is in memory only
    let mut plan = load_text(&file, draft.text, set)
        .map_err(|e| e.about(&name, &first.display().to_string()))?;
    plan.typed = recordings.to_vec();
    plan.remarks.insert(0, Remark::Columns(draft.words.trim_end().to_string()));
    Ok(plan)
}

fn load_text(file: &Path, text: String, set: &[String]) -> Result<Plan, ExperimentError> {
    let parsed = ExperimentFile::parse(&file.display().to_string(), &text, set)?;
    let mut as_run = text.clone();
    if !set.is_empty() {
        let set = set.iter().map(|s| format!("--set {s}")).collect::<Vec<_>>().join(" ");
        as_run = format!("# run with {set}\n{text}");
    }
    let table = ExperimentFile::table(&file.display().to_string(), &text, set)?;
    let remarks = remarks(&table);
    let plan = match &parsed.grid {
        None => resolve(file, &as_run, &parsed),
        Some(grid) => grid::resolve_grid(file, &as_run, table, grid),
    };
    let mut plan = plan?;
    plan.remarks.splice(0..0, remarks);
    Ok(plan)
}

/// Runs a plan and writes its result folder.
pub fn execute(plan: Plan, options: &RunOptions) -> Outcome {
    let (name, title) = (plan.name.clone(), plan.title.clone());
    Outcome { name, title, result: finish(&plan, options) }
}

/// Merges the parts of a grid that were run by [`execute`] with a shard, and writes its result folder.
pub fn merge(plan: Plan, options: &RunOptions) -> Outcome {
    let result = match &plan.grid {
        Some(grid) => grid::merge(&plan, grid, options),
        None => Err(ExperimentError::Meaning {
            file: format!("{}.toml", plan.name),
            message: "has no [grid], so there are no parts to join; run it as it is".into(),
        }),
    };
    Outcome { name: plan.name, title: plan.title, result }
}

fn finish(plan: &Plan, options: &RunOptions) -> Result<Done, ExperimentError> {
    // an unwritable folder is reported before the fit
    check_writable(&options.out.join(&plan.name))?;
    if let Some(grid) = &plan.grid {
        return match options.shard {
            Some(shard) => grid::run_part(plan, grid, shard, options),
            None => grid::finish(plan, grid, options),
        };
    }
    let stages = Stages::new(&plan.name, options.progress);
    let study = run_in_stages(plan, &stages);
    stages.enter("drawing the report");
    match study {
        Ok(study) => write(plan, study, &options.out),
        Err(Unfitted { reason, study: None }) => Err(reason.into()),
        Err(Unfitted { reason, study: Some(study) }) => {
            let Done { report, .. } = write(plan, *study, &options.out)?;
            Err(ExperimentError::Unfitted { reason, report })
        }
    }
}

/// The default folder of the results.
const USUAL_OUT: &str = "reports";

/// Writes the result folder of a study under `out`: report, figures, `results.json`, the identified
/// model, and what is needed to repeat the run.
///
/// # Errors
/// If the report cannot be drawn or a file cannot be written.
pub fn write(plan: &Plan, study: Study, out: &Path) -> Result<Done, ExperimentError> {
    let mut folder = ResultFolder::new(out, &plan.name);
    let (versions, comparable) = versions(folder.earlier("versions.json").as_deref(), &study);
    let root = out.to_path_buf();
    let out = (out != Path::new(USUAL_OUT)).then(|| out.display().to_string());
    let invocation = Invocation { out, ..study.invocation };
    let study = Study { versions: comparable, invocation, ..study };
    let rendered = crate::report::render(&study)?;
    if !study.file.is_empty() {
        folder.add("experiment.toml", study.file.clone());
    }
    for (file, bytes) in rendered.figures {
        folder.add(file, bytes);
    }
    for (file, text) in study.model_out.iter().flat_map(|model| &model.files) {
        folder.add(file.clone(), text.clone());
    }
    if let Some(proposal) = study.diagnosis.as_ref().and_then(|d| d.proposal.as_ref()) {
        let (toml, csv) = next_run_files(plan, proposal);
        folder.add("next_run.toml", toml);
        folder.add("next_run.csv", csv);
    }
    for measured in plan.recordings.iter().filter(|m| m.sha256.is_none()) {
        let file = format!("{}.csv", measured.recording.name().replace(' ', "_"));
        folder.add(file, write_csv(&measured.recording));
    }
    folder.add("estimates.parquet", super::estimates::parquet(&study)?);
    folder.add("versions.json", serde_json::to_string_pretty(&versions).unwrap_or_default());
    folder.add("report.html", rendered.html);
    let mut results = results(&study);
    results["file"] = origin(plan, &root).into();
    results["finding"] = finding(&study).into();
    let results = serde_json::to_string_pretty(&results).unwrap_or_default();
    folder.add("results.json", results);
    if let Some(png) = crate::report::thumbnail(&study)? {
        folder.add(THUMBNAIL, png);
    }
    let path = folder.write()?;
    Ok(Done {
        verdict: verdict(&study),
        contradictions: contradictions(&study),
        report: path.join("report.html"),
        error: study.given.as_ref().map_or(f64::NAN, |given| study.error_of(given)),
        floor: study.judged_floor(),
    })
}

/// What the method that is shown in detail and others contradict each other in.
fn contradictions(study: &Study) -> Vec<String> {
    let reference = study.reference.map(|n| &study.methods[n]);
    let notes = reference.into_iter().flat_map(|m| m.notes.iter().map(move |note| (&m.name, note)));
    let one = |(name, note): (&String, &Note)| match note {
        Note::Contradiction(one) => Some(format!("{name}: {one}")),
        _ => None,
    };
    notes.filter_map(one).collect()
}

/// The manoeuvre as segments and as set-points at 100 Hz.
fn next_run_files(plan: &Plan, proposal: &crate::diagnose::Proposal) -> (String, String) {
    use std::fmt::Write as _;
    let mut toml = String::from("[simulation]\nmovement = [\n");
    for s in &proposal.movement.segments {
        let _ = writeln!(
            toml,
            "  {{ speed_m_s = {:.5}, turn_rad_s = {:.5}, blend_s = {:.4}, hold_s = {:.4} }},",
            s.speed_m_s, s.turn_rad_s, s.blend_s, s.hold_s
        );
    }
    toml.push_str("]\n");
    let robot = plan.model.robot();
    let mut csv = String::from("t_s,dalpha1_rad_s,dalpha2_rad_s,ddalpha1_rad_s2,ddalpha2_rad_s2\n");
    for k in 0..=(proposal.movement.duration() * 100.0) as usize {
        let t = 0.01 * k as f64;
        let r = proposal.movement.reference(robot, t);
        let (w, a) = (r.omega, r.acceleration);
        let _ = writeln!(csv, "{t:.2},{:.5},{:.5},{:.5},{:.5}", w[0], w[1], a[0], a[1]);
    }
    (toml, csv)
}

/// Largest number of versions of the model that are kept, for all data.
const VERSIONS: usize = 100;

/// Earlier versions of the model followed by this one, one entry per data and set of effects: all that are
/// kept, and those on the same data. Errors on other recordings, or with other noise, are not comparable.
fn versions(earlier: Option<&str>, study: &Study) -> (Vec<Version>, Vec<Version>) {
    let mut versions: Vec<Version> =
        earlier.and_then(|text| serde_json::from_str(text).ok()).unwrap_or_default();
    let Some(given) = &study.given else { return (versions, vec![]) };
    let version = Version {
        effects: study.effects.clone(),
        data: checksum(study),
        window_rms: study.error_of(given),
        ise: Judged::of(&study.recordings).ise(&given.performance),
        floor: study.judged_floor(),
    };
    let is_same = |v: &Version| v.data == version.data && v.effects == version.effects;
    versions.retain(|v| v.window_rms.is_finite() && !is_same(v));
    versions.drain(..versions.len().saturating_sub(VERSIONS - 1));
    let comparable = versions.iter().filter(|v| v.data == version.data).cloned();
    let comparable = comparable.chain([version.clone()]).collect();
    versions.push(version);
    (versions, comparable)
}

/// SHA-256 of the data for fitting and validation: role, time and channels of every recording.
fn checksum(study: &Study) -> String {
    let mut hash = Sha256::new();
    for r in &study.recordings {
        hash.update(r.role.name());
        r.t.iter().for_each(|t| hash.update(t.to_le_bytes()));
        let channels = [&r.alpha, &r.omega, &r.torque];
        channels.iter().flat_map(|c| c.iter().flatten()).for_each(|v| hash.update(v.to_le_bytes()));
    }
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The effects found, without the figures that the index shows separately.
fn finding(study: &Study) -> String {
    match (&study.diagnosis, study.reference_method()) {
        (Some(diagnosis), _) => sentence(diagnosis),
        (None, Some(method)) => format!("Fitted by {}; no diagnosis.", method.name),
        (None, None) => verdict(study),
    }
}

/// The short verdict printed by the command, with what it is conditional on.
fn verdict(study: &Study) -> String {
    [Some(compared(study)), sign_of_speed(study)]
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join(". ")
}

/// The errors compared with the noise floor, behind the text of a diagnosis.
fn compared(study: &Study) -> String {
    let Some(method) = study.reference_method() else {
        return "no method has a fit".into();
    };
    let error = study.last_model().map_or(f64::NAN, |m| study.error_of(m));
    let (floor, named) = (study.judged_floor(), simulation_error(study));
    let judged = match Judged::of(&study.recordings).are_held_out() {
        true => "validation",
        false => "training: no validation recording is given",
    };
    let staircase = study.diagnosis.as_ref().map_or(&[][..], |d| &d.staircase);
    match (&study.diagnosis, staircase.first().zip(staircase.last())) {
        // error, floor and ratio are those of the fits of the diagnosis
        (Some(diagnosis), Some((first, last))) => {
            let [before, after] = [first, last].map(|s| format!("{:.4}", s.window_rms_validation));
            let errors = if staircase.len() > 1 { format!("{before} to {after}") } else { after };
            format!(
                "{} {named} {errors} rad/s, noise floor {floor:.4} rad/s ({judged})",
                sentence(diagnosis)
            )
        }
        _ => {
            let unknown =
                study.undetermined().map_or(String::new(), |why| not_determined(why) + " ");
            format!(
                "{unknown}{named} {error:.4} rad/s, noise floor {floor:.4} rad/s ({}, {judged})",
                method.name
            )
        }
    }
}
