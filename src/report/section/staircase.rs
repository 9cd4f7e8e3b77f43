//! The error over the versions of the model, down to the noise floor.

use super::Section;
use crate::report::block::Block;
use crate::report::figure::{Axis, BarSeries, Bars, Direction, Figure, Layer, Panel};
use crate::report::format;
use crate::report::palette::Role;
use crate::study::Study;

/// The staircase of the error.
#[derive(Default)]
pub struct Staircase;

impl Section for Staircase {
    fn id(&self) -> &'static str {
        "staircase"
    }
    fn title(&self) -> &'static str {
        "The error falls"
    }
    fn how_to_read(&self) -> &'static str {
        "Each bar is a model; the dashed line is the noise floor that no model can pass."
    }
    fn blocks(&self, study: &Study) -> Vec<Block> {
        let mut blocks = Vec::new();
        if let Some(d) = study.diagnosis.as_ref().filter(|d| d.staircase.len() > 1) {
            let steps: Vec<(String, f64)> = d
                .staircase
                .iter()
                .map(|s| {
                    let name =
                        s.added.as_ref().map_or("model as given".into(), |a| format!("+ {a}"));
                    (name, s.window_rms_validation)
                })
                .collect();
            blocks.push(bars("staircase", "What each effect that was found removes", &steps, study));
        }
        if study.versions.len() > 1 {
            let steps: Vec<(String, f64)> = study
                .versions
                .iter()
                .map(|v| {
                    let name = if v.effects.is_empty() {
                        "base model".into()
                    } else {
                        format!("base + {}", v.effects.join(" + "))
                    };
                    (name, v.window_rms)
                })
                .collect();
            blocks.push(bars("versions", "The versions of your model so far", &steps, study));
        }
        blocks
    }
}

fn bars(id: &str, title: &str, steps: &[(String, f64)], study: &Study) -> Block {
    let values: Vec<f64> = steps.iter().map(|s| s.1).collect();
    let text = values.iter().map(|v| format::significant(*v, 3)).collect();
    let bars = Bars {
        categories: steps.iter().map(|s| s.0.clone()).collect(),
        series: vec![BarSeries { text, ..BarSeries::new("window error", Role::Model, values) }],
        direction: Direction::Horizontal,
        highlight: None,
    };
    let panel = Panel::new(Axis::linear("window error", "rad/s"), Axis::unlabelled())
        .with(Layer::Bars(bars))
        .with(Layer::vline(study.judged_floor(), "noise floor", Role::NoiseFloor));
    let subtitle = format!("Judged on the {} recordings", study.judged_words());
    Figure::new(id, title).with_subtitle(subtitle).with_panel(panel).into()
}
