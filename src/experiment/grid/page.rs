//! The report of a grid: summary, figures, tables, provenance.

use super::cell::Cell as GridCell;
use super::figures::figures;
use super::summary::{FEWEST_COVERED, Summary, conditions, share_interval};
use super::winner::{Winner, judged_on};
use crate::experiment::combinations::GridPlan;
use crate::experiment::plan::Plan;
use crate::report::block::{Block, Cell, Column, Table, Text, Tone};
use crate::report::{PageContent, Picture, ReportError, SectionContent, format, render_page};

/// A rendered report.
pub(super) struct Rendered {
    pub(super) html: String,
    pub(super) figures: Vec<(String, Vec<u8>)>,
}

/// Renders the report of a grid.
///
/// # Errors
/// If a figure cannot be drawn.
pub(super) fn render(
    plan: &Plan,
    grid: &GridPlan,
    cells: &[GridCell],
    summaries: &[Summary],
    winner: Option<&Winner>,
) -> Result<Rendered, ReportError> {
    let section = |id: &str, title: &str, blocks: Vec<Block>| SectionContent {
        id: id.into(),
        title: title.into(),
        blocks,
        folded: id == "summary" && summaries.len() > MOST_OPEN,
    };
    let failed = cells.iter().any(GridCell::failed);
    let tone = if failed { Tone::Notice } else { Tone::Neutral };
    let headline = winner.map(|w| w.sentence(judged_on(cells)));
    let runs = verdict(grid, cells, summaries);
    let mut first = vec![match headline {
        Some(headline) => Block::verdict(tone, headline, runs),
        None => Block::verdict(tone, runs, ""),
    }];
    first.extend(caution(cells));
    first.extend(figures(grid, summaries));
    let sections = vec![
        section("accuracy", "Results of the repetitions", first),
        section(
            "summary",
            "Summary",
            vec![
                Block::HowToRead { aid: TABLE_WORDS.into(), guide: String::new() },
                table(grid, summaries),
            ],
        ),
        section("diagnosis", "Verdicts of the diagnosis", verdicts(grid, cells)),
        section("failures", "Failures", failures(grid, cells)),
        section("provenance", "Provenance", provenance(plan)),
    ];
    let content = PageContent {
        title: plan.title.clone(),
        subtitle: format!(
            "{} · {} combinations · {} {}",
            plan.name,
            cells.len(),
            env!("CARGO_PKG_NAME"),
            env!("CARGO_PKG_VERSION")
        ),
        sections: sections.into_iter().filter(|s| !s.blocks.is_empty()).collect(),
        versions: vec![],
        footer: format!("{} {}", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION")),
    };
    let page = render_page(&content)?;
    let figures = page.pictures.into_iter().flat_map(Picture::files).collect();
    Ok(Rendered { html: page.html, figures })
}

/// Caution on the errors if no recordings are held out.
fn caution(cells: &[GridCell]) -> Option<Block> {
    let on = judged_on(cells);
    let sentence = format!("The 2 s simulation errors are{on}, which the models were fitted to.");
    let detail = Text::from(
        "With enough parameters even a wrong model fits its training data. List held-out recordings under ",
    )
    .code("validation")
    .plain(" (for simulated data, their number).");
    (!on.is_empty()).then(|| Block::verdict(Tone::Notice, sentence, detail))
}

/// Largest number of rows of a table that is not collapsed, and therefore printed: two pages.
const MOST_OPEN: usize = 60;
/// Largest number of rows of a table: larger pages open too slowly.
const MOST_ROWS: usize = 1000;

const TABLE_WORDS: &str = "n estimates enter the means; failures are cells without a fit. RMSE is about \
                           the true value. Coverage near 95 % means that the standard errors are right. \
                           Efficiency is the mean variance reported by prediction_error in the same cells \
                           (a proxy of the Cramér-Rao bound; the smallest reported variance where that \
                           method does not run) over the mean square error: a value near 1 is optimal; \
                           values above 1 are due to chance or to standard errors that are too large.";

/// A coverage with its 95 % interval; for few repetitions only the interval.
fn coverage(s: &Summary) -> Cell {
    let (low, high) = s.coverage_interval();
    if !s.coverage.is_finite() {
        return Cell::formatted(format::MISSING, f64::NAN);
    }
    let interval = interval(low, high);
    match s.n {
        ..FEWEST_COVERED => Cell::formatted(interval, s.coverage),
        _ => Cell::formatted(format::percent(s.coverage), s.coverage).noted(interval),
    }
}

fn interval(low: f64, high: f64) -> String {
    let percent = |share: f64| format!("{:.0}", 100.0 * share.clamp(0.0, 1.0));
    format!("{} to {} %", percent(low), percent(high))
}

/// Number of combinations and failures and, with enough repetitions, the coverage of every method.
pub(super) fn verdict(grid: &GridPlan, cells: &[GridCell], summaries: &[Summary]) -> String {
    let failed = cells.iter().filter(|c| c.failed()).count();
    let failed = if failed == 0 { "none".into() } else { failed.to_string() };
    let mut out =
        format!("{} combinations of {}, {failed} with a failure", cells.len(), grid.words());
    let mut methods: Vec<&str> = Vec::new();
    for s in summaries.iter().filter(|s| s.coverage.is_finite() && s.n >= FEWEST_COVERED) {
        if !methods.contains(&s.method.as_str()) {
            methods.push(&s.method);
        }
    }
    for method in methods {
        let of = summaries.iter().filter(|s| s.method == method && s.coverage.is_finite());
        let (covered, n) =
            of.fold((0.0, 0.0), |(c, n), s| (c + s.coverage * s.n as f64, n + s.n as f64));
        // the parameters of one run have the same noise: runs are counted, not estimates
        let has_fit = |c: &&GridCell| c.rows.iter().any(|r| *r.method == *method && !r.failed());
        let runs = cells.iter().filter(has_fit).count();
        let (low, high) = share_interval(covered / n, runs);
        out += &format!(
            "; {method}: 95 % intervals cover the true value in {} ({}, {runs} runs)",
            format::percent(covered / n),
            interval(low, high)
        );
    }
    out + "."
}

type Count = (&'static str, fn(&Summary) -> usize);

/// Number of estimates, and of missing ones if there are any.
fn counts(summaries: &[Summary]) -> Vec<Count> {
    let missing: [Count; 2] =
        [("Failures", |s| s.failures), ("Not identifiable", |s| s.unidentifiable)];
    let occurs = |(_, of): &Count| summaries.iter().any(|s| of(s) > 0);
    let estimates: Count = ("n", |s| s.n);
    std::iter::once(estimates).chain(missing.into_iter().filter(occurs)).collect()
}

fn table(grid: &GridPlan, summaries: &[Summary]) -> Block {
    let axes = conditions(grid);
    let mut columns: Vec<Column> = axes.iter().map(|k| Column::text(&grid.axes[*k].name)).collect();
    columns.extend([Column::text("Method"), Column::text("Parameter"), Column::text("Unit")]);
    let counts = counts(summaries);
    columns.extend(counts.iter().map(|(title, _)| Column::number(*title, "")));
    columns.extend(["True value", "Bias", "RMSE", "Standard error"].map(|t| Column::number(t, "")));
    columns.extend([Column::number("Coverage", ""), Column::number("Efficiency", "")]);
    columns.extend(["2 s simulation error", "Noise floor"].map(|t| Column::number(t, "rad/s")));
    let lead = if summaries.len() > MOST_ROWS {
        format!("The first {MOST_ROWS} of {} rows; all are in summary.csv.", summaries.len())
    } else {
        "Every combination, method and parameter.".to_owned()
    };
    let caption =
        format!("{lead} Bias, RMSE and reported standard error in the unit of the parameter.");
    // a hundred repetitions determine an error to 7 %, so three digits are sufficient
    let three = |v: f64| Cell::formatted(format::digits(v, 3), v);
    // the combination, the method and the parameter
    let mut table = Table::new(caption, columns).with_heads(axes.len() + 2);
    for s in summaries.iter().take(MOST_ROWS) {
        let mut row: Vec<Cell> = axes
            .iter()
            .zip(&s.places)
            .map(|(k, p)| {
                let text = grid.axes[*k].text(*p);
                match grid.axes[*k].numbers() {
                    Some(numbers) => Cell::formatted(text, numbers[*p]),
                    None => Cell::text(text),
                }
            })
            .collect();
        row.extend(
            [s.method.clone(), s.parameter.clone(), format::unit(&s.unit).replace(' ', "\u{a0}")]
                .map(Cell::text),
        );
        row.extend(counts.iter().map(|(_, of)| Cell::count(of(s))));
        row.push(Cell::number(s.truth));
        row.extend([s.bias, s.rmse, s.std_error].map(three));
        row.push(coverage(s));
        row.extend([s.efficiency, s.window_rms, s.floor].map(three));
        table.push(row);
    }
    table.into()
}

/// Frequency of the verdicts of the diagnosis, per combination.
fn verdicts(grid: &GridPlan, cells: &[GridCell]) -> Vec<Block> {
    let axes = conditions(grid);
    let mut counts: Vec<(Vec<String>, usize)> = Vec::new();
    for cell in cells {
        let Some(verdict) = &cell.verdict else { continue };
        let places = grid.places(cell.cell);
        let mut key: Vec<String> = axes.iter().map(|k| grid.axes[*k].text(places[*k])).collect();
        key.extend([verdict.text().into(), cell.found.clone()]);
        match counts.iter_mut().find(|(k, _)| *k == key) {
            Some((_, count)) => *count += 1,
            None => counts.push((key, 1)),
        }
    }
    if counts.is_empty() {
        return vec![];
    }
    let mut columns: Vec<Column> = axes.iter().map(|k| Column::text(&grid.axes[*k].name)).collect();
    columns.extend([Column::text("Verdict"), Column::text("Found"), Column::number("Times", "")]);
    let mut table = Table::new("Verdict of the diagnosis in each combination.", columns);
    for (key, count) in counts.into_iter().take(MOST_ROWS) {
        let mut row: Vec<Cell> = key.into_iter().map(Cell::text).collect();
        row.push(Cell::count(count));
        table.push(row);
    }
    vec![table.into()]
}

fn failures(grid: &GridPlan, cells: &[GridCell]) -> Vec<Block> {
    const SHOWN: usize = 50;
    let failed: Vec<_> = cells
        .iter()
        .flat_map(|c| c.rows.iter().map(move |row| (c, row)))
        .filter(|(_, row)| row.failed())
        .collect();
    if failed.is_empty() {
        return vec![];
    }
    let columns = vec![Column::text("Combination"), Column::text("Method"), Column::text("Reason")];
    let caption = format!("{} of {} failures.", failed.len().min(SHOWN), failed.len());
    let mut table = Table::new(caption, columns);
    for (cell, row) in failed.into_iter().take(SHOWN) {
        let places = grid.places(cell.cell);
        let values =
            grid.axes.iter().zip(places).map(|(a, p)| format!("{} = {}", a.name, a.text(p)));
        let values = values.collect::<Vec<_>>().join(", ");
        table.push(
            [values, row.method.to_string(), row.reason.to_string()].map(Cell::text).to_vec(),
        );
    }
    vec![table.into()]
}

fn provenance(plan: &Plan) -> Vec<Block> {
    let file = format!("experiment {}.toml", plan.name);
    vec![
        Block::paragraph(
            Text::from(
                "Every cell is in estimates.parquet. To repeat the run, save this file next to its recordings and run ",
            )
            .code(file)
            .plain("; the numbers, but for wall times, are the same on any number of threads."),
        ),
        Block::Code(plan.file.clone()),
    ]
}
