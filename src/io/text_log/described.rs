//! Names of columns in comments that number them: `# column 2: right wheel speed [rad/s]`, `# 2) speed`, and several a
//! line, `%  5  6 Motor voltage [V] left, right: 2.1 2.1`, `% 15 .. 34 Line sensor`.

use super::lines::{is_comment, made_up};

/// The names in comments that describe all columns, and the number of the last line of them.
pub(super) fn described(above: &[&str], count: usize) -> Option<(usize, Vec<String>)> {
    let is_remark = |(_, line): &(usize, &&str)| is_comment(line);
    let comments: Vec<(usize, &str)> =
        above.iter().enumerate().filter(is_remark).map(|(k, line)| (k, *line)).collect();
    one_by_one(&comments, count).or_else(|| several_a_line(&comments, count))
}

/// One column a line, in their order.
fn one_by_one(comments: &[(usize, &str)], count: usize) -> Option<(usize, Vec<String>)> {
    let name = |line: &str, number: usize| -> Option<String> {
        let numbered = Numbered::of(line)?;
        (numbered.first == number && numbered.is_parted).then(|| numbered.text.to_string())
    };
    [1, 0].into_iter().find_map(|base| {
        comments.windows(count).find_map(|run| {
            let names: Option<Vec<String>> =
                run.iter().enumerate().map(|(k, (_, line))| name(line, k + base)).collect();
            Some((run.last()?.0, names?))
        })
    })
}

/// The first number of a comment and what follows it.
struct Numbered<'a> {
    first: usize,
    rest: &'a str,
    /// Whether a sign or space stands behind the number.
    is_parted: bool,
    /// The text behind that.
    text: &'a str,
}

impl<'a> Numbered<'a> {
    fn of(line: &'a str) -> Option<Self> {
        let text = line.trim_start_matches(['#', '%', '/', ' ', '\t']);
        let (before, rest) = text.split_at(text.find(|c: char| c.is_ascii_digit())?);
        let is_word = before.chars().all(|c| c.is_alphabetic() || c == ' ' || c == '[' || c == '(');
        let (first, rest) = number(rest).filter(|_| is_word)?;
        let text = rest.trim_start_matches([':', ')', ']', '.', '=', '-', ' ', '\t']);
        let is_parted = text.len() < rest.len();
        let text = text.trim();
        (!text.is_empty()).then_some(Self { first, rest, is_parted, text })
    }
}

/// The whole number at the start of a text, and the text behind it.
fn number(text: &str) -> Option<(usize, &str)> {
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    Some((text[..end].parse().ok()?, &text[end..]))
}

/// Several columns a line, which together are all of them; the later line has a column of two.
fn several_a_line(comments: &[(usize, &str)], count: usize) -> Option<(usize, Vec<String>)> {
    let found: Vec<(usize, Vec<(usize, String)>)> =
        comments.iter().filter_map(|(k, line)| Some((*k, listed(line)?))).collect();
    if found.iter().all(|(_, all)| all.len() == 1) {
        return None;
    }
    let base = found.iter().flat_map(|(_, all)| all).map(|(number, _)| *number).min()?;
    let mut names = vec![None; count];
    for (number, name) in found.iter().flat_map(|(_, all)| all) {
        *names.get_mut(number - base)? = Some(name.clone());
    }
    let last = found.last()?.0;
    (base < 2).then_some((last, names.into_iter().collect::<Option<_>>()?))
}

/// The columns that a comment names.
fn listed(line: &str) -> Option<Vec<(usize, String)>> {
    let Numbered { first, mut rest, .. } = Numbered::of(line)?;
    let mut numbers = vec![first];
    loop {
        let next = rest.trim_start_matches([' ', '\t', ',']);
        let behind = next.strip_prefix("..").or_else(|| next.strip_prefix('-'));
        let (is_range, next) =
            behind.map_or((false, next), |n| (true, n.trim_start_matches([' ', '.'])));
        let Some((number, behind)) = number(next) else { break };
        let last = numbers[numbers.len() - 1];
        let is_number = behind.starts_with([' ', '\t', ':', ')', ',', '.', '-']) && number > last;
        if !is_number || (next.len() == rest.len()) {
            break;
        }
        numbers.extend(if is_range { last + 1..=number } else { number..=number });
        rest = behind;
    }
    let text = rest.trim_start_matches([':', ')', ']', '.', '=', '-', ' ', '\t']).trim();
    let (words, units) = without_units(without_samples(text));
    let parts: Vec<&str> = words.split(',').map(str::trim).collect();
    // `7 9` of three names are 7 to 9
    if let [a, b] = numbers[..]
        && parts.len() == b - a + 1
    {
        numbers = (a..=b).collect();
    }
    let names = match numbers.len() {
        1 => vec![words.clone()],
        n if n == parts.len() => each(&parts),
        n => (1..=n).map(|k| format!("{words} {k}")).collect(),
    };
    let unit = |k: usize| match &units[..] {
        [] => String::new(),
        [one] => format!(" [{one}]"),
        all => all.get(k).map_or(String::new(), |unit| format!(" [{unit}]")),
    };
    let named = numbers.into_iter().zip(names).enumerate().map(|(k, (number, name))| {
        let name = if name.is_empty() { made_up(number) } else { name };
        (number, format!("{name}{}", unit(k)))
    });
    (!text.is_empty()).then(|| named.collect())
}

/// A description without the values of the first row: what stands behind a colon or an equals sign, and numbers with a
/// point.
fn without_samples(text: &str) -> String {
    let text = text.split_once(':').map_or(text, |(before, _)| before);
    let without = |part: &str| part.split_once('=').map_or(part, |(before, _)| before).to_string();
    let is_sample = |word: &&str| word.contains('.') && word.parse::<f64>().is_ok();
    let words = |part: String| {
        part.split_whitespace().filter(|w| !is_sample(w)).collect::<Vec<_>>().join(" ")
    };
    // the commas within a bracket part units
    let mut depth = 0;
    let parts = text.split(|c: char| {
        depth += i32::from(c == '[') - i32::from(c == ']');
        c == ',' && depth == 0
    });
    parts.map(|part| words(without(part))).collect::<Vec<_>>().join(", ")
}

/// A description and the units in its bracket.
fn without_units(text: String) -> (String, Vec<String>) {
    let bracket = text.split_once('[').and_then(|(a, rest)| Some((a, rest.split_once(']')?)));
    let Some((before, (units, behind))) = bracket else { return (text, vec![]) };
    let units = units.split(',').map(|unit| unit.trim().to_string()).collect();
    (format!("{} {}", before.trim(), behind.trim()).trim().to_string(), units)
}

/// The names of `Motor voltage left, right`: the words before the first item belong to all of them.
fn each(parts: &[&str]) -> Vec<String> {
    let (first, others) = (parts[0], &parts[1..]);
    let common = first.rsplit_once(' ').map_or("", |(common, _)| common);
    let other = others.iter().map(|part| format!("{common} {part}").trim().to_string());
    std::iter::once(first.to_string()).chain(other).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_before_a_name_are_a_list_or_a_range() {
        // of a REGBOT, first rows in the comments
        let header = [
            "%% logfile from robot 32",
            "%  1    time 0.000 sec",
            "%  2    mission (0) state 2",
            "%  3  4 Motor velocity ref left, right: 2.10 2.10",
            "%  5  6 Motor voltage [V] left, right: 2.1 2.1",
            "%  7  8 Motor current left, right [A]: 0.011 0.010",
            "%  9 10 11 12 Pose x,y,h,tilt [m,m,rad,rad]: 0.0000 0.0000 0.000000 -2.446083",
            "% 13 .. 16 Line sensor: left 0.000000 0, right 0.000000 0",
            "% 16    Battery voltage [V]: 12.20",
        ];
        let (last, names) = described(&header, 16).unwrap();
        assert_eq!(last, 8);
        assert_eq!(names[..2], ["time sec", "mission (0) state 2"]);
        assert_eq!(names[2..4], ["Motor velocity ref left", "Motor velocity ref right"]);
        assert_eq!(names[4..6], ["Motor voltage left [V]", "Motor voltage right [V]"]);
        assert_eq!(names[6..8], ["Motor current left [A]", "Motor current right [A]"]);
        assert_eq!(names[8..12], ["Pose x [m]", "Pose y [m]", "Pose h [rad]", "Pose tilt [rad]"]);
        assert_eq!(names[12..15], ["Line sensor 1", "Line sensor 2", "Line sensor 3"]);
        assert_eq!(names[15], "Battery voltage [V]");
        // all columns of the rows, or none
        assert!(described(&header, 17).is_none() && described(&header, 15).is_none());
    }

    #[test]
    fn two_numbers_of_more_names_are_the_first_and_the_last() {
        let header = [
            "%  1    time 0.010 sec",
            "%  2  3 Wheel velocity [m/s] left, right: 0.0000 -0.0000",
            "%  4  6 Chirp frequency =1256.1 rad/s, phase=1.2561 rad, value=0.95089",
        ];
        let (_, names) = described(&header, 6).unwrap();
        assert_eq!(names[1..3], ["Wheel velocity left [m/s]", "Wheel velocity right [m/s]"]);
        assert_eq!(names[3..], ["Chirp frequency", "Chirp phase", "Chirp value"]);
    }

    #[test]
    fn remarks_with_numbers_describe_no_columns() {
        let remarks = ["# 2 3rd try, 2.5 V", "# run 1 of 2", "# robot 3"];
        for count in 2..5 {
            assert!(described(&remarks, count).is_none(), "{count}");
        }
    }
}
