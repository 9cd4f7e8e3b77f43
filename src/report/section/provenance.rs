//! What is needed to repeat the run.

use super::Section;
use crate::report::block::{Block, Cell, Column, Table};
use crate::study::Study;

/// Version, seed, file and hashes.
#[derive(Default)]
pub struct Provenance;

impl Section for Provenance {
    fn id(&self) -> &'static str {
        "provenance"
    }
    fn title(&self) -> &'static str {
        "To repeat this run"
    }
    fn how_to_read(&self) -> &'static str {
        ""
    }
    fn blocks(&self, study: &Study) -> Vec<Block> {
        let mut blocks = vec![
            Block::paragraph(format!(
                "{} {}, seed {}, robot {}.",
                env!("CARGO_PKG_NAME"),
                study.version,
                study.seed,
                study.robot
            )),
            Block::Code(study.file.clone()),
        ];
        let mut table = Table::new(
            "SHA-256 of the recordings.",
            vec![Column::text("File"), Column::text("SHA-256")],
        );
        for r in &study.recordings {
            if let Some(hash) = &r.sha256 {
                table.push(vec![Cell::text(&r.file), Cell::text(hash)]);
            }
        }
        if !table.rows.is_empty() {
            blocks.push(table.into());
        }
        blocks
    }
}
