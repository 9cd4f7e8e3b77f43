//! A dummy section, by the recipe of CONTRIBUTING.md; `.ci/extension` adds it to a scratch copy.

use super::{Depth, Section};
use crate::report::block::Block;
use crate::study::{DiagnosisStudy, Study};

/// The false-alarm rate that a diagnosis was asked for, in a sentence; nothing without a diagnosis.
#[derive(Default)]
pub struct ExtensionProbe;

impl Section for ExtensionProbe {
    fn id(&self) -> &'static str {
        "extension-probe"
    }

    fn title(&self) -> &'static str {
        "Test of the recipe"
    }

    fn depth(&self) -> Depth {
        Depth::Details
    }

    fn how_to_read(&self) -> &'static str {
        "It states the rate that was asked for."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        let said = |d: &DiagnosisStudy| Block::paragraph(format!("Asked: {}.", d.false_alarm));
        study.diagnosis.iter().map(said).collect()
    }
}
