//! Speeds of the motors in addition to those of the wheels after their gears.

use super::guessed::Candidate;
use super::names::Quantity;
use super::values::largest;

/// Relative deviation allowed between a speed and another one times the ratio of a gear (chosen by
/// judgement).
const ALIKE: f64 = 0.03;
/// Ratio beyond which two speeds are those of two shafts.
const GEAR: f64 = 1.25;

/// Whether the second of two measured speeds in one unit is that of a slower shaft after a gear: the ratio of
/// the two is the same in all rows.
pub(super) fn is_slower(first: &Candidate, second: &Candidate) -> bool {
    let of = |c: &Candidate| {
        (c.named.quantity, c.named.wished, c.named.unit, c.named.scale, c.named.side)
    };
    of(first) == of(second)
        && first.named.quantity == Some(Quantity::Speed)
        && !first.named.wished
        && ratio(&first.column.values, &second.column.values).is_some_and(|x| x > GEAR)
}

/// How many times the second the first is, where it is so in all rows.
fn ratio(first: &[f64], second: &[f64]) -> Option<f64> {
    let rows = || {
        let pairs = first.iter().zip(second);
        pairs.filter(|(a, b)| a.is_finite() && b.is_finite())
    };
    let squares: f64 = rows().map(|(_, b)| b * b).sum();
    let by = rows().map(|(a, b)| a * b).sum::<f64>() / squares;
    let differs = |(a, b): (&f64, &f64)| (a - by * b).abs() > ALIKE * largest(first);
    (squares > 0.0 && by.is_finite() && !rows().any(differs)).then_some(by)
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use crate::io::PreviewColumn;

    #[test]
    fn of_two_speeds_in_a_constant_ratio_the_slower_is_that_of_the_wheel() {
        let column = |name: &str, factor: f64| PreviewColumn {
            name: name.into(),
            values: (0..200).map(|k| factor * (0.05 * f64::from(k)).sin()).collect(),
            ..PreviewColumn::default()
        };
        let of = |fast: &str, slow: &str| {
            let names = [("l", 30.0), ("r", 29.0)];
            let time = (0..200).map(|k| 0.05 * f64::from(k)).collect();
            let mut log =
                vec![PreviewColumn { name: "t".into(), values: time, ..PreviewColumn::default() }];
            for (side, by) in names {
                log.push(column(&format!("{fast}_{side}"), 34.0 * by));
                log.push(column(&format!("{slow}_{side}"), by));
                log.push(column(&format!("amps_{side}"), 1.0));
            }
            guess(&log).columns.into_iter().find(|c| c.key == "dalpha1").unwrap().name
        };
        assert_eq!(of("motor_rpm", "output_rpm"), "output_rpm_r");
        assert_eq!(of("a_rpm", "b_rpm"), "b_rpm_r");
        assert_eq!(of("wheel_rpm", "b_rpm"), "wheel_rpm_r");
    }
}
