//! Messages as `ros2 topic echo` and `rostopic echo` print them: YAML with `---` between two messages.

use super::lines::Columns;
use super::record::collected;
use crate::io::csv::{Style, value};

/// Number of messages from which the format is detected.
const MESSAGES: usize = 2;
/// Largest number of elements of a list that become columns; longer lists are images and maps.
const ELEMENTS: usize = 64;
/// The list of words that contains the names of the elements of the lists next to it.
const NAMES: &str = "name";

/// A value of a message by its path: `header.stamp.sec`, `position[0]`.
type Value<'a> = (String, &'a str);

/// Whether a text consists of messages: lines of `key:`, `key: value` and `- value`, separated by `---`.
pub(super) fn is_one(lines: &[&str]) -> bool {
    let ends: Vec<usize> = (0..lines.len()).filter(|k| is_end(lines[*k])).collect();
    ends.len() >= MESSAGES
        && lines[..ends[MESSAGES - 1]].iter().all(|line| {
            let bare = line.trim();
            bare.is_empty() || is_end(line) || bare.starts_with("- ") || key(bare).is_some()
        })
}

fn is_end(line: &str) -> bool {
    line.trim_end() == "---"
}

/// The key of a line and the text after it.
fn key(line: &str) -> Option<(&str, &str)> {
    let (key, rest) = line.split_once(':')?;
    let is_key = !key.is_empty() && key.chars().all(|c| c.is_alphanumeric() || c == '_');
    (is_key && (rest.is_empty() || rest.starts_with(' '))).then(|| (key, rest.trim()))
}

/// The columns of messages. Elements of lists beside a list of names have the name before them, as the columns of a
/// bag do: `wheel_left.position`.
pub(super) fn columns(text: &str) -> Columns {
    let (mut messages, mut message) = (vec![], vec![]);
    for line in text.lines() {
        if is_end(line) {
            messages.push(std::mem::take(&mut message));
        } else {
            message.push(line);
        }
    }
    // behind the last mark the message may be cut
    collected(messages.iter().map(|lines| numbers(&values(lines))).filter(|m| !m.is_empty()))
}

/// The values of a message in order.
fn values<'a>(lines: &[&'a str]) -> Vec<Value<'a>> {
    let mut out: Vec<Value> = vec![];
    // keys with their indentation, the innermost last, and elements of the list so far
    let mut open: Vec<(usize, &str)> = vec![];
    let mut elements = 0;
    for line in lines {
        let (indent, bare) = (line.len() - line.trim_start().len(), line.trim());
        let path =
            |open: &[(usize, &str)]| open.iter().map(|(_, key)| *key).collect::<Vec<_>>().join(".");
        if let Some(element) = bare.strip_prefix("- ") {
            out.push((format!("{}[{elements}]", path(&open)), element.trim()));
            elements += 1;
        } else if let Some((key, rest)) = key(bare) {
            open.retain(|(other, _)| *other < indent);
            open.push((indent, key));
            elements = 0;
            let list = rest.strip_prefix('[').and_then(|r| r.strip_suffix(']'));
            match list {
                Some(list) => {
                    let cells = list.split(',').map(str::trim).filter(|c| !c.is_empty());
                    out.extend(
                        cells.enumerate().map(|(k, c)| (format!("{}[{k}]", path(&open)), c)),
                    );
                }
                None if rest.is_empty() => {}
                None => out.push((path(&open), rest)),
            }
        }
    }
    out
}

/// The numbers of a message; elements have the names that the list next to them gives.
fn numbers(values: &[Value]) -> Vec<(String, f64)> {
    let parted = |path: &str| -> Option<(String, usize)> {
        let (list, index) = path.strip_suffix(']')?.rsplit_once('[')?;
        Some((list.to_string(), index.parse().ok()?))
    };
    let beside = |list: &str| match list.rsplit_once('.') {
        Some((parent, _)) => format!("{parent}.{NAMES}"),
        None => NAMES.into(),
    };
    let word = |path: String| {
        let found = values.iter().find(|(other, _)| *other == path);
        found.map(|(_, word)| word.trim_matches(['\'', '"']))
    };
    let named = |path: &str| match parted(path) {
        Some((list, k)) => match word(format!("{}[{k}]", beside(&list))) {
            Some(joint) => format!("{joint}.{}", list.rsplit('.').next().unwrap_or_default()),
            None => path.to_string(),
        },
        None => path.to_string(),
    };
    let is_short = |path: &str| parted(path).is_none_or(|(_, k)| k < ELEMENTS);
    let number = |(path, text): &Value| {
        let number = value(text, Style::Point).filter(|x| x.is_finite())?;
        is_short(path).then(|| (named(path), number))
    };
    values.iter().filter_map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joint_states_are_columns_under_the_names_of_their_joints() {
        let message = |k: i32| {
            format!(
                "header:\n  stamp:\n    sec: 17\n    nanosec: {k}00\n  frame_id: ''\nname:\n- left\n- right\n\
                 position:\n- 0.{k}\n- -1.5\nvelocity: [0.25, {k}.0]\neffort: []\n---\n"
            )
        };
        let text: String = (0..4).map(message).collect::<String>() + "header:\n  stamp:\n    se";
        let lines: Vec<&str> = text.lines().collect();
        assert!(is_one(&lines));
        let found = columns(&lines.join("\n"));
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(
            names,
            [
                "header.stamp.sec",
                "header.stamp.nanosec",
                "left.position",
                "right.position",
                "left.velocity",
                "right.velocity"
            ]
        );
        assert_eq!(found[5].1, [0.0, 1.0, 2.0, 3.0]);
        assert_eq!((found[2].1[3], found[3].1[0], found[1].1[2]), (0.3, -1.5, 200.0));
    }

    #[test]
    fn other_texts_are_not_taken_for_messages() {
        for text in ["t,a\n---\n0,1\n---\n", "key: 1\n---\n", "Samples: 3\n--- START ---\n1,2\n"] {
            assert!(!is_one(&text.lines().collect::<Vec<_>>()), "{text}");
        }
    }
}
