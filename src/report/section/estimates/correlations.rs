//! Correlations of parameters.

use super::super::words;
use crate::report::figure::{Axis, ColorMap, Figure, HeatMap, Layer, Panel, Size};
use crate::report::format;
use crate::study::{MethodStudy, Study};

/// Correlations of the estimated parameters of a method; `None` for fewer than two.
pub(super) fn figure(study: &Study, method: &MethodStudy) -> Option<Figure> {
    let count = method.estimates.len().min(method.correlations.len());
    let free: Vec<usize> = (0..count)
        .filter(|&j| method.estimates[j].identifiable && !method.estimates[j].fixed)
        .collect();
    if free.len() < 2 {
        return None;
    }
    let at = |i: usize, j: usize| method.correlations[i].get(j).copied().unwrap_or(f64::NAN);
    let pairs = free.iter().flat_map(|&i| free.iter().map(move |&j| (i, j)));
    let strongest = pairs
        .filter(|(i, j)| i < j && at(*i, *j).is_finite())
        .max_by(|a, b| at(a.0, a.1).abs().total_cmp(&at(b.0, b.1).abs()));
    let name = |j: usize| method.estimates[j].symbol.clone();
    let title = match strongest {
        Some((i, j)) => format!(
            "Strongest correlation: {} and {}, {}",
            name(i),
            name(j),
            format::fixed(at(i, j), 2)
        ),
        None => "Correlations of the estimates".to_owned(),
    };
    let names: Vec<String> = free.iter().map(|&j| name(j)).collect();
    let values: Vec<Vec<f64>> =
        free.iter().map(|&i| free.iter().map(|&j| at(i, j)).collect()).collect();
    let text =
        values.iter().map(|row| row.iter().map(|v| format::fixed(*v, 2)).collect()).collect();
    let map = HeatMap {
        rows: names.clone(),
        columns: names,
        values,
        text,
        colors: ColorMap::Diverging,
        label: "correlation".to_owned(),
        unit: String::new(),
        range: Some((-1.0, 1.0)),
    };
    let mut figure = Figure::new("correlations", title)
        .with_subtitle(format!("Estimates of {}", words::method(study, method)))
        .with_caption(
            "Correlations between the errors of the estimates. Near ±1 the data determine only a \
             combination of the two.",
        )
        .with_panel(Panel::new(Axis::unlabelled(), Axis::unlabelled()).with(Layer::HeatMap(map)));
    figure.size = Size { width: 560.0, height: None };
    Some(figure)
}
