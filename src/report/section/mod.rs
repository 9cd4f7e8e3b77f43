//! The sections of a report, one per file, in reading order.

mod curves;
mod intervals;
mod listed;
mod overlay;
mod what_if;
mod words;

use super::block::Block;
use super::figure::Figure;
use crate::catalogue;
use crate::study::Study;

/// Level of a section in the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// The results; the first screen.
    Summary,
    /// The evidence for the verdict.
    Evidence,
    /// All details, collapsed.
    Details,
}

/// A section of the report.
pub trait Section: Send + Sync {
    /// Anchor on the page.
    fn id(&self) -> &'static str;

    /// Heading.
    fn title(&self) -> &'static str;

    /// How to read it, in one sentence.
    fn how_to_read(&self) -> &'static str;

    /// Its level in the report.
    fn depth(&self) -> Depth {
        Depth::Evidence
    }

    /// Its content; empty sections are omitted.
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

/// The first figure of the report as a small picture; `None` without a fit.
pub(super) fn thumbnail(study: &Study) -> Option<Figure> {
    Some(overlay::Overlay::of(study)?.thumbnail())
}

#[cfg(test)]
mod tests;
