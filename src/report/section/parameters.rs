//! The parameters of the models of the verdict, without and with the effects found.

use super::estimates::truth;
use super::{Section, words};
use crate::diagnose::INPUT_SHIFT;
use crate::identify::Estimate;
use crate::report::block::{Block, Cell, Column, Table, Tone};
use crate::report::format;
use crate::study::{ParameterStudy, Study};

/// Estimates of the last model, with their standard errors and identifiability.
#[derive(Default)]
pub struct Parameters;

/// Deviation from the true value, in standard errors, above which an estimate is marked.
const FAR: f64 = 3.0;

impl Section for Parameters {
    fn id(&self) -> &'static str {
        "parameters"
    }

    fn title(&self) -> &'static str {
        "Parameters"
    }

    fn how_to_read(&self) -> &'static str {
        words::INTERVALS
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        let Some(given) = study.given.as_ref().filter(|m| !m.parameters.is_empty()) else {
            return vec![];
        };
        let mut rows: Vec<&ParameterStudy> = given.parameters.iter().collect();
        for parameter in study.completed.iter().flat_map(|m| &m.parameters) {
            if !rows.iter().any(|r| r.estimate.symbol == parameter.estimate.symbol) {
                rows.push(parameter);
            }
        }
        let mut table = Table::new(caption(study), columns(study));
        rows.iter().for_each(|row| table.push(cells(study, row)));
        vec![table.into()]
    }
}

fn caption(study: &Study) -> String {
    let by = match (&study.diagnosis, study.reference_method()) {
        (None, Some(method)) => words::method(study, method),
        _ => "the diagnosis, by the simulation error over windows of 1 s".to_owned(),
    };
    let marked = if study.truth.is_empty() {
        ""
    } else {
        " Coloured values differ from the true value by more than three standard errors."
    };
    format!("Estimates ± standard error with 95 % intervals below, fitted by {by}.{marked}")
}

fn columns(study: &Study) -> Vec<Column> {
    let mut columns = vec![Column::text("Parameter"), Column::text("Meaning")];
    let mut model = |name: String| {
        columns.push(Column::number(format::capital(&name), ""));
    };
    model(words::given(study));
    if study.completed.is_some() {
        model(words::added(study));
    }
    if !study.truth.is_empty() {
        columns.push(Column::number("True value", ""));
    }
    columns.push(Column::text("Unit"));
    columns
}

fn cells(study: &Study, row: &ParameterStudy) -> Vec<Cell> {
    let symbol = &row.estimate.symbol;
    let known = truth(study, symbol);
    // a time of milliseconds
    let (factor, unit) = match symbol == INPUT_SHIFT {
        true => (1e3, "ms".to_owned()),
        false => (1.0, words::unit(&row.estimate.unit)),
    };
    let mut out = vec![Cell::text(symbol).strong(), Cell::text(&row.meaning)];
    for model in [&study.given, &study.completed].into_iter().flatten() {
        match model.parameter(symbol) {
            Some(p) => out.push(value(&times(&p.estimate, factor), known)),
            None => out.push(Cell::text(format::MISSING)),
        }
    }
    if !study.truth.is_empty() {
        out.push(known.map_or_else(|| Cell::text(""), Cell::number));
    }
    out.push(Cell::text(unit));
    out
}

/// An estimate in a smaller unit.
fn times(e: &Estimate, factor: f64) -> Estimate {
    let (low, high) = e.interval;
    Estimate {
        value: factor * e.value,
        std_error: factor * e.std_error,
        interval: (factor * low, factor * high),
        ..e.clone()
    }
}

/// A value with its interval below.
fn value(e: &Estimate, known: Option<f64>) -> Cell {
    if e.fixed {
        return Cell::number(e.value).noted("held");
    }
    let estimate = Cell::estimate(e.value, e.std_error);
    let (low, high) = e.interval;
    if !low.is_finite() || !high.is_finite() {
        return estimate.tone(Tone::Bad);
    }
    let far = known.is_some_and(|v| (e.value - v).abs() > FAR * e.std_error);
    let estimate = if far { estimate.tone(Tone::Bad) } else { estimate };
    estimate.noted(format::interval(e.interval, e.value, e.std_error))
}
