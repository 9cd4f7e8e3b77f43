//! Lines that are records: `t=20,l=131,r=-4` of a serial console, or a JSON object each; and files of JSON with
//! columns or records.

use std::collections::HashMap;

use serde_json::Value;

use super::Columns;
use crate::io::csv::value;

/// Lines that say whether a text is one of records.
const LOOKED_AT: usize = 40;
/// Elements of an array that are columns; longer ones are images and maps.
const ELEMENTS: usize = 64;

/// Whether nearly all of the first lines are records; a console begins with words and half a line.
pub(super) fn is_one(lines: &[&str]) -> bool {
    let held: Vec<&&str> = lines.iter().filter(|l| !l.trim().is_empty()).take(LOOKED_AT).collect();
    let records = held.iter().filter(|line| !pairs(line).is_empty()).count();
    records > 1 && 10 * records >= 9 * held.len()
}

/// The columns of records, in the order in which their names come up; NaN where a record lacks one.
pub(super) fn columns<'a>(lines: impl Iterator<Item = &'a str>) -> Columns {
    collected(lines.map(pairs).filter(|pairs| !pairs.is_empty()))
}

/// Records side by side.
pub(super) fn collected(records: impl Iterator<Item = Vec<(String, f64)>>) -> Columns {
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

/// Names and numbers of a record; nothing of a line that is none.
fn pairs(line: &str) -> Vec<(String, f64)> {
    let line = line.trim();
    if line.starts_with('{') {
        let mut out = vec![];
        if let Ok(object @ Value::Object(_)) = serde_json::from_str(line) {
            flatten("", &object, &mut out);
        }
        return out;
    }
    // the console of Arduino writes the time of arrival before an arrow
    let (clock, rest) = line.split_once(" -> ").map_or((None, line), |(c, r)| (Some(c), r));
    let clock = clock.and_then(|c| Some(("clock".to_string(), value(c, false)?)));
    let glued = rest.replace(": ", ":").replace("= ", "=").replace(" =", "=");
    let words = glued.split([',', ';', '\t', ' ']).filter(|word| !word.is_empty());
    let pair = |word: &str| {
        let (name, number) = word.split_once(['=', ':'])?;
        let is_name = name.starts_with(|c: char| c.is_alphabetic() || c == '_');
        Some((name.to_string(), number.parse().ok()?)).filter(|_| is_name)
    };
    let found: Option<Vec<(String, f64)>> = words.map(pair).collect();
    found.filter(|f| f.len() > 1).map_or(vec![], |f| clock.into_iter().chain(f).collect())
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
            let inner = list.iter().enumerate();
            inner.for_each(|(k, value)| flatten(&format!("{path}[{k}]"), value, out));
        }
        Value::Number(number) => out.push((path.into(), number.as_f64().unwrap_or(f64::NAN))),
        Value::Bool(flag) => out.push((path.into(), f64::from(u8::from(*flag)))),
        Value::String(text) => {
            // a date is a number too; other words are none
            let number = super::value(text, false).filter(|x| x.is_finite());
            out.extend(number.map(|x| (path.into(), x)));
        }
        Value::Null | Value::Array(_) => {}
    }
}
