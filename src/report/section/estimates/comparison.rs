//! Estimates of all methods beside each other.

use super::super::words;
use super::truth;
use crate::identify::Estimate;
use crate::report::figure::{Axis, BarSeries, Bars, ColourRole, Figure, Layer, Panel};
use crate::report::format;
use crate::study::{MethodStudy, Study};

/// Ratio to the median reach of the methods beyond which the interval of one does not set the range of a panel: it
/// would hide the others (judgement).
const WIDE: f64 = 5.0;

/// Deviations of the estimates from the true value, or from the reference method: one panel per parameter; empty if
/// there is nothing to compare.
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
    let name = study.methods.iter().find(|m| std::ptr::eq(*m, reference));
    let name = name.map_or_else(String::new, |m| words::method(study, m));
    let (against, title) = if study.truth.is_empty() {
        (format!("{name}, the reference"), "How far the methods disagree on each parameter")
    } else {
        ("the true value".to_owned(), "How far each method is from the true parameters")
    };
    let mut figure = Figure::new("estimates", title)
        .with_subtitle(format!("Deviation from {against}, with 95 % intervals"))
        .with_caption(format!(
            "Deviation of each estimate from {against}, in percent, or in the unit of the parameter where it may be zero; \
             whiskers are 95 % intervals and should reach zero. An interval more than {WIDE:.0} times as wide as the median \
             one is cut at the edge."
        ))
        .with_columns(2);
    figure.panels = panels;
    Some(figure)
}

fn panel(study: &Study, physical: &[&MethodStudy], reference: &Estimate) -> Option<Panel> {
    let known = truth(study, &reference.symbol);
    let centre = known.unwrap_or(reference.value);
    if !centre.is_finite() || centre == 0.0 {
        return None;
    }
    // a share of a value that may be zero has no meaning
    let (low, high) = reference.interval;
    let is_share = known.is_some() || low * high > 0.0;
    let off = |v: f64| if is_share { 100.0 * (v - centre) / centre.abs() } else { v - centre };
    let (mut categories, mut values, mut intervals, mut text) = (vec![], vec![], vec![], vec![]);
    let mut reaches: Vec<f64> = Vec::new();
    for method in physical {
        let Some(e) = method.estimates.iter().find(|e| e.symbol == reference.symbol) else {
            continue;
        };
        categories.push(words::method(study, method));
        let known = e.identifiable && !e.fixed;
        let ends = [e.value, e.interval.0, e.interval.1].map(off);
        if known {
            let finite = ends.into_iter().filter(|v| v.is_finite());
            reaches.push(finite.fold(0.0, |most, v| most.max(v.abs())));
        }
        values.push(if known { ends[0] } else { f64::NAN });
        intervals.push(if known { (ends[1], ends[2]) } else { (f64::NAN, f64::NAN) });
        text.push(match (e.fixed, e.identifiable) {
            (true, _) => "fixed".to_owned(),
            (false, false) => format::NOT_IDENTIFIABLE.to_owned(),
            _ => String::new(),
        });
    }
    let reach = reach(&reaches);
    let series = BarSeries { intervals, text, ..BarSeries::new("", ColourRole::Measured, values) };
    let bars = Bars { categories, series: vec![series], highlight: None };
    let unit = if is_share { "%".to_owned() } else { words::unit(&reference.unit) };
    let x = Axis::linear("deviation", unit).with_range(-reach, reach);
    let title = format!(
        "{}, {} {} {}",
        reference.symbol,
        if known.is_some() { "true value" } else { "reference" },
        format::number(centre),
        words::unit(&reference.unit)
    );
    let zero = Layer::vline(0.0, "", ColourRole::Ink);
    Some(Panel::new(x, Axis::unlabelled()).with_title(title).with(Layer::Bars(bars)).with(zero))
}

/// Half the range of a panel: the reach of the methods, without those far beyond the median.
fn reach(reaches: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = reaches.iter().copied().filter(|r| *r > 0.0).collect();
    sorted.sort_by(f64::total_cmp);
    // of two the smaller
    let Some(median) = sorted.get(sorted.len().saturating_sub(1) / 2) else { return 1.0 };
    let near = sorted.iter().filter(|r| **r <= WIDE * median);
    1.1 * near.fold(0.0, |most: f64, r| most.max(*r))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_method_that_is_far_off_does_not_set_the_range() {
        assert!((reach(&[2.0, 3.0, 5000.0]) - 3.3).abs() < 1e-12);
        assert!((reach(&[2.0, 8.0]) - 8.8).abs() < 1e-12);
        assert_eq!(reach(&[]), 1.0);
    }
}
