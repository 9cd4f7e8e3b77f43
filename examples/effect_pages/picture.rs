//! The picture of an effect: the residual torque against what shows it, among the first that it depends on.

use amigo_ident::compare::Dependence;
use amigo_ident::effects;
use amigo_ident::report::figure::{Axis, ColourRole, Dash, Figure, Layer, Panel, Size};
use amigo_ident::report::{ReportError, figure_to_png};

use crate::cases::Case;
use crate::work::Outcome;

const WHEELS: [(&str, ColourRole); 2] =
    [("wheel 1", ColourRole::Wheel1), ("wheel 2", ColourRole::Wheel2)];
/// Samples of a window, 2 s at 100 Hz.
const WINDOW: usize = 200;
/// Width of a picture [px].
const WIDTH: f64 = 430.0;

/// The picture as PNG.
pub(crate) fn draw(case: &Case, outcome: &Outcome) -> Result<Vec<u8>, ReportError> {
    let title = effects::find(case.id).map_or_else(String::new, |e| e.description().title);
    let height = if case.against.is_some() { 300.0 } else { 400.0 };
    let mut figure = Figure::new(case.id, title);
    figure.size = Size { width: WIDTH, height: Some(height) };
    let on = |variable| outcome.dependences.iter().find(|d| d.variable == variable);
    figure = match case.against.and_then(on) {
        Some(dependence) => figure
            .with_subtitle("Torque that the model without it misses; bands: 95 %")
            .with_panel(missing(dependence)),
        None => excerpt(figure, outcome),
    };
    figure_to_png(&figure)
}

/// Residual torque of both wheels in bins of a variable, with 95 % bands.
fn missing(dependence: &Dependence) -> Panel {
    let variable = dependence.variable;
    let mut panel = Panel::new(
        Axis::linear(variable.words(), variable.unit("N m")),
        Axis::linear("residual torque", "N m"),
    )
    .with(Layer::HLine {
        at: 0.0,
        label: String::new(),
        role: ColourRole::Ink,
        dash: Dash::Solid,
    });
    for (i, (label, role)) in WHEELS.into_iter().enumerate() {
        let known = dependence.bins.iter().filter(|bin| bin.torque[i].is_finite());
        let rows: Vec<(f64, f64, f64)> =
            known.map(|bin| (bin.at, bin.torque[i], 1.96 * bin.std_error[i])).collect();
        let points: Vec<(f64, f64)> = rows.iter().map(|row| (row.0, row.1)).collect();
        panel = panel
            .with(Layer::Band {
                x: rows.iter().map(|row| row.0).collect(),
                lower: rows.iter().map(|row| row.1 - row.2).collect(),
                upper: rows.iter().map(|row| row.1 + row.2).collect(),
                label: String::new(),
                role,
            })
            .with(Layer::line(points.clone(), label, role))
            .with(Layer::Points { points, label: String::new(), role, radius: 2.6, alpha: 1.0 });
    }
    panel
}

/// The window in which the effect helps most: the speed, and the errors without and
/// with the effect, of the wheel that shows it.
fn excerpt(figure: Figure, outcome: &Outcome) -> Figure {
    let (t, omega) = (outcome.held_out.t(), outcome.held_out.omega());
    let error =
        |i: usize, wheel: usize, k: usize| omega[k][wheel] - outcome.windows[i][k].omega[wheel];
    let gain = |&(from, wheel): &(usize, usize)| -> f64 {
        let square = |i: usize, k: usize| error(i, wheel, k).powi(2);
        (from..from + WINDOW).map(|k| square(0, k) - square(1, k)).sum()
    };
    let (from, wheel) = (0..t.len() - WINDOW)
        .step_by(WINDOW)
        .flat_map(|from| [(from, 0), (from, 1)])
        .max_by(|a, b| gain(a).total_cmp(&gain(b)))
        .unwrap_or((0, 0));
    let rows = from..from + WINDOW;
    // the mean over nine samples takes out two thirds of the noise
    let smooth = |i: usize| -> Vec<(f64, f64)> {
        let mean = |k: usize| {
            let near = k.saturating_sub(4).max(from)..(k + 5).min(from + WINDOW);
            let count = near.len() as f64;
            near.map(|n| error(i, wheel, n)).sum::<f64>() / count
        };
        rows.clone().map(|k| (t[k], mean(k))).collect()
    };
    let measured = rows.clone().map(|k| (t[k], omega[k][wheel])).collect();
    let speed = Panel::new(
        Axis::linear("time", "s"),
        Axis::linear(format!("speed of wheel {}", wheel + 1), "rad/s"),
    );
    let errors = Panel::new(Axis::linear("time", "s"), Axis::linear("error", "rad/s"));
    figure
        .with_subtitle("Measured speed, and measured minus simulated")
        .with_panel(speed.with(Layer::line(measured, "", ColourRole::Measured)))
        .with_panel(
            errors
                .with(Layer::hline(0.0, "", ColourRole::Ink))
                .with(Layer::line(smooth(0), "without the effect", ColourRole::Model))
                .with(Layer::line(smooth(1), "with it", ColourRole::NoiseFloor)),
        )
}
