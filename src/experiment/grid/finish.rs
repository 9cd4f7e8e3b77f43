//! A whole grid, a part of it, or its merged parts; and its result folder.

use serde::{Serialize, Serializer};
use serde_json::{Value, json};

use super::cell::Cell;
use super::competitors::{Best, competitors};
use super::run::{Finished, Line, run_cells};
use super::shell::command;
use super::summary::{self, Summary};
use super::winner::{judged_on, winner};
use super::{page, table, thumbnail};
use crate::experiment::combinations::GridPlan;
use crate::experiment::error::ExperimentError;
use crate::experiment::options::{Done, RunOptions, THUMBNAIL};
use crate::experiment::origin::origin;
use crate::experiment::plan::Plan;
use crate::experiment::shard::Shard;
use crate::io::{Journal, ResultFolder, write_csv_table};
use crate::report::SCHEMA;

/// Runs a grid and writes its folder.
///
/// # Errors
/// A folder that cannot be written and figures that cannot be drawn; failures of cells are not errors.
pub(in crate::experiment) fn finish(
    plan: &Plan,
    grid: &GridPlan,
    options: &RunOptions,
) -> Result<Done, ExperimentError> {
    let path = options.out.join(&plan.name).join("grid.journal.jsonl");
    let wanted: Vec<usize> = (0..grid.cells()).collect();
    let cells = run_cells(plan, grid, options, &path, &wanted)?;
    write(plan, grid, options, &cells)
}

/// Runs a part of a grid and writes its journal for [`merge`].
///
/// # Errors
/// A folder that cannot be written; failures of cells are not errors.
pub(in crate::experiment) fn run_part(
    plan: &Plan,
    grid: &GridPlan,
    shard: Shard,
    options: &RunOptions,
) -> Result<Done, ExperimentError> {
    let path = options.out.join(&plan.name).join(shard.file());
    let wanted: Vec<usize> = (0..grid.cells()).filter(|cell| shard.holds(*cell)).collect();
    let cells = run_cells(plan, grid, options, &path, &wanted)?;
    let failed = cells.iter().filter(|cell| cell.failed()).count();
    let verdict = format!(
        "part {shard}: {} of {} combinations, {failed} with a failure; when all parts are there: {}",
        cells.len(),
        grid.cells(),
        command("merge", grid, options)
    );
    Ok(Done::of_grid(verdict, path))
}

/// Merges the parts of a grid and writes the same folder as a single run. Parts of different divisions (1/2
/// and 2/4, 4/4) can be merged if together they contain all combinations.
///
/// # Errors
/// Missing combinations, parts of another version, and the errors of [`finish`].
pub(in crate::experiment) fn merge(
    plan: &Plan,
    grid: &GridPlan,
    options: &RunOptions,
) -> Result<Done, ExperimentError> {
    let folder = options.out.join(&plan.name);
    let parts = Shard::in_folder(&folder);
    let mut finished = Finished::new(plan, grid);
    for part in &parts {
        let path = folder.join(part.file());
        let mut others = 0_usize;
        Journal::read(&path, |line| {
            others += usize::from(matches!(finished.take(line), Line::Other));
        })?;
        if others > 0 {
            let run = command(&format!("--shard {part} --resume"), grid, options);
            let message = format!(
                "{others} of its combinations are of another version of the experiment file, its \
                 --set values, its recordings or the program (their checksums differ); run \
                 `{run}`, or delete the part if it is not of this grid"
            );
            return Err(ExperimentError::Meaning { file: path.display().to_string(), message });
        }
    }
    let missing: Vec<usize> = (0..grid.cells()).filter(|cell| !finished.has(*cell)).collect();
    if !missing.is_empty() {
        let message = missing_words(&missing, &parts, grid, options);
        return Err(ExperimentError::Meaning { file: folder.display().to_string(), message });
    }
    write(plan, grid, options, &finished.cells())
}

/// The missing combinations, and the commands that run them.
fn missing_words(
    missing: &[usize],
    parts: &[Shard],
    grid: &GridPlan,
    options: &RunOptions,
) -> String {
    let all = grid.cells();
    // the division with the most parts present
    let count = |of: usize| (parts.iter().filter(|part| part.of() == of).count(), of);
    let Some(of) = parts.iter().map(|part| part.of()).max_by_key(|of| count(*of)) else {
        let run = command("--shard I/N", grid, options);
        return format!(
            "contains no part of the {all} combinations; run `{run}` for every I from 1 to N, or \
             copy the parts into this folder"
        );
    };
    let mut out = format!("{} of {all} combinations are missing; run", missing.len());
    for part in Shard::all(of) {
        let cells: Vec<usize> = missing.iter().copied().filter(|c| part.holds(*c)).collect();
        let wanted = (0..all).filter(|cell| part.holds(*cell)).count();
        let what = if parts.contains(&part) {
            format!("--shard {part} --resume")
        } else {
            format!("--shard {part}")
        };
        if let Some(first) = cells.first() {
            out += &format!("\n    {}", command(&what, grid, options));
            out += &format!("    # {} of {wanted}, from combination {first} on", cells.len());
        }
    }
    out + "\nand merge again"
}

/// Writes the folder of a grid from all its cells in order.
fn write(
    plan: &Plan,
    grid: &GridPlan,
    options: &RunOptions,
    cells: &[Cell],
) -> Result<Done, ExperimentError> {
    let mut folder = ResultFolder::new(&options.out, &plan.name);
    folder.add("experiment.toml", plan.file.clone());
    folder.add("estimates.parquet", table::parquet(grid, cells)?);
    let summaries = summary::summaries(grid, cells)?;
    folder.add("summary.csv", write_csv_table(&summary::columns(grid, &summaries))?);
    let competitors = competitors(grid, cells);
    let (best, winner) = (Best::of(&competitors), winner(&competitors));
    let rendered = page::render(plan, grid, cells, &summaries, winner.as_ref())?;
    for (file, bytes) in rendered.figures {
        folder.add(file, bytes);
    }
    folder.add("report.html", rendered.html);
    if let Some(png) = thumbnail::thumbnail(&competitors)? {
        folder.add(THUMBNAIL, png);
    }
    let headline = winner.map(|winner| format!(" {}", winner.sentence(judged_on(cells))));
    let verdict = page::verdict(grid, cells, &summaries) + &headline.unwrap_or_default();
    let results = serde_json::to_string_pretty(&results(
        plan,
        grid,
        cells,
        &summaries,
        (&verdict, best.as_ref()),
        origin(plan, &options.out),
    ));
    folder.add("results.json", results.unwrap_or_default());
    let path = folder.write()?;
    Ok(Done::of_grid(verdict, path.join("report.html")))
}

/// `results.json` of a grid. Its lists are serialised entry by entry.
#[derive(Serialize)]
struct Results<'a, F: Iterator<Item = Value> + Clone, S: Iterator<Item = Value> + Clone> {
    schema: u32,
    experiment: &'a str,
    title: &'a str,
    file: String,
    program: Value,
    grid: Vec<Value>,
    cells: usize,
    finding: &'a str,
    best: Option<Value>,
    #[serde(serialize_with = "each")]
    failures: F,
    #[serde(serialize_with = "each")]
    summary: S,
}

fn each<S: Serializer, I: Iterator<Item = Value> + Clone>(
    entries: &I,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(entries.clone())
}

fn results<'a>(
    plan: &'a Plan,
    grid: &'a GridPlan,
    cells: &'a [Cell],
    summaries: &'a [Summary],
    (finding, best): (&'a str, Option<&Best>),
    file: String,
) -> impl Serialize + use<'a> {
    let axes = grid.axes.iter();
    let axes = axes.map(|a| json!({ "key": a.name, "path": a.key, "values": a.values }));
    let rows = cells.iter().flat_map(|cell| cell.rows.iter().map(move |row| (cell.cell, row)));
    let failures = rows
        .filter(|(_, row)| row.failed())
        .map(|(cell, row)| json!({ "cell": cell, "method": &*row.method, "reason": &*row.reason }));
    Results {
        schema: SCHEMA,
        experiment: &plan.name,
        title: &plan.title,
        file,
        program: json!({ "name": env!("CARGO_PKG_NAME"), "version": env!("CARGO_PKG_VERSION") }),
        grid: axes.collect(),
        cells: cells.len(),
        finding,
        best: best.map(best_json),
        failures,
        summary: summaries.iter().map(|s| summary::json(grid, s)),
    }
}

/// The method or setting with the smallest 2 s simulation error: geometric means over its runs, and their grade.
fn best_json(best: &Best) -> Value {
    json!({
        "name": best.name,
        "window_rms": best.error,
        "noise_floor": best.floor,
        "grade": best.grade,
        "runs": best.words(),
    })
}
