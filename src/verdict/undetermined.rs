//! The verdict where the columns do not determine the model.

use crate::study::{DiagnosisStudy, Verdict};

/// What is said in place of a comparison with the noise floor.
const SENTENCE: &str = "These columns do not determine the model: the fit stalled, and a1 is not identifiable. Its \
                        error is no measure of it.";
/// What to do about it.
const NEXT: &str = "Check in the experiment file that the columns are those of the wheels and of their input, and that \
                    the units are right: `experiment new` shows the ranges of all columns.";

/// Takes the findings back where the columns do not determine the model: what such a fit leaves is no effect.
pub(super) fn unless_undetermined(words: DiagnosisStudy, is_undetermined: bool) -> DiagnosisStudy {
    if !is_undetermined {
        return words;
    }
    DiagnosisStudy {
        verdict: Verdict::UnknownEffect,
        sentence: SENTENCE.into(),
        next_run: Some(NEXT.into()),
        proposal: None,
        found: vec![],
        likely: vec![],
        effects: vec![],
        formula: None,
        is_undetermined,
        ..words
    }
}
