//! Which effect is missing, and how sure that is.

use super::Section;
use crate::report::block::{Block, Cell, Column, Table, Tone};
use crate::report::format;
use crate::study::{Candidate, DiagnosisStudy, Study};

/// The ranking of the candidates.
#[derive(Default)]
pub struct Diagnosis;

impl Section for Diagnosis {
    fn id(&self) -> &'static str {
        "diagnosis"
    }
    fn title(&self) -> &'static str {
        "Which effect is missing"
    }
    fn how_to_read(&self) -> &'static str {
        "Every effect of the catalogue was tried with the base parameters free again; evidence is \
         the logarithm of the odds that it is there, size and choice already paid for."
    }
    fn blocks(&self, study: &Study) -> Vec<Block> {
        let Some(d) = &study.diagnosis else { return vec![] };
        let mut blocks = vec![Block::paragraph(format!(
            "Stated false-alarm rate: {}. Left of what can be explained: {}.",
            format::percent(d.false_alarm),
            format::percent(d.unexplained_fraction)
        ))];
        if let Some(next) = &d.next_run {
            blocks.push(Block::Heading("Next run".into()));
            blocks.push(Block::paragraph(next.clone()));
        }
        blocks.push(table(d).into());
        blocks
    }
}

fn table(d: &DiagnosisStudy) -> Table {
    let mut table = Table::new(
        "Candidates, best first: alone, added to the model as given.",
        vec![
            Column::text("Effect"),
            Column::number("Probability", ""),
            Column::number("Log-evidence", ""),
            Column::text("Parameters"),
            Column::number("Window error before", "rad/s"),
            Column::number("after", "rad/s"),
            Column::text("Cannot be told from"),
            Column::text("Evidence"),
        ],
    );
    for c in &d.ranking {
        table.push(row(c, d.found.contains(&c.effect)));
    }
    table
}

fn row(c: &Candidate, found: bool) -> Vec<Cell> {
    let name = Cell::text(&c.effect);
    let parameters: Vec<String> = c
        .parameters
        .iter()
        .map(|e| {
            let value = if e.fixed {
                format::number(e.value)
            } else {
                format::estimate(e.value, e.std_error)
            };
            format!("{} = {value} {}", e.symbol, e.unit)
        })
        .collect();
    let after = if c.window_after.is_finite() {
        Cell::formatted(format::significant(c.window_after, 3), c.window_after)
    } else {
        Cell::text("–")
    };
    vec![
        if found { name.strong().tone(Tone::Notice) } else { name },
        Cell::formatted(format::significant(c.probability, 2), c.probability).bar(c.probability),
        Cell::formatted(format::significant(c.evidence, 3), c.evidence),
        Cell::text(parameters.join("; ")),
        Cell::formatted(format::significant(c.window_before, 3), c.window_before),
        after,
        Cell::text(c.indistinguishable.join(", ")),
        Cell::text(&c.words),
    ]
}
