//! Commands that rest in the middle of their scale and never at zero: 128 of 8 bits.

use super::guessed::Guessed;
use super::values::values_of;
use crate::io::PreviewColumn;

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
    use super::middle;

    #[test]
    fn a_command_that_rests_in_the_middle_is_centred() {
        let of = |by: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let level = |k: u32| if k < 100 { 0.0 } else { (0.05 * f64::from(k)).sin() };
            (0..400).map(|k| by(level(k)).round()).collect()
        };
        assert_eq!(middle(&of(&|x| 128.0 + 100.0 * x)), Some(128.0));
        assert_eq!(middle(&of(&|x| 255.0 * x.abs())), None);
        assert_eq!(middle(&of(&|x| 128.0 + 200.0 * x)), None);
    }
}
