//! Messages as `gz topic -e` prints them: the text format of protocol buffers, with an empty line between two messages.
//!
//! ```text
//! joint {
//!   name: "wheel_left_joint"
//!   axis1 {
//!     velocity: 1.25
//!   }
//! }
//! ```

use super::lines::Columns;
use super::record::collected;
use crate::io::csv::{Style, value};

/// Number of blocks from which the format is detected.
const BLOCKS: usize = 4;
/// The field with the name of its block.
const NAME: &str = "name";

/// What a line is.
enum Line<'a> {
    Open(&'a str),
    Field(&'a str, &'a str),
    Close,
    Empty,
}

fn line(text: &str) -> Option<Line<'_>> {
    let is_key =
        |key: &str| !key.is_empty() && key.chars().all(|c| c.is_alphanumeric() || c == '_');
    let bare = text.trim();
    if bare.is_empty() {
        return Some(Line::Empty);
    }
    if bare == "}" {
        return Some(Line::Close);
    }
    if let Some(key) = bare.strip_suffix('{') {
        let key = key.trim_end();
        return is_key(key).then_some(Line::Open(key));
    }
    let (key, rest) = bare.split_once(": ")?;
    is_key(key).then(|| Line::Field(key, rest.trim().trim_matches('"')))
}

/// Whether a text consists of blocks.
pub(super) fn is_one(lines: &[&str]) -> bool {
    let read = || lines.iter().map(|text| line(text));
    let opened = read().filter(|l| matches!(l, Some(Line::Open(_)))).count();
    opened >= BLOCKS && read().all(|l| l.is_some())
}

/// A block that is open, or was: its key, or its name where it states one.
struct Block {
    title: String,
    parent: Option<usize>,
}

/// The columns of messages by the path of their fields, `wheel_left_joint.axis1.velocity`.
pub(super) fn columns(text: &str) -> Columns {
    let (mut messages, mut message, mut depth) = (vec![], vec![], 0_usize);
    for line in text.lines().filter_map(line) {
        match line {
            Line::Empty if depth == 0 => messages.push(std::mem::take(&mut message)),
            Line::Empty => {}
            line => {
                match line {
                    Line::Open(_) => depth += 1,
                    Line::Close => depth = depth.saturating_sub(1),
                    _ => {}
                }
                message.push(line);
            }
        }
    }
    // behind the last mark the message may be cut
    collected(messages.iter().map(|lines| numbers(lines)).filter(|m| !m.is_empty()))
}

/// The numbers of a message.
fn numbers(lines: &[Line]) -> Vec<(String, f64)> {
    let (mut blocks, mut fields) = (Vec::<Block>::new(), vec![]);
    let mut own: Option<usize> = None;
    for line in lines {
        match line {
            Line::Open(key) => {
                blocks.push(Block { title: (*key).to_string(), parent: own });
                own = Some(blocks.len() - 1);
            }
            Line::Close => own = own.and_then(|k| blocks[k].parent),
            Line::Field(NAME, name) => {
                if let Some(k) = own {
                    blocks[k].title = (*name).to_string();
                }
            }
            Line::Field(key, text) => fields.push((own, *key, *text)),
            Line::Empty => {}
        }
    }
    let path = |mut block: Option<usize>, key: &str| {
        let mut out = key.to_string();
        while let Some(k) = block {
            out = format!("{}.{out}", blocks[k].title);
            block = blocks[k].parent;
        }
        out
    };
    let number = |(block, key, text): &(Option<usize>, &str, &str)| {
        let number = value(text, Style::Point).filter(|x| x.is_finite())?;
        Some((path(*block, key), number))
    };
    fields.iter().filter_map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_stand_under_the_names_of_their_blocks() {
        let joint = |name: &str, k: i32| {
            format!(
                "joint {{\n  name: \"{name}\"\n  axis1 {{\n    position: 0.{k}\n    force: -{k}\n  }}\n}}\n"
            )
        };
        let message = |k: i32| {
            let stamp = format!("header {{\n  stamp {{\n    sec: {k}\n    nsec: 500\n  }}\n}}\n");
            format!("{stamp}{}{}\n", joint("left", k), joint("right", k + 1))
        };
        let text: String = (0..3).map(message).collect::<String>() + "header {\n  stamp {\n";
        assert!(is_one(&text.lines().collect::<Vec<_>>()));
        let found = columns(&text);
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        let axes = ["left.axis1.position", "left.axis1.force", "right.axis1.position"];
        assert_eq!(names[..2], ["header.stamp.sec", "header.stamp.nsec"]);
        assert_eq!(names[2..5], axes);
        assert_eq!((found[0].1.len(), found[4].1[2]), (3, 0.3));
    }

    #[test]
    fn other_texts_are_no_blocks() {
        for text in ["a: 1\nb: 2\n", "int main() {\n  return 0;\n}\n", "t,a\n0,1\n"] {
            assert!(!is_one(&text.lines().collect::<Vec<_>>()), "{text}");
        }
    }
}
