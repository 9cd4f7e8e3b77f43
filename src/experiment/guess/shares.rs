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

    #[test]
    fn of_one_motor_too_the_voltage_goes_before_its_share() {
        let of = |pwm: &str, volts: &str| {
            let column = |name: &str, f: &dyn Fn(usize) -> f64| PreviewColumn {
                name: name.into(),
                values: (0..300).map(f).collect(),
                ..PreviewColumn::default()
            };
            let on = |k: usize| if k < 100 { 0.0 } else { 1.0 };
            let speed = |k: usize| 18.0 * on(k) * (1.0 - (-0.02 * (k as f64 - 100.0)).exp());
            guess(&[
                column("Tiempo (s)", &|k| 0.02 * k as f64),
                column(pwm, &|k| 180.0 * on(k)),
                column(volts, &|k| 9.0 * on(k)),
                column("Velocidad (rad/s)", &speed),
            ])
        };
        for (pwm, volts) in
            [("PWM", "Voltaje (V)"), ("PWM", "Motor Voltage (V)"), ("pwm", "voltage")]
        {
            let g = of(pwm, volts);
            let input = g.columns.iter().find(|c| c.key == "M1").map(|c| c.name.as_str());
            assert_eq!((input, g.drive_unit), (Some(volts), DriveUnit::Volt), "{pwm}");
            assert!(g.one_axis);
        }
    }
}
