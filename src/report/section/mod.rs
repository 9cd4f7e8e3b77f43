//! One section of the report per file, and the list in reading order.

use super::block::Block;
use crate::catalogue;
use crate::study::Study;

/// A section of the report.
pub trait Section: Send + Sync {
    /// Anchor on the page.
    fn id(&self) -> &'static str;
    /// Heading.
    fn title(&self) -> &'static str;
    /// How to read it, in one sentence; empty for none.
    fn how_to_read(&self) -> &'static str;
    /// Its blocks; none leaves the section out.
    fn blocks(&self, study: &Study) -> Vec<Block>;
}

catalogue! {
    dyn Section;
    verdict::Verdict,
    staircase::Staircase,
    fit::FitSection,
    regimes::Regimes,
    dependence::DependenceSection,
    diagnosis::Diagnosis,
    parameters::Parameters,
    methods::Methods,
    emulator::Emulator,
    fuzzy::Fuzzy,
    recordings::Recordings,
    provenance::Provenance,
}

/// Every `n`-th point such that at most `most` remain: clouds of dots need no more.
fn thinned<T: Clone>(points: Vec<T>, most: usize) -> Vec<T> {
    let step = points.len().div_ceil(most).max(1);
    points.into_iter().step_by(step).collect()
}

/// Words for a name of results: `pivot_left` is "pivot left".
fn spoken(name: &str) -> String {
    name.replace('_', " ")
}

#[cfg(test)]
mod tests;
