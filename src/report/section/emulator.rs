//! The emulator's state and its error, as in the paper's Fig. 13 and 14.

use super::Section;
use crate::report::block::Block;
use crate::report::figure::{Axis, Figure, Layer, Panel};
use crate::report::format;
use crate::report::palette::Role;
use crate::study::Study;

/// State estimates and errors of the parallel emulator.
#[derive(Default)]
pub struct Emulator;

const STATES: [(&str, &str); 4] =
    [("angle 1", "rad"), ("angle 2", "rad"), ("speed 1", "rad/s"), ("speed 2", "rad/s")];

impl Section for Emulator {
    fn id(&self) -> &'static str {
        "emulator"
    }
    fn title(&self) -> &'static str {
        "State emulator"
    }
    fn how_to_read(&self) -> &'static str {
        "The emulator of eq. (19) in parallel structure; the errors are what the paper integrates."
    }
    fn blocks(&self, study: &Study) -> Vec<Block> {
        let Some(&index) = study.judged().first() else { return vec![] };
        // the paper's emulator is fuzzy; without one the reference method stands for it
        let fuzzy = study.methods.iter().find(|m| m.fuzzy.is_some());
        let Some(method) = fuzzy.or(study.reference_method()) else { return vec![] };
        let Some(performance) = method.performance.get(index) else { return vec![] };
        if performance.emulator.is_empty() {
            return vec![];
        }
        let r = &study.recordings[index];
        let k = format::significant(study.emulator_gain, 3);
        let subtitle = format!("{}, method {}, K = {k} 1/s on the wheel speeds", r.file, method.name);
        let mut states = Figure::new("emulator", "State of the emulator (the paper's Fig. 13)")
            .with_subtitle(subtitle.clone())
            .interactive();
        let mut errors = Figure::new("emulator_error", "Error of the emulator (the paper's Fig. 14)")
            .with_subtitle(subtitle)
            .interactive();
        for pair in [[0, 1], [2, 3]] {
            let unit = STATES[pair[0]].1;
            let axis = if pair[0] == 0 { "angle" } else { "speed" };
            let mut state = Panel::new(Axis::linear("time", "s"), Axis::linear(axis, unit));
            let mut error =
                Panel::new(Axis::linear("time", "s"), Axis::linear(format!("{axis} error"), unit));
            for (n, i) in pair.into_iter().enumerate() {
                let role = if n == 0 { Role::Wheel1 } else { Role::Wheel2 };
                let measured = |k: usize| {
                    if i < 2 { r.alpha[k][i] } else { r.omega[k][i - 2] }
                };
                let rows = || performance.emulator.iter().enumerate();
                state = state.with(Layer::line(
                    rows().map(|(k, x)| (r.t[k], x[i])).collect(),
                    STATES[i].0,
                    role,
                ));
                error = error.with(Layer::line(
                    rows().map(|(k, x)| (r.t[k], measured(k) - x[i])).collect(),
                    STATES[i].0,
                    role,
                ));
            }
            states = states.with_panel(state);
            errors = errors.with_panel(error);
        }
        vec![states.into(), errors.into()]
    }
}
