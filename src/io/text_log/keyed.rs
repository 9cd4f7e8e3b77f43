//! Records of several motors or topics in turn: one field of each record names it.

use std::collections::HashMap;

use serde_json::Value;

use super::lines::Columns;
use super::record::{Pairs, assigned_texts, collected, joined, pairs};
use crate::io::csv::{Style, is_owner, is_part};
use crate::io::json::parsed;

/// Number of records from which this is detected.
const LOOKED_AT: usize = 64;
/// The most words that do.
const OWNERS: usize = 16;

/// The field that identifies the motor of each record, and its word in each line.
type Owners = (String, Vec<Option<String>>);

/// The columns of records, in the order in which their names come up; NaN where a record lacks one.
pub(super) fn columns<'a>(lines: impl Iterator<Item = &'a str>) -> Columns {
    let lines: Vec<&str> = lines.collect();
    let records = lines.iter().map(|line| pairs(line)).collect();
    let records = qualified(records, keys(&lines)).into_iter();
    collected(joined(records.filter(|pairs| !pairs.is_empty())))
}

/// The field of words, or of whole numbers under the name of a motor, that differ from those of the line before in at
/// least half of the lines. `None` where there is none.
fn keys(lines: &[&str]) -> Option<Owners> {
    let words = |line: &str| -> HashMap<String, String> { words(line).into_iter().collect() };
    let held = lines.iter().map(|line| words(line)).filter(|found| !found.is_empty());
    let head: Vec<HashMap<String, String>> = held.take(LOOKED_AT).collect();
    let mut fields: Vec<&String> = head.first().into_iter().flat_map(HashMap::keys).collect();
    fields.retain(|field| !is_part(field));
    fields.sort();
    let says = |field: &&String| {
        let of: Vec<Option<&String>> = head.iter().map(|words| words.get(*field)).collect();
        let mut distinct = of.clone();
        distinct.sort();
        distinct.dedup();
        let changes = of.windows(2).filter(|w| w[0] != w[1]).count();
        of.iter().all(Option::is_some)
            && (2..=OWNERS).contains(&distinct.len())
            && 2 * changes + 1 >= of.len()
    };
    let field = fields.into_iter().find(says)?.clone();
    let of_lines = lines.iter().map(|line| words(line).remove(&field)).collect();
    Some((field, of_lines))
}

/// The words of a record with their names; dates are not words.
fn words(line: &str) -> Vec<(String, String)> {
    let is_word = |name: &str, text: &str| {
        let is_number = text.parse::<i64>().is_ok();
        is_number && is_owner(name) || !is_number && super::value(text, Style::Point).is_none()
    };
    let found: Vec<(String, String)> = match parsed(line.trim()) {
        Ok(Value::Object(map)) => {
            let text = |value: &Value| match value {
                Value::String(text) => Some(text.clone()),
                Value::Number(number) => Some(number.to_string()),
                _ => None,
            };
            map.into_iter().filter_map(|(name, value)| Some((name, text(&value)?))).collect()
        }
        _ => assigned_texts(line),
    };
    found
        .into_iter()
        .filter(|(name, text)| {
            is_word(name, text) && super::quantity(text).is_none_or(|q| q.1.is_empty())
        })
        .collect()
}

/// Records whose names have the word before them; what never falls from record to record is that of all: the time.
fn qualified(records: Vec<Pairs>, found: Option<Owners>) -> Vec<Pairs> {
    let Some((field, keys)) = found else { return records };
    let mut last: HashMap<&str, (f64, f64, bool)> = HashMap::new();
    for (name, value) in records.iter().flatten() {
        let (first, before, rises) =
            last.get(name.as_str()).copied().unwrap_or((*value, *value, true));
        last.insert(name, (first, *value, rises && *value >= before));
    }
    let shared: Vec<String> = last
        .iter()
        .filter(|(_, (first, last, rises))| *rises && last > first)
        .map(|(name, _)| (*name).to_string())
        .collect();
    let one = |(pairs, key): (Pairs, &Option<String>)| {
        let pairs = pairs.into_iter().filter(|(name, _)| *name != field);
        let (mut of_all, own): (Pairs, Pairs) = pairs.partition(|(name, _)| shared.contains(name));
        let key = key.as_deref().unwrap_or_default();
        of_all.extend(own.into_iter().map(|(name, x)| (format!("{key}.{name}"), x)));
        of_all
    };
    records.into_iter().zip(&keys).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::columns;

    #[test]
    fn records_of_two_topics_have_columns_of_their_own() {
        let line = |k: u32, side: &str| {
            format!(
                r#"{{"topic":"robot/{side}","time":{k}.{},"data":{{"speed":-{k}.5}}}}"#,
                side.len()
            )
        };
        let text: Vec<String> = (0..9).flat_map(|k| [line(k, "left"), line(k, "right")]).collect();
        let found = columns(text.iter().map(String::as_str));
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["time", "robot/left.data.speed", "robot/right.data.speed"]);
        let line = |k: u32, id: u32| format!("t={k} id={id} mode=RUN rpm={}", k * id);
        let text: Vec<String> = (0..9).flat_map(|k| [line(k, 1), line(k, 2)]).collect();
        let found = columns(text.iter().map(String::as_str));
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!((names, found[2].1[3]), (vec!["t", "1.rpm", "2.rpm"], 6.0));
        // a state that stays is none of a topic
        let line =
            |k: u32| format!(r#"{{"mode":"{}","t":{k},"w":1}}"#, ["a", "b"][(k / 10) as usize]);
        let text: Vec<String> = (0..20).map(line).collect();
        assert_eq!(columns(text.iter().map(String::as_str))[1].0, "w");
    }
}
