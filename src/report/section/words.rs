//! Names and phrases common to several sections.

use crate::effects;
use crate::identify::{Estimate, Status};
use crate::recording::Regime;
use crate::report::format;
pub(super) use crate::report::format::unit;
pub(super) use crate::report::words::simulation_error;
use crate::study::{MethodStudy, Study};

/// The wheel with index 0 or 1 in text.
pub(super) const WHEELS: [&str; 2] = ["right wheel (1)", "left wheel (2)"];
/// The same without its number, for narrow cells and sentences.
pub(super) const SIDES: [&str; 2] = ["right", "left"];
/// How to read estimates with their intervals.
pub(super) const INTERVALS: &str =
    "The data are compatible with every value inside the 95 % interval, if the model is correct.";
/// Symbols of the wheel speeds.
pub(super) const OMEGA: [&str; 2] = ["ω₁", "ω₂"];
/// Symbols of the inputs.
pub(super) const INPUT: [&str; 2] = ["M₁", "M₂"];

/// A regime in a sentence: "pivot to the left".
pub(super) fn regime(regime: Regime) -> String {
    match regime {
        Regime::PivotLeft => "pivot to the left",
        Regime::PivotRight => "pivot to the right",
        Regime::CurveLeft => "left curve",
        Regime::CurveRight => "right curve",
        Regime::CurveLeftBackward => "left curve backward",
        Regime::CurveRightBackward => "right curve backward",
        other => return other.name().replace('_', " "),
    }
    .to_owned()
}

/// The title of an effect; the id if it is not in the catalogue.
pub(super) fn effect(id: &str) -> String {
    let own = || format::capital(&id.replace('_', " "));
    effects::find(id).map_or_else(own, |effect| effect.description().title)
}

/// The title of an effect within a sentence: without its capital, except for names of persons.
pub(super) fn effect_in_text(id: &str) -> String {
    format::in_text(&effect(id))
}

/// Meaning of a parameter of the catalogue; empty for others.
pub(super) fn meaning(symbol: &str) -> String {
    let specs = effects::all().into_iter().flat_map(|effect| effect.parameters());
    specs.into_iter().find(|spec| spec.symbol == symbol).map_or(String::new(), |s| s.meaning)
}

/// Caution for an estimate outside the physical range of its parameter.
pub(super) fn out_of_range(estimate: &Estimate) -> Option<String> {
    let effects = effects::all();
    let specs = effects.iter().map(|effect| (effect, effect.parameters()));
    let (effect, spec) = specs
        .filter_map(|(e, specs)| {
            Some((e, specs.into_iter().find(|s| s.symbol == estimate.symbol)?))
        })
        .next()?;
    let (low, high) = spec.range;
    // ranges are valid for torques in N m, not for inputs in other units
    if spec.unit != estimate.unit {
        return None;
    }
    if estimate.fixed || (low..=high).contains(&estimate.value) || estimate.value.is_nan() {
        return None;
    }
    let (near, side) = if estimate.value < low { (low, "below") } else { (high, "above") };
    let far = (estimate.value - near).abs() > 2.0 * estimate.std_error;
    let cause = if far {
        "it compensates for another effect that the model lacks"
    } else {
        "the difference is within its uncertainty, so the effect may be absent"
    };
    let id = effect.id();
    let base = effects::BASE.contains(&id.as_str());
    let remedy = if base { String::new() } else { format!("; remove {id} from the model") };
    Some(format!(
        "{} = {} is {side} {}, outside its physical range: {cause}{remedy}",
        estimate.symbol,
        format::with_unit(estimate.value, &unit(&estimate.unit)),
        if near == 0.0 { "0".to_owned() } else { format::with_unit(near, &unit(&estimate.unit)) },
    ))
}

/// "a", "a and b", "a, b and c".
pub(super) fn list(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The name of a method, with its options if another method of the study has the same name.
pub(super) fn method(study: &Study, method: &MethodStudy) -> String {
    let same = study.methods.iter().filter(|other| other.name == method.name).count();
    if same > 1 && !method.options.is_empty() {
        format!("{} ({})", method.name, method.options.trim().replace('\n', ", "))
    } else {
        method.name.clone()
    }
}

/// Status of a method.
pub(super) fn status(method: &MethodStudy) -> &'static str {
    if method.failure.is_some() {
        return "failed";
    }
    match method.status {
        Some(Status::IterationLimit) => "reached the iteration limit",
        Some(Status::Stalled) => "stalled",
        Some(Status::Converged) => "converged",
        None => "–",
    }
}

/// The base model with the added effects: "base model + back-EMF".
pub(super) fn model(effects: &[String]) -> String {
    let added = effects.iter().map(|id| effect_in_text(id));
    std::iter::once("base model".to_owned()).chain(added).collect::<Vec<_>>().join(" + ")
}

/// Reference to the corresponding figure of the paper, for its movement; otherwise empty.
pub(super) fn in_paper(study: &Study, figure: &str) -> String {
    if study.of_paper { format!(" The paper shows this as {figure}.") } else { String::new() }
}

/// Short name of the model as given: "base model".
pub(super) fn given(study: &Study) -> String {
    let is_fuzzy = study.reference_method().is_some_and(|m| m.fuzzy.is_some());
    let undiagnosed = study.diagnosis.is_none();
    let delay = undiagnosed && has_fitted_delay(study);
    match study.effects.len() - usize::from(delay && !study.effects.is_empty()) {
        _ if is_fuzzy && undiagnosed => "fuzzy system".to_owned(),
        0 => format!("base model{}", with_delay(delay)),
        _ => format!("model as given{}", with_delay(delay)),
    }
}

/// The model that the methods fit: as given, with a delay of the input for a dead time.
pub(super) fn fitted(study: &Study) -> String {
    match study.diagnosis {
        Some(_) => given(study) + with_delay(has_fitted_delay(study)),
        None => given(study),
    }
}

/// Whether the methods fit a delay that the model of the file does not have.
pub(super) fn has_fitted_delay(study: &Study) -> bool {
    study.timing.is_ok_and(|timing| timing.is_late())
}

fn with_delay(delay: bool) -> &'static str {
    if delay { " with a delay" } else { "" }
}

/// The effects found: "turning scrub and slope".
pub(super) fn found(study: &Study) -> String {
    let effects = study.diagnosis.iter().flat_map(|d| &d.effects);
    list(&effects.map(|e| format::in_text(&e.title)).collect::<Vec<_>>())
}

/// Short name of the model with the effects found: "with turning scrub"; with a count if there are many.
pub(super) fn added(study: &Study) -> String {
    match study.diagnosis.as_ref().map_or(0, |d| d.effects.len()) {
        1 => format!("with {}", found(study)),
        many => format!("with {many} effects"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_estimate_beyond_its_range_states_what_that_means() {
        let of = |value, error| {
            out_of_range(&Estimate::new("f_t", "N m".to_owned(), value, error)).unwrap_or_default()
        };
        assert_eq!(of(0.01, 0.001), "");
        let absent = of(-1e-4, 1e-4);
        assert!(absent.starts_with("f_t = −1 × 10⁻⁴ N m is below 0, outside"), "{absent}");
        assert!(absent.contains("may be absent; remove turning_scrub from"), "{absent}");
        assert!(of(-0.01, 1e-3).contains("another effect that the model lacks"));
    }

    #[test]
    fn lists_read_as_in_a_sentence() {
        let words = ["a", "b", "c"].map(str::to_owned);
        assert_eq!(list(&words), "a, b and c");
        assert_eq!(list(&words[..1]), "a");
    }

    #[test]
    fn effects_outside_the_catalogue_keep_their_id() {
        assert_eq!(effect("cubic_friction"), "Cubic friction");
        assert_eq!(effect_in_text("viscous_friction"), "viscous friction");
        assert_eq!(effect_in_text("coulomb_friction"), "Coulomb friction");
        assert!(!meaning("a1").is_empty());
        assert!(meaning("no such symbol").is_empty());
    }
}
