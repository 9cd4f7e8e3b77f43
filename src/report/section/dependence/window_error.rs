//! The plain error against what the robot does.

use super::super::{curves, words};
use crate::report::figure::{Axis, Dash, ErrorBar, Figure, Layer, Panel, Role};
use crate::study::{RecordingStudy, Study};

/// Dots drawn a wheel.
const DOTS: usize = 1500;
/// Bins of each variable.
const BINS: usize = 16;

/// A variable of the motion.
struct Against {
    axis: Axis,
    /// Value at every sample, for each wheel.
    values: Box<dyn Fn(usize, usize) -> f64>,
}

/// The window error of the reference method on the recording shown, against speed, turn rate,
/// acceleration, heading and time.
pub(super) fn figure(study: &Study) -> Option<Figure> {
    let method = study.reference_method()?;
    let (recording, performance) = curves::shown_performance(study, method)?;
    let count = performance.windows.len().min(recording.omega.len()).min(recording.t.len());
    if count < 2 * BINS {
        return None;
    }
    let error: [Vec<f64>; 2] = [0, 1].map(|i| {
        curves::residual(recording, &performance.windows, i).into_iter().map(|p| p.1).collect()
    });
    let mut figure = Figure::new("window-error", "Window error against what the robot does")
        .with_subtitle(format!("{}, fit by {}", recording.file, words::method(study, method)))
        .with_caption(
            "Measured minus simulated wheel speed over windows of 2 s: dots are samples, lines join \
             the means of bins of equal counts. The error grows within each window, and neighbouring \
             samples err alike, so judge significance by the missing moment, not by this figure.",
        )
        .with_columns(2);
    for against in variables(recording) {
        let points = |i: usize| -> Vec<(f64, f64)> {
            (0..count).map(|k| ((against.values)(k, i), error[i][k])).collect()
        };
        figure.panels.push(panel(against.axis.clone(), [points(0), points(1)]));
    }
    Some(figure)
}

fn panel(mut x: Axis, points: [Vec<(f64, f64)>; 2]) -> Panel {
    x.range = curves::most_of(&points.concat());
    let mut panel = Panel::new(x, Axis::linear("window error", "rad/s"));
    for (i, role) in [Role::Wheel1, Role::Wheel2].into_iter().enumerate() {
        panel = panel.with(Layer::Points {
            points: curves::thin(&points[i], DOTS),
            label: String::new(),
            role,
            radius: 1.1,
            alpha: 0.22,
        });
    }
    for (i, role) in [Role::Wheel1, Role::Wheel2].into_iter().enumerate() {
        let bins = curves::binned(&points[i], BINS);
        let line = bins.iter().map(|(x, y, _)| (*x, *y)).collect();
        let whiskers = bins.iter().map(|(x, y, e)| ErrorBar {
            x: *x,
            y: *y,
            lower: y - 1.96 * e,
            upper: y + 1.96 * e,
        });
        let label = words::WHEELS[i].to_owned();
        panel = panel
            .with(Layer::Line { points: line, label, role, width: 2.2, dash: Dash::Solid })
            .with(Layer::ErrorBars { points: whiskers.collect(), label: String::new(), role });
    }
    let dash = Dash::Solid;
    panel.with(Layer::HLine { at: 0.0, label: String::new(), role: Role::Ink, dash })
}

fn variables(recording: &RecordingStudy) -> Vec<Against> {
    let omega = recording.omega.clone();
    let acceleration = recording.acceleration.clone();
    let t = recording.t.clone();
    let heading: Vec<f64> =
        recording.path.iter().map(|p| p[2].rem_euclid(std::f64::consts::TAU)).collect();
    let at = |rows: Vec<f64>| -> Box<dyn Fn(usize, usize) -> f64> {
        Box::new(move |k, _| rows.get(k).copied().unwrap_or(f64::NAN))
    };
    let mut variables = vec![Against {
        axis: Axis::linear("speed of the wheel", "rad/s"),
        values: Box::new(move |k, i| omega[k][i]),
    }];
    if let Some(turn) = turning(recording) {
        let rates = recording.omega.iter().map(|w| turn * (w[0] - w[1])).collect();
        variables.push(Against { axis: Axis::linear("turn rate", "rad/s"), values: at(rates) });
    }
    variables.push(Against {
        axis: Axis::linear("acceleration of the wheel", "rad/s²"),
        values: Box::new(move |k, i| acceleration.get(k).map_or(f64::NAN, |a| a[i])),
    });
    variables.push(Against { axis: Axis::linear("heading", "rad"), values: at(heading) });
    variables.push(Against { axis: Axis::linear("time", "s"), values: at(t) });
    variables
}

/// Turn of the robot per difference of the wheel angles, from the path; `None` where it never turns.
fn turning(recording: &RecordingStudy) -> Option<f64> {
    let rows = recording.path.iter().zip(&recording.alpha);
    let first = recording.path.first()?[2];
    let [a, b] = *recording.alpha.first()?;
    let (mut product, mut square) = (0.0, 0.0);
    for (path, alpha) in rows {
        let difference = alpha[0] - alpha[1] - (a - b);
        product += (path[2] - first) * difference;
        square += difference * difference;
    }
    let turn = product / square;
    (turn.is_finite() && turn != 0.0).then_some(turn)
}
