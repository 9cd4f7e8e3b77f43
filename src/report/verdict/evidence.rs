//! Text on the evidence for a candidate.

use super::error::removed;
use super::judged_error;
use crate::diagnose::{Errors, explainable};
use crate::report::format::fixed;
use crate::study::{CandidateStudy, DiagnosisStudy};

/// "removes 92 % of the mean square error above the noise floor: the 2 s simulation error falls from …"; for a
/// candidate without computed errors, the likelihood ratios of the screening.
#[must_use]
pub fn evidence(candidate: &CandidateStudy, diagnosis: &DiagnosisStudy) -> String {
    stated(candidate, &diagnosis.errors, &judged_error(diagnosis))
}

fn stated(candidate: &CandidateStudy, errors: &Errors, named: &str) -> String {
    let CandidateStudy { before, after: Some(after), .. } = candidate else {
        return format!(
            "not refitted (likelihood ratio {:.0} by regression, {:.0} over the windows)",
            candidate.by_regression, candidate.by_windows
        );
    };
    let square = before.window_rms.powi(2);
    let gained = square - after.window_rms.powi(2);
    let share = explainable(square, errors.floor).filter(|_| gained > 0.0).map(|whole| {
        let left = (1.0 - gained / whole).clamp(0.0, 1.0);
        format!("removes {} of the mean square error above the noise floor: ", removed(left))
    });
    let [from, to] = [before, after].map(|error| fixed(error.window_rms, 4));
    let floor = fixed(errors.floor.sqrt(), 4);
    let changed = match gained > 0.0 {
        _ if from == to => format!("leaves the {named} at {from} rad/s"),
        true => {
            let share = share.unwrap_or_default();
            format!("{share}the {named} falls from {from} to {to} rad/s")
        }
        false => format!("the {named} rises from {from} to {to} rad/s"),
    };
    format!("{changed} (noise floor {floor})")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::Judgement;

    fn said(before: f64, after: f64) -> String {
        let judged = |window_rms| Judgement { ise: 1.0, window_rms };
        let candidate = CandidateStudy {
            effect: "slope".into(),
            probability: 0.5,
            no_better: false,
            indistinguishable: vec![],
            p_value: 0.5,
            log_significance: 1.0,
            evidence: 1.0,
            delta_bic: 2.0,
            before: judged(before),
            after: Some(judged(after)),
            by_regression: 1.0,
            by_windows: 1.0,
            parameters: vec![],
            torque_rms: 0.1,
        };
        let errors = Errors {
            before: before * before,
            after: after * after,
            floor: 0.05 * 0.05,
            most: 0.05 * 0.05,
            uncertain: 0.0,
            slow_floor: false,
            speed: 1e4,
        };
        stated(&candidate, &errors, "2 s simulation error")
    }

    #[test]
    fn an_error_that_does_not_fall_is_not_reported_as_removed() {
        assert_eq!(
            said(0.25, 0.15),
            "removes 67 % of the mean square error above the noise floor: the 2 s simulation error falls from 0.2500 to \
             0.1500 rad/s (noise floor 0.0500)"
        );
        assert!(said(0.25, 0.2499).starts_with("removes less than 1 % of"));
        assert!(said(0.25, 0.26).starts_with("the 2 s simulation error rises from 0.2500 to"));
        assert!(said(0.05, 0.050_01).starts_with("leaves the 2 s simulation error at 0.0500"));
        // at the floor there is nothing to remove
        assert!(said(0.0505, 0.0501).starts_with("the 2 s simulation error falls from 0.0505"));
    }
}
