//! The recordings and what was noticed in them.

use super::Section;
use crate::report::block::{Block, Cell, Column, Table};
use crate::report::format;
use crate::study::Study;

/// Table of recordings.
#[derive(Default)]
pub struct Recordings;

impl Section for Recordings {
    fn id(&self) -> &'static str {
        "recordings"
    }
    fn title(&self) -> &'static str {
        "Recordings"
    }
    fn how_to_read(&self) -> &'static str {
        "Noise is that of the sensors alone, from fourth differences, right wheel / left wheel."
    }
    fn blocks(&self, study: &Study) -> Vec<Block> {
        let mut table = Table::new(
            "The recordings of this experiment.",
            vec![
                Column::text("File"),
                Column::text("Use"),
                Column::number("Length", "s"),
                Column::number("Samples", ""),
                Column::number("Rate", "Hz"),
                Column::text("Noise of angles [rad]"),
                Column::text("of speeds [rad/s]"),
                Column::text(format!("of drives [{}]", study.drive_unit.symbol())),
            ],
        );
        let mut findings = Vec::new();
        for r in &study.recordings {
            let pair = |v: [f64; 2]| {
                format!("{} / {}", format::significant(v[0], 2), format::significant(v[1], 2))
            };
            let computed = |v: [f64; 2], measured: bool| {
                if measured { pair(v) } else { "not measured".into() }
            };
            table.push(vec![
                Cell::text(&r.file),
                Cell::text(r.role.name()),
                Cell::formatted(format::significant(r.duration_s, 4), r.duration_s),
                Cell::count(r.samples),
                Cell::formatted(format::significant(r.rate_hz, 4), r.rate_hz),
                Cell::text(computed(r.noise.alpha, r.measured.alpha)),
                Cell::text(computed(r.noise.omega, r.measured.omega)),
                Cell::text(pair(r.noise.moment)),
            ]);
            findings.extend(r.findings.iter().map(|f| format!("{}: {f}", r.file)));
        }
        let mut blocks = vec![table.into()];
        if !findings.is_empty() {
            blocks.push(Block::Heading("Noticed in the recordings".into()));
            blocks.push(Block::list(findings));
        }
        blocks
    }
}
