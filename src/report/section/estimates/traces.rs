//! Estimates and costs over time or evaluations, and profiles of the likelihood over a parameter.

use super::super::words;
use super::truth;
use crate::identify::{DROP, Trace, TraceAxis, TraceKind};
use crate::report::figure::{Axis, ColourRole, Dash, Figure, Layer, Panel};
use crate::study::{MethodStudy, Study};

/// A curve of a trace.
type Points = Vec<(f64, f64)>;

/// One figure a trace of the method.
pub(in super::super) fn figures(study: &Study, method: &MethodStudy) -> Vec<Figure> {
    let traces = method.traces.iter().filter(|trace| trace.at.len() > 1);
    traces.filter_map(|trace| figure(study, method, trace)).collect()
}

fn figure(study: &Study, method: &MethodStudy, trace: &Trace) -> Option<Figure> {
    let name = words::method(study, method);
    let (over, _) = label(&trace.axis);
    let (what, caption) = words_of(&trace.kind);
    let id = match trace.kind {
        TraceKind::Profile => format!("profile-{}-{over}", method.name),
        TraceKind::Estimates(_) | TraceKind::Cost => format!("trace-{}", method.name),
    };
    let title = match trace.axis {
        TraceAxis::Evaluation => format!("{what} of {name} over the evaluations"),
        _ => format!("{what} of {name} over {over}"),
    };
    let mut figure = Figure::new(id, title).with_subtitle(&method.title);
    figure.caption = caption.to_owned();
    let x = || {
        let (name, unit) = label(&trace.axis);
        Axis::linear(name, unit)
    };
    let shown = |points: &Points| points.iter().any(|p| p.1.is_finite());
    figure.panels = match &trace.kind {
        TraceKind::Estimates(symbols) => symbols
            .iter()
            .enumerate()
            .map(|(curve, symbol)| (symbol, points(trace, curve)))
            .filter(|(_, points)| shown(points))
            .map(|(symbol, points)| of_estimate(study, method, x(), symbol, points))
            .collect(),
        TraceKind::Cost => {
            Some(points(trace, 0)).filter(shown).map(|p| of_cost(x(), p)).into_iter().collect()
        }
        TraceKind::Profile => {
            Some(points(trace, 0)).filter(shown).map(|p| of_profile(x(), p)).into_iter().collect()
        }
    };
    (!figure.panels.is_empty()).then(|| figure.interactive())
}

fn points(trace: &Trace, curve: usize) -> Points {
    let value = |row: &Vec<f64>| row.get(curve).copied().unwrap_or(f64::NAN);
    trace.at.iter().zip(&trace.values).map(|(at, row)| (*at, value(row))).collect()
}

/// Title and caption of a trace.
fn words_of(kind: &TraceKind) -> (&'static str, &'static str) {
    match kind {
        TraceKind::Estimates(_) => (
            "Estimates",
            "Dashed lines mark the true value if it is known, otherwise the last one.",
        ),
        TraceKind::Cost => {
            ("Cost", "In-sample ISE of the emulator, the cost of the fit, after each evaluation.")
        }
        TraceKind::Profile => (
            "Profile likelihood",
            "All other parameters follow. The values above the line are the 95 % interval.",
        ),
    }
}

fn of_profile(x: Axis, points: Points) -> Panel {
    let y = Axis::linear("log-likelihood below its maximum", "").with_range(-5.0, 0.2);
    let limit = Layer::hline(-DROP, "95 %", ColourRole::Ink);
    Panel::new(x, y).with(limit).with(Layer::line(points, "", ColourRole::Model))
}

fn of_cost(x: Axis, points: Points) -> Panel {
    let finite = || points.iter().map(|p| p.1).filter(|v| v.is_finite());
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(0.0, f64::max));
    let (name, unit) = ("ISE", words::unit("rad^2/s"));
    let is_wide = low > 0.0 && high > 30.0 * low;
    let y = if is_wide { Axis::log(name, unit) } else { Axis::linear(name, unit) };
    Panel::new(x, y).with(line(points))
}

fn of_estimate(
    study: &Study,
    method: &MethodStudy,
    x: Axis,
    symbol: &str,
    points: Points,
) -> Panel {
    let unit = method.estimates.iter().find(|e| e.symbol == symbol).map(|e| words::unit(&e.unit));
    let known = truth(study, symbol);
    let y = Axis::linear(symbol, unit.unwrap_or_default());
    // the initial estimates of a recursion would hide its convergence
    let y = match settled(&points, known) {
        Some((low, high)) => y.with_range(low, high),
        None => y,
    };
    let last = points.iter().rev().map(|p| p.1).find(|v| v.is_finite());
    let label = if known.is_some() { "true value" } else { "last value" };
    let mark = known.or(last).map(|at| Layer::hline(at, label, ColourRole::Ink));
    mark.into_iter().fold(Panel::new(x, y), Panel::with).with(line(points))
}

fn line(points: Points) -> Layer {
    let label = String::new();
    Layer::Line { points, label, role: ColourRole::Model, width: 1.4, dash: Dash::Solid }
}

/// The range of the last four fifths, with the true value and a margin.
fn settled(points: &[(f64, f64)], known: Option<f64>) -> Option<(f64, f64)> {
    let later = points[points.len() / 5..].iter().map(|p| p.1);
    let (low, high) = later
        .chain(known)
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    let room = 0.15 * (high - low);
    (high > low).then_some((low - room, high + room))
}

/// Label and unit of an axis.
fn label(axis: &TraceAxis) -> (String, String) {
    match axis {
        TraceAxis::Time => ("time".to_owned(), "s".to_owned()),
        TraceAxis::Evaluation => ("evaluation".to_owned(), String::new()),
        TraceAxis::Parameter { symbol, unit } => (symbol.clone(), words::unit(unit)),
    }
}
