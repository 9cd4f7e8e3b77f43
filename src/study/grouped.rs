//! Sentences on recordings, said once of all recordings of which they hold.

/// Recordings that a finding names at most.
const NAMED: usize = 20;

/// Recordings, each with a sentence on it, as sentences, each with the names of its recordings:
/// "a.csv", "a.csv and b.csv", "3 recordings (a.csv, b.csv, c.csv)", or "all 3 recordings" where
/// there are `count` in all. In the order of the first ones. Sentences that differ in their numbers
/// alone become one with the range of the numbers.
///
/// ```
/// use amigo_ident::study::grouped;
/// let said = grouped([("a", "is short"), ("b", "has gaps"), ("c", "is short")].into_iter(), 4);
/// assert_eq!(said, [("a and c".into(), "is short".into()), ("b".into(), "has gaps".into())]);
/// let late = [("a", "dalpha1 is 49.5 ms late"), ("b", "dalpha1 is 50.2 ms late")].into_iter();
/// let said = grouped(late, 2);
/// assert_eq!(said, [("all 2 recordings".into(), "dalpha1 is 49.5 to 50.2 ms late".into())]);
/// ```
#[must_use]
pub fn grouped<'a>(
    findings: impl Iterator<Item = (&'a str, &'a str)>,
    count: usize,
) -> Vec<(String, String)> {
    let mut groups: Vec<(Vec<&str>, Sentence)> = Vec::new();
    for (name, text) in findings {
        let sentence = Sentence::of(text);
        match groups.iter_mut().find(|(_, known)| known.words == sentence.words) {
            Some((names, known)) => {
                // a recording of which the same is said twice is named once
                if names.last() != Some(&name) {
                    names.push(name);
                }
                known.include(&sentence);
            }
            None => groups.push((vec![name], sentence)),
        }
    }
    groups.into_iter().map(|(names, sentence)| (listed(&names, count), sentence.text())).collect()
}

/// The names of recordings, as the subject of a sentence.
fn listed(names: &[&str], count: usize) -> String {
    match names {
        [one] => (*one).to_string(),
        all if all.len() == count => format!("all {count} recordings"),
        [one, other] => format!("{one} and {other}"),
        many if many.len() > NAMED => {
            format!("{} recordings ({}, ...)", many.len(), many[..NAMED].join(", "))
        }
        many => format!("{} recordings ({})", many.len(), many.join(", ")),
    }
}

/// A sentence taken apart into words and numbers: before each number stand the words of its place, and the last
/// words end it.
struct Sentence<'a> {
    words: Vec<&'a str>,
    /// Of each number the smallest and the largest, as they were written.
    numbers: Vec<[&'a str; 2]>,
}

impl<'a> Sentence<'a> {
    fn of(text: &'a str) -> Self {
        let (mut words, mut numbers, mut from) = (vec![], vec![], 0);
        while let Some((start, end)) = next_number(text, from) {
            words.push(&text[from..start]);
            numbers.push([&text[start..end]; 2]);
            from = end;
        }
        words.push(&text[from..]);
        Self { words, numbers }
    }

    /// Widens the ranges by the numbers of a sentence of the same words.
    fn include(&mut self, other: &Self) {
        let value = |text: &str| text.parse().unwrap_or(f64::NAN);
        for ([low, high], [number, _]) in self.numbers.iter_mut().zip(&other.numbers) {
            if value(number) < value(low) {
                *low = number;
            }
            if value(number) > value(high) {
                *high = number;
            }
        }
    }

    fn text(&self) -> String {
        let mut out = String::new();
        for (words, [low, high]) in self.words.iter().zip(&self.numbers) {
            out += words;
            out += low;
            if low != high {
                out += " to ";
                out += high;
            }
        }
        out + self.words.last().unwrap_or(&"")
    }
}

/// The next number at or behind byte `from`, where it starts and ends; digits of a name (`dalpha1`) are none.
fn next_number(text: &str, from: usize) -> Option<(usize, usize)> {
    let of_name = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.');
    let begins = |at: usize| !text[..at].ends_with(of_name);
    let digit = text[from..]
        .char_indices()
        .map(|(at, _)| from + at)
        .find(|&at| text[at..].starts_with(|c: char| c.is_ascii_digit()) && begins(at))?;
    let sign = text[from..digit].ends_with(['-', '+']) && begins(digit - 1);
    let digits = |at: usize| {
        let none = |c: char| !(c.is_ascii_digit() || c == '.');
        at + text[at..].find(none).unwrap_or(text.len() - at)
    };
    let mut end = digits(digit);
    if let Some(power) = text[end..].strip_prefix('e') {
        let power = power.strip_prefix(['-', '+']).unwrap_or(power);
        if power.starts_with(|c: char| c.is_ascii_digit()) {
            end = digits(text.len() - power.len());
        }
    }
    let number = text[digit..end].trim_end_matches('.');
    Some((digit - usize::from(sign), digit + number.len()))
}

#[cfg(test)]
mod tests {
    use super::grouped;

    #[test]
    fn sentences_that_differ_in_a_number_become_one_and_digits_of_names_do_not_count() {
        let lag = |axis: u8, lag: f64, error: f64| {
            format!("dalpha{axis} lags by {lag:.2} ms ± {error:.2} ms.")
        };
        let said = [("a", lag(1, 49.5, 0.2)), ("b", lag(1, 9.05, 1.3)), ("b", lag(2, 9.05, 1.3))];
        let said = grouped(said.iter().map(|(name, text)| (*name, text.as_str())), 3);
        let expected = [
            ("a and b", "dalpha1 lags by 9.05 to 49.50 ms ± 0.20 to 1.30 ms."),
            ("b", "dalpha2 lags by 9.05 ms ± 1.30 ms."),
        ];
        assert_eq!(said, expected.map(|(names, text)| (names.to_string(), text.to_string())));
    }

    #[test]
    fn a_recording_with_two_sentences_of_the_same_words_is_named_once() {
        let said = [("a", "row 3 repeats"), ("a", "row 17 repeats"), ("b", "row 3.")];
        let said = grouped(said.into_iter(), 2);
        assert_eq!(said[0], ("a".to_string(), "row 3 to 17 repeats".to_string()));
        assert_eq!(said[1], ("b".to_string(), "row 3.".to_string()));
    }

    #[test]
    fn signs_and_powers_belong_to_the_number_and_a_difference_does_not() {
        let said = [("a", "a1 - a2 is -3.5e-3 off"), ("b", "a1 - a2 is 2e-5 off")];
        let said = grouped(said.into_iter(), 9);
        assert_eq!(said, [("a and b".to_string(), "a1 - a2 is -3.5e-3 to 2e-5 off".to_string())]);
    }
}
