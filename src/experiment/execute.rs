//! Load, run, write: an experiment file to its result folder.

use std::path::{Path, PathBuf};

use super::error::ExperimentError;
use super::file::ExperimentFile;
use super::grid::{self, GridPlan};
use super::options::{Done, RunOptions};
use super::plan::Plan;
use super::remarks::remarks;
use super::resolve::resolve;
use super::run::run;
use crate::export::Written;
use crate::io::{ResultFolder, check_writable, read_text, write_csv, write_whole};
use crate::study::{DiagnosisStudy, Study, Version, results};

/// What became of an experiment.
#[derive(Debug)]
pub struct Outcome {
    /// Name of its folder.
    pub name: String,
    /// Heading.
    pub title: String,
    /// The result or why there is none.
    pub result: Result<Done, ExperimentError>,
}

/// Loads and checks every file before anything runs.
///
/// # Errors
/// All that is wrong, one entry a file.
pub fn load_all(
    files: &[PathBuf],
    options: &RunOptions,
) -> Result<Vec<Plan>, Vec<ExperimentError>> {
    let mut plans: Vec<Plan> = Vec::new();
    let mut errors = Vec::new();
    if let Err(e) = check_writable(&options.out) {
        errors.push(e.into());
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
            Ok(plan) => plans.push(plan),
            Err(e) => errors.push(e),
        }
    }
    if errors.is_empty() { Ok(plans) } else { Err(errors) }
}

/// Loads one file with its recordings.
///
/// # Errors
/// Whatever is wrong with file or recordings.
pub fn load(file: &Path, set: &[String]) -> Result<Plan, ExperimentError> {
    let text = read_text(file)?;
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
        Some(grid) => GridPlan::load(file, &as_run, table, grid),
    };
    Ok(Plan { remarks, ..plan? })
}

/// Runs a plan and writes its folder.
pub fn execute(plan: Plan, options: &RunOptions) -> Outcome {
    let (name, title) = (plan.name.clone(), plan.title.clone());
    Outcome { name, title, result: finish(&plan, options) }
}

/// Joins the parts of a grid, which [`execute`] left with a shard, and writes its folder.
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
    // said before the fit and not after it
    check_writable(&options.out.join(&plan.name))?;
    if let Some(grid) = &plan.grid {
        return match options.shard {
            Some(shard) => grid::run_part(plan, grid, shard, options),
            None => grid::finish(plan, grid, options),
        };
    }
    let mut folder = ResultFolder::new(&options.out, &plan.name);
    let mut study = run(plan)?;
    study.versions = versions(folder.earlier("versions.json").as_deref(), &study);
    let model = super::model_out::model_out(plan, &study);
    study.model_out = model.as_ref().map(Written::words);
    let rendered = crate::report::render(&study)?;
    folder.add("experiment.toml", study.file.clone());
    for (file, bytes) in rendered.figures {
        folder.add(file, bytes);
    }
    for (file, text) in model.map_or(vec![], |written| written.files) {
        folder.add(file, text);
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
    folder.add("versions.json", serde_json::to_string_pretty(&study.versions).unwrap_or_default());
    folder.add("report.html", rendered.html);
    let results = serde_json::to_string_pretty(&results(&study)).unwrap_or_default();
    folder.add("results.json", results);
    let path = folder.write()?;
    let window_rms = study
        .reference_method()
        .map_or((f64::NAN, f64::NAN), |m| (study.judged_window_rms(m), study.judged_floor()));
    Ok(Done { verdict: verdict(&study), report: path.join("report.html"), window_rms })
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

/// Earlier versions of the model with this one at the end; one entry per set of effects.
fn versions(earlier: Option<&str>, study: &Study) -> Vec<Version> {
    let mut versions: Vec<Version> =
        earlier.and_then(|text| serde_json::from_str(text).ok()).unwrap_or_default();
    let Some(method) = study.reference_method() else { return versions };
    let version = Version {
        effects: study.effects.clone(),
        window_rms: study.judged_window_rms(method),
        ise: study.judged_ise(method),
        floor: study.judged_floor(),
    };
    versions.retain(|v| v.effects != version.effects && v.window_rms.is_finite());
    versions.push(version);
    versions
}

/// The short verdict that the command prints.
fn verdict(study: &Study) -> String {
    let Some(method) = study.reference_method() else {
        return "no method has a fit".into();
    };
    let (error, floor) = (study.judged_window_rms(method), study.judged_floor());
    let (capital, sentence) = match &study.diagnosis {
        Some(DiagnosisStudy { sentence, .. }) => ("Window", format!("{sentence} ")),
        None => ("window", String::new()),
    };
    format!(
        "{sentence}{capital} error {error:.4} rad/s, noise floor {floor:.4} rad/s ({}, {})",
        method.name,
        study.judged_words()
    )
}

/// Writes `index.html`, which compares the experiments of one run.
///
/// # Errors
/// If it cannot be drawn or written.
pub fn write_index(outcomes: &[Outcome], options: &RunOptions) -> Result<(), ExperimentError> {
    use crate::report::block::{Block, Cell, Column, Table, Tone};
    let mut table = Table::new(
        "The experiments of this run.",
        vec![
            Column::text("Experiment"),
            Column::number("Window error", "rad/s"),
            Column::number("Noise floor", "rad/s"),
            Column::text("Verdict"),
            Column::text("Report"),
        ],
    );
    let error = |v: f64| Cell::formatted(crate::report::format::digits(v, 3), v);
    for outcome in outcomes {
        let row = match &outcome.result {
            Ok(done) => vec![
                Cell::text(&outcome.title),
                error(done.window_rms.0),
                error(done.window_rms.1),
                Cell::text(&done.verdict),
                Cell::text("open").link(format!("{}/report.html", outcome.name)),
            ],
            Err(e) => vec![
                Cell::text(&outcome.title),
                Cell::number(f64::NAN),
                Cell::number(f64::NAN),
                Cell::text(format!("failed: {e}")).tone(Tone::Bad),
                Cell::text(""),
            ],
        };
        table.push(row);
    }
    let section = crate::report::SectionContent {
        id: "experiments".into(),
        title: "Experiments".into(),
        blocks: vec![Block::from(table)],
    };
    let html = crate::report::page(&crate::report::PageContent {
        title: "Experiments".into(),
        subtitle: format!("{} experiments", outcomes.len()),
        sections: vec![section],
        footer: format!("{} {}", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION")),
    })?;
    if options.out.is_dir() {
        write_whole(&options.out.join("index.html"), html.as_bytes())?;
    }
    Ok(())
}
