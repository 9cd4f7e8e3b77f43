//! Placeholder.
use super::Section;
use crate::report::block::Block;
use crate::study::Study;
/// Diagnosis.
#[derive(Default)]
pub struct Diagnosis;
impl Section for Diagnosis {
    fn id(&self) -> &'static str {
        "diagnosis"
    }
    fn title(&self) -> &'static str {
        "Diagnosis"
    }
    fn how_to_read(&self) -> &'static str {
        ""
    }
    fn blocks(&self, _study: &Study) -> Vec<Block> {
        vec![]
    }
}
