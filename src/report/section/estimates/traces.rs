//! How estimates or costs settle, over time or over evaluations.

use super::super::words;
use super::truth;
use crate::identify::{DROP, PROFILE, Trace};
use crate::report::figure::{Axis, Dash, Figure, Layer, Panel, Role};
use crate::study::{MethodStudy, Study};

/// One figure a trace of the method.
pub(in super::super) fn figures(study: &Study, method: &MethodStudy) -> Vec<Figure> {
    let traces = method.traces.iter().filter(|trace| trace.at.len() > 1);
    traces.filter_map(|trace| figure(study, method, trace)).collect()
}

fn figure(study: &Study, method: &MethodStudy, trace: &Trace) -> Option<Figure> {
    let name = words::method(study, method);
    let (settling, over) = (Settling::of(method, trace), label(&trace.axis).0);
    let id = match settling {
        Settling::Likelihood => format!("profile-{}-{over}", method.name),
        Settling::Estimates | Settling::Cost => format!("trace-{}", method.name),
    };
    let title = format!("{} of {name} over {over}", settling.word());
    let mut figure = Figure::new(id, title).with_subtitle(&method.title);
    figure.caption = settling.caption().to_owned();
    for (curve, symbol) in trace.names.iter().enumerate() {
        let points: Vec<(f64, f64)> = trace
            .at
            .iter()
            .zip(&trace.values)
            .map(|(at, row)| (*at, row.get(curve).copied().unwrap_or(f64::NAN)))
            .collect();
        if points.iter().any(|p| p.1.is_finite()) {
            figure.panels.push(panel(study, method, trace, symbol, points));
        }
    }
    (!figure.panels.is_empty()).then(|| figure.interactive())
}

/// What settles along a trace.
#[derive(Clone, Copy)]
enum Settling {
    Estimates,
    Cost,
    /// How the likelihood falls beside the estimate.
    Likelihood,
}

impl Settling {
    fn of(method: &MethodStudy, trace: &Trace) -> Self {
        let is_estimate = |name: &String| method.estimates.iter().any(|e| e.symbol == *name);
        match &trace.names {
            names if names.iter().any(|name| name == PROFILE) => Self::Likelihood,
            names if names.iter().any(is_estimate) => Self::Estimates,
            _ => Self::Cost,
        }
    }

    fn word(self) -> &'static str {
        match self {
            Self::Estimates => "Estimates",
            Self::Cost => "Cost",
            Self::Likelihood => "Profile likelihood",
        }
    }

    fn caption(self) -> &'static str {
        match self {
            Self::Estimates => {
                "Dashed lines mark the true value where it is known, else the last one."
            }
            Self::Cost => "",
            Self::Likelihood => {
                "All other parameters follow. The values above the line are the 95 % interval."
            }
        }
    }
}

fn panel(
    study: &Study,
    method: &MethodStudy,
    trace: &Trace,
    symbol: &str,
    points: Vec<(f64, f64)>,
) -> Panel {
    let (x, x_unit) = label(&trace.axis);
    if symbol == PROFILE {
        let y = Axis::linear(PROFILE, "").with_range(-5.0, 0.2);
        let line = Layer::line(points, "", Role::Model);
        let limit = Layer::hline(-DROP, "95 %", Role::Ink);
        return Panel::new(Axis::linear(x, x_unit), y).with(limit).with(line);
    }
    let estimate = method.estimates.iter().find(|e| e.symbol == symbol);
    let (y, y_unit) = match estimate {
        Some(e) => (symbol.to_owned(), words::unit(&e.unit)),
        None => label(symbol),
    };
    let finite = || points.iter().map(|p| p.1).filter(|v| v.is_finite());
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(0.0, f64::max));
    let is_cost = estimate.is_none() && low > 0.0;
    let y =
        if is_cost && high > 30.0 * low { Axis::log(y, y_unit) } else { Axis::linear(y, y_unit) };
    let last = points.iter().rev().map(|p| p.1).find(|v| v.is_finite());
    let known = truth(study, symbol);
    // the first guesses of a recursion would hide how it settles
    let y = match estimate {
        Some(_) => settled(&points, known).map_or(y.clone(), |(a, b)| y.clone().with_range(a, b)),
        None => y,
    };
    let mut panel = Panel::new(Axis::linear(x, x_unit), y);
    if let Some(at) = known.or(last.filter(|_| estimate.is_some())) {
        let label = if known.is_some() { "true value" } else { "last value" };
        panel = panel.with(Layer::hline(at, label, Role::Ink));
    }
    let label = String::new();
    panel.with(Layer::Line { points, label, role: Role::Model, width: 1.4, dash: Dash::Solid })
}

/// The range of the later four fifths, with the true value and some room around.
fn settled(points: &[(f64, f64)], known: Option<f64>) -> Option<(f64, f64)> {
    let later = points[points.len() / 5..].iter().map(|p| p.1);
    let (low, high) = later
        .chain(known)
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    let room = 0.15 * (high - low);
    (high > low).then_some((low - room, high + room))
}

/// `time [s]` as label and unit.
fn label(text: &str) -> (String, String) {
    match text.split_once('[') {
        Some((name, unit)) => {
            (name.trim().to_owned(), words::unit(unit.trim_end_matches(']').trim()))
        }
        None => (text.to_owned(), String::new()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_is_split_into_label_and_unit() {
        assert_eq!(label("time [s]"), ("time".to_owned(), "s".to_owned()));
        assert_eq!(label("ISE [rad^2/s]"), ("ISE".to_owned(), "rad²/s".to_owned()));
        assert_eq!(label("iteration"), ("iteration".to_owned(), String::new()));
    }
}
