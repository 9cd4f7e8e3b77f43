//! The state emulator of eq. (19), and the fuzzy system inside it.

mod rules;

use super::curves;
use super::{Depth, Section, words};
use crate::report::block::{Block, Text};
use crate::report::figure::{Axis, Dash, Figure, Layer, Panel, Role};
use crate::report::format;
use crate::study::{MethodStudy, Performance, RecordingStudy, Study};

/// The emulator.
#[derive(Default)]
pub struct Emulator;

impl Section for Emulator {
    fn id(&self) -> &'static str {
        "emulator"
    }

    fn title(&self) -> &'static str {
        "State emulator and fuzzy system"
    }

    fn depth(&self) -> Depth {
        Depth::Details
    }

    fn how_to_read(&self) -> &'static str {
        "The emulator runs beside the robot and is drawn to the measurement by the gain K, so its \
         error is small where K is large, whatever the model; with K = 0 it is a pure simulation."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        if !study.emulated {
            return vec![];
        }
        let fuzzy = best_fuzzy(study);
        let mut blocks = Vec::new();
        if let Some((method, system)) = fuzzy.and_then(|m| Some((m, m.fuzzy.as_ref()?))) {
            let name = words::method(study, method);
            blocks.push(Block::paragraph(
                Text::from("Takagi-Sugeno systems f31 and f41, fitted by ")
                    .strong(&name)
                    .plain(", the fuzzy method with the lowest 2 s simulation error."),
            ));
            blocks.extend(rules::figures(study, &name, system).into_iter().map(Block::from));
        }
        let shown = fuzzy.or_else(|| study.reference_method());
        let emulated = shown.and_then(|m| Some((m, curves::shown_performance(study, m)?)));
        if let Some((method, (recording, performance))) = emulated {
            blocks.extend(states(study, method, recording, performance));
        }
        blocks
    }
}

/// The fuzzy method with the lowest 2 s simulation error on the judged recordings.
fn best_fuzzy(study: &Study) -> Option<&MethodStudy> {
    let error = |m: &MethodStudy| {
        let rms = study.judged_window_rms(m);
        if rms.is_nan() { f64::INFINITY } else { rms }
    };
    let fuzzy = study.methods.iter().filter(|m| m.fuzzy.is_some());
    fuzzy.min_by(|a, b| error(a).total_cmp(&error(b)))
}

/// States of the emulator and their errors: Fig. 13 and 14 of the paper.
fn states(
    study: &Study,
    method: &MethodStudy,
    recording: &RecordingStudy,
    performance: &Performance,
) -> Vec<Block> {
    let count = performance.emulator.len().min(recording.t.len());
    if count < 2 || recording.alpha.len() < count || recording.omega.len() < count {
        return vec![];
    }
    let subtitle = format!(
        "{}, {}, parallel structure, K = {} s⁻¹ on the wheel speeds",
        words::method(study, method),
        recording.file,
        format::number(study.emulator_gain)
    );
    let symbols = ["α₁", "α₂", "ω₁", "ω₂"];
    let units = ["rad", "rad", "rad/s", "rad/s"];
    let measured = |k: usize, state: usize| match state {
        0 | 1 => recording.alpha[k][state],
        _ => recording.omega[k][state - 2],
    };
    let largest = |state: usize| (0..count).map(|k| measured(k, state).abs()).fold(1e-9, f64::max);
    let mut outputs = Figure::new("emulator-states", "States of the emulator and measured states")
        .with_subtitle(&subtitle)
        .with_caption(format!(
            "Angles α and speeds ω of the wheels.{}",
            words::in_paper(study, "Fig. 13")
        ))
        .interactive();
    let rms = |state: usize| {
        let square = |k: usize| (measured(k, state) - performance.emulator[k][state]).powi(2);
        ((0..count).map(square).sum::<f64>() / count as f64).sqrt()
    };
    let title = format!(
        "Errors of the emulator: {} and {} rad/s rms in speed",
        format::digits(rms(2), 2),
        format::digits(rms(3), 2)
    );
    let mut errors = Figure::new("emulator-errors", title)
        .with_subtitle(&subtitle)
        .with_caption(format!(
            "Measured minus emulated states, wheel 1 right, wheel 2 left.{}",
            words::in_paper(study, "Fig. 14")
        ))
        .interactive();
    for state in 0..4 {
        let limit = 5.0 * largest(state);
        let near = |v: f64| if v.abs() <= limit { v } else { f64::NAN };
        let over_time = |value: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
            (0..count).map(|k| (recording.t[k], value(k))).collect()
        };
        let line = |points, label: &str, width, role| Layer::Line {
            points: curves::broken_at_gaps(points),
            label: label.to_owned(),
            role,
            width,
            dash: Dash::Solid,
        };
        let time = || Axis::linear("time", "s");
        let real = over_time(&|k| measured(k, state));
        let emulated = over_time(&|k| near(performance.emulator[k][state]));
        let name = |name: &'static str| if state == 0 { name } else { "" };
        outputs.panels.push(
            Panel::new(time(), Axis::linear(symbols[state], units[state]))
                .with(Layer::points(real, name("measured"), Role::Measured))
                .with(line(emulated, name("emulator"), 1.6, Role::Model)),
        );
        let error = over_time(&|k| measured(k, state) - near(performance.emulator[k][state]));
        let role = if state % 2 == 0 { Role::Wheel1 } else { Role::Wheel2 };
        let axis = Axis::linear(format!("error of {}", symbols[state]), units[state]);
        let panel = Panel::new(time(), axis).with(line(error, "", 1.0, role));
        errors.panels.push(panel.with(Layer::HLine {
            at: 0.0,
            label: String::new(),
            role: Role::Ink,
            dash: Dash::Solid,
        }));
    }
    vec![outputs.into(), errors.into()]
}
