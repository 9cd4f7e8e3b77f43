//! The sections of a report, one per file, in reading order.

mod curves;
mod listed;
mod words;

use super::block::Block;
use crate::catalogue;
use crate::study::Study;

/// A part of the report: what it shows of a study.
pub trait Section: Send + Sync {
    /// Anchor on the page.
    fn id(&self) -> &'static str;

    /// Heading.
    fn title(&self) -> &'static str;

    /// How a newcomer reads it, in one sentence.
    fn how_to_read(&self) -> &'static str;

    /// What it is made of; empty where the study has nothing to show, and then it is left out.
    fn blocks(&self, study: &Study) -> Vec<Block>;
}

catalogue! {
    dyn Section;
    verdict::Verdict,
    staircase::Staircase,
    fit::Fit,
    regimes::Regimes,
    dependence::Dependence,
    diagnosis::Diagnosis,
    parameters::Parameters,
    methods::Methods,
    emulator::Emulator,
    recordings::Recordings,
    provenance::Provenance,
}

#[cfg(test)]
mod tests;
