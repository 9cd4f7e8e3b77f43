//! RMSE and coverage against the first key of numbers, a curve per method.

use super::GridPlan;
use super::summary::{Summary, conditions};
use crate::report::block::Block;
use crate::report::figure::{Axis, Figure, Layer, Panel, Role};

/// Curves of one figure at most: as many as there are colours.
const MOST_SERIES: usize = 7;

/// A point of a curve: place, value, lower and upper edge of its 95 % interval.
type Point = (f64, f64, f64, f64);

/// What a figure shows of a summary.
struct Quantity {
    id: &'static str,
    title: &'static str,
    how_to_read: &'static str,
    point: fn(&Summary) -> (f64, (f64, f64)),
    axis: fn(&str) -> Axis,
    line: Option<(f64, &'static str)>,
}

const QUANTITIES: [Quantity; 2] = [
    Quantity {
        id: "grid_rmse",
        title: "Error of the estimates",
        how_to_read: "Each curve is the root mean square difference between estimate and truth \
                      over the repetitions, the band its 95 % interval. Lower is better; where \
                      bands overlap, the repetitions do not tell the methods apart.",
        point: |s| (s.rmse, s.rmse_interval()),
        axis: |unit| Axis::log("RMSE", unit),
        line: None,
    },
    Quantity {
        id: "grid_coverage",
        title: "Coverage of the 95 % intervals",
        how_to_read: "The share of repetitions whose interval holds the truth, with its own 95 % \
                      interval as a band. Near 95 % the claimed errors are honest; below, they \
                      are too small.",
        point: |s| {
            (100.0 * s.coverage, {
                let (low, high) = s.coverage_interval();
                (100.0 * low, 100.0 * high)
            })
        },
        axis: |_| Axis::linear("coverage", "%").with_range(0.0, 100.0),
        line: Some((95.0, "nominal")),
    },
];

/// The figures of a grid along its first key of at least two numbers, or else the first of at least
/// two values, which are then numbered from 1; none without such a key.
pub(super) fn figures(grid: &GridPlan, summaries: &[Summary]) -> Vec<Block> {
    let axes = conditions(grid);
    let several = |k: &usize| grid.axes[*k].values.len() > 1;
    let numeric = axes.iter().position(|k| several(k) && grid.axes[*k].numbers().is_some());
    let Some(along) = numeric.or_else(|| axes.iter().position(several)) else { return vec![] };
    let mut parameters: Vec<(&str, &str)> = Vec::new();
    for s in summaries.iter().filter(|s| !s.parameter.is_empty() && s.rmse.is_finite()) {
        if !parameters.iter().any(|(p, _)| *p == s.parameter) {
            parameters.push((&s.parameter, &s.unit));
        }
    }
    if parameters.is_empty() {
        return vec![];
    }
    QUANTITIES.iter().map(|q| figure(grid, summaries, along, &parameters, q).into()).collect()
}

fn figure(
    grid: &GridPlan,
    summaries: &[Summary],
    along: usize,
    parameters: &[(&str, &str)],
    quantity: &Quantity,
) -> Figure {
    let axis = &grid.axes[conditions(grid)[along]];
    let count = || (1..=axis.values.len()).map(|n| n as f64).collect();
    let numbered = axis.numbers().is_none();
    let numbers: Vec<f64> = axis.numbers().unwrap_or_else(count);
    let label = if numbered { format!("{}, value no.", axis.name) } else { axis.name.clone() };
    let positive = numbers.iter().all(|x| *x > 0.0);
    let wide = numbers.iter().copied().fold(0.0, f64::max)
        >= 4.0 * numbers.iter().copied().fold(f64::INFINITY, f64::min);
    let x = || {
        if positive && wide && !numbered { Axis::log(&label, "") } else { Axis::linear(&label, "") }
    };
    let names = series_names(grid, summaries, along);
    let mut out = Figure::new(quantity.id, quantity.title)
        .with_subtitle(format!("{} combinations: {}", grid.cells(), grid.words()))
        .with_how_to_read(quantity.how_to_read)
        .with_columns(if parameters.len() > 1 { 2 } else { 1 });
    if names.len() > MOST_SERIES {
        let shown =
            format!("The first {MOST_SERIES} of {} curves; all are in summary.csv.", names.len());
        out = out.with_caption(shown);
    }
    for (parameter, unit) in parameters {
        let mut panel = Panel::new(x(), (quantity.axis)(unit)).with_title(*parameter);
        for (n, name) in names.iter().take(MOST_SERIES).enumerate() {
            let of =
                |s: &&Summary| s.parameter == *parameter && series_name(grid, s, along) == *name;
            let mut points: Vec<Point> = summaries
                .iter()
                .filter(of)
                .map(|s| {
                    let (y, (low, high)) = (quantity.point)(s);
                    (numbers[s.places[along]], y, low, high)
                })
                .filter(|p| p.1.is_finite())
                .collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            panel = with_curve(panel, &points, name, Role::Series(n));
        }
        if let Some((at, label)) = quantity.line {
            panel = panel.with(Layer::hline(at, label, Role::Ink));
        }
        out = out.with_panel(panel);
    }
    out
}

fn with_curve(panel: Panel, points: &[Point], name: &str, role: Role) -> Panel {
    let band = Layer::Band {
        x: points.iter().map(|p| p.0).collect(),
        lower: points.iter().map(|p| p.2).collect(),
        upper: points.iter().map(|p| p.3).collect(),
        label: String::new(),
        role,
    };
    let centres: Vec<(f64, f64)> = points.iter().map(|p| (p.0, p.1)).collect();
    let dots = Layer::Points {
        points: centres.clone(),
        label: String::new(),
        role,
        radius: 3.0,
        alpha: 1.0,
    };
    panel.with(band).with(Layer::line(centres, name, role)).with(dots)
}

/// The method, and the other conditions where there are any.
fn series_name(grid: &GridPlan, s: &Summary, along: usize) -> String {
    let axes = conditions(grid).into_iter().zip(&s.places).enumerate();
    let others: Vec<String> = axes
        .filter(|(j, (k, _))| *j != along && grid.axes[*k].values.len() > 1)
        .map(|(_, (k, p))| format!("{} = {}", grid.axes[k].name, grid.axes[k].text(*p)))
        .collect();
    if others.is_empty() {
        s.method.clone()
    } else {
        format!("{}, {}", s.method, others.join(", "))
    }
}

fn series_names(grid: &GridPlan, summaries: &[Summary], along: usize) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for s in summaries.iter().filter(|s| !s.parameter.is_empty()) {
        let name = series_name(grid, s, along);
        if !out.contains(&name) {
            out.push(name);
        }
    }
    out
}
