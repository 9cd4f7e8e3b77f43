//! Text of the verdict of a diagnosis, with the evidence for each candidate and the recommended recording.

mod dependence;
mod effects;
mod error;
mod evidence;
mod formula;
mod next;
mod undetermined;

pub(super) use self::effects::shifts_input;
use self::effects::{found, judged, lowered, named, unproven};
use crate::diagnose::Difference;
use crate::report::format::{in_text, percent};
use crate::report::words::simulation_error_over;
use crate::study::{DiagnosisStudy, FAR_BELOW_FLOOR, MethodAtFloor, Verdict, Withheld};

pub(crate) use self::effects::title;
pub(super) use self::error::caused;
pub use self::evidence::evidence;
pub use self::next::recommendation;
pub(super) use self::next::recommends;
pub use self::undetermined::not_determined;

/// The text of a verdict: the missing effects with the remaining error; likely further effects; the
/// dependence of the residual torque, and a formula for it.
#[must_use]
pub fn sentence(diagnosis: &DiagnosisStudy) -> String {
    sentences(diagnosis).join(" ")
}

/// The sentences of a verdict: the missing effects with the remaining error; likely further effects; the
/// dependence of the residual torque, and a formula for it.
#[must_use]
pub(super) fn sentences(diagnosis: &DiagnosisStudy) -> Vec<String> {
    if let Some(why) = diagnosis.undetermined {
        return vec![not_determined(why)];
    }
    let DiagnosisStudy { errors, logging, differs, dependence, formula, .. } = diagnosis;
    let mut sentences = concluded(diagnosis);
    sentences.extend(likely_beside(diagnosis));
    sentences.extend(differs.iter().map(differs_words));
    sentences.extend(dependence.iter().map(|on| dependence::words(on, logging.unit)));
    sentences.extend(
        formula.iter().map(|formula| formula::words(formula, errors, &judged_error(diagnosis))),
    );
    sentences
}

/// The name of the judged simulation error.
fn judged_error(diagnosis: &DiagnosisStudy) -> String {
    simulation_error_over(diagnosis.logging.longest_s)
}

/// States that the recordings differ, with the parameter that differs most significantly.
fn differs_words(difference: &Difference) -> String {
    let Difference { recording, symbol, share, std_error } = difference;
    let side = if *share < 0.0 { "smaller" } else { "larger" };
    format!(
        "The recordings differ: {symbol} of {recording} is {} ± {} {side} than in the others. If load, tyres or battery \
         were changed between recordings, fit them separately.",
        percent(share.abs()),
        percent(*std_error)
    )
}

/// The missing effects and the remaining error.
fn concluded(diagnosis: &DiagnosisStudy) -> Vec<String> {
    let DiagnosisStudy { errors, effects, .. } = diagnosis;
    let error = error::words(errors, effects.len(), &judged_error(diagnosis));
    let likely = || diagnosis.unproven.as_ref().map_or(String::new(), unproven);
    let unknown = "An effect outside the catalogue is missing.".to_owned();
    match diagnosis.verdict {
        Verdict::ModelSufficient => sufficient(diagnosis, error),
        Verdict::EffectsMissing => {
            let mut out = vec![format!("Missing: {}.", found(diagnosis)), error];
            // the effects found explain the larger part of the error; the remaining error may still be far
            // above the floor
            if errors.far_above_all() {
                out.push("Further effects are missing.".to_owned());
            }
            out
        }
        // this far above the floor something is missing, even if it is not known
        Verdict::EffectLikely if errors.far_above_all() => {
            let likely = format!("An effect is missing. Likely, but not proven: {}.", likely());
            vec![likely, error]
        }
        Verdict::EffectLikely => vec![format!("Likely missing, not proven: {}.", likely()), error],
        Verdict::UnknownEffect if effects.is_empty() => vec![unknown, error],
        Verdict::UnknownEffect => {
            let mut out = vec![unknown, format!("Found: {}.", found(diagnosis)), error];
            // the effects found may approximate another effect; a shift of the input is identified by the
            // time of the motion, which no other effect changes
            if !effects.iter().all(|effect| shifts_input(&effect.id)) {
                let in_place = "The effects found may approximate part of the missing one.";
                out.push(in_place.to_owned());
            }
            out
        }
    }
}

/// States that nothing is missing, or that nothing is proven to be missing.
fn sufficient(stated: &DiagnosisStudy, error: String) -> Vec<String> {
    let rate = format!("at a false-alarm rate of {:.0} %", 100.0 * stated.false_alarm);
    let nothing =
        || format!("Nothing is missing: none of the effects of the catalogue is proven {rate}.");
    let not_proven = format!("Nothing is proven to be missing {rate}");
    let text = |text: &str| text.to_owned();
    if let Some((effect, why)) = &stated.withheld {
        let with = format!(
            "With {} {} falls by {}, but {}.",
            named(&effect.id),
            judged(effect),
            lowered(effect),
            reason(*why)
        );
        return vec![text("Nothing is proven to be missing."), error, with];
    }
    if stated.errors.ratio() < FAR_BELOW_FLOOR {
        return vec![not_proven + ".", error];
    }
    if !stated.errors.above_floor() {
        return vec![nothing(), error];
    }
    if let Some(MethodAtFloor { method, ratio }) = &stated.at_floor {
        let sufficient = format!(
            "As fitted by {method}, the same model is at the noise floor of the validation recordings ({ratio:.2} times \
             it), so its structure is sufficient."
        );
        let own = format!("The fit of the diagnosis is not: {}", in_text(&error));
        return vec![nothing(), sufficient, own];
    }
    if !stated.errors.above_input() {
        let faster = text("To decide, record at the rate of the controller.");
        return vec![not_proven + ".", error, faster];
    }
    if !stated.errors.above_all() {
        return vec![not_proven + ".", error];
    }
    if stated.errors.slow_floor {
        let slow = "Most of the noise floor is slow noise of the recorded input, which was estimated while the robot rests \
                    and is known to within a factor of two at best. To decide, record longer rests.";
        return vec![not_proven + ".", error, text(slow)];
    }
    // the floor assumes white noise: coloured noise of the input can cause such an error too
    vec![
        not_proven + ", and no dependence of the residual torque is significant.",
        error,
        text(
            "Coloured noise of the recorded input or an external disturbance can cause an error of this size.",
        ),
    ]
}

fn reason(why: Withheld) -> String {
    let text = match why {
        Withheld::Raises => {
            "the simulation error rises; a correct model can show this where friction determines when a wheel stops"
        }
        Withheld::BetweenRows => {
            "the input between its rows could cause the same; record at a higher rate to decide"
        }
        Withheld::Small => "its size does not differ significantly from zero",
        Withheld::Idle => {
            "it does not act in the held-out recordings by more than noise of their input, so that they do not test it"
        }
        Withheld::Short { windows, parameters } => {
            return format!(
                "the training recordings are too short to prove it: {windows} windows of 1 s for {parameters} \
                 parameters; record at least {} s",
                2 * parameters
            );
        }
    };
    text.to_owned()
}

/// The likely effect in addition to the effects found, or to a dependence that the catalogue does not
/// explain.
fn likely_beside(stated: &DiagnosisStudy) -> Option<String> {
    let beside = matches!(stated.verdict, Verdict::EffectsMissing | Verdict::UnknownEffect);
    let likely = stated.likely().filter(|_| beside)?;
    Some(format!("Likely, but not proven: {}.", unproven(likely)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::Errors;
    use crate::recording::DriveUnit;
    use crate::study::Undetermined;
    use crate::study::{DependenceStudy, FormulaStudy, Logging, UnprovenEffect};

    /// A model three times as far from the measurement as its noise floor, of which nothing was found.
    fn unknown() -> DiagnosisStudy {
        DiagnosisStudy {
            verdict: Verdict::UnknownEffect,
            errors: Errors {
                before: 9.0,
                after: 9.0,
                floor: 1.0,
                most: 1.0,
                uncertain: 0.0,
                slow_floor: false,
                speed: 1e4,
            },
            found: vec![],
            unproven: None,
            withheld: None,
            logging: Logging {
                unit: DriveUnit::NewtonMetre,
                if_held: None,
                speeds_alone: false,
                longest_s: 60.0,
            },
            at_floor: None,
            differs: None,
            dependence: None,
            parameters: vec![],
            correlations: vec![],
            ranking: vec![],
            staircase: vec![],
            next: vec![],
            proposal: None,
            false_alarm: 0.05,
            effects: vec![],
            formula: None,
            undetermined: None,
        }
    }

    #[test]
    fn a_verdict_states_its_parts_in_the_order_error_likely_effect_dependence_formula() {
        let likely = UnprovenEffect { id: "slope".into(), lowers: 0.117, crossed: false };
        let depends = DependenceStudy {
            shown: None,
            beside: None,
            tested: None,
            is_left: false,
            events: None,
        };
        let stated =
            DiagnosisStudy { unproven: Some(likely), dependence: Some(depends), ..unknown() };
        let error = "An effect outside the catalogue is missing. The 2 s simulation error is 3.0 times the noise floor.";
        let beside = "Likely, but not proven: inclined floor (slope), which lowers the error of held-out windows of 1 s by 12 %.";
        let depends = "The residual torque does not depend clearly on any variable that was tried; coloured noise of the \
                       recorded input and external disturbances look the same.";
        assert_eq!(sentence(&stated), format!("{error} {beside} {depends}"));
        let formula =
            FormulaStudy { id: "pile".into(), window_rms: 1.04, ..FormulaStudy::default() };
        // with the formula no effect of the catalogue is likely
        let lowers = "A formula for this dependence (pile) lowers the 2 s simulation error to 1.04 rad/s, at the noise floor.";
        let stated = DiagnosisStudy { formula: Some(formula), ..stated };
        assert_eq!(sentence(&stated), format!("{error} {depends} {lowers}"));
        assert_eq!(stated.likely(), None);
        // but a verdict "likely" names the effect
        let stated = DiagnosisStudy { verdict: Verdict::EffectLikely, ..stated };
        assert_eq!(stated.likely().map(|likely| likely.id.as_str()), Some("slope"));
    }

    #[test]
    fn columns_that_do_not_determine_the_model_make_no_effect_likely() {
        let likely = UnprovenEffect { id: "slope".into(), lowers: 0.117, crossed: false };
        let stated = DiagnosisStudy {
            undetermined: Some(Undetermined::Columns),
            unproven: Some(likely),
            ..unknown()
        };
        assert_eq!(sentence(&stated), not_determined(Undetermined::Columns));
        assert_eq!(stated.likely(), None);
    }

    #[test]
    fn too_few_windows_leave_open_what_is_missing_and_not_that_the_model_fails() {
        let on = |validated, fails| {
            not_determined(Undetermined::Untested { windows: 2, validated, fails })
        };
        let of = |fails| on(true, fails);
        let few = "the validation recordings have 2 windows of 1 s, too few for a comparison of two models.";
        assert_eq!(of(None), format!("Whether an effect is missing cannot be tested: {few}"));
        let fails = "Something is missing: on the recordings that were fitted the 2 s simulation error is 6.1 times the \
                     noise floor. Which effect it is cannot be tested";
        assert_eq!(of(Some(6.1)), format!("{fails}: {few}"));
        // without validation recordings effects are tested on those of the training
        assert!(on(false, None).contains("the training recordings have 2 windows"));
    }

    #[test]
    fn an_effect_that_is_withheld_is_named_with_the_reason() {
        let effect = UnprovenEffect { id: "wheel_slip".into(), lowers: 0.25, crossed: false };
        let stated = DiagnosisStudy {
            verdict: Verdict::ModelSufficient,
            withheld: Some((effect, Withheld::Small)),
            ..unknown()
        };
        let text = sentence(&stated);
        assert!(text.starts_with("Nothing is proven to be missing. The 2 s"), "{text}");
        let end = "the error of held-out windows of 1 s falls by 25 %, but its size does not differ significantly from zero.";
        assert!(text.ends_with(end), "{text}");
        let idle = DiagnosisStudy {
            withheld: Some((stated.withheld.unwrap().0, Withheld::Idle)),
            ..unknown()
        };
        assert!(
            sentence(&DiagnosisStudy { verdict: Verdict::ModelSufficient, ..idle })
                .ends_with("so that they do not test it.")
        );
    }

    #[test]
    fn recordings_with_fewer_windows_than_parameters_are_reported_as_too_short() {
        let effect = UnprovenEffect { id: "wheel_slip".into(), lowers: 0.25, crossed: false };
        let short = Withheld::Short { windows: 6, parameters: 8 };
        let verdict = Verdict::ModelSufficient;
        let text =
            sentence(&DiagnosisStudy { verdict, withheld: Some((effect, short)), ..unknown() });
        assert!(
            text.ends_with("6 windows of 1 s for 8 parameters; record at least 16 s."),
            "{text}"
        );
    }

    #[test]
    fn a_method_at_the_floor_shows_that_the_structure_is_sufficient() {
        let at_floor = MethodAtFloor { method: "torque_regression".into(), ratio: 0.954 };
        let verdict = Verdict::ModelSufficient;
        let stated = DiagnosisStudy { verdict, at_floor: Some(at_floor), ..unknown() };
        let text = sentence(&stated);
        assert!(text.starts_with("Nothing is missing: none of the effects"), "{text}");
        assert!(
            text.contains("As fitted by torque_regression, the same model is at the noise floor")
        );
        assert!(text.ends_with("is not: the 2 s simulation error is 3.0 times the noise floor."));
        assert!(!stated.is_open());
        let open = DiagnosisStudy { at_floor: None, ..stated };
        assert!(open.is_open());
        assert!(sentence(&open).starts_with("Nothing is proven to be missing at a false-alarm"));
    }

    #[test]
    fn a_floor_of_slow_noise_is_reported_as_rough() {
        let errors = Errors {
            before: 4.0,
            after: 4.0,
            floor: 1.0,
            most: 1.0,
            uncertain: 0.0,
            slow_floor: true,
            speed: 1e4,
        };
        let stated = DiagnosisStudy { verdict: Verdict::ModelSufficient, errors, ..unknown() };
        let text = sentence(&stated);
        assert!(text.contains("slow noise of the recorded input"), "{text}");
        assert!(!text.contains("no dependence"), "{text}");
    }
}
