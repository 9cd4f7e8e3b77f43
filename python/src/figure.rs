//! The overlay as a figure.

use amigo_ident::experiment::Overlay;
use amigo_ident::report::figure::{Axis, ColourRole, Dash, Figure, Layer, Panel};

/// Measured wheel speeds, and those of 2 s simulations of the model, without and with what was found.
pub(crate) fn figure(overlay: &Overlay) -> Figure {
    let column = |name: &str| overlay.columns.iter().find(|(n, _)| n == name).map(|(_, v)| v);
    let Some(t) = column("t_s") else { return Figure::new("overlay", "No samples") };
    let line = |values: &Vec<f64>, label: &str, role: ColourRole, dash: Dash| Layer::Line {
        points: t.iter().copied().zip(values.iter().copied()).collect(),
        label: label.to_owned(),
        role,
        width: 1.4,
        dash,
    };
    let mut figure = Figure::new("overlay", "Measured and simulated wheel speeds")
        .with_subtitle(&overlay.recording)
        .with_caption("Simulations start anew every 2 s from the measured motion.");
    for (i, name) in [(1, "ω₁ (right)"), (2, "ω₂ (left)")] {
        let mut panel = Panel::new(Axis::linear("time", "s"), Axis::linear(name, "rad/s"));
        if let Some(measured) = column(&format!("dalpha{i}_rad_s")) {
            panel = panel.with(line(measured, "measured", ColourRole::Measured, Dash::Solid));
        }
        if let Some(model) = column(&format!("dalpha{i}_simulated_2s_rad_s")) {
            panel = panel.with(line(model, "model", ColourRole::Model, Dash::Solid));
        }
        if let Some(found) = column(&format!("dalpha{i}_simulated_2s_with_effects_rad_s")) {
            panel =
                panel.with(line(found, "with the effects found", ColourRole::Ink, Dash::Dashed));
        }
        figure = figure.with_panel(panel);
    }
    figure
}
