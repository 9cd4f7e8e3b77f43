//! `index.html`: overview of the experiments of a folder.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use super::error::ExperimentError;
use super::execute::Outcome;
use super::options::THUMBNAIL;
use crate::io::{ResultFolder, exists, file_names, write_whole};
use crate::report::block::{Block, Cell, Column, Table, Tone};
use crate::report::title;
use crate::report::{PageContent, SectionContent, format, page};
use crate::study::Grade;

/// Largest number of experiments with a thumbnail: each adds about 20 kB to the page.
const PICTURED: usize = 30;

/// Entry of an experiment in the index, as in its `results.json`.
#[derive(Deserialize)]
struct Listed {
    title: String,
    #[serde(default)]
    finding: String,
    grade: Option<Grade>,
    model_as_given: Option<Errors>,
    model_completed: Option<Errors>,
    diagnosis: Option<Found>,
    /// For a grid: the method or setting with the smallest error.
    best: Option<Best>,
}

#[derive(Clone, Copy, Deserialize)]
struct Errors {
    window_rms: Option<f64>,
    noise_floor: Option<f64>,
}

#[derive(Deserialize)]
struct Found {
    found: Vec<String>,
}

#[derive(Deserialize)]
struct Best {
    grade: Option<Grade>,
    /// Number of runs, and their kind.
    runs: String,
    #[serde(flatten)]
    errors: Errors,
}

/// Writes `index.html` into a folder of results, which compares the last runs of all experiments there. Those of
/// `outcomes` that failed are named with the reason. A single experiment has no index, unless there was one.
///
/// # Errors
/// If it cannot be drawn or written.
pub fn write_index(outcomes: &[Outcome], out: &Path) -> Result<(), ExperimentError> {
    let rows = rows(outcomes, out);
    let path = out.join("index.html");
    if !out.is_dir() || rows.len() < 2 && !exists(&path) {
        return Ok(());
    }
    let count = rows.len();
    let section = SectionContent {
        id: "experiments".into(),
        title: "Experiments".into(),
        blocks: vec![Block::from(table(rows))],
        folded: false,
    };
    let html = page(&PageContent {
        title: "Experiments".into(),
        subtitle: if count == 1 { "1 experiment".into() } else { format!("{count} experiments") },
        sections: vec![section],
        versions: vec![],
        footer: format!("{} {}", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION")),
    })?;
    Ok(write_whole(&path, html.as_bytes())?)
}

fn table(rows: impl IntoIterator<Item = Vec<Cell>>) -> Table {
    let columns = vec![
        Column::text("Experiment"),
        Column::text("Overview"),
        Column::text("Model"),
        Column::number("Error over floor", ""),
        Column::number("2 s simulation error", "rad/s"),
        Column::text("Found"),
    ];
    let caption = "The last run of each experiment in this folder. Error over floor is that of the model with the effects found; for a grid that of the best method or setting. Overview: measured and simulated speed; for a grid the error over floor of every run.";
    let mut table = Table::new(caption, columns);
    rows.into_iter().for_each(|row| table.push(row));
    table
}

/// The rows by name of the result folder.
fn rows(outcomes: &[Outcome], out: &Path) -> Vec<Vec<Cell>> {
    let mut listed: BTreeMap<String, Result<Listed, String>> = BTreeMap::new();
    for name in file_names(out) {
        let results = ResultFolder::new(out, &name).earlier("results.json");
        let results = results.and_then(|text| serde_json::from_str(&text).ok());
        listed.extend(results.map(|results| (name, Ok(results))));
    }
    for outcome in outcomes {
        if let Err(e) = &outcome.result {
            listed.insert(outcome.name.clone(), Err(e.to_string()));
        }
    }
    let title = |name: &str| outcomes.iter().find(|o| o.name == name).map(|o| o.title.clone());
    let row = |(n, (name, results)): (usize, (String, Result<Listed, String>))| match results {
        Ok(results) => row(&name, &results, out, n < PICTURED),
        Err(reason) => failed(&title(&name).unwrap_or_default(), &reason),
    };
    listed.into_iter().enumerate().map(row).collect()
}

fn row(name: &str, results: &Listed, out: &Path, pictured: bool) -> Vec<Cell> {
    let three = |v: f64| Cell::formatted(format::digits(v, 3), v);
    let picture = || ResultFolder::new(out, name).earlier_bytes(THUMBNAIL);
    let (grade, errors, runs) = match &results.best {
        Some(best) => (best.grade, Some(best.errors), best.runs.as_str()),
        None => (results.grade, results.model_completed.or(results.model_as_given), ""),
    };
    let grade = match grade {
        Some(grade) => Cell::text(grade.words()).tone(tone(grade)).noted(runs),
        None => Cell::text(format::MISSING).noted(runs),
    };
    let number = |of: fn(&Errors) -> Option<f64>| errors.as_ref().and_then(of).unwrap_or(f64::NAN);
    let (error, floor) = (number(|e| e.window_rms), number(|e| e.noise_floor));
    let found = results.diagnosis.as_ref().map_or(&[][..], |d| &d.found);
    let found: Vec<String> = found.iter().map(|id| title(id)).collect();
    vec![
        Cell::text(&results.title).link(format!("{name}/report.html")).noted(&results.finding),
        overview(pictured.then(picture).flatten(), results.best.is_some()),
        grade,
        three(error / floor),
        three(error),
        Cell::text(if found.is_empty() { format::MISSING.into() } else { found.join(", ") }),
    ]
}

fn overview(picture: Option<Vec<u8>>, is_grid: bool) -> Cell {
    let shows =
        if is_grid { "Error over floor of every run" } else { "Measured and simulated speed" };
    let text = picture.as_ref().map_or("", |_| shows);
    Cell { picture, ..Cell::text(text) }
}

fn tone(grade: Grade) -> Tone {
    match grade {
        Grade::AtFloor | Grade::Near => Tone::Good,
        Grade::Useful => Tone::Neutral,
        Grade::Poor => Tone::Notice,
        Grade::NotUsable => Tone::Bad,
    }
}

fn failed(title: &str, reason: &str) -> Vec<Cell> {
    let mut row = vec![Cell::text(title).noted(reason), Cell::text("")];
    row.push(Cell::text("failed").tone(Tone::Bad));
    row.extend([f64::NAN; 2].map(Cell::number));
    row.push(Cell::text(""));
    row
}
