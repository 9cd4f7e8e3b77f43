//! Names and phrases that several sections use.

use crate::effects;
use crate::identify::Status;
use crate::recording::Regime;
use crate::study::{MethodStudy, Study};

/// The wheel of index 0 or 1, as a reader calls it.
pub(super) const WHEELS: [&str; 2] = ["right wheel (1)", "left wheel (2)"];
/// The same without its number, for narrow cells and sentences.
pub(super) const SIDES: [&str; 2] = ["right", "left"];
/// Symbols of the wheel speeds.
pub(super) const OMEGA: [&str; 2] = ["ω₁", "ω₂"];
/// Symbols of the drives.
pub(super) const DRIVE: [&str; 2] = ["M₁", "M₂"];

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

/// A unit with exponents as superscripts: `kg m^2` becomes `kg m²`.
pub(super) fn unit(unit: &str) -> String {
    unit.replace("^2", "²").replace("^3", "³").replace('*', "·")
}

/// A symbol with its number as subscript: `a1` becomes `a₁`; others stay as they are typed.
pub(super) fn symbol(symbol: &str) -> String {
    const SUBSCRIPTS: [char; 10] = ['₀', '₁', '₂', '₃', '₄', '₅', '₆', '₇', '₈', '₉'];
    let stem = symbol.trim_end_matches(|c: char| c.is_ascii_digit());
    if stem.is_empty() || stem.len() == symbol.len() || stem.ends_with('_') {
        return symbol.to_owned();
    }
    let digits = symbol[stem.len()..].bytes().map(|b| SUBSCRIPTS[usize::from(b - b'0')]);
    stem.chars().chain(digits).collect()
}

/// The name of an effect in words; the id where the catalogue does not have it.
pub(super) fn effect(id: &str) -> String {
    effects::find(id).map_or_else(|| id.replace('_', " "), |effect| effect.description().title)
}

/// The name of an effect within a sentence: without its capital, save for people.
pub(super) fn effect_in_text(id: &str) -> String {
    let title = effect(id);
    if ["Coulomb", "Stribeck"].iter().any(|name| title.starts_with(name)) {
        return title;
    }
    let mut letters = title.chars();
    letters.next().map_or(String::new(), |first| first.to_lowercase().chain(letters).collect())
}

/// What a parameter of the catalogue means; empty for others.
pub(super) fn meaning(symbol: &str) -> String {
    let specs = effects::all().into_iter().flat_map(|effect| effect.parameters());
    specs.into_iter().find(|spec| spec.symbol == symbol).map_or(String::new(), |s| s.meaning)
}

/// "a", "a and b", "a, b and c".
pub(super) fn list(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The name of a method, with its options where another method of the study has the same name.
pub(super) fn method(study: &Study, method: &MethodStudy) -> String {
    let same = study.methods.iter().filter(|other| other.name == method.name).count();
    if same > 1 && !method.options.is_empty() {
        format!("{} ({})", method.name, method.options.trim().replace('\n', ", "))
    } else {
        method.name.clone()
    }
}

/// How a method ended.
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

/// The equation of the model's base with the effects added to it.
pub(super) fn model(study: &Study) -> String {
    if study.effects.is_empty() {
        "base model (inertia, centrifugal, Coulomb friction)".to_owned()
    } else {
        format!("base model + {}", study.effects.join(" + "))
    }
}

/// The experiment file in a command.
pub(super) fn file_name(study: &Study) -> String {
    format!("{}.toml", study.experiment)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_and_units_are_set_as_in_print() {
        assert_eq!(symbol("a1"), "a₁");
        assert_eq!(symbol("f_t"), "f_t");
        assert_eq!(symbol("b_1"), "b_1");
        assert_eq!(symbol("12"), "12");
        assert_eq!(unit("kg m^2"), "kg m²");
        let words = ["a", "b", "c"].map(str::to_owned);
        assert_eq!(list(&words), "a, b and c");
        assert_eq!(list(&words[..1]), "a");
    }

    #[test]
    fn effects_outside_the_catalogue_keep_their_id() {
        assert_eq!(effect("cubic_friction"), "cubic friction");
        assert_eq!(effect_in_text("viscous_friction"), "viscous friction");
        assert_eq!(effect_in_text("coulomb_friction"), "Coulomb friction");
        assert!(!meaning("a1").is_empty());
        assert!(meaning("no such symbol").is_empty());
    }
}
