//! `index.html`: the experiments of one run side by side.

use super::error::ExperimentError;
use super::execute::Outcome;
use super::options::{Done, RunOptions};
use crate::io::write_whole;
use crate::report::block::{Block, Cell, Column, Table, Tone};
use crate::report::{PageContent, SectionContent, format, page};
use crate::study::Grade;
use crate::verdict::title;

/// Experiments with a thumbnail at most: each adds some 20 kB to the page.
const PICTURED: usize = 30;

/// Writes `index.html`, which compares the experiments of one run.
///
/// # Errors
/// If it cannot be drawn or written.
pub fn write_index(outcomes: &[Outcome], options: &RunOptions) -> Result<(), ExperimentError> {
    let columns = vec![
        Column::text("Experiment"),
        Column::text("Measured and simulated"),
        Column::text("Model"),
        Column::number("Error over floor", "×"),
        Column::number("2 s simulation error", "rad/s"),
        Column::text("Found"),
    ];
    let caption =
        "The experiments of this run; error over floor is that of the model with what was found.";
    let mut table = Table::new(caption, columns);
    for (n, outcome) in outcomes.iter().enumerate() {
        table.push(match &outcome.result {
            Ok(done) => row(outcome, done, n < PICTURED),
            Err(e) => failed(outcome, &e.to_string()),
        });
    }
    let section = SectionContent {
        id: "experiments".into(),
        title: "Experiments".into(),
        blocks: vec![Block::from(table)],
        folded: false,
    };
    let html = page(&PageContent {
        title: "Experiments".into(),
        subtitle: format!("{} experiments", outcomes.len()),
        sections: vec![section],
        versions: vec![],
        footer: format!("{} {}", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION")),
    })?;
    if options.out.is_dir() {
        write_whole(&options.out.join("index.html"), html.as_bytes())?;
    }
    Ok(())
}

fn row(outcome: &Outcome, done: &Done, pictured: bool) -> Vec<Cell> {
    let three = |v: f64| Cell::formatted(format::digits(v, 3), v);
    let picture = done.thumbnail.clone().filter(|_| pictured);
    let grade = match done.grade {
        Some(grade) => Cell::text(grade.words()).tone(tone(grade)),
        None => Cell::text(format::MISSING),
    };
    vec![
        Cell::text(&outcome.title)
            .link(format!("{}/report.html", outcome.name))
            .noted(&done.finding),
        Cell { picture, ..Cell::text("") },
        grade,
        three(done.error_completed / done.floor),
        three(done.error_completed),
        Cell::text(if done.found.is_empty() {
            format::MISSING.into()
        } else {
            done.found.iter().map(|id| title(id)).collect::<Vec<_>>().join(", ")
        }),
    ]
}

fn tone(grade: Grade) -> Tone {
    match grade {
        Grade::AtFloor | Grade::Near => Tone::Good,
        Grade::Useful => Tone::Neutral,
        Grade::Poor => Tone::Notice,
        Grade::NotUsable => Tone::Bad,
    }
}

fn failed(outcome: &Outcome, reason: &str) -> Vec<Cell> {
    let mut row = vec![Cell::text(&outcome.title).noted(reason), Cell::text("")];
    row.push(Cell::text("failed").tone(Tone::Bad));
    row.extend([f64::NAN; 2].map(Cell::number));
    row.push(Cell::text(""));
    row
}
