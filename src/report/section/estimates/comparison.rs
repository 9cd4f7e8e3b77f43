//! Estimates of all methods beside each other.

use super::super::words;
use super::truth;
use crate::identify::Estimate;
use crate::report::figure::{Axis, BarSeries, Bars, ColourRole, Figure, Layer, Panel};
use crate::report::format;
use crate::study::{MethodStudy, Study};

/// Deviations of the estimates from the true value, or from the reference method, in per cent: one panel per
/// parameter; empty if there is nothing to compare.
pub(super) fn figure(study: &Study, physical: &[&MethodStudy]) -> Option<Figure> {
    if study.truth.is_empty() && physical.len() < 2 {
        return None;
    }
    let reference = study.reference_method().filter(|m| !m.estimates.is_empty());
    let reference = reference.unwrap_or(physical[0]);
    let panels: Vec<Panel> = reference
        .estimates
        .iter()
        .filter(|e| !e.fixed)
        .filter_map(|e| panel(study, physical, e))
        .collect();
    if panels.is_empty() {
        return None;
    }
    let (against, title) = if study.truth.is_empty() {
        ("the reference method", "How far the methods agree on each parameter")
    } else {
        ("the true value", "How far each method is from the true parameters")
    };
    let mut figure = Figure::new("estimates", title)
        .with_subtitle(format!("Deviation from {against}, with 95 % intervals"))
        .with_caption(format!(
            "Deviation of each estimate from {against} in percent; whiskers are 95 % intervals and \
             should reach zero."
        ))
        .with_columns(2);
    figure.panels = panels;
    Some(figure)
}

fn panel(study: &Study, physical: &[&MethodStudy], reference: &Estimate) -> Option<Panel> {
    let centre = truth(study, &reference.symbol).unwrap_or(reference.value);
    if !centre.is_finite() || centre == 0.0 {
        return None;
    }
    let percent = |v: f64| 100.0 * (v - centre) / centre.abs();
    let (mut categories, mut values, mut intervals, mut text) = (vec![], vec![], vec![], vec![]);
    let mut reach: f64 = 0.0;
    for method in physical {
        let Some(e) = method.estimates.iter().find(|e| e.symbol == reference.symbol) else {
            continue;
        };
        categories.push(words::method(study, method));
        let known = e.identifiable && !e.fixed;
        if known {
            let ends = [percent(e.value), percent(e.interval.0), percent(e.interval.1)];
            reach = ends.iter().filter(|v| v.is_finite()).fold(reach, |most, v| most.max(v.abs()));
        }
        values.push(if known { percent(e.value) } else { f64::NAN });
        intervals.push(if known {
            (percent(e.interval.0), percent(e.interval.1))
        } else {
            (f64::NAN, f64::NAN)
        });
        text.push(match (e.fixed, e.identifiable) {
            (true, _) => "fixed".to_owned(),
            (false, false) => format::NOT_IDENTIFIABLE.to_owned(),
            _ => String::new(),
        });
    }
    let reach = if reach > 0.0 { 1.1 * reach } else { 1.0 };
    let series = BarSeries { intervals, text, ..BarSeries::new("", ColourRole::Measured, values) };
    let bars = Bars { categories, series: vec![series], highlight: None };
    let x = Axis::linear("deviation", "%").with_range(-reach, reach);
    let title = format!(
        "{}, {} {} {}",
        reference.symbol,
        if truth(study, &reference.symbol).is_some() { "true value" } else { "reference" },
        format::number(centre),
        words::unit(&reference.unit)
    );
    let zero = Layer::vline(0.0, "", ColourRole::Ink);
    Some(Panel::new(x, Axis::unlabelled()).with_title(title).with(Layer::Bars(bars)).with(zero))
}
