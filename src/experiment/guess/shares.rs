//! The voltage of a motor in addition to the duty cycle.

use super::commands::is_share_word;
use super::guessed::Candidate;
use super::names::Quantity;

/// Part of the square of a voltage that its share must explain: a battery sags.
const EXPLAINED: f64 = 0.9;

/// Whether the second of two inputs is the voltage of which the first is the share of the battery voltage.
pub(super) fn is_volts_of(share: &Candidate, volts: &Candidate) -> bool {
    let is_input = |c: &Candidate| c.named.quantity == Some(Quantity::Voltage) && !c.named.battery;
    let says_volts = |c: &Candidate| c.named.unit == Some("V") || c.named.word.starts_with("volt");
    is_input(share)
        && is_input(volts)
        && share.named.side == volts.named.side
        && is_share_word(&share.column.name)
        && !says_volts(share)
        && says_volts(volts)
        && follows(&share.column.values, &volts.column.values)
}

/// Whether a column is nearly a multiple of another.
fn follows(a: &[f64], b: &[f64]) -> bool {
    let rows = || a.iter().zip(b).filter(|(a, b)| a.is_finite() && b.is_finite());
    let sum = |of: fn((&f64, &f64)) -> f64| rows().map(of).sum::<f64>();
    let (aa, bb, ab) = (sum(|(a, _)| a * a), sum(|(_, b)| b * b), sum(|(a, b)| a * b));
    ab > 0.0 && ab * ab > EXPLAINED * aa * bb
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use crate::io::PreviewColumn;
    use crate::recording::DriveUnit;

    #[test]
    fn volts_go_before_the_share_that_they_are() {
        let of = |volts: fn(f64) -> f64| {
            let column = |name: &str, f: &dyn Fn(f64) -> f64| PreviewColumn {
                name: name.into(),
                values: (0..400).map(|k| f(0.05 * f64::from(k))).collect(),
                ..PreviewColumn::default()
            };
            guess(&[
                column("t", &|t| t),
                column("left_rad_per_s", &|t| 8.0 * t.sin()),
                column("right_rad_per_s", &|t| 8.0 * t.cos()),
                column("left_pwm_percent", &|t| 60.0 * t.sin()),
                column("right_pwm_percent", &|t| 60.0 * t.cos()),
                column("left_voltage_equivalent", &|t| volts(t.sin())),
                column("right_voltage_equivalent", &|t| volts(t.cos())),
            ])
        };
        let name = |g: &super::super::Guess| {
            g.columns.iter().find(|c| c.key == "M1").map(|c| c.name.clone()).unwrap()
        };
        let volts = of(|x| 7.2 * x);
        assert_eq!(
            (name(&volts).as_str(), volts.drive_unit),
            ("right_voltage_equivalent", DriveUnit::Volt)
        );
        assert!(volts.questions.is_empty(), "{:?}", volts.questions);
        // the voltage of the supply, which every controller measures
        assert_eq!(name(&of(|x| 12.0 - x * x)), "right_pwm_percent");
    }
}
