//! Runs cells and writes the journal.

use std::fmt;
use std::fmt::Write as _;
use std::path::Path;

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use rayon::prelude::*;

use super::cell::{Cell, run_cell};
use super::word::Words;
use crate::experiment::combinations::GridPlan;
use crate::experiment::options::RunOptions;
use crate::experiment::plan::Plan;
use crate::io::{IoError, Journal, sha256_text};

/// Kind of a journal line.
pub(super) enum Line {
    /// A completed cell that is new.
    New,
    /// A completed cell that is already known.
    Known,
    /// A cell of another version of the experiment, its recordings or the program.
    Other,
    /// An invalid line.
    Broken,
}

/// The completed cells of a grid, without the keys, which are needed only in journals.
pub(super) struct Finished {
    base: String,
    words: Words,
    cells: Vec<Cell>,
    known: Vec<bool>,
}

impl Finished {
    pub(super) fn new(plan: &Plan, grid: &GridPlan) -> Self {
        Self {
            base: base_key(plan),
            words: Words::default(),
            cells: vec![],
            known: vec![false; grid.cells()],
        }
    }

    /// Reads a line of a journal.
    pub(super) fn take(&mut self, line: &str) -> Line {
        let Ok(mut cell) = serde_json::from_str::<Cell>(line) else { return Line::Broken };
        if cell.cell >= self.known.len() || cell.key != self.key(cell.cell) {
            return Line::Other;
        }
        if std::mem::replace(&mut self.known[cell.cell], true) {
            return Line::Known;
        }
        self.lighten(&mut cell);
        self.cells.push(cell);
        Line::New
    }

    pub(super) fn has(&self, cell: usize) -> bool {
        self.known[cell]
    }

    /// Runs the requested cells that are not known, and writes them to a journal.
    ///
    /// # Errors
    /// A journal that cannot be written; failures of cells are not errors.
    fn run(
        &mut self,
        plan: &Plan,
        grid: &GridPlan,
        journal: &Journal,
        wanted: &[usize],
        shown: bool,
    ) -> Result<(), IoError> {
        let missing: Vec<usize> = wanted.iter().copied().filter(|c| !self.has(*c)).collect();
        let bar = progress(wanted.len(), wanted.len() - missing.len(), shown);
        let methods: Vec<&str> = plan.methods.iter().map(|m| m.name.as_str()).collect();
        let run = |cell: usize| -> Result<Cell, IoError> {
            let mut done = run_cell(grid, cell, self.key(cell), &methods);
            journal.append(&serde_json::to_string(&done).unwrap_or_default())?;
            self.lighten(&mut done);
            bar.inc(1);
            Ok(done)
        };
        // one at a time: cells differ in duration, and the first ones are complete after an interruption
        let cells = missing.par_iter().with_max_len(1).map(|cell| run(*cell));
        let cells = cells.collect::<Result<Vec<Cell>, IoError>>()?;
        bar.finish_and_clear();
        self.cells.extend(cells);
        Ok(())
    }

    /// The cells, sorted by number.
    pub(super) fn cells(mut self) -> Vec<Cell> {
        self.cells.sort_unstable_by_key(|cell| cell.cell);
        self.cells
    }

    fn key(&self, cell: usize) -> String {
        sha256_text(&format!("{} {cell}", self.base))
    }

    fn lighten(&self, cell: &mut Cell) {
        cell.key = String::new();
        cell.rows.shrink_to_fit();
        self.words.share(cell.rows.iter_mut().flat_map(|row| row.words()));
    }
}

/// The requested cells: those in an earlier journal are kept if requested, the others are run.
///
/// # Errors
/// A journal that cannot be written; failures of cells are not errors.
pub(super) fn run_cells(
    plan: &Plan,
    grid: &GridPlan,
    options: &RunOptions,
    path: &Path,
    wanted: &[usize],
) -> Result<Vec<Cell>, IoError> {
    // the completed cells of an interrupted run of the same experiment are kept; a complete run is repeated,
    // unless `resume` is set
    let resume = options.resume || is_interrupted(plan, grid, path, wanted)?;
    let mut finished = Finished::new(plan, grid);
    let keep = |line: &str| resume && matches!(finished.take(line), Line::New);
    let journal = Journal::start(path, keep)?;
    finished.run(plan, grid, &journal, wanted, options.progress)?;
    Ok(finished.cells())
}

/// Whether a journal contains some of the requested cells but not all.
fn is_interrupted(
    plan: &Plan,
    grid: &GridPlan,
    path: &Path,
    wanted: &[usize],
) -> Result<bool, IoError> {
    let mut earlier = Finished::new(plan, grid);
    Journal::read(path, |line| {
        earlier.take(line);
    })?;
    let known = wanted.iter().filter(|cell| earlier.has(**cell)).count();
    Ok(known > 0 && known < wanted.len())
}

/// Everything on which the results depend except the cell: program, file as run, recordings.
fn base_key(plan: &Plan) -> String {
    let mut text = format!("{} {}\n", env!("CARGO_PKG_VERSION"), plan.file);
    for measured in &plan.recordings {
        let _ = writeln!(text, "{}", measured.sha256.as_deref().unwrap_or("made"));
    }
    sha256_text(&text)
}

fn progress(cells: usize, finished: usize, shown: bool) -> ProgressBar {
    let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(cells as u64), target);
    // the rate of this run, which is unknown before its first combination
    let left = move |state: &ProgressState, out: &mut dyn fmt::Write| {
        if state.pos() > finished as u64 {
            let _ = write!(out, ", {:#} left", HumanDuration(state.eta()));
        }
    };
    let template = "{wide_bar} {pos}/{len} combinations ({elapsed}{left})";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.with_key("left", left));
    }
    bar.set_position(finished as u64);
    bar.reset_eta();
    bar
}
