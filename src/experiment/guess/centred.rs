//! Commands that rest in the middle of their scale and never at zero, 128 of 8 bits, and counts of a converter that do.

use super::guessed::{Guess, Guessed};
use super::values::{values_of, whole};
use crate::io::PreviewColumn;
use crate::math::median_high;

/// Middles of the scales of 8, 10 and 12 bits.
const MIDDLES: [f64; 8] = [127.0, 127.5, 128.0, 511.0, 511.5, 512.0, 2047.0, 2048.0];

/// Part of the rows in which such a command is at rest.
const RESTS: f64 = 0.03;

/// The middle at which all of these inputs begin and rest, and which they leave in both directions.
pub(super) fn centre(columns: &[PreviewColumn], inputs: &[&mut Guessed]) -> Option<f64> {
    let mut found = inputs.iter().map(|one| middle(values_of(columns, &one.name)));
    let first = found.next()??;
    found.all(|other| other == Some(first)).then_some(first)
}

/// Middles of the scales of converters of 10 and 12 bits, and the error of a current sensor's zero on them (judgement: the
/// tolerance of such sensors and of the supply).
const CONVERTERS: [f64; 2] = [511.5, 2047.5];
const ZERO: f64 = 0.03;

/// Asks for the current of one count of inputs in counts of a converter, whose zero is near the middle of its scale, and
/// sets that to zero.
pub(super) fn of_converter(columns: &[PreviewColumn], guess: &mut Guess) {
    let is_input = |c: &&Guessed| c.key.starts_with('M');
    let is_plain = |c: &Guessed| c.unit.is_none() && c.scale.is_none() && c.offset.is_none();
    let zero = |c: &Guessed| is_plain(c).then(|| zero_of_converter(values_of(columns, &c.name)))?;
    let zeros: Option<Vec<f64>> = guess.columns.iter().filter(is_input).map(zero).collect();
    let Some(zeros) = zeros.filter(|zeros| zeros.len() == 2) else { return };
    let inputs = guess.columns.iter_mut().filter(|c| c.key.starts_with('M'));
    let mut names = vec![];
    for (one, zero) in inputs.zip(zeros) {
        (one.offset, one.scale_open) = (Some(-zero), true);
        one.evidence.push(format!("rests at {zero}, near the middle of a converter's scale: zero"));
        names.push(format!("`{}`", one.name));
    }
    guess.ask(format!(
        "{} are counts of a converter: how large is the input for one count (current sensor: supply voltage, over the counts \
         of the scale, over the volts per ampere)? Write it as scale of M1 and M2, and offset = minus the rest value times \
         this scale",
        names.join(" and ")
    ));
}

/// The value at which counts of a converter rest at their beginning, if they leave it in both directions.
fn zero_of_converter(values: &[f64]) -> Option<f64> {
    let held: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let first = median_high(held.get(..REST_ROWS)?.iter().copied());
    let middle = CONVERTERS.into_iter().find(|m| (first - m).abs() < ZERO * m)?;
    let low = held.iter().copied().fold(first, f64::min);
    let high = held.iter().copied().fold(first, f64::max);
    let leaves = low < first - ZERO * middle && first + ZERO * middle < high;
    (whole(&held) && low >= 0.0 && high <= 2.0 * middle + 1.0 && leaves).then_some(first)
}

/// Rows at the beginning of a log in which the robot rests (judgement).
const REST_ROWS: usize = 10;

/// Whether both inputs rest in the middle of their scale.
pub(super) fn are_centred(columns: &[PreviewColumn], pair: &[Guessed; 2]) -> bool {
    let [a, b] = pair.each_ref().map(|one| middle(values_of(columns, &one.name)));
    a.is_some() && a == b
}

/// Sets the middle to zero by an offset.
pub(super) fn shift(inputs: &mut [&mut Guessed], centre: f64) {
    for one in inputs {
        one.offset = Some(-centre);
        one.evidence.push(format!("rests at {centre}, the middle of its scale: zero"));
    }
}

/// The middle of a scale at which values rest.
fn middle(values: &[f64]) -> Option<f64> {
    let held = || values.iter().copied().filter(|v| v.is_finite());
    let first = held().next().filter(|first| MIDDLES.contains(first))?;
    let (low, high) = held().fold((first, first), |(a, b), v| (a.min(v), b.max(v)));
    let count = |value: f64| held().filter(|v| *v == value).count();
    let rests = count(first) as f64 > RESTS * held().count() as f64;
    let spreads = 0.0 <= low && low < first && first < high && high <= 2.0 * first + 1.0;
    // a magnitude rests at zero
    (rests && spreads && count(first) > count(0.0)).then_some(first)
}

#[cfg(test)]
mod tests {
    use super::{middle, zero_of_converter};

    #[test]
    fn a_command_that_rests_in_the_middle_is_centred() {
        let of = |by: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let level = |k: u32| if k < 100 { 0.0 } else { (0.05 * f64::from(k)).sin() };
            (0..400).map(|k| by(level(k)).round()).collect()
        };
        assert_eq!(middle(&of(&|x| 128.0 + 100.0 * x)), Some(128.0));
        assert_eq!(middle(&of(&|x| 255.0 * x.abs())), None);
        assert_eq!(middle(&of(&|x| 128.0 + 200.0 * x)), None);
        // the zero of a current sensor is not exactly the middle
        assert_eq!(zero_of_converter(&of(&|x| 509.0 + 60.0 * x)), Some(509.0));
        assert_eq!(zero_of_converter(&of(&|x| 509.0 + 60.0 * x.abs())), None);
        assert_eq!(zero_of_converter(&of(&|x| 60.0 * x)), None);
    }
}
