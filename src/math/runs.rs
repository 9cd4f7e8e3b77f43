//! Runs of consecutive numbers.

use std::ops::Range;

/// The longest ranges of numbers below `count` of which `holds` is true.
pub(crate) fn runs(count: usize, holds: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut out: Vec<Range<usize>> = vec![];
    for k in (0..count).filter(|&k| holds(k)) {
        match out.last_mut() {
            Some(last) if last.end == k => last.end = k + 1,
            _ => out.push(k..k + 1),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_end_where_the_flag_does() {
        let flags = [true, true, false, true, false, false, true];
        assert_eq!(runs(flags.len(), |k| flags[k]), [0..2, 3..4, 6..7]);
        assert!(runs(3, |_| false).is_empty());
    }
}
