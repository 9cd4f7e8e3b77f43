//! Placeholder.
use super::Section;
use crate::report::block::Block;
use crate::study::Study;
/// Dependence.
#[derive(Default)]
pub struct Dependence;
impl Section for Dependence {
    fn id(&self) -> &'static str {
        "dependence"
    }
    fn title(&self) -> &'static str {
        "Dependence"
    }
    fn how_to_read(&self) -> &'static str {
        ""
    }
    fn blocks(&self, _study: &Study) -> Vec<Block> {
        vec![]
    }
}
