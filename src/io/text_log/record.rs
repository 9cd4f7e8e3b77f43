//! Lines that are records: `t=20,l=131,r=-4` of a serial console, or a JSON object each; and files of JSON with
//! columns or records.

use std::collections::{HashMap, HashSet};

use serde_json::Value;

use super::lines::{Columns, made_up};
use super::stamp;
use super::stamp::CLOCK;
use crate::io::csv::{Style, quantity, value, with_unit};
use crate::io::json::parsed;

/// Largest number of labels of a line among which repeated ones are distinguished.
const REPEATED: usize = 256;

/// Name, number and unit.
type Assigned<'a> = (&'a str, f64, &'a str);

/// Names and numbers of a record.
pub(super) type Pairs = Vec<(String, f64)>;

/// Number of lines from which the format is detected.
const LOOKED_AT: usize = 40;
/// Largest number of elements of an array that become columns; longer arrays are images and maps.
const ELEMENTS: usize = 64;
/// Keys that contain the name of an object in a list.
const NAMES: [&str; 6] = ["name", "motor", "joint", "wheel", "side", "id"];

/// Whether nearly all of the first lines behind a preamble are records; a console begins with words and half a line.
pub(super) fn is_one(lines: &[&str]) -> bool {
    let held = lines.iter().filter(|line| !line.trim().is_empty());
    let held = held.map(|line| !pairs(line).is_empty()).skip_while(|is_record| !is_record);
    let held: Vec<bool> = held.take(LOOKED_AT).collect();
    let records = held.iter().filter(|is_record| **is_record).count();
    records > 1 && 10 * records >= 9 * held.len()
}

/// Records of several kinds that follow each other in one row, until a name comes again: a log without a time
/// prints one line for the wheels and one for the gyroscope. Where both begin with the same name, as that of the
/// time, its value is the same in a row.
pub(super) fn joined(records: impl Iterator<Item = Pairs>) -> impl Iterator<Item = Pairs> {
    let mut records = records.peekable();
    std::iter::from_fn(move || {
        let mut row = records.next()?;
        while let Some(next) = records.next_if(|next| is_of_row(&row, next)) {
            let same = usize::from(row.first() == next.first());
            row.extend(next.into_iter().skip(same));
        }
        Some(row)
    })
}

fn is_of_row(row: &[(String, f64)], next: &[(String, f64)]) -> bool {
    let same = usize::from(row.first() == next.first());
    next.len() > same
        && next[same..].iter().all(|(name, _)| row.iter().all(|(other, _)| other != name))
}

/// One column per name, with NaN where a record lacks it.
pub(super) fn collected(records: impl Iterator<Item = Pairs>) -> Columns {
    let mut columns: Columns = vec![];
    let mut places: HashMap<String, usize> = HashMap::new();
    for (row, pairs) in records.enumerate() {
        for (name, value) in pairs {
            let place = *places.entry(name.clone()).or_insert_with(|| {
                columns.push((name, vec![f64::NAN; row]));
                columns.len() - 1
            });
            // of a name that stands twice in a record the first counts
            if columns[place].1.len() == row {
                columns[place].1.push(value);
            }
        }
        columns.iter_mut().for_each(|(_, values)| values.resize(row + 1, f64::NAN));
    }
    columns
}

/// The columns of a JSON document: lists of numbers by their paths (`{"t": [0, 0.01], "left": {"vel": [1, 2]}}`),
/// or a list of records (`[{"t": 0}, {"t": 0.01}]`), at the top or below one name. `None` without any, and of the
/// files of SysId, which have a reader of their own.
pub(super) fn of_json(value: &Value) -> Option<Columns> {
    if let Some(table) = table(value) {
        return (table.len() > 1).then_some(table);
    }
    let records = match value {
        Value::Object(map) if map.contains_key("sysid") => return None,
        Value::Object(map) => map.values().find_map(records),
        other => records(other),
    };
    let found = match records {
        Some(rows) => collected(rows.iter().map(|row| {
            let mut pairs = vec![];
            flatten("", row, &mut pairs);
            pairs
        })),
        None => {
            let mut columns = vec![];
            lists("", value, &mut columns);
            columns
        }
    };
    (found.len() > 1).then_some(found)
}

/// A table as a list of names beside a list of rows: `{"columns": ["t", "w"], "data": [[0, 1], [0.1, 2]]}`.
fn table(value: &Value) -> Option<Columns> {
    let lists =
        || value.as_object().into_iter().flat_map(|map| map.values()).filter_map(Value::as_array);
    let names = lists().find(|list| list.len() > 1 && list.iter().all(Value::is_string))?;
    let is_row = |row: &Value| row.as_array().is_some_and(|row| row.len() == names.len());
    let rows = lists().find(|list| list.len() > 1 && list.iter().all(is_row))?;
    let column = |(k, name): (usize, &Value)| {
        let number =
            |row: &Value| row[k].as_f64().or_else(|| super::value(row[k].as_str()?, Style::Point));
        let values = rows.iter().map(|row| number(row).unwrap_or(f64::NAN)).collect();
        (name.as_str().unwrap_or_default().to_string(), values)
    };
    Some(names.iter().enumerate().map(column).collect())
}

/// A list of more than one object.
fn records(value: &Value) -> Option<&Vec<Value>> {
    value.as_array().filter(|list| list.len() > 1 && list.iter().all(Value::is_object))
}

/// Lists of numbers below a value, with their paths.
fn lists(path: &str, value: &Value, out: &mut Columns) {
    let number = |x: &Value| x.as_f64().or(x.is_null().then_some(f64::NAN));
    match value {
        Value::Object(map) => map.iter().for_each(|(key, inner)| {
            let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            lists(&path, inner, out);
        }),
        Value::Array(list) if list.len() > 1 => {
            let numbers: Option<Vec<f64>> = list.iter().map(number).collect();
            out.extend(numbers.map(|numbers| (path.to_string(), numbers)));
        }
        _ => {}
    }
}

/// Names and numbers of a record; empty for other lines.
pub(super) fn pairs(line: &str) -> Pairs {
    let line = line.trim();
    if line.starts_with('{') {
        let mut out = vec![];
        if let Ok(object @ Value::Object(_)) = parsed(line) {
            flatten("", &object, &mut out);
            return out;
        }
    }
    // an element of XML with its values as attributes
    let line = line.strip_prefix('<').map_or(line, |l| l.trim_end_matches(['/', '>']));
    let line = line.trim_matches(['{', '}']).trim();
    let element = line
        .split_once(' ')
        .filter(|(name, _)| line.ends_with('"') && name.bytes().all(|b| b.is_ascii_alphabetic()));
    let (before, rest) = before(element.map_or(line, |(_, rest)| rest));
    let glued = glued(rest);
    let separators = |c: char| c.is_whitespace() || ",;|".contains(c);
    let words = glued.split(separators).filter(|word| word.contains(char::is_alphanumeric));
    let found: Option<Vec<Option<Assigned>>> = words.map(assigned).collect();
    let found: Vec<Assigned> = found.unwrap_or_default().into_iter().flatten().collect();
    if found.len() < 2 {
        return vec![];
    }
    let labels: Vec<[&str; 1]> = found.iter().map(|(name, ..)| [*name]).collect();
    let names = qualified(&labels.iter().map(|label| &label[..]).collect::<Vec<_>>());
    let named = names.iter().zip(&found).map(|(name, (_, x, unit))| (with_unit(name, unit), *x));
    before.into_iter().chain(named).collect()
}

/// Names and texts of `side=R`, `id: 1`, of any kind.
pub(super) fn assigned_texts(line: &str) -> Vec<(String, String)> {
    let glued = glued(line.trim().trim_matches(['{', '}']));
    let separators = |c: char| c.is_whitespace() || ",;|".contains(c);
    let one = |word: &str| {
        let (name, text) = word.split_once(['=', ':'])?;
        let bare = |text: &str| text.trim_matches(['"', '\'']).to_string();
        let is_name = name.starts_with(|c: char| c.is_alphabetic() || "\"'_".contains(c));
        (is_name && !text.is_empty()).then(|| (bare(name), bare(text)))
    };
    glued.split(separators).filter_map(one).collect()
}

/// The words of each label as a name. Repeated labels get the last unique word before them as a prefix: `L.u`, `R.u`.
pub(super) fn qualified(labels: &[&[&str]]) -> Vec<String> {
    let once =
        |word: &str| labels.iter().flat_map(|l| l.iter()).filter(|w| **w == word).count() == 1;
    let own: Vec<String> = labels.iter().map(|words| words.join(" ")).collect();
    let are_distinct = own.iter().collect::<HashSet<_>>().len() == own.len();
    if are_distinct || own.len() > REPEATED {
        return own;
    }
    let mut last: Option<&str> = None;
    let mut names: Vec<String> = vec![];
    for (words, own) in labels.iter().zip(own) {
        let comes_again = labels.iter().filter(|other| other == &words).count() > 1;
        let name = match last.filter(|_| comes_again) {
            Some(before) => format!("{before}.{own}"),
            None => own,
        };
        last = words.iter().rev().find(|word| once(word)).copied().or(last);
        let other = (2..).map(|k| format!("{name}.{k}"));
        let free = std::iter::once(name.clone()).chain(other).find(|n| !names.contains(n));
        names.push(free.unwrap_or(name));
    }
    names
}

/// The time of arrival or a number without a label before a record, and the record.
pub(super) fn before(line: &str) -> (Option<(String, f64)>, &str) {
    if let Some((clock, rest)) = stamp::parted(line) {
        return (Some((CLOCK.into(), clock)), rest);
    }
    if let Some((_, rest)) = line.split_once(" -> ") {
        return (None, rest);
    }
    let Some((first, rest)) = line.split_once(|c: char| c.is_whitespace() || ",;|".contains(c))
    else {
        return (None, line);
    };
    let number = first.trim_end_matches(':').parse().ok().filter(|x: &f64| x.is_finite());
    number.map_or((None, line), |number| (Some((made_up(0), number)), rest))
}

/// A text without the spaces around `:` and `=`.
fn glued(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if matches!(c, ':' | '=') {
            out.truncate(out.trim_end().len());
        } else if c.is_whitespace() && out.ends_with([':', '=']) {
            continue;
        }
        out.push(c);
    }
    out
}

/// Name, number and unit of `l=134`, `v:4.5rpm`; `Some(None)` of a word behind a name, `mode=DRIVE`, and `None` of
/// anything else.
fn assigned(word: &str) -> Option<Option<Assigned<'_>>> {
    let (name, text) = word.split_once(['=', ':'])?;
    let name = name.trim_matches('"');
    let text = text.strip_prefix('"').and_then(|t| t.strip_suffix('"')).unwrap_or(text);
    if !name.starts_with(|c: char| c.is_alphabetic() || c == '_') {
        return None;
    }
    let found = quantity(text).or_else(|| Some((value(text, Style::Point)?, "")));
    match found {
        Some((number, unit)) => Some(Some((name, number, unit))),
        None => (!text.contains([':', '='])).then_some(None),
    }
}

/// The numbers of a JSON value by their paths: `left.vel`, `position[0]`.
fn flatten(path: &str, value: &Value, out: &mut Vec<(String, f64)>) {
    match value {
        Value::Object(map) => {
            for (key, inner) in map {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                flatten(&path, inner, out);
            }
        }
        Value::Array(list) if list.len() <= ELEMENTS => {
            for (k, value) in list.iter().enumerate() {
                match NAMES.iter().find_map(|key| value.get(key)?.as_str()) {
                    Some(name) => flatten(&format!("{path}.{name}"), value, out),
                    None => flatten(&format!("{path}[{k}]"), value, out),
                }
            }
        }
        Value::Number(number) => out.push((path.into(), number.as_f64().unwrap_or(f64::NAN))),
        Value::Bool(flag) => out.push((path.into(), f64::from(u8::from(*flag)))),
        Value::String(text) => {
            // a date is a number too; other words are none
            let number = super::value(text, Style::Point).filter(|x| x.is_finite());
            out.extend(number.map(|x| (path.into(), x)));
        }
        Value::Null | Value::Array(_) => {}
    }
}
