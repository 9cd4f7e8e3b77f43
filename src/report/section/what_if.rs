//! The recordings of the explorer, simulated on the page with other parameter values.

use super::words;
use crate::effects;
use crate::export::reasons;
use crate::report::block::Block;
use crate::report::figure::{Axis, ColourRole, Dash, Figure, Layer, Panel};
use crate::report::format;
use crate::report::what_if::{Driven, Slider, WhatIf};
use crate::study::{ParameterStudy, Study};

/// Largest number of rows of all recordings together, which keeps the page below 3 MB.
const ROWS: usize = 24_000;
/// Longest simulated duration \[s\]: with a step of 1 ms the simulation follows a slider without delay
/// (judgement).
const SECONDS: f64 = 60.0;
/// Range of a slider (judgement): shares of the estimate, for the base model and for effects, which may be absent
/// or twice as large; and the smallest range in standard errors.
const SHARES: [f64; 2] = [0.5, 1.0];
const STD_ERRORS: f64 = 5.0;

/// The panel, or the reason why there is none; empty without a physical model.
pub(super) fn blocks(study: &Study, shown: &[usize]) -> Vec<Block> {
    let (Some(data), Some(model)) = (&study.what_if, study.last_model()) else { return vec![] };
    let script = match &data.script {
        Ok(script) => script.clone(),
        Err(obstacles) => {
            let reasons = reasons(obstacles);
            let text = format!("This model cannot be simulated on the page ({reasons}).");
            return vec![Block::paragraph(text)];
        }
    };
    let sliders: Vec<Slider> = model.parameters.iter().filter_map(slider).collect();
    let rows = ROWS / shown.len().max(1);
    let recordings = shown.iter().filter_map(|&r| driven(study, r, rows)).collect();
    let block = WhatIf { script, sliders, recordings, figure: figure(study) };
    vec![Block::WhatIf(Box::new(block))]
}

fn slider(parameter: &ParameterStudy) -> Option<Slider> {
    let ParameterStudy { effect, meaning, estimate } = parameter;
    let (value, error) = (estimate.value, estimate.std_error);
    // the shift of the input is already applied to the data
    if estimate.fixed || estimate.symbol == crate::diagnose::INPUT_SHIFT {
        return None;
    }
    let is_base = effects::BASE.contains(&effect.as_str());
    let errors = if error.is_finite() { STD_ERRORS * error } else { 0.0 };
    let half = errors.max(SHARES[usize::from(!is_base)] * value.abs());
    // includes the opposite sign only if the sign of the estimate is not significant
    let is_signed = value.abs() > 2.0 * error;
    let least = if is_signed && value > 0.0 { -(value / half).min(1.0) } else { -1.0 };
    (half.is_finite() && half > 0.0).then(|| Slider {
        name: format!("p_{}", estimate.symbol),
        symbol: estimate.symbol.clone(),
        meaning: meaning.clone(),
        unit: format::unit(&estimate.unit),
        value,
        half,
        least,
    })
}

/// A recording, or its first part.
fn driven(study: &Study, index: usize, most: usize) -> Option<Driven> {
    let recording = &study.recordings[index];
    let data = study.what_if.as_ref()?;
    let (input, starts) = (data.inputs.get(index)?, data.starts.get(index)?);
    let first = *recording.t.first()?;
    let in_time = recording.t.partition_point(|t| t - first <= SECONDS);
    let rows = recording.t.len().min(most).min(in_time).max(2.min(recording.t.len()));
    let is_whole = rows == recording.t.len();
    let mut name = format!("{} ({})", recording.file, recording.role.name());
    if !is_whole {
        let seconds = recording.t[rows - 1] - first;
        name += &format!(", its first {} s", format::significant(seconds, 3));
    }
    Some(Driven {
        name,
        t: recording.t[..rows].to_vec(),
        input: input[..rows].to_vec(),
        omega: recording.omega[..rows].to_vec(),
        starts: starts.iter().filter(|s| s.row < rows).copied().collect(),
        floor: if is_whole { recording.floor.window_rms } else { f64::NAN },
    })
}

/// The panels, whose points are computed by the page; no layer depends on the selection of the model in the
/// report.
fn figure(study: &Study) -> Figure {
    let line = |label: &str, role: ColourRole, width: f64, dash: Dash| Layer::Line {
        points: vec![(0.0, 0.0), (1.0, 1.0)],
        label: label.to_owned(),
        role,
        width,
        dash,
    };
    let identified = format!(
        "identified ({})",
        match study.completed {
            Some(_) => words::added(study),
            None => words::given(study),
        }
    );
    let mut figure = Figure::new("what-if", "");
    for i in 0..2 {
        let mut panel =
            Panel::new(Axis::linear("time", "s"), Axis::linear(words::OMEGA[i], "rad/s"));
        panel.layers = vec![
            line("measured", ColourRole::Measured, 2.6, Dash::Solid),
            line(&identified, ColourRole::Series(6), 1.0, Dash::Dashed),
            line("with these values", ColourRole::Series(3), 1.6, Dash::Solid),
        ];
        if i > 0 {
            panel.layers.iter_mut().for_each(Layer::unlabel);
        }
        figure.panels.push(panel);
    }
    figure
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::Obstacle;
    use crate::identify::Estimate;
    use crate::report::section::tests::full;
    use crate::study::Start;

    fn of(effect: &str, value: f64, std_error: f64) -> Option<Slider> {
        let estimate = Estimate::new("x", "N m".to_owned(), value, std_error);
        slider(&ParameterStudy { effect: effect.into(), meaning: String::new(), estimate })
    }

    #[test]
    fn a_slider_spans_half_the_estimate_five_errors_or_to_an_absent_effect() {
        let span = |s: Slider| [s.value + s.least * s.half, s.value + s.half];
        assert_eq!(of("inertia", 0.04, 1e-4).map(span), Some([0.02, 0.06]));
        assert_eq!(of("turning_scrub", 0.02, 1e-4).map(span), Some([0.0, 0.04]));
        // 0.001 ± 0.001: of either sign
        assert_eq!(of("turning_scrub", 0.001, 0.001).map(span), Some([-0.004, 0.006]));
        // ± 0.015 reaches beyond zero, and the sign of 0.01 is known
        assert_eq!(of("inertia", 0.01, 0.003).map(span), Some([0.0, 0.025]));
        assert_eq!(of("inertia", 0.0, 0.0), None);
    }

    /// The full study with a function, or with the reason why there is none.
    fn with(script: Result<String, Vec<Obstacle>>) -> Study {
        let study = full();
        let start = |row| Start { row, state: [0.0; 4], is_piece: row == 0 };
        let count = study.recordings.len();
        let inputs = study.recordings.iter().map(|r| r.torque.clone()).collect();
        let starts = vec![vec![start(0), start(200)]; count];
        let what_if = Some(crate::study::WhatIfStudy { script, inputs, starts });
        Study { what_if, ..study }
    }

    #[test]
    fn a_model_with_states_of_its_own_is_named_in_place_of_the_sliders() {
        let obstacle = Obstacle { effect: "wheel_slip".into(), reason: "it has states".into() };
        let blocks = blocks(&with(Err(vec![obstacle])), &[0]);
        let [Block::Paragraph(text)] = &blocks[..] else { panic!("{blocks:?}") };
        assert!(format!("{text:?}").contains("wheel_slip"), "{text:?}");
    }

    #[test]
    fn of_a_long_recording_the_first_minute_is_simulated_and_has_no_noise_floor() {
        let mut study = with(Ok("function model() {}".into()));
        study.recordings[0].t = (0..400).map(f64::from).collect();
        let blocks = blocks(&study, &[0, 1]);
        let [Block::WhatIf(panel)] = &blocks[..] else { panic!("{blocks:?}") };
        let [long, short] = &panel.recordings[..] else { panic!("{panel:?}") };
        assert!(long.name.ends_with(", its first 60 s"), "{}", long.name);
        assert_eq!((long.t.len(), long.starts.len(), long.floor.is_nan()), (61, 1, true));
        assert_eq!((short.t.len(), short.starts.len(), short.floor), (400, 2, 0.05));
    }
}
