//! Factors in names: the unit of a number in the column.

/// Numbers by which a value is multiplied before it is logged.
const POWERS: [f64; 4] = [10.0, 100.0, 1000.0, 10000.0];

/// The number before a unit: `10 mA`, `0.1 A`, `x0.1 rpm`.
pub(super) fn many(unit: &str) -> (Option<f64>, &str) {
    let number_at = unit.trim_start_matches(['x', 'X', '\u{d7}', '*']).trim_start();
    let unit = if number_at.starts_with(|c: char| c.is_ascii_digit()) { number_at } else { unit };
    let end = unit.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(unit.len());
    let number: Option<f64> = unit[..end].parse().ok().filter(|x| *x > 0.0);
    // `1/min` and the like are units
    let rest = unit[end..].trim_start();
    if number.is_some() && !rest.starts_with('/') { (number, rest) } else { (None, unit) }
}

/// What stands before `*10`, ` x10` or `/10` at the end, and how many of its unit are one: a value that was multiplied
/// by 10 is a tenth of a unit.
pub(super) fn multiplied(text: &str) -> (Option<f64>, &str) {
    let by = |sign: char| {
        let (before, number) = text.trim_end().rsplit_once(sign)?;
        let number: f64 = number.trim().parse().ok()?;
        POWERS.contains(&number).then_some((number, before.trim_end()))
    };
    let letter = || by('x').filter(|_| text.contains(" x"));
    let found =
        by('*').or_else(|| by('\u{d7}')).or_else(letter).map(|(n, before)| (1.0 / n, before));
    match found.or_else(|| by('/')) {
        Some((scale, before)) => (Some(scale), before),
        None => (None, text),
    }
}

/// Takes `x100` off the end of the words: how many of a unit are one.
pub(super) fn take_multiple(words: &mut Vec<String>) -> Option<f64> {
    let [.., x, number] = &words[..] else { return None };
    let many = POWERS.into_iter().find(|k| number.parse() == Ok(*k));
    let many = many.filter(|_| x == "x")?;
    words.truncate(words.len() - 2);
    Some(1.0 / many)
}

/// Removes a power of ten from the end of the words, where the unit was before it.
pub(super) fn take_power_of_ten(words: &mut Vec<String>) -> Option<f64> {
    let number: f64 = words.last()?.parse().ok()?;
    let power = POWERS.into_iter().find(|k| *k == number)?;
    words.pop();
    Some(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_before_and_behind_a_unit_are_read() {
        assert_eq!(many("10ms"), (Some(10.0), "ms"));
        assert_eq!(many("x0.1 rpm"), (Some(0.1), "rpm"));
        assert_eq!((many("1/min"), many("rpm")), ((None, "1/min"), (None, "rpm")));
        assert_eq!(multiplied("mA*10"), (Some(0.1), "mA"));
        assert_eq!(multiplied("A x10"), (Some(0.1), "A"));
        assert_eq!(multiplied("0x10"), (None, "0x10"));
        assert_eq!(multiplied("rpm / 10"), (Some(10.0), "rpm"));
        assert_eq!(multiplied("wheel/2"), (None, "wheel/2"));
    }
}
