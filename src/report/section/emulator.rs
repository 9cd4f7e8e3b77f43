//! Placeholder.
use super::Section;
use crate::report::block::Block;
use crate::study::Study;
/// Emulator.
#[derive(Default)]
pub struct Emulator;
impl Section for Emulator {
    fn id(&self) -> &'static str {
        "emulator"
    }
    fn title(&self) -> &'static str {
        "Emulator"
    }
    fn how_to_read(&self) -> &'static str {
        ""
    }
    fn blocks(&self, _study: &Study) -> Vec<Block> {
        vec![]
    }
}
