//! Text on effects: names, sizes, and what logging may explain.

use crate::effects::Change;
use crate::identify::Estimate;
use crate::report::format;
use crate::study::{DiagnosisStudy, FoundEffect, Logging, UnprovenEffect};

/// Largest number of parameters of an effect in a sentence.
const SIZES: usize = 2;

/// The effects found, each with its size and the effects that these data do not distinguish from it.
pub(super) fn found(diagnosis: &DiagnosisStudy) -> String {
    let name = |effect: &FoundEffect| {
        let sized = sized(diagnosis, effect) + &by_logging(&effect.id, &diagnosis.logging);
        match effect.indistinguishable.as_slice() {
            [] => sized,
            equals => {
                let equals: Vec<String> = equals.iter().map(|id| title(id)).collect();
                format!("{sized} (or {}: not distinguishable from these data)", equals.join(" or "))
            }
        }
    };
    diagnosis.effects.iter().map(name).collect::<Vec<_>>().join(", then ")
}

/// "turning scrub (turning_scrub), which lowers the error of held-out windows of 1 s by 12 %".
pub(super) fn unproven(effect: &UnprovenEffect) -> String {
    format!("{}, which lowers {} by {}", named(&effect.id), judged(effect), lowered(effect))
}

/// The error that was judged: over 1 s, where the errors of the report are over 2 s.
pub(super) fn judged(effect: &UnprovenEffect) -> &'static str {
    if effect.crossed {
        "the error of windows of 1 s in cross-validation"
    } else {
        "the error of held-out windows of 1 s"
    }
}

/// "turning scrub (turning_scrub)".
pub(super) fn named(id: &str) -> String {
    format!("{} ({id})", title(id))
}

/// "12 %": the reduction of that error.
pub(super) fn lowered(effect: &UnprovenEffect) -> String {
    format!("{:.0} %", 100.0 * effect.lowers)
}

/// The title of an effect of the catalogue within a sentence; for others the id as words.
pub(crate) fn title(id: &str) -> String {
    let known = crate::effects::find(id).map(|effect| effect.description().title);
    known.map_or_else(|| id.replace('_', " "), |title| format::in_text(&title))
}

/// Whether an effect of the catalogue shifts the input in time.
pub(in crate::report) fn shifts_input(id: &str) -> bool {
    crate::effects::find(id).is_some_and(|e| e.change() == Change::TimeShift)
}

/// "turning scrub (turning_scrub), f_t = 0.0202 N m (95 %: 0.0198 to 0.0206)"; of several parameters the
/// first two estimated ones.
fn sized(diagnosis: &DiagnosisStudy, effect: &FoundEffect) -> String {
    let FoundEffect { id, title, .. } = effect;
    let parameters = diagnosis.parameters.iter();
    let sizes: Vec<String> = parameters
        .filter(|p| p.effect == *id && !p.estimate.fixed && p.estimate.std_error.is_finite())
        .take(SIZES)
        .map(|p| size(&p.estimate))
        .collect();
    let name = format::in_text(title);
    match sizes.as_slice() {
        [] => format!("{name} ({id})"),
        sizes => format!("{name} ({id}), {}", sizes.join(", ")),
    }
}

/// The part of a shift of the input that may not be a property of the actuator: half a row for an input that
/// is held between its rows, all of it if the speed sensor may be delayed.
fn by_logging(id: &str, logging: &Logging) -> String {
    if !shifts_input(id) {
        return String::new();
    }
    let held = logging.if_held.map_or_else(String::new, |time| {
        let time = format::digits(time, 2);
        format!(", of which {time} s come from sampling if the input is held between its rows")
    });
    let sensor = match logging.speeds_alone {
        true => ", unless the speed sensor is late (recorded angles would show which)",
        false => "",
    };
    held + sensor
}

/// "f_t = 0.0202 N m (95 %: 0.0198 to 0.0206)".
fn size(e: &Estimate) -> String {
    let (low, high) = e.interval;
    // to the first digit of the standard error
    let decimals = (-e.std_error.log10().floor()).clamp(0.0, 9.0) as usize;
    let fixed = |v: f64| format::fixed(v, decimals);
    let unit = format::unit(&e.unit);
    let unit = if unit.is_empty() || unit == "1" { String::new() } else { format!(" {unit}") };
    format!("{} = {}{unit} (95 %: {} to {})", e.symbol, fixed(e.value), fixed(low), fixed(high))
}
