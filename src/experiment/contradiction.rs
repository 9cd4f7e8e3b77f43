//! Estimates of two methods that contradict each other.
//!
//! ```text
//! |θ - θ'| > 4 √(s² + s'²)   and   > a tenth of the larger
//! ```
//! θ: a parameter, or the combination of two that is identifiable, with standard error s. The errors of two methods on the
//! same recordings are not independent; with a positive correlation the limit is the larger.

use crate::diagnose::THRESHOLDS;
use crate::identify::{Contradiction, Note};
use crate::study::{Judged, MethodStudy};

/// Number of joint standard errors from which two estimates contradict each other: by chance one of 16 000 does.
const CONTRADICTS: f64 = 4.0;

/// Adds to the method `reference`, which is shown in detail, and to each that contradicts it, what differs most, and which
/// of both simulates the `judged` recordings better.
pub(super) fn note_contradictions(
    methods: &mut [MethodStudy],
    reference: usize,
    judged: Judged<'_>,
) {
    let own = &methods[reference];
    let error = |m: &MethodStudy| judged.window_rms(&m.performance);
    let of = |(n, other): (usize, &MethodStudy)| {
        let (subject, values) = largest(own, other)?;
        let (errors, held_out) = ([error(own), error(other)], judged.are_held_out());
        let method = other.name.clone();
        Some((n, Contradiction { subject, values, method, errors, held_out }))
    };
    let others = methods.iter().enumerate().filter(|(n, _)| *n != reference);
    let found: Vec<(usize, Contradiction)> = others.filter_map(of).collect();
    let name = own.name.clone();
    for (n, one) in found {
        methods[n].notes.push(Note::Contradiction(one.seen_from(&name)));
        methods[reference].notes.push(Note::Contradiction(one));
    }
}

/// An identifiable quantity, with value and standard error.
type Known = (String, (f64, f64));

/// The parameters that a method identifies, and its combinations of two.
fn known(method: &MethodStudy) -> Vec<Known> {
    let is_known = |value: f64, error: f64| value.is_finite() && error > 0.0 && error.is_finite();
    let estimates = method.estimates.iter().filter(|e| e.identifiable && !e.fixed);
    let single = estimates.map(|e| (e.symbol.clone(), (e.value, e.std_error)));
    let sum = |weight: f64| if weight < 0.0 { "-" } else { "+" };
    let combinations = method.combinations().into_iter().filter(|c| c.weight.abs() == 1.0);
    let pairs = combinations
        .map(|c| (format!("{} {} {}", c.first, sum(c.weight), c.second), (c.value, c.std_error)));
    single.chain(pairs).filter(|(_, (value, error))| is_known(*value, *error)).collect()
}

/// The quantity in which two methods contradict each other by most standard errors, unless one of them states a bias of it.
fn largest(own: &MethodStudy, other: &MethodStudy) -> Option<(String, [(f64, f64); 2])> {
    let theirs = known(other);
    let states_bias = |symbol: &str| {
        let is_of = |note: &Note| match note {
            Note::Biased(biased) => biased.iter().any(|(s, _)| s == symbol),
            Note::Disagreement(moved) => moved.iter().any(|(s, _)| s == symbol),
            _ => false,
        };
        own.notes.iter().chain(&other.notes).any(is_of)
    };
    let apart = |[one, two]: [(f64, f64); 2]| (one.0 - two.0).abs() / one.1.hypot(two.1);
    let pairs = known(own).into_iter().filter_map(|(symbol, one)| {
        let (_, two) = theirs.iter().find(|(s, _)| *s == symbol)?;
        let least = THRESHOLDS.least_difference * one.0.abs().max(two.0.abs());
        let differs = apart([one, *two]) > CONTRADICTS && (one.0 - two.0).abs() > least;
        (differs && !states_bias(&symbol)).then_some((symbol, [one, *two]))
    });
    pairs.max_by(|a, b| apart(a.1).total_cmp(&apart(b.1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::{Estimate, Unknown};

    fn method(name: &str, value: f64, std_error: f64) -> MethodStudy {
        let [first, second] = ["a1", "a2"].map(String::from);
        let unknown = Unknown::Two { first, second, weight: 1.0, value, std_error };
        MethodStudy {
            estimates: vec![Estimate::new("a4", "V".into(), 0.85, 0.02)],
            notes: vec![Note::Unknown { unknown, effect: "inertia".into() }],
            ..MethodStudy::new(name, "", "", 0.0)
        }
    }

    #[test]
    fn an_identifiable_sum_that_differs_by_many_standard_errors_contradicts() {
        let filter = method("prediction_error", 0.003_424, 7.8e-5);
        let regression = method("torque_regression", 0.002_151, 4.4e-5);
        let (subject, values) = largest(&filter, &regression).unwrap();
        assert_eq!((subject.as_str(), values[1].0), ("a1 + a2", 0.002_151));
        // within four standard errors, and within a tenth
        assert!(largest(&filter, &method("torque_regression", 0.003_1, 4.4e-5)).is_none());
        assert!(largest(&filter, &method("torque_regression", 0.002_151, 4e-4)).is_none());
        let exact = method("prediction_error", 0.003_424, 1e-9);
        assert!(largest(&exact, &method("torque_regression", 0.003_3, 1e-9)).is_none());
    }

    #[test]
    fn a_bias_that_is_stated_already_is_no_contradiction() {
        let of = |value: f64, notes: Vec<Note>| MethodStudy {
            estimates: vec![Estimate::new("a1", "kg m^2".into(), value, 1e-3)],
            notes,
            ..MethodStudy::new("torque_regression", "", "", 0.0)
        };
        assert!(largest(&of(0.1, vec![]), &of(0.08, vec![])).is_some());
        let biased = vec![Note::Biased(vec![("a1".into(), -0.02)])];
        assert!(largest(&of(0.1, vec![]), &of(0.08, biased)).is_none());
    }
}
