//! The panel for simulations with other values of the parameters.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use maud::{Markup, PreEscaped, html};
use serde::Serialize;

use super::data::{self, FigureData};
use crate::report::ReportError;
use crate::report::block::Block;
use crate::report::what_if::{Driven, Slider, WhatIf};

/// Number of slider positions on either side of the estimate.
const POSITIONS: f64 = 100.0;

#[derive(Serialize)]
struct Data<'a> {
    parameters: Vec<Parameter<'a>>,
    recordings: Vec<RecordingData<'a>>,
    figure: FigureData<'a>,
}

#[derive(Serialize)]
struct Parameter<'a> {
    name: &'a str,
    unit: &'a str,
    value: f64,
    step: f64,
}

impl<'a> Parameter<'a> {
    fn of(slider: &'a Slider) -> Self {
        let Slider { name, unit, value, half, .. } = slider;
        Self { name, unit, value: *value, step: half / POSITIONS }
    }
}

/// Columns are little-endian numbers in base64: the differences of the time have 32 bits, inputs 24 and speeds 16.
#[derive(Serialize)]
struct RecordingData<'a> {
    name: &'a str,
    start: f64,
    steps: String,
    input: [Signal; 2],
    omega: [Signal; 2],
    starts: Vec<(usize, bool, [f64; 4])>,
    floor: Option<f64>,
}

impl<'a> RecordingData<'a> {
    fn of(driven: &'a Driven) -> Self {
        let pair = |rows: &[[f64; 2]], bytes: usize| {
            [0, 1].map(|i| Signal::of(rows.iter().map(|row| row[i]), bytes))
        };
        Self {
            name: &driven.name,
            start: driven.t.first().copied().unwrap_or(0.0),
            steps: encoded(driven.t.windows(2).flat_map(|t| ((t[1] - t[0]) as f32).to_le_bytes())),
            input: pair(&driven.input, INPUT_BYTES),
            omega: pair(&driven.omega, SPEED_BYTES),
            starts: driven.starts.iter().map(|s| (s.row, s.is_piece, s.state)).collect(),
            floor: Some(driven.floor).filter(|floor| floor.is_finite()),
        }
    }
}

/// Bytes per measured speed: 65535 steps over its range, far below the noise of a sensor.
const SPEED_BYTES: usize = 2;
/// Bytes per input: the simulation integrates the rounding error of a constant input (with two bytes, 0.1 %
/// of the error).
const INPUT_BYTES: usize = 3;

/// A signal as integer steps above its minimum, with a given number of bytes.
#[derive(Serialize)]
struct Signal {
    bytes: usize,
    least: f64,
    step: f64,
    values: String,
}

impl Signal {
    fn of(values: impl Iterator<Item = f64> + Clone, bytes: usize) -> Self {
        let (least, most) = values
            .clone()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (v.min(a), v.max(b)));
        // a signal that never changes, or is empty, has no range
        let range = if most > least { most - least } else { 1.0 };
        let least = if least.is_finite() { least } else { 0.0 };
        let step = range / f64::from((1_u32 << (8 * bytes)) - 1);
        let whole = move |v: f64| ((v - least) / step).round() as u32;
        let values = values.flat_map(move |v| whole(v).to_le_bytes().into_iter().take(bytes));
        Self { bytes, least, step, values: encoded(values) }
    }
}

fn encoded(bytes: impl Iterator<Item = u8>) -> String {
    BASE64.encode(bytes.collect::<Vec<u8>>())
}

/// The panels among blocks, in the order of the page.
fn panels<'a>(blocks: impl Iterator<Item = &'a Block>) -> impl Iterator<Item = &'a WhatIf> {
    blocks.filter_map(|block| match block {
        Block::WhatIf(panel) => Some(&**panel),
        _ => None,
    })
}

/// The data of every panel, in the order of the page.
///
/// # Errors
/// If data cannot be written as JSON.
pub(super) fn all<'a>(blocks: impl Iterator<Item = &'a Block>) -> Result<Vec<String>, ReportError> {
    panels(blocks).map(json).collect()
}

fn json(panel: &WhatIf) -> Result<String, ReportError> {
    let data = Data {
        parameters: panel.sliders.iter().map(Parameter::of).collect(),
        recordings: panel.recordings.iter().map(RecordingData::of).collect(),
        figure: data::of(&panel.figure),
    };
    data::json(&data, "what-if")
}

/// The function called by the panels of a page. User-defined names appear only in its comments, where they
/// must not end the script.
pub(super) fn script<'a>(blocks: impl Iterator<Item = &'a Block>) -> Option<String> {
    let script = &panels(blocks).next()?.script;
    Some(script.replace("</", "< /").replace("<!", "< !").replace("<script", "< script"))
}

/// The sliders and empty elements that are filled by the script; without scripts there is no simulation.
pub(super) fn markup(panel: &WhatIf, json: &str) -> Markup {
    html! {
        div.what-if hidden {
            h3 { "What if: other values of the parameters" }
            p {
                "Simulated with the recorded input from the first measured state: " strong.recording {}
                ". The sliders begin at the estimates."
            }
            div.sliders {
                @for (k, slider) in panel.sliders.iter().enumerate() { (row(k, slider)) }
            }
            p.tools { button.reset type="button" { "Reset to the estimates" } }
            dl.numbers aria-live="polite" {
                (number("2 s simulation error", "rad/s"))
                (number("ISE of the free simulation", "rad²/s"))
            }
            figure { div.plot {} }
            script type="application/json" { (PreEscaped(json)) }
        }
    }
}

fn row(k: usize, slider: &Slider) -> Markup {
    let id = format!("what-if-{k}");
    let least = (POSITIONS * slider.least).ceil();
    html! {
        div.slider {
            label for=(id) { (slider.symbol) " " span { (slider.meaning) } }
            input id=(id) type="range" min=(least) max=(POSITIONS) value="0" step="1";
            output for=(id) {}
        }
    }
}

fn number(label: &str, unit: &str) -> Markup {
    html! {
        div.neutral {
            dt { (label) }
            dd.value { output {} " " span.unit { (unit) } }
            dd.note {}
        }
    }
}
