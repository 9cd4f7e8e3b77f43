//! Measured and simulated wheel speeds of one recording, and the error over simulations of different lengths.

use super::overlay::Overlay;
use super::{Section, words};
use crate::report::block::{Block, Cell, Column, Table};
use crate::report::format;
use crate::study::{ModelStudy, Study};

/// Measured against simulated.
#[derive(Default)]
pub struct Fit;

impl Section for Fit {
    fn id(&self) -> &'static str {
        "fit"
    }

    fn title(&self) -> &'static str {
        "Measured against simulated"
    }

    fn how_to_read(&self) -> &'static str {
        "The free simulation starts once and is driven by the recorded input alone, so errors \
         accumulate; the 2 s simulations restart from the measured motion and show the error of the model itself."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        let Some(overlay) = Overlay::of(study) else { return vec![] };
        let mut blocks = vec![overlay.whole().into()];
        blocks.extend(horizons(study).map(Block::from));
        blocks
    }
}

/// Error and fit of the models over simulations of different lengths.
fn horizons(study: &Study) -> Option<Table> {
    let given = study.given.as_ref().filter(|m| !m.horizons.is_empty())?;
    let models: Vec<(&ModelStudy, String)> = std::iter::once((given, words::given(study)))
        .chain(study.completed.as_ref().map(|m| (m, words::added(study))))
        .collect();
    let mut columns = vec![Column::text("Simulated for")];
    for (_, name) in &models {
        columns.push(Column::number(format!("Error, {name}"), "rad/s"));
        columns.push(Column::number(format!("Fit right / left, {name}"), "%"));
    }
    let caption = format!(
        "RMS error of both wheel speeds and fit, 100 (1 − ‖w − ŵ‖/‖w − mean‖), by the time that is simulated \
         from the measured motion; one sample is the prediction of the Kalman filter, whose state comes from the model too, so that a wrong model \
         may miss more than in 0.1 s. On {} data.",
        study.judged_words()
    );
    let mut table = Table::new(caption, columns);
    for (n, horizon) in given.horizons.iter().enumerate() {
        let name = match horizon.seconds {
            0.0 => "one sample".to_owned(),
            s if s.is_infinite() => "the whole recording (free)".to_owned(),
            s => format!("{} s", format::significant(s, 2)),
        };
        let mut row = vec![Cell::formatted(name, horizon.seconds)];
        for (model, _) in &models {
            let Some(h) = model.horizons.get(n) else { continue };
            row.push(Cell::formatted(format::digits(h.rms, 3), h.rms));
            let fit = h.fit_percent.map(|f| format::fixed(f, 1)).join(" / ");
            row.push(Cell::formatted(fit, 0.5 * (h.fit_percent[0] + h.fit_percent[1])));
        }
        table.push(row);
    }
    Some(table)
}
