//! The sections of a report, one per file, in reading order.

mod curves;
mod listed;
mod overlay;
mod what_if;
mod words;

use super::block::Block;
use super::figure::Figure;
use crate::catalogue;
use crate::study::Study;

/// How far down the reader finds a section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// What comes out; the first screen.
    Summary,
    /// What the verdict rests on.
    Evidence,
    /// Everything else, folded away.
    Details,
}

/// A part of the report: what it shows of a study.
pub trait Section: Send + Sync {
    /// Anchor on the page.
    fn id(&self) -> &'static str;

    /// Heading.
    fn title(&self) -> &'static str;

    /// How a newcomer reads it, in one sentence.
    fn how_to_read(&self) -> &'static str;

    /// How far down the reader finds it.
    fn depth(&self) -> Depth {
        Depth::Evidence
    }

    /// What it is made of; empty where the study has nothing to show, and then it is left out.
    fn blocks(&self, study: &Study) -> Vec<Block>;
}

catalogue! {
    dyn Section;
    verdict::Verdict,
    staircase::Staircase,
    fit::Fit,
    dependence::Dependence,
    regimes::Regimes,
    residuals::Residuals,
    parameters::Parameters,
    diagnosis::Diagnosis,
    methods::Methods,
    estimates::Estimates,
    explorer::Explorer,
    signals::Signals,
    emulator::Emulator,
    recordings::Recordings,
    provenance::Provenance,
}

/// The first figure of the report, small; `None` without a fit.
pub(super) fn thumbnail(study: &Study) -> Option<Figure> {
    Some(overlay::Overlay::of(study)?.thumbnail())
}

#[cfg(test)]
mod tests;
