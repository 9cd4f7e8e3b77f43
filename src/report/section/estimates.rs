//! The estimates of each method with their intervals.

mod comparison;
mod correlations;
mod traces;

pub(super) use traces::figures;

use super::{Depth, Section, words};
use crate::identify::Estimate;
use crate::report::block::{Block, Cell, Column, Table, Text, Tone};
use crate::report::format;
use crate::study::{MethodStudy, Study};

/// Estimates of the methods.
#[derive(Default)]
pub struct Estimates;

impl Section for Estimates {
    fn id(&self) -> &'static str {
        "estimates"
    }

    fn title(&self) -> &'static str {
        "Estimates of the methods"
    }

    fn depth(&self) -> Depth {
        Depth::Details
    }

    fn how_to_read(&self) -> &'static str {
        words::INTERVALS
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        let physical: Vec<&MethodStudy> =
            study.methods.iter().filter(|m| !m.estimates.is_empty()).collect();
        if physical.is_empty() {
            return vec![];
        }
        let mut blocks: Vec<Block> = physical.iter().map(|m| table(study, m).into()).collect();
        let beyond: Vec<Text> = physical
            .iter()
            .flat_map(|m| {
                m.estimates.iter().filter_map(move |e| Some((m, words::out_of_range(e)?)))
            })
            .map(|(m, said)| {
                Text::default().strong(words::method(study, m)).plain(format!(": {said}."))
            })
            .collect();
        if !beyond.is_empty() {
            blocks.push(Block::Heading("Physically implausible values".to_owned()));
            blocks.push(Block::List(beyond));
        }
        blocks.extend(comparison::figure(study, &physical).map(Block::from));
        let reference = study.reference_method().filter(|m| !m.estimates.is_empty());
        let shown = reference.unwrap_or(physical[0]);
        blocks.extend(correlations::figure(study, shown).map(Block::from));
        blocks.extend(physical.iter().flat_map(|m| traces::figures(study, m)).map(Block::from));
        blocks
    }
}

/// The true value of a parameter, if known.
pub(super) fn truth(study: &Study, symbol: &str) -> Option<f64> {
    study.truth.iter().find(|(known, _)| known == symbol).map(|(_, value)| *value)
}

fn table(study: &Study, method: &MethodStudy) -> Table {
    let mut columns = vec![
        Column::text("Parameter"),
        Column::text("Meaning"),
        Column::number("Estimate ± std. error", ""),
        Column::number("95 % interval", ""),
        Column::text("Unit"),
    ];
    let known = !study.truth.is_empty();
    if known {
        columns.push(Column::number("True value", ""));
        columns.push(Column::number("Error", "std. errors"));
    }
    let caption = format!("{} ({}).", method.title, words::method(study, method));
    let mut table = Table::new(caption, columns);
    for estimate in &method.estimates {
        let mut row = row(estimate);
        if known {
            row.extend(against_truth(estimate, truth(study, &estimate.symbol)));
        }
        table.push(row);
    }
    table
}

fn row(e: &Estimate) -> Vec<Cell> {
    let interval = if e.fixed {
        Cell::formatted("held fixed", f64::NAN)
    } else {
        let (low, high) = e.interval;
        let text = match (low.is_finite(), high.is_finite()) {
            (true, true) => format::interval((low, high), e.value, e.std_error),
            _ => format::NOT_IDENTIFIABLE.to_owned(),
        };
        Cell::formatted(text, high - low)
    };
    let estimate = Cell::estimate(e.value, e.std_error);
    vec![
        Cell::text(&e.symbol).strong(),
        Cell::text(words::meaning(&e.symbol)),
        if e.fixed || e.identifiable { estimate } else { estimate.tone(Tone::Bad) },
        interval,
        Cell::text(words::unit(&e.unit)),
    ]
}

/// The true value, and the deviation of the estimate from it; above three standard errors it is marked.
pub(super) fn against_truth(e: &Estimate, truth: Option<f64>) -> Vec<Cell> {
    let Some(truth) = truth else { return vec![Cell::text(""), Cell::text("")] };
    let errors = (e.value - truth) / e.std_error;
    let cell = if errors.is_finite() && e.std_error > 0.0 && e.identifiable {
        let cell = Cell::formatted(format::fixed(errors, 2), errors);
        if errors.abs() > 3.0 { cell.tone(Tone::Bad) } else { cell }
    } else {
        Cell::formatted(format::MISSING, f64::NAN)
    };
    vec![Cell::number(truth), cell]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_beyond_three_standard_errors_is_marked() {
        let e = Estimate::new("a1", String::new(), 1.0, 0.1);
        assert_eq!(against_truth(&e, Some(0.5))[1].tone, Some(Tone::Bad));
        assert_eq!(against_truth(&e, Some(0.9))[1].tone, None);
        assert_eq!(against_truth(&e, Some(0.9))[1].text, "1.00");
    }
}
