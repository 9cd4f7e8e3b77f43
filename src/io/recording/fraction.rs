//! The part of a second of a time in whole seconds.

use crate::io::words;

/// Words of a name that state parts of a second, with their size \[s\].
const PARTS: [(&[&str], f64); 2] = [
    (
        &["us", "usec", "usecs", "micros", "microsec", "microsecs", "microsecond", "microseconds"],
        1e-6,
    ),
    (
        &["ms", "msec", "msecs", "millis", "millisec", "millisecs", "millisecond", "milliseconds"],
        1e-3,
    ),
];

/// Size \[s\] of one in a column that goes on from whole seconds, by its name: `tv_usec` holds microseconds. A name
/// without unit is that of nanoseconds.
#[must_use]
pub fn part_of_second(name: &str) -> f64 {
    let words = words(name);
    let is_one = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
    PARTS.iter().find(|(list, _)| is_one(list)).map_or(1e-9, |(_, size)| *size)
}

/// The values of such a column \[s\].
pub(super) fn in_seconds(name: &str, mut values: Vec<f64>) -> Vec<f64> {
    let size = part_of_second(name);
    values.iter_mut().for_each(|x| *x *= size);
    values
}

#[cfg(test)]
mod tests {
    use super::part_of_second;

    #[test]
    fn the_name_states_the_part_of_a_second() {
        assert_eq!(["tv_usec", "stamp [ms]", "nsec"].map(part_of_second), [1e-6, 1e-3, 1e-9]);
    }
}
