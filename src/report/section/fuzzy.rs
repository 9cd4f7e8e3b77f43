//! The fuzzy systems, as in the paper's Fig. 8 to 11.

use super::Section;
use crate::report::block::Block;
use crate::report::figure::{Axis, ColorMap, Figure, HeatMap, Layer, Panel};
use crate::report::format;
use crate::report::palette::Role;
use crate::study::{FuzzyStudy, Study};

/// Membership functions, rules and output surface.
#[derive(Default)]
pub struct Fuzzy;

impl Section for Fuzzy {
    fn id(&self) -> &'static str {
        "fuzzy"
    }
    fn title(&self) -> &'static str {
        "Fuzzy systems f31 and f41"
    }
    fn how_to_read(&self) -> &'static str {
        "Rules know only the speeds they were shown: outside, the surface is that of the edge."
    }
    fn blocks(&self, study: &Study) -> Vec<Block> {
        let Some(method) = study.methods.iter().find(|m| m.fuzzy.is_some()) else {
            return vec![];
        };
        let Some(fuzzy) = &method.fuzzy else { return vec![] };
        vec![
            Block::paragraph(format!("Drawn for the method {}.", method.name)),
            memberships(fuzzy).into(),
            rules(fuzzy).into(),
            surface(fuzzy).into(),
        ]
    }
}

fn memberships(fuzzy: &FuzzyStudy) -> Figure {
    let mut figure =
        Figure::new("memberships", "Membership functions of the inputs (the paper's Fig. 8, 9)");
    for input in 0..2 {
        let mut panel = Panel::new(
            Axis::linear(format!("speed of wheel {}", input + 1), "rad/s"),
            Axis::linear("degree", ""),
        );
        for (n, curve) in fuzzy.memberships[input].iter().enumerate() {
            let points = fuzzy.grid[input].iter().copied().zip(curve.iter().copied()).collect();
            panel = panel.with(Layer::line(points, "", Role::Series(n)));
        }
        figure = figure.with_panel(panel);
    }
    figure.with_columns(2)
}

fn rules(fuzzy: &FuzzyStudy) -> Figure {
    let count = fuzzy.memberships[0].len();
    let columns = fuzzy.memberships[1].len();
    let mut figure = Figure::new("rules", "Rules: constant part of each (the paper's Fig. 10)");
    for (system, name) in [(0, "f31"), (1, "f41")] {
        let values: Vec<Vec<f64>> = (0..count)
            .map(|i| {
                (0..columns)
                    .map(|j| {
                        fuzzy.consequents[system].get(i * columns + j).copied().unwrap_or(f64::NAN)
                    })
                    .collect()
            })
            .collect();
        let text = values
            .iter()
            .map(|row| row.iter().map(|v| format::significant(*v, 2)).collect())
            .collect();
        let heat = HeatMap {
            rows: (1..=count).map(|i| format!("w1 is {i}")).collect(),
            columns: (1..=columns).map(|j| format!("w2 is {j}")).collect(),
            values,
            text,
            colors: ColorMap::Diverging,
            label: name.into(),
            unit: "rad/s²".into(),
            range: None,
        };
        figure = figure.with_panel(
            Panel::new(Axis::unlabelled(), Axis::unlabelled())
                .with_title(name)
                .with(Layer::HeatMap(heat)),
        );
    }
    figure
}

fn surface(fuzzy: &FuzzyStudy) -> Figure {
    let mut figure = Figure::new("surface", "Output of the systems (the paper's Fig. 11)")
        .with_subtitle("One curve for each of some speeds of wheel 2");
    for (system, name) in [(0, "f31"), (1, "f41")] {
        let mut panel = Panel::new(
            Axis::linear("speed of wheel 1", "rad/s"),
            Axis::linear(name, "rad/s²"),
        )
        .with_title(name);
        let columns = fuzzy.grid[1].len();
        for (n, j) in (0..columns).step_by((columns / 5).max(1)).enumerate() {
            let points = fuzzy.grid[0]
                .iter()
                .enumerate()
                .map(|(i, w)| (*w, fuzzy.surface[system][i][j]))
                .collect();
            let label = if system == 0 {
                format!("w2 = {} rad/s", format::significant(fuzzy.grid[1][j], 2))
            } else {
                String::new()
            };
            panel = panel.with(Layer::line(points, label, Role::Series(n)));
        }
        figure = figure.with_panel(panel);
    }
    figure.with_columns(2)
}
