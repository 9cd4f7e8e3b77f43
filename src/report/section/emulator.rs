//! The state emulator of eq. (19), and the fuzzy system inside it.

mod rules;

use super::curves;
use super::{Depth, Section, words};
use crate::report::block::{Block, Text};
use crate::report::figure::{Axis, ColourRole, Dash, Figure, Layer, Panel};
use crate::report::format;
use crate::study::{MethodStudy, Performance, RecordingStudy, Study};

/// Simulations by eq. (19) and the rules of fuzzy methods.
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
        "The emulator is simulated in parallel with the recording and corrected towards the measurement \
         with the gain K (a state observer), so its error is small for large K, however poor the model; \
         with K = 0 it is a pure simulation."
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
                    .plain(", the fuzzy method with the lowest simulation error."),
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
    let Some(run) = Run::new(recording, performance) else { return vec![] };
    let subtitle = format!(
        "{}, {}, parallel structure, K = {} s⁻¹ on the wheel speeds",
        words::method(study, method),
        recording.file,
        format::number(study.emulator_gain)
    );
    let title = format!(
        "Errors of the emulator: {} and {} rad/s rms in speed",
        format::digits(run.rms(2), 2),
        format::digits(run.rms(3), 2)
    );
    let outputs =
        Figure::new("emulator-states", "States of the emulator and measured states").with_caption(
            format!("Angles α and speeds ω of the wheels.{}", words::in_paper(study, "Fig. 13")),
        );
    let errors = Figure::new("emulator-errors", title).with_caption(format!(
        "Measured minus emulated states, wheel 1 right, wheel 2 left.{}",
        words::in_paper(study, "Fig. 14")
    ));
    let drawn = |figure: Figure, panel: &dyn Fn(usize) -> Panel| {
        let figure = figure.with_subtitle(&subtitle).interactive();
        (0..4).map(panel).fold(figure, Figure::with_panel).into()
    };
    vec![drawn(outputs, &|state| run.output(state)), drawn(errors, &|state| run.error(state))]
}

const SYMBOLS: [&str; 4] = ["α₁", "α₂", "ω₁", "ω₂"];
const UNITS: [&str; 4] = ["rad", "rad", "rad/s", "rad/s"];

/// The emulator beside a recording; states are alpha1, alpha2, omega1, omega2.
struct Run<'a> {
    recording: &'a RecordingStudy,
    emulated: &'a [[f64; 4]],
}

impl<'a> Run<'a> {
    /// `None` without emulated states.
    fn new(recording: &'a RecordingStudy, performance: &'a Performance) -> Option<Self> {
        let count = performance.emulator.len().min(recording.t.len());
        let is_there =
            count >= 2 && recording.alpha.len() >= count && recording.omega.len() >= count;
        is_there.then(|| Self { recording, emulated: &performance.emulator[..count] })
    }

    fn measured(&self, k: usize, state: usize) -> f64 {
        match state {
            0 | 1 => self.recording.alpha[k][state],
            _ => self.recording.omega[k][state - 2],
        }
    }

    fn rms(&self, state: usize) -> f64 {
        let square = |(k, e): (usize, &[f64; 4])| (self.measured(k, state) - e[state]).powi(2);
        let sum: f64 = self.emulated.iter().enumerate().map(square).sum();
        (sum / self.emulated.len() as f64).sqrt()
    }

    /// Emulated values without diverged ones.
    fn near(&self, state: usize) -> Vec<f64> {
        let rows = 0..self.emulated.len();
        let largest = rows.map(|k| self.measured(k, state).abs()).fold(1e-9, f64::max);
        let near = |v: f64| if v.abs() <= 5.0 * largest { v } else { f64::NAN };
        self.emulated.iter().map(|e| near(e[state])).collect()
    }

    fn over_time(&self, value: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
        (0..self.emulated.len()).map(|k| (self.recording.t[k], value(k))).collect()
    }

    fn output(&self, state: usize) -> Panel {
        let near = self.near(state);
        let (real, emulated) =
            (self.over_time(|k| self.measured(k, state)), self.over_time(|k| near[k]));
        // one legend for all panels
        let name = |name: &'static str| if state == 0 { name } else { "" };
        Panel::new(Axis::linear("time", "s"), Axis::linear(SYMBOLS[state], UNITS[state]))
            .with(Layer::points(real, name("measured"), ColourRole::Measured))
            .with(line(emulated, name("emulator"), 1.6, ColourRole::Model))
    }

    fn error(&self, state: usize) -> Panel {
        let near = self.near(state);
        let error = self.over_time(|k| self.measured(k, state) - near[k]);
        let role = if state.is_multiple_of(2) { ColourRole::Wheel1 } else { ColourRole::Wheel2 };
        let axis = Axis::linear(format!("error of {}", SYMBOLS[state]), UNITS[state]);
        let zero = Layer::HLine {
            at: 0.0,
            label: String::new(),
            role: ColourRole::Ink,
            dash: Dash::Solid,
        };
        Panel::new(Axis::linear("time", "s"), axis).with(line(error, "", 1.0, role)).with(zero)
    }
}

fn line(points: Vec<(f64, f64)>, label: &str, width: f64, role: ColourRole) -> Layer {
    let (points, label) = (curves::broken_at_gaps(points), label.to_owned());
    Layer::Line { points, label, role, width, dash: Dash::Solid }
}
