//! Figures of the fuzzy system: membership functions, rules, surface.

use super::super::words;
use crate::report::figure::{Axis, ColorMap, ColourRole, Figure, HeatMap, Layer, Panel};
use crate::report::format;
use crate::study::{FuzzyStudy, Study};

/// Names of the two systems in the paper.
const SYSTEMS: [&str; 2] = ["f31", "f41"];
/// Cells of a surface along each side.
const CELLS: usize = 40;

/// Figures 8 to 11 of the paper.
pub(super) fn figures(study: &Study, method: &str, system: &FuzzyStudy) -> Vec<Figure> {
    let figures = [memberships(study, system), consequents(study, system), surface(study, system)];
    figures.into_iter().flatten().map(|f| f.with_subtitle(method)).collect()
}

fn memberships(study: &Study, system: &FuzzyStudy) -> Option<Figure> {
    let mut figure = Figure::new("memberships", "Membership functions of the wheel speeds")
        .with_caption(format!(
            "Sets of the right and of the left wheel speed.{}",
            words::in_paper(study, "Fig. 8 (right wheel) and Fig. 9 (left wheel)")
        ));
    figure.shared_x = false;
    for i in 0..2 {
        let mut panel = Panel::new(
            Axis::linear(words::OMEGA[i], "rad/s"),
            Axis::linear("membership", "").with_range(0.0, 1.05),
        );
        for (n, curve) in system.memberships[i].iter().enumerate() {
            let points = system.grid[i].iter().copied().zip(curve.iter().copied()).collect();
            panel =
                panel.with(Layer::line(points, format!("set {}", n + 1), ColourRole::Series(n)));
        }
        if !panel.layers.is_empty() {
            figure.panels.push(panel);
        }
    }
    (!figure.panels.is_empty()).then_some(figure)
}

fn consequents(study: &Study, system: &FuzzyStudy) -> Option<Figure> {
    let counts = [system.memberships[0].len(), system.memberships[1].len()];
    let rules = counts[0] * counts[1];
    if rules == 0 || system.consequents.iter().any(|c| c.len() != rules) {
        return None;
    }

    let mut figure = Figure::new("rules", "Consequents of the rules")
        .with_caption(format!(
            "Constant part of each rule's output, sets of the right wheel speed upwards, of the left to \
             the right ({rules} rules). Input in {}.{}",
            study.drive_unit.symbol(),
            words::in_paper(study, "Fig. 10")
        ))
        .with_columns(2);
    for (name, consequents) in SYSTEMS.into_iter().zip(&system.consequents) {
        // the sets of wheel 1 rise upwards, as in the surface
        let values: Vec<Vec<f64>> =
            consequents.chunks(counts[1]).rev().map(<[f64]>::to_vec).collect();
        let text = values
            .iter()
            .map(|row| row.iter().map(|v| format::fixed(*v, usize::from(v.abs() < 9.95))).collect())
            .collect();
        let map = HeatMap {
            rows: (1..=counts[0]).rev().map(|n| n.to_string()).collect(),
            columns: (1..=counts[1]).map(|n| n.to_string()).collect(),
            values,
            text,
            colors: ColorMap::Diverging,
            label: "output".to_owned(),
            unit: "rad/s²".to_owned(),
            range: None,
        };
        let axis = |i: usize| Axis::linear(format!("set of {}", words::OMEGA[i]), "");
        figure.panels.push(Panel::new(axis(1), axis(0)).with_title(name).with(Layer::HeatMap(map)));
    }
    Some(figure)
}

fn surface(study: &Study, system: &FuzzyStudy) -> Option<Figure> {
    let every = |length: usize| length.div_ceil(CELLS).max(1);
    let steps = [every(system.grid[0].len()), every(system.grid[1].len())];
    let names = |i: usize| -> Vec<String> {
        system.grid[i].iter().step_by(steps[i]).map(|v| format::fixed(*v, 1)).collect()
    };
    let mut figure = Figure::new("surface", "Output surface of the fuzzy systems")
        .with_caption(format!(
            "Output of f31 and f41 over both wheel speeds: the part of the acceleration that does \
             not come from the input.{}",
            words::in_paper(study, "Fig. 11")
        ))
        .with_columns(2);
    for (name, surface) in SYSTEMS.into_iter().zip(&system.surface) {
        if surface.is_empty() {
            continue;
        }
        // the speed of wheel 1 grows upwards
        let thin = |row: &Vec<f64>| row.iter().copied().step_by(steps[1]).collect();
        let values: Vec<Vec<f64>> = surface.iter().step_by(steps[0]).rev().map(thin).collect();
        let map = HeatMap {
            rows: names(0).into_iter().rev().collect(),
            columns: names(1),
            values,
            text: vec![],
            colors: ColorMap::Diverging,
            label: "output".to_owned(),
            unit: "rad/s²".to_owned(),
            range: None,
        };
        let panel = Panel::new(
            Axis::linear(words::OMEGA[1], "rad/s"),
            Axis::linear(words::OMEGA[0], "rad/s"),
        );
        figure.panels.push(panel.with_title(name).with(Layer::HeatMap(map)));
    }
    figure.size.height = Some(460.0);
    (!figure.panels.is_empty()).then_some(figure)
}
