//! RMSE and coverage over the first numeric key, one curve per method.

use super::curves::{Curves, MOST_SERIES};
use super::summary::{FEWEST_COVERED, Summary, conditions};
use crate::experiment::combinations::GridPlan;
use crate::math::distribution::{NORMAL_95, chi2_quantile};
use crate::report::block::Block;
use crate::report::figure::{Axis, ColourRole, Dash, Figure, Layer, Panel};
use crate::report::format;

/// A point of a curve: position, value, lower and upper end of its 95 % interval.
type Point = (f64, f64, Option<(f64, f64)>);

/// The 95 % interval of a quantity of the summary.
type Interval = fn(&Summary) -> (f64, f64);

/// A quantity of a summary that is plotted.
struct Quantity {
    id: &'static str,
    title: &'static str,
    how_to_read: &'static str,
    /// What is drawn, in a sentence.
    caption: &'static str,
    value: fn(&Summary) -> f64,
    /// 95 % interval of the value, if it is plotted.
    interval: Option<Interval>,
    axis: fn(&str) -> Axis,
    /// Target: value, label, and its range by chance.
    target: Option<Target>,
    /// Smallest number of repetitions for which it is plotted.
    fewest: usize,
}

struct Target {
    at: f64,
    label: &'static str,
    chance: fn(usize) -> (f64, f64),
}

const QUANTITIES: [Quantity; 3] = [
    Quantity {
        id: "grid_rmse",
        title: "Error of the estimates",
        how_to_read: "Each curve is the root mean square difference between estimate and true value \
                      over the repetitions, the band its 95 % interval. Lower is better; where \
                      bands overlap, the methods are not distinguishable.",
        caption: "Root mean square difference between estimate and true value; bands are 95 % intervals.",
        value: |s| s.rmse,
        interval: Some(Summary::rmse_interval),
        axis: |unit| Axis::log("RMSE", unit),
        fewest: 0,
        target: None,
    },
    Quantity {
        id: "grid_efficiency",
        title: "Efficiency of the estimates",
        how_to_read: "Cramér-Rao bound (variance reported by prediction_error) divided by the mean squared \
                      error. A method at 1 is efficient; at 0.25 it needs four times the data. The grey \
                      band contains 95 % of the values of an efficient method.",
        caption: "Smallest possible variance divided by the mean squared error; 1 is optimal for an unbiased estimator.",
        value: |s| s.efficiency,
        interval: None,
        axis: |_| Axis::log("bound / mean squared error", ""),
        fewest: 0,
        target: Some(Target { at: 1.0, label: "efficient", chance: efficiency_by_chance }),
    },
    Quantity {
        id: "grid_coverage",
        title: "Coverage of the 95 % intervals",
        how_to_read: "The share of repetitions whose interval covers the true value. Near 95 % the \
                      standard errors are right; below, they are too small. The grey band holds \
                      95 % of the values that right intervals show by chance.",
        caption: "Share of the repetitions whose 95 % interval covers the true value.",
        value: |s| 100.0 * s.coverage,
        interval: None,
        axis: |_| Axis::linear("coverage", "%"),
        fewest: FEWEST_COVERED,
        target: Some(Target { at: 95.0, label: "nominal", chance: coverage_by_chance }),
    },
];

/// 95 % interval of the reciprocal of chi-square(n)/n.
fn efficiency_by_chance(n: usize) -> (f64, f64) {
    let n = n as f64;
    (n / chi2_quantile(0.975, n), n / chi2_quantile(0.025, n))
}

/// 95 % interval of the share of successes in n draws with probability 0.95 [%].
fn coverage_by_chance(n: usize) -> (f64, f64) {
    let reach = NORMAL_95 * (0.95 * 0.05 / n as f64).sqrt();
    (100.0 * (0.95 - reach), 100.0 * (0.95 + reach).min(1.0))
}

/// The figures of a grid over its first key with at least two numbers, otherwise the first with at least two
/// values, which are then numbered from 1; empty without such a key.
pub(super) fn figures(grid: &GridPlan, summaries: &[Summary]) -> Vec<Block> {
    let axes = conditions(grid);
    let several = |k: &usize| grid.axes[*k].values.len() > 1;
    let numeric = axes.iter().position(|k| several(k) && grid.axes[*k].scale().is_some());
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
    let repetitions = summaries.iter().map(|s| s.n).max().unwrap_or(0);
    let known = QUANTITIES.iter().filter(|q| repetitions >= q.fewest);
    known.map(|q| figure(grid, summaries, along, &parameters, q).into()).collect()
}

fn figure(
    grid: &GridPlan,
    summaries: &[Summary],
    along: usize,
    parameters: &[(&str, &str)],
    quantity: &Quantity,
) -> Figure {
    let axis = &grid.axes[conditions(grid)[along]];
    let numbered = || {
        let count = (1..=axis.values.len()).map(|n| n as f64).collect();
        (count, format!("{}, value no.", axis.name), "")
    };
    let (numbers, label, unit) = axis.scale().unwrap_or_else(numbered);
    let (least, most) =
        numbers.iter().fold((f64::INFINITY, 0.0_f64), |(l, m), x| (l.min(*x), m.max(*x)));
    let wide = axis.scale().is_some() && least > 0.0 && most >= 4.0 * least;
    // room for the first and the last dot
    let log = || Axis::log(&label, unit).with_range(least / 1.15, 1.15 * most);
    let x = || if wide { log() } else { Axis::linear(&label, unit) };
    let curves = Curves::new(grid, summaries, along);
    let names = &curves.names;
    let mut out = Figure::new(quantity.id, quantity.title)
        .with_subtitle(format!("{} combinations: {}", grid.cells(), grid.words()))
        .with_how_to_read(quantity.how_to_read)
        .with_caption(format!("{}{}", quantity.caption, curves.words(grid)))
        .with_columns(columns(parameters.len()));
    let repetitions = summaries.iter().map(|s| s.n).max().unwrap_or(0);
    for (parameter, unit) in parameters {
        let mut panel =
            Panel::new(x(), (quantity.axis)(&format::unit(unit))).with_title(*parameter);
        if let Some(target) = quantity.target.as_ref().filter(|_| repetitions > 0) {
            panel = panel.with(chance(&numbers, (target.chance)(repetitions)));
        }
        for (n, name) in names.iter().take(MOST_SERIES).enumerate() {
            let of = |s: &&Summary| s.parameter == *parameter && curves.has(grid, s, name);
            let x = |s: &Summary| numbers[s.places[along]];
            panel = with_curve(panel, &points(summaries.iter().filter(of), quantity, x), name, n);
        }
        if let Some(target) = &quantity.target {
            panel = panel.with(Layer::hline(target.at, target.label, ColourRole::Ink));
        }
        out = out.with_panel(panel);
    }
    out
}

/// The points of a curve in the order of x, of summaries with enough repetitions.
fn points<'a>(
    summaries: impl Iterator<Item = &'a Summary>,
    quantity: &Quantity,
    x: impl Fn(&Summary) -> f64,
) -> Vec<Point> {
    let mut points: Vec<Point> = summaries
        .filter(|s| s.n >= quantity.fewest)
        .map(|s| (x(s), (quantity.value)(s), quantity.interval.map(|of| of(s))))
        .filter(|p| p.1.is_finite())
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

/// Number of columns for this number of panels.
fn columns(panels: usize) -> usize {
    match panels {
        0 | 1 => 1,
        2..=4 => 2,
        _ => 3,
    }
}

/// Range by chance, over the width of the axis.
fn chance(x: &[f64], (low, high): (f64, f64)) -> Layer {
    let mut x = x.to_vec();
    x.sort_by(f64::total_cmp);
    let (lower, upper) = (vec![low; x.len()], vec![high; x.len()]);
    Layer::Band { x, lower, upper, label: "by chance (95 %)".into(), role: ColourRole::NoiseFloor }
}

/// Adds the n-th curve: its colour, and its dashes for colour-blind readers.
fn with_curve(mut panel: Panel, points: &[Point], name: &str, n: usize) -> Panel {
    let role = ColourRole::Series(n);
    let dash = [Dash::Solid, Dash::Dashed, Dash::Dotted][n % 3];
    let edges: Option<Vec<(f64, f64)>> = points.iter().map(|p| p.2).collect();
    if let Some(edges) = edges {
        panel = panel.with(Layer::Band {
            x: points.iter().map(|p| p.0).collect(),
            lower: edges.iter().map(|e| e.0).collect(),
            upper: edges.iter().map(|e| e.1).collect(),
            label: String::new(),
            role,
        });
    }
    let centres: Vec<(f64, f64)> = points.iter().map(|p| (p.0, p.1)).collect();
    let dots = Layer::Points {
        points: centres.clone(),
        label: String::new(),
        role,
        radius: 3.0,
        alpha: 1.0,
    };
    let label = name.to_owned();
    panel.with(Layer::Line { points: centres, label, role, width: 1.8, dash }).with(dots)
}
