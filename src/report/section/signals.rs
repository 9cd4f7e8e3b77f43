//! Recorded signals and path of the recording shown in detail.

use super::curves::{self, broken_at_gaps, wheel};
use super::overlay::LINK;
use super::{Depth, Section, words};
use crate::report::block::Block;
use crate::report::figure::{Axis, ColourRole, Dash, Figure, Layer, Panel, Size};
use crate::report::format;
use crate::study::{RecordingStudy, Study};

/// Recorded signals.
#[derive(Default)]
pub struct Signals;

impl Section for Signals {
    fn id(&self) -> &'static str {
        "signals"
    }

    fn title(&self) -> &'static str {
        "Recorded signals"
    }

    fn depth(&self) -> Depth {
        Depth::Details
    }

    fn how_to_read(&self) -> &'static str {
        "Input and speeds as used in the fit, after conditioning, and, if the dimensions of the robot are known, its path."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        let Some((index, recording)) = curves::shown(study) else { return vec![] };
        if recording.t.is_empty() {
            return vec![];
        }
        let mut blocks: Vec<Block> =
            vec![input(study, recording).into(), velocity(study, recording).into()];
        let model = study.last_model().and_then(|m| m.performance.get(index));
        let errors = model.map(|p| p.windows.as_slice()).unwrap_or_default();
        if recording.path.len() > 1 {
            blocks.push(path(study, recording, errors).into());
        }
        blocks
    }
}

fn time() -> Axis {
    Axis::linear("time", "s")
}

fn line(points: Vec<(f64, f64)>, label: &str, role: ColourRole, width: f64) -> Layer {
    let points = broken_at_gaps(points);
    Layer::Line { points, label: label.to_owned(), role, width, dash: Dash::Solid }
}

/// The recorded input: Fig. 3 of the paper.
fn input(study: &Study, recording: &RecordingStudy) -> Figure {
    let roles = [ColourRole::Wheel1, ColourRole::Wheel2];
    let mut panel = Panel::new(time(), Axis::linear("input", study.drive_unit.symbol()));
    for i in 0..2 {
        let label = format!("{} {}", words::INPUT[i], words::WHEELS[i]);
        panel = panel.with(line(wheel(&recording.t, &recording.torque, i), &label, roles[i], 1.2));
    }
    Figure::new("drive", "Recorded input of the wheels")
        .with_subtitle(&recording.file)
        .with_caption(format!(
            "Input of both wheels after conditioning, as fit and simulation use it.{}",
            words::in_paper(study, "Fig. 3")
        ))
        .with_panel(panel)
        .linked(LINK)
}

/// The measured speeds: Fig. 4 of the paper.
fn velocity(study: &Study, recording: &RecordingStudy) -> Figure {
    let roles = [ColourRole::Wheel1, ColourRole::Wheel2];
    let mut panel = Panel::new(time(), Axis::linear("wheel speed", "rad/s"));
    panel.layers.extend(curves::failing(study, recording));
    for i in 0..2 {
        let label = format!("{} {}", words::OMEGA[i], words::WHEELS[i]);
        panel = panel.with(line(wheel(&recording.t, &recording.omega, i), &label, roles[i], 1.2));
    }
    let source = if recording.measured.omega {
        "Measured speeds of both wheels"
    } else {
        "Speeds of both wheels, differentiated from the measured angles"
    };
    Figure::new("speeds", "Angular speeds of the wheels")
        .with_subtitle(&recording.file)
        .with_caption(format!("{source}.{}", words::in_paper(study, "Fig. 4")))
        .with_panel(panel)
        .linked(LINK)
}

/// The path of the axle's centre, dotted where the error of the model exceeds the noise floor.
fn path(study: &Study, recording: &RecordingStudy, windows: &[[f64; 2]]) -> Figure {
    let all: Vec<(f64, f64)> = recording.path.iter().map(|[x, y, _]| (*x, *y)).collect();
    let over_floor = over_floor(recording, windows, all.len());
    let above = |low: f64, high: f64| -> Vec<(f64, f64)> {
        let rows = over_floor.iter().zip(&all).filter(|(over, _)| **over > low && **over <= high);
        rows.map(|(_, place)| *place).collect()
    };
    let (some, many) = (above(2.0, 4.0), above(4.0, f64::INFINITY));
    let marked = some.len() + many.len();
    let marks = [
        dots(some, "error 2 to 4 times the floor", ColourRole::Highlight, 1.6),
        dots(many, "more than 4 times", ColourRole::Model, 2.6),
        dots(vec![all[0]], "start", ColourRole::Ink, 4.5),
    ];
    let size = map_size(&all);
    let panel = Panel::new(Axis::linear("x", "m"), Axis::linear("y", "m")).with_equal_units().with(
        Layer::line(
            curves::broken_where_rows_miss(&recording.t, &all),
            "path",
            ColourRole::NoiseFloor,
        ),
    );
    // regimes that do not occur are not in the legend
    let occurs =
        |layer: &Layer| !matches!(layer, Layer::Points { points, .. } if points.is_empty());
    let panel = marks.into_iter().filter(occurs).fold(panel, Panel::with);
    let mut figure = Figure::new("path", title_of_path(study, marked, over_floor.len()))
        .with_subtitle(&recording.file)
        .with_caption(
            "Path of the axle's centre, computed from the wheel angles; dots mark where the simulation \
             error, averaged over 0.2 s, exceeds twice the noise floor.",
        )
        .with_panel(panel);
    figure.size = size;
    figure
}

/// Ratio of the 2 s simulation error to the noise floor of the verdict, row by row, averaged over 0.2 s.
fn over_floor(recording: &RecordingStudy, windows: &[[f64; 2]], rows: usize) -> Vec<f64> {
    let floor = recording.floor.window_rms.max(1e-9);
    let error = |(w, simulated): (&[f64; 2], &[f64; 2])| {
        let square = |i: usize| (w[i] - simulated[i]).powi(2);
        (0.5 * (square(0) + square(1))).sqrt() / floor
    };
    let errors: Vec<f64> = recording.omega.iter().zip(windows).map(error).take(rows).collect();
    smoothed(&errors, recording.rate_hz)
}

fn dots(points: Vec<(f64, f64)>, label: &str, role: ColourRole, radius: f64) -> Layer {
    Layer::Points { points, label: label.to_owned(), role, radius, alpha: 1.0 }
}

fn title_of_path(study: &Study, marked: usize, rows: usize) -> String {
    let model = match &study.completed {
        Some(_) => format!(" {}", words::added(study)),
        None => String::new(),
    };
    match (rows, marked) {
        (0, _) => "Robot path".to_owned(),
        (_, 0) => format!("The error{model} stays below twice the noise floor everywhere"),
        _ => format!(
            "The error{model} exceeds twice the noise floor for {} of the time",
            format::percent(marked as f64 / rows as f64)
        ),
    }
}

/// Root mean square over 0.2 s.
fn smoothed(values: &[f64], rate: f64) -> Vec<f64> {
    let half = ((0.1 * rate) as usize).min(values.len());
    let mut sums = vec![0.0];
    for v in values {
        let square = if v.is_finite() { (v * v).min(1e6) } else { 1e6 };
        sums.push(sums[sums.len() - 1] + square);
    }
    (0..values.len())
        .map(|k| {
            let (from, to) = (k.saturating_sub(half), (k + half + 1).min(values.len()));
            ((sums[to] - sums[from]) / (to - from) as f64).sqrt()
        })
        .collect()
}

/// A figure of suitable height for a map of these points.
fn map_size(points: &[(f64, f64)]) -> Size {
    const WIDTH: f64 = 620.0;
    let span = |pick: fn(&(f64, f64)) -> f64| {
        let values = || points.iter().map(pick).filter(|v| v.is_finite());
        let ends =
            (values().fold(f64::INFINITY, f64::min), values().fold(-f64::INFINITY, f64::max));
        (ends.1 - ends.0).max(1e-3)
    };
    let height = (WIDTH * span(|p| p.1) / span(|p| p.0)).clamp(150.0, 480.0);
    Size { width: WIDTH, height: Some(height + 130.0) }
}
