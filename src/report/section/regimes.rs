//! In which regimes of driving the model fails.

use super::{Section, spoken};
use crate::recording::Regime;
use crate::report::block::{Block, Cell, Column, Table, Tone};
use crate::report::figure::{Axis, ColorMap, Figure, HeatMap, Layer, Panel};
use crate::report::format;
use crate::study::Study;

/// Error by regime and wheel.
#[derive(Default)]
pub struct Regimes;

impl Section for Regimes {
    fn id(&self) -> &'static str {
        "regimes"
    }
    fn title(&self) -> &'static str {
        "Where the model fails"
    }
    fn how_to_read(&self) -> &'static str {
        "A ratio of 1 is noise; the test asks whether a constant moment is missing in the regime, \
         after the parameters took up what they can, with Holm's correction for looking at all."
    }
    fn blocks(&self, study: &Study) -> Vec<Block> {
        if study.failures.is_empty() {
            return vec![];
        }
        vec![map(study).into(), table(study).into()]
    }
}

fn map(study: &Study) -> Figure {
    let present: Vec<Regime> = Regime::ALL
        .into_iter()
        .filter(|r| study.failures.iter().any(|f| f.regime == *r))
        .collect();
    let ratio = |regime: Regime, wheel: usize| {
        let found = study.failures.iter().find(|f| f.regime == regime && f.wheel == wheel);
        found.map_or(f64::NAN, |f| f.ratio_to_noise)
    };
    let values: Vec<Vec<f64>> =
        present.iter().map(|r| vec![ratio(*r, 1), ratio(*r, 2)]).collect();
    let text = values
        .iter()
        .map(|row| row.iter().map(|v| format::significant(*v, 2)).collect())
        .collect();
    let largest = values.iter().flatten().copied().filter(|v| v.is_finite()).fold(2.0, f64::max);
    let heat = HeatMap {
        rows: present.iter().map(|r| spoken(r.name())).collect(),
        columns: vec!["wheel 1 (right)".into(), "wheel 2 (left)".into()],
        values,
        text,
        colors: ColorMap::Sequential,
        label: "error over noise floor".into(),
        unit: String::new(),
        range: Some((1.0, largest)),
    };
    let panel = Panel::new(Axis::unlabelled(), Axis::unlabelled()).with(Layer::HeatMap(heat));
    Figure::new("regimes", "Error over the noise floor, by regime of driving")
        .with_subtitle(format!("Windows of 2 s, {} recordings", study.judged_words()))
        .with_panel(panel)
}

fn table(study: &Study) -> Table {
    let unit = study.drive_unit.symbol();
    let mut table = Table::new(
        "Regimes, those that fail beyond noise first.",
        vec![
            Column::text("Regime"),
            Column::number("Wheel", ""),
            Column::number("Error over noise", ""),
            Column::number("Share of squared error", "%"),
            Column::number("Missing moment", unit),
            Column::number("p", ""),
            Column::text("Beyond noise"),
            Column::number("Samples", ""),
        ],
    );
    for f in &study.failures {
        let verdict = if f.significant {
            Cell::text("yes").tone(Tone::Bad)
        } else {
            Cell::text("no")
        };
        table.push(vec![
            Cell::text(spoken(f.regime.name())),
            Cell::count(f.wheel),
            Cell::formatted(format::significant(f.ratio_to_noise, 3), f.ratio_to_noise),
            Cell::formatted(format::significant(100.0 * f.share_of_ise, 2), f.share_of_ise)
                .bar(f.share_of_ise),
            Cell::estimate(f.moment, f.std_error),
            Cell::p_value(f.p_value),
            verdict,
            Cell::count(f.samples),
        ]);
    }
    table
}
