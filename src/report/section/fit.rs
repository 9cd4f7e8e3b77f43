//! Measured against simulated, with residuals.

use super::{Section, thinned};
use crate::recording::Regime;
use crate::report::block::Block;
use crate::report::figure::{Axis, Figure, Layer, Panel};
use crate::report::palette::Role;
use crate::study::{MethodStudy, RecordingStudy, Study};

/// Measured against simulated.
#[derive(Default)]
pub struct FitSection;

impl Section for FitSection {
    fn id(&self) -> &'static str {
        "fit"
    }
    fn title(&self) -> &'static str {
        "Measured against simulated"
    }
    fn how_to_read(&self) -> &'static str {
        "The free simulation knows only the moments and may wander with their noise; the windows \
         start anew every 2 s and show the model itself."
    }
    fn blocks(&self, study: &Study) -> Vec<Block> {
        let Some(method) = study.reference_method() else { return vec![] };
        let Some(&index) = study.judged().first() else { return vec![] };
        let recording = &study.recordings[index];
        vec![
            speeds(study, method, index).into(),
            drives(study, recording).into(),
            path(recording, method, index).into(),
        ]
    }
}

/// Consecutive samples of standstill as ranges of time.
fn rests(r: &RecordingStudy) -> Vec<(f64, f64)> {
    let mut out: Vec<(f64, f64)> = Vec::new();
    let mut open = None;
    for (k, regime) in r.regimes.iter().enumerate() {
        let still = *regime == Regime::Standstill;
        match (still, open) {
            (true, None) => open = Some(r.t[k]),
            (false, Some(start)) => {
                out.push((start, r.t[k]));
                open = None;
            }
            _ => {}
        }
    }
    if let Some(start) = open {
        out.push((start, *r.t.last().unwrap_or(&start)));
    }
    out
}

fn speeds(study: &Study, method: &MethodStudy, index: usize) -> Figure {
    let r = &study.recordings[index];
    let performance = &method.performance[index];
    let mut figure = Figure::new("fit", "Wheel speeds, measured and simulated")
        .with_subtitle(format!("{}, {} recording, method {}", r.file, r.role.name(), method.name))
        .interactive();
    let series = |values: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        (0..r.t.len()).map(|k| (r.t[k], values(k))).collect()
    };
    for wheel in 0..2 {
        let title = if wheel == 0 { "Wheel 1 (right)" } else { "Wheel 2 (left)" };
        let measured = series(&|k| r.omega[k][wheel]);
        let panel = Panel::new(Axis::linear("time", "s"), Axis::linear("wheel speed", "rad/s"))
            .with_title(title)
            .with(Layer::Shade {
                ranges: rests(r),
                label: if wheel == 0 { "standstill".into() } else { String::new() },
                role: Role::Ink,
            })
            .with(Layer::points(thinned(measured, 2500), label(wheel, "measured"), Role::Measured))
            .with(Layer::line(
                series(&|k| performance.free.get(k).map_or(f64::NAN, |w| w[wheel])),
                label(wheel, "free simulation"),
                Role::Model,
            ));
        figure = figure.with_panel(panel);
    }
    let error = |k: usize, wheel: usize| {
        performance.windows.get(k).map_or(f64::NAN, |w| r.omega[k][wheel] - w[wheel])
    };
    let noise = r.noise.omega[0].max(r.noise.omega[1]);
    let residual = Panel::new(Axis::linear("time", "s"), Axis::linear("error", "rad/s"))
        .with_title("Error of the 2 s windows")
        .with(Layer::Band {
            x: vec![r.t[0], r.t[r.t.len() - 1]],
            lower: vec![-2.0 * noise; 2],
            upper: vec![2.0 * noise; 2],
            label: "± 2 sensor noise".into(),
            role: Role::NoiseFloor,
        })
        .with(Layer::line(series(&|k| error(k, 0)), "wheel 1", Role::Wheel1))
        .with(Layer::line(series(&|k| error(k, 1)), "wheel 2", Role::Wheel2));
    figure.with_panel(residual)
}

/// Legend entries stand once, on the first panel.
fn label(wheel: usize, text: &str) -> String {
    if wheel == 0 { text.into() } else { String::new() }
}

fn drives(study: &Study, r: &RecordingStudy) -> Figure {
    let unit = study.drive_unit.symbol();
    let name = if unit == "N m" { "moment" } else { "drive" };
    let mut panel = Panel::new(Axis::linear("time", "s"), Axis::linear(name, unit));
    for (wheel, role) in [(0, Role::Wheel1), (1, Role::Wheel2)] {
        let points = (0..r.t.len()).map(|k| (r.t[k], r.moment[k][wheel])).collect();
        panel = panel.with(Layer::line(points, format!("wheel {}", wheel + 1), role));
    }
    Figure::new("drive", "Recorded drive (the paper's Fig. 3)")
        .with_subtitle(r.file.clone())
        .with_panel(panel)
        .interactive()
}

fn path(r: &RecordingStudy, method: &MethodStudy, index: usize) -> Figure {
    let windows = &method.performance[index].windows;
    let sizes: Vec<f64> = (0..r.t.len())
        .map(|k| {
            windows.get(k).map_or(f64::NAN, |w| {
                ((r.omega[k][0] - w[0]).powi(2) + (r.omega[k][1] - w[1]).powi(2)).sqrt()
            })
        })
        .collect();
    let mut sorted: Vec<f64> = sizes.iter().copied().filter(|s| s.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let limit = sorted.get(sorted.len() * 9 / 10).copied().unwrap_or(f64::INFINITY);
    let all: Vec<(f64, f64)> = r.path.iter().map(|p| (p[0], p[1])).collect();
    let worst: Vec<(f64, f64)> =
        r.path.iter().zip(&sizes).filter(|(_, s)| **s > limit).map(|(p, _)| (p[0], p[1])).collect();
    let panel = Panel::new(Axis::linear("x", "m"), Axis::linear("y", "m"))
        .with(Layer::line(thinned(all, 3000), "path of the axle's centre", Role::Measured))
        .with(Layer::Points {
            points: thinned(worst, 800),
            label: "a tenth of the samples, where the error is largest".into(),
            role: Role::Highlight,
            radius: 2.2,
            alpha: 0.6,
        });
    Figure::new("path", "Where on the floor the error is largest")
        .with_subtitle(r.file.clone())
        .with_panel(panel)
}
