//! A dummy section, by the recipe of CONTRIBUTING.md; `.ci/extension` adds it to a scratch copy.

use super::{Depth, Section};
use crate::report::block::Block;
use crate::study::Study;

/// The number of recordings in a sentence.
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
        "It states how many recordings there are."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        vec![Block::paragraph(format!("{} recordings.", study.recordings.len()))]
    }
}
