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

/// "f_t = 0.0202 N m (95 %: 0.0198 to 0.0206)", "c = 8.7 × 10⁻⁵ A s²/rad² (95 %: 4.6 to 12.8 × 10⁻⁵)".
fn size(e: &Estimate) -> String {
    let (low, high) = e.interval;
    let place = |v: f64| v.abs().log10().floor();
    let exponent = place(e.value.abs().max(e.std_error));
    // to the first digit of the standard error, and to two digits of the value
    let last = place(e.std_error).min(exponent - 1.0);
    let power = if (-3.0..5.0).contains(&exponent) { 0.0 } else { exponent };
    let decimals = (power - last).clamp(0.0, 9.0) as usize;
    let fixed = |v: f64| format::fixed(v / 10f64.powf(power), decimals);
    let times = match power {
        0.0 => String::new(),
        power => format!(" × {}", format::power_of_ten(power as i32)),
    };
    let unit = format::unit(&e.unit);
    let unit = if unit.is_empty() || unit == "1" { String::new() } else { format!(" {unit}") };
    format!(
        "{} = {}{times}{unit} (95 %: {} to {}{times})",
        e.symbol,
        fixed(e.value),
        fixed(low),
        fixed(high)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_the_digits_that_their_error_leaves() {
        let of = |value, error, unit: &str| {
            let interval = (value - 1.96 * error, value + 1.96 * error);
            size(&Estimate { interval, ..Estimate::new("c", unit.to_owned(), value, error) })
        };
        assert_eq!(of(0.0202, 2e-4, "N m"), "c = 0.0202 N m (95 %: 0.0198 to 0.0206)");
        let drag = of(8.7e-5, 2.1e-5, "A s^2/rad^2");
        assert_eq!(drag, "c = 8.7 × 10⁻⁵ A s²/rad² (95 %: 4.6 to 12.8 × 10⁻⁵)");
        assert_eq!(of(2.496e-5, 7.7e-7, ""), "c = 2.50 × 10⁻⁵ (95 %: 2.35 to 2.65 × 10⁻⁵)");
        assert_eq!(of(12.0, 3.0, "1"), "c = 12 (95 %: 6 to 18)");
    }
}
