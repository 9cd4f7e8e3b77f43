//! Data required to repeat the run.

use super::{Depth, Section, listed, words};
use crate::report::block::{Block, Cell, Column, Table, Text};
use crate::study::{Grade, Study};

/// Data required to repeat the run: version, seed, checksums, the experiment file.
#[derive(Default)]
pub struct Provenance;

impl Section for Provenance {
    fn id(&self) -> &'static str {
        "provenance"
    }

    fn title(&self) -> &'static str {
        "Provenance"
    }

    fn depth(&self) -> Depth {
        Depth::Details
    }

    fn how_to_read(&self) -> &'static str {
        "The same program version, experiment file and recordings give the same numbers on any \
         number of threads."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        let mut facts = Table::new("The run.", vec![Column::text("What"), Column::text("Value")]);
        let mut fact = |what: &str, value: String| {
            facts.push(vec![Cell::text(what), Cell::text(value)]);
        };
        fact("Program", format!("{} {}", env!("CARGO_PKG_NAME"), study.version));
        fact("Robot", study.robot.clone());
        fact("Model", words::model(&study.effects));
        fact("Unit of the input", study.drive_unit.symbol().to_owned());
        if study.recordings.iter().any(|r| r.sha256.is_none()) {
            fact("Seed", study.seed.to_string());
        }
        if let Some(files) = &study.model_out {
            fact("Identified model", format!("{}{}", files.words(), identified(study)));
        } else if study.grade() == Some(Grade::NotUsable) {
            fact("Identified model", "none is written, because it is not usable".to_owned());
        }
        let mut blocks = vec![facts.into()];
        if !study.recordings.is_empty() {
            let columns = vec![Column::text("Recording"), Column::text("SHA-256")];
            let mut sums = Table::new("Checksums of the recordings.", columns);
            for recording in listed::recordings(study).iter().map(|&r| &study.recordings[r]) {
                let sum = recording.sha256.clone();
                let sum = sum.unwrap_or_else(|| "synthetic, from the seed".to_owned());
                sums.push(vec![Cell::text(&recording.file), Cell::text(sum).code()]);
            }
            blocks.extend(listed::left_out(study).map(Block::paragraph));
            blocks.push(sums.into());
        }
        if !study.file.is_empty() {
            blocks.push(Block::Heading("Experiment file as run".to_owned()));
            blocks.push(Block::Code(study.file.clone()));
        }
        if !study.invocation.has_file() {
            return blocks;
        }
        let repeat = if study.invocation.recordings.is_empty() {
            Text::from("To repeat the run, save this file next to its recordings and run ")
                .code(format!("experiment {}.toml", study.experiment))
        } else {
            Text::from("To repeat the run, type ").code(study.invocation.run())
        };
        blocks.push(Block::paragraph(repeat.plain(".")));
        blocks
    }
}

/// Which model the files contain: that of the file, not the one with the effects found.
fn identified(study: &Study) -> String {
    let Some(method) = study.reference_method() else { return String::new() };
    let by = words::method(study, method);
    match study.diagnosis.as_ref().map_or(&[][..], |d| &d.found) {
        [] => format!("; fitted by {by}"),
        _ => {
            let (model, found) = (words::fitted(study), words::found(study));
            format!("; {model}, without {found}, fitted by {by}")
        }
    }
}
