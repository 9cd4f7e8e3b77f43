//! The verdict of a diagnosis as a text.

mod dependence;
mod effects;
mod error;
mod formula;

pub(super) use self::effects::Logging;
pub(crate) use self::effects::title;

use self::effects::{found, lowered, named, shifts_input, unproven};
use super::dependence::Dependence;
use crate::diagnose::{Conclusion, Diagnosis, Errors};
use crate::study::{FormulaStudy, UnprovenEffect};

/// What a verdict states.
pub(super) struct Statement<'a> {
    /// Whether the columns do not determine the model; then nothing else is stated.
    pub(super) is_undetermined: bool,
    pub(super) conclusion: Conclusion,
    /// What was found, first found first.
    pub(super) diagnosis: &'a Diagnosis,
    pub(super) errors: Errors,
    pub(super) likely: Option<&'a UnprovenEffect>,
    /// What lowers the held-out error without being accepted.
    pub(super) withheld: Option<(&'a UnprovenEffect, Withheld)>,
    /// The rate at which an effect is named where none is missing.
    pub(super) false_alarm: f64,
    pub(super) logging: Logging,
    /// What the residual torque depends on, where that is stated.
    pub(super) dependence: Option<Dependence<'a>>,
    /// That as a formula, beside which no effect of the catalogue is likely.
    pub(super) formula: Option<&'a FormulaStudy>,
    /// Noise floor of the judged recordings under the last model [rad/s].
    pub(super) floor: f64,
}

/// Why an effect that lowers the held-out error is not accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Withheld {
    /// The 2 s simulation error rises.
    Raises,
    /// The sampling of the input leaves as much open.
    BetweenRows,
    /// Its size is within its uncertainty.
    Small,
}

/// The text of a verdict: what is missing, with the error that is left; what is likely beside it; what the residual torque
/// depends on, and a formula of that.
pub(super) fn sentence(statement: &Statement) -> String {
    if statement.is_undetermined {
        return UNDETERMINED.to_owned();
    }
    let mut sentences = concluded(statement);
    sentences.extend(likely_beside(statement));
    let unit = statement.logging.unit;
    sentences.extend(statement.dependence.iter().map(|on| dependence::words(on, unit)));
    sentences.extend(statement.formula.map(|formula| formula::words(formula, statement.floor)));
    sentences.join(" ")
}

/// What is said in place of a comparison with the noise floor.
const UNDETERMINED: &str = "These columns do not determine the model: the fit stalled, and a1 is not identifiable. Its \
                            error is no measure of it.";

/// What is missing, and the error that is left.
fn concluded(stated: &Statement) -> Vec<String> {
    let Statement { conclusion, diagnosis, errors, .. } = stated;
    let error = error::words(errors, diagnosis.steps.len());
    let likely = || stated.likely.map_or(String::new(), unproven);
    let unknown = "Something is missing that the catalogue does not explain.".to_owned();
    match conclusion {
        Conclusion::Sufficient => sufficient(stated, error),
        Conclusion::Missing => {
            let mut out = vec![format!("Missing: {}.", found(diagnosis, &stated.logging)), error];
            // what was found explains the larger part of the error; what is left may be far above the floor all the same
            if errors.far_above_all() {
                out.push("More is missing than was found.".to_owned());
            }
            out
        }
        // so far above its floor something is missing, whatever it is
        Conclusion::Likely if errors.far_above_all() => {
            let likely = format!("Something is missing. Likely, not proven: {}.", likely());
            vec![likely, error]
        }
        Conclusion::Likely => vec![format!("Likely missing, not proven: {}.", likely()), error],
        Conclusion::Unknown if diagnosis.steps.is_empty() => vec![unknown, error],
        Conclusion::Unknown => {
            let mut out =
                vec![unknown, format!("Found: {}.", found(diagnosis, &stated.logging)), error];
            // what was found may take the place of something else; a shift of the input shows in when the wheels move,
            // and nothing else moves them earlier or later
            if !diagnosis.steps.iter().all(|step| shifts_input(&step.id)) {
                let in_place =
                    "What was found may stand for a part of what is not in the catalogue.";
                out.push(in_place.to_owned());
            }
            out
        }
    }
}

/// That nothing is missing, or nothing proven to be.
fn sufficient(stated: &Statement, error: String) -> Vec<String> {
    let rate = format!("at a false-alarm rate of {:.0} %", 100.0 * stated.false_alarm);
    let none = format!("none of the effects of the catalogue is proven {rate}");
    let text = |text: &str| text.to_owned();
    if let Some((effect, why)) = stated.withheld {
        let with = format!(
            "With {} the held-out error falls by {}, but {}.",
            named(&effect.id),
            lowered(effect),
            reason(why)
        );
        return vec![text("Nothing is proven to be missing."), error, with];
    }
    if !stated.errors.above_floor() {
        return vec![format!("Nothing is missing: {none}."), error];
    }
    if !stated.errors.above_input() {
        let faster = text("A recording at the rate of the controller decides.");
        return vec![format!("Nothing is proven to be missing: {none}."), error, faster];
    }
    // the floor is an estimate for white noise: coloured noise of the input reaches so far too
    vec![
        format!(
            "Nothing is proven to be missing: {none}, and no dependence of the residual torque is significant."
        ),
        error,
        text(
            "Coloured noise of the recorded input makes that much, and so does a disturbance from outside.",
        ),
    ]
}

fn reason(why: Withheld) -> &'static str {
    match why {
        Withheld::Raises => {
            "the 2 s simulation error rises with it, as that of a right model may where friction decides when a wheel \
             stops"
        }
        Withheld::BetweenRows => {
            "what the input does between its rows could be the reason as well; a recording at a higher rate decides"
        }
        Withheld::Small => "its size does not differ from zero by more than its uncertainty",
    }
}

/// The effect that is likely beside what was found, or beside what the catalogue does not explain.
fn likely_beside(stated: &Statement) -> Option<String> {
    let beside = matches!(stated.conclusion, Conclusion::Missing | Conclusion::Unknown);
    let likely = stated.likely.filter(|_| beside && stated.formula.is_none())?;
    Some(format!("Likely, not proven: {}.", unproven(likely)))
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::diagnose::WindowFit;
    use crate::model::Model;
    use crate::recording::DriveUnit;
    use crate::robot::Robot;

    fn nothing_found() -> Diagnosis {
        let model = Model::base(Robot::amigobot());
        let (p, free) = (model.initial(), model.parameters().len());
        let covariance = DMatrix::identity(free, free);
        let base = WindowFit { model, p, cost: 1.0, covariance, at_bound: vec![false; free] };
        Diagnosis { base, ranking: vec![], steps: vec![], rest: vec![], validated: true }
    }

    /// A model three times as far from the measurement as its noise floor, of which nothing was found.
    fn unknown(diagnosis: &Diagnosis) -> Statement<'_> {
        let logging = Logging { unit: DriveUnit::NewtonMetre, if_held: None, speeds_alone: false };
        Statement {
            is_undetermined: false,
            conclusion: Conclusion::Unknown,
            diagnosis,
            errors: Errors { before: 9.0, after: 9.0, floor: 1.0, most: 1.0, speed: 1e4 },
            likely: None,
            withheld: None,
            false_alarm: 0.05,
            logging,
            dependence: None,
            formula: None,
            floor: 1.0,
        }
    }

    #[test]
    fn a_verdict_states_its_parts_in_the_order_error_likely_effect_dependence_formula() {
        let diagnosis = nothing_found();
        let likely = UnprovenEffect { id: "slope".into(), lowers: 0.117 };
        let depends = Dependence { shown: None, beside: None, tested: None, is_left: false };
        let stated =
            Statement { likely: Some(&likely), dependence: Some(depends), ..unknown(&diagnosis) };
        let error = "Something is missing that the catalogue does not explain. The 2 s simulation error is 3.0 times \
                     the noise floor.";
        let beside =
            "Likely, not proven: inclined floor (slope), which lowers the held-out error by 12 %.";
        let depends = "The residual torque depends little on anything that was tried; coloured noise of the recorded \
                       input and disturbances from outside look like this too.";
        assert_eq!(sentence(&stated), format!("{error} {beside} {depends}"));
        let formula =
            FormulaStudy { id: "pile".into(), window_rms: 1.04, ..FormulaStudy::default() };
        // beside the formula no effect of the catalogue is likely
        let lowers = "A formula of it (pile) lowers the 2 s simulation error to 1.04 rad/s, the noise floor.";
        let stated = Statement { formula: Some(&formula), ..stated };
        assert_eq!(sentence(&stated), format!("{error} {depends} {lowers}"));
    }

    #[test]
    fn columns_that_do_not_determine_the_model_make_no_effect_likely() {
        let diagnosis = nothing_found();
        let likely = UnprovenEffect { id: "slope".into(), lowers: 0.117 };
        let stated =
            Statement { is_undetermined: true, likely: Some(&likely), ..unknown(&diagnosis) };
        assert_eq!(sentence(&stated), UNDETERMINED);
    }

    #[test]
    fn an_effect_that_is_withheld_is_named_with_the_reason() {
        let diagnosis = nothing_found();
        let effect = UnprovenEffect { id: "wheel_slip".into(), lowers: 0.25 };
        let stated = Statement {
            conclusion: Conclusion::Sufficient,
            withheld: Some((&effect, Withheld::Small)),
            ..unknown(&diagnosis)
        };
        let text = sentence(&stated);
        assert!(text.starts_with("Nothing is proven to be missing. The 2 s"), "{text}");
        let end = "the held-out error falls by 25 %, but its size does not differ from zero by more than its \
                   uncertainty.";
        assert!(text.ends_with(end), "{text}");
    }
}
