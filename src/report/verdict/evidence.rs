//! Text on the evidence for a candidate.

use super::error::removed;
use crate::diagnose::Errors;
use crate::study::CandidateStudy;

/// "removes 92 % of the error above the noise floor, the 2 s simulation error falls from …"; for a candidate
/// without computed errors, the likelihood ratios of the screening. `errors`: those of the diagnosis.
#[must_use]
pub fn evidence(candidate: &CandidateStudy, errors: &Errors) -> String {
    let CandidateStudy { before, after: Some(after), .. } = candidate else {
        return format!(
            "not refitted (likelihood ratio {:.0} by regression, {:.0} over the windows)",
            candidate.by_regression, candidate.by_windows
        );
    };
    let explainable = before.window_rms.powi(2) - errors.floor;
    let gained = before.window_rms.powi(2) - after.window_rms.powi(2);
    let share = if explainable > 0.02 * errors.floor {
        format!(
            "removes {} of the error above the noise floor, ",
            removed((1.0 - gained / explainable).clamp(0.0, 1.0))
        )
    } else {
        String::new()
    };
    format!(
        "{share}the 2 s simulation error {} from {:.4} to {:.4} rad/s (noise floor {:.4})",
        if after.window_rms < before.window_rms { "falls" } else { "rises" },
        before.window_rms,
        after.window_rms,
        errors.floor.sqrt()
    )
}
