//! Parameters with intervals, method by method.

use super::{Section, spoken};
use crate::report::block::{Block, Cell, Column, Table};
use crate::report::figure::{
    Axis, ColorMap, ErrorBar, Figure, HeatMap, Layer, Panel,
};
use crate::report::format;
use crate::report::palette::Role;
use crate::study::{MethodStudy, Study};

/// Parameter tables, intervals and correlations.
#[derive(Default)]
pub struct Parameters;

impl Section for Parameters {
    fn id(&self) -> &'static str {
        "parameters"
    }
    fn title(&self) -> &'static str {
        "Parameters"
    }
    fn how_to_read(&self) -> &'static str {
        "Values with standard errors and 95 % intervals; a parameter that the data cannot give has \
         an infinite interval, not a number."
    }
    fn blocks(&self, study: &Study) -> Vec<Block> {
        let physical: Vec<&MethodStudy> =
            study.methods.iter().filter(|m| !m.estimates.is_empty()).collect();
        let mut blocks = Vec::new();
        for method in &physical {
            blocks.push(table(study, method).into());
            if !method.notes.is_empty() {
                blocks.push(Block::list(method.notes.iter().cloned()));
            }
        }
        if let Some(figure) = intervals(study, &physical) {
            blocks.push(figure.into());
        }
        if let Some(figure) = study.reference_method().and_then(correlations) {
            blocks.push(figure.into());
        }
        for method in &study.methods {
            blocks.extend(traces(method).into_iter().map(Into::into));
        }
        blocks
    }
}

fn table(study: &Study, method: &MethodStudy) -> Table {
    let mut columns = vec![
        Column::text("Parameter"),
        Column::number("Value ± standard error", ""),
        Column::text("Unit"),
        Column::text("95 % interval"),
        Column::text("Known from this data"),
    ];
    let known_truth = !study.truth.is_empty();
    if known_truth {
        columns.push(Column::number("Truth", ""));
        columns.push(Column::number("Error", "standard errors"));
    }
    let mut table = Table::new(format!("{}: {}", method.name, method.title), columns);
    for e in &method.estimates {
        let known = match (e.fixed, e.identifiable) {
            (true, _) => "held",
            (_, true) => "yes",
            _ => "no",
        };
        let value = if e.fixed { Cell::number(e.value) } else { Cell::estimate(e.value, e.std_error) };
        let interval = if e.fixed || !e.identifiable {
            "–".to_string()
        } else {
            format!(
                "{} … {}",
                format::significant(e.interval.0, 5),
                format::significant(e.interval.1, 5)
            )
        };
        let mut row = vec![
            Cell::text(&e.symbol),
            value,
            Cell::text(&e.unit),
            Cell::text(interval),
            Cell::text(known),
        ];
        if known_truth {
            let truth = study.truth.iter().find(|(s, _)| *s == e.symbol).map(|t| t.1);
            row.push(truth.map_or(Cell::text("–"), Cell::number));
            row.push(match truth {
                Some(t) if e.identifiable && !e.fixed => {
                    let z = (e.value - t) / e.std_error;
                    Cell::formatted(format::significant(z, 2), z)
                }
                _ => Cell::text("–"),
            });
        }
        table.push(row);
    }
    table
}

/// One panel a parameter: the intervals of all methods side by side.
fn intervals(study: &Study, methods: &[&MethodStudy]) -> Option<Figure> {
    if methods.len() < 2 {
        return None;
    }
    let first = methods[0];
    let names: Vec<String> =
        methods.iter().enumerate().map(|(n, m)| format!("{} {}", n + 1, m.name)).collect();
    let mut figure = Figure::new("estimates", "Estimates of all methods with 95 % intervals")
        .with_subtitle(names.join(", "));
    for e in first.estimates.iter().filter(|e| e.identifiable && !e.fixed).take(8) {
        let mut panel = Panel::new(
            Axis::linear("method", "").with_range(0.5, methods.len() as f64 + 0.5),
            Axis::linear(e.symbol.clone(), e.unit.clone()),
        );
        let points: Vec<ErrorBar> = methods
            .iter()
            .enumerate()
            .filter_map(|(n, m)| {
                let own = m.estimates.iter().find(|x| x.symbol == e.symbol && x.identifiable)?;
                let x = (n + 1) as f64;
                Some(ErrorBar { x, y: own.value, lower: own.interval.0, upper: own.interval.1 })
            })
            .collect();
        panel = panel.with(Layer::ErrorBars { points, label: String::new(), role: Role::Model });
        if let Some((_, truth)) = study.truth.iter().find(|(s, _)| *s == e.symbol) {
            panel = panel.with(Layer::hline(*truth, "truth", Role::Highlight));
        }
        figure = figure.with_panel(panel);
    }
    (!figure.panels.is_empty()).then(|| figure.with_columns(3))
}

fn correlations(method: &MethodStudy) -> Option<Figure> {
    let keep: Vec<usize> = (0..method.estimates.len())
        .filter(|&j| method.estimates[j].identifiable && !method.estimates[j].fixed)
        .collect();
    if keep.len() < 2 || method.correlations.len() != method.estimates.len() {
        return None;
    }
    let names: Vec<String> = keep.iter().map(|&j| method.estimates[j].symbol.clone()).collect();
    let values: Vec<Vec<f64>> = keep
        .iter()
        .map(|&i| keep.iter().map(|&j| method.correlations[i][j]).collect())
        .collect();
    let text = values
        .iter()
        .map(|row| row.iter().map(|v| format::fixed(*v, 2)).collect())
        .collect();
    let heat = HeatMap {
        rows: names.clone(),
        columns: names,
        values,
        text,
        colors: ColorMap::Diverging,
        label: "correlation".into(),
        unit: String::new(),
        range: Some((-1.0, 1.0)),
    };
    let panel = Panel::new(Axis::unlabelled(), Axis::unlabelled()).with(Layer::HeatMap(heat));
    let title = format!("Correlations of the estimates ({})", method.name);
    Some(Figure::new("correlations", title).with_panel(panel))
}

/// Curves over time or work that a method left behind.
fn traces(method: &MethodStudy) -> Vec<Figure> {
    method
        .traces
        .iter()
        .enumerate()
        .filter(|(_, trace)| trace.at.len() > 1)
        .map(|(n, trace)| {
            let mut parts = trace.axis.trim_end_matches(']').split(" [");
            let (label, unit) = (parts.next().unwrap_or(""), parts.next().unwrap_or(""));
            let title = format!("{}: progress", method.name);
            let mut figure = Figure::new(format!("trace_{}_{n}", method.name), title);
            let positive = trace.values.iter().flatten().all(|v| *v > 0.0);
            for (c, name) in trace.names.iter().enumerate() {
                let points: Vec<(f64, f64)> = trace
                    .at
                    .iter()
                    .zip(&trace.values)
                    .map(|(x, row)| (*x, row.get(c).copied().unwrap_or(f64::NAN)))
                    .collect();
                let y = if positive && trace.names.len() == 1 {
                    Axis::log(spoken(name), "")
                } else {
                    Axis::linear(spoken(name), "")
                };
                let panel = Panel::new(Axis::linear(label, unit), y).with(Layer::line(
                    points,
                    "",
                    Role::Series(c),
                ));
                figure = figure.with_panel(panel);
            }
            figure
        })
        .collect()
}
