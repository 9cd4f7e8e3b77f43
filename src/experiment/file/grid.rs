//! The keys of `[grid]` and their values.

use serde::Deserialize;
use toml::{Table, Value};

use crate::catalogue;

/// Keys of `[simulation]`, which may be used in `[grid]` without the name of their table.
pub(super) const SIMULATION_KEYS: [&str; 13] = [
    "movement",
    "hidden",
    "noise",
    "seed",
    "train",
    "validation",
    "rate_hz",
    "control_rate_hz",
    "duration_s",
    "top_speed_rad_s",
    "encoder_ticks",
    "truth",
    "noise_scale",
];

/// Tables of an experiment file whose keys may vary.
pub(super) const TABLES: [&str; 6] =
    ["robot", "recordings", "simulation", "model", "emulator", "diagnosis"];

/// Largest number of combinations of a grid.
const MOST_CELLS: usize = 1_000_000;

/// A key of the experiment file and the values it takes.
#[derive(Clone, Debug, PartialEq)]
pub struct GridAxis {
    /// Name in `[grid]`, which is also that of its column.
    pub name: String,
    /// Dotted key of the experiment file.
    pub key: String,
    /// Its values, in order.
    pub values: Vec<Value>,
}

impl GridAxis {
    /// Whether it only repeats the experiment with other noise realisations.
    #[must_use]
    pub fn is_seed(&self) -> bool {
        self.key == "simulation.seed"
    }

    /// Whether it changes only the recordings.
    #[must_use]
    pub fn is_data(&self) -> bool {
        self.key.starts_with("simulation.") || self.key.starts_with("recordings.")
    }

    /// Its values as numbers, if all are numeric.
    #[must_use]
    pub fn numbers(&self) -> Option<Vec<f64>> {
        self.values.iter().map(number).collect()
    }

    /// Positions of its values on an axis, with label and unit: the values themselves, or the speed noise in
    /// a table of noise levels.
    #[must_use]
    pub fn scale(&self) -> Option<(Vec<f64>, String, &'static str)> {
        if let Some(numbers) = self.numbers() {
            return Some((numbers, self.name.clone(), ""));
        }
        let of = |v: &Value| v.as_table()?.get("dalpha").and_then(number);
        let numbers = self.values.iter().map(of).collect::<Option<Vec<f64>>>()?;
        Some((numbers, "noise of dalpha".into(), "rad/s"))
    }

    /// A value as text.
    #[must_use]
    pub fn text(&self, value: usize) -> String {
        match &self.values[value] {
            Value::String(text) => text.clone(),
            other => other.to_string(),
        }
    }
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|i| i as f64))
}

/// An error in a key of `[grid]`.
pub(in crate::experiment) struct WrongKey {
    pub(in crate::experiment) key: String,
    pub(in crate::experiment) message: String,
}

/// `{ count = 100 }` or `{ from = 0.1, to = 10, steps = 5, log = true }`.
#[derive(Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Range {
    /// Number of integers, starting at `from` (1 unless given).
    #[schemars(range(min = 1, max = MOST_CELLS))]
    count: Option<usize>,
    /// First value.
    #[schemars(with = "Option<f64>")]
    from: Option<Value>,
    /// Last value.
    #[schemars(with = "Option<f64>")]
    to: Option<Value>,
    /// Number of values, from the first to the last.
    #[schemars(range(min = 2, max = MOST_CELLS))]
    steps: Option<usize>,
    /// Equal ratios instead of equal steps.
    #[serde(default)]
    log: bool,
}

/// The axes of `[grid]`, in alphabetical order of their keys as written.
///
/// # Errors
/// An unknown key, and values that are neither a list nor a range.
pub(in crate::experiment) fn axes(grid: &Table) -> Result<Vec<GridAxis>, WrongKey> {
    let mut out: Vec<GridAxis> = Vec::new();
    for (name, values) in flat(grid, "") {
        let wrong = |message: String| WrongKey { key: name.clone(), message };
        let key = full_key(&name).map_err(wrong)?;
        if out.iter().any(|axis| axis.key == key) {
            return Err(wrong(format!("and {key} are the same key; keep one")));
        }
        let values = self::values(&values).map_err(wrong)?;
        out.push(GridAxis { name, key, values });
    }
    let cells = out.iter().try_fold(1_usize, |n, axis| n.checked_mul(axis.values.len()));
    if cells.is_none_or(|n| n > MOST_CELLS) {
        let key = out.iter().max_by_key(|a| a.values.len()).map_or("", |a| &a.name).to_string();
        let message = format!("makes more than {MOST_CELLS} combinations; give fewer values");
        return Err(WrongKey { key, message });
    }
    Ok(out)
}

/// Entries with dotted keys; `simulation.seed = …` without quotes is a table in a table.
fn flat(table: &Table, before: &str) -> Vec<(String, Value)> {
    let mut out = Vec::new();
    for (key, value) in table {
        let key = format!("{before}{key}");
        match value {
            Value::Table(inner) if holds_axes(inner) => out.extend(flat(inner, &format!("{key}."))),
            _ => out.push((key, value.clone())),
        }
    }
    out
}

/// Whether a table contains axes and is not itself a range.
fn holds_axes(table: &Table) -> bool {
    !table.is_empty() && table.values().all(|v| v.is_array() || v.is_table())
}

fn full_key(name: &str) -> Result<String, String> {
    if let Some((table, rest)) = name.split_once('.') {
        if TABLES.contains(&table) && rest.split('.').all(|part| !part.is_empty()) {
            return Ok(name.to_string());
        }
        if table == "method" {
            let message = "varies a method; write one [[method]] block for each instead: all \
                           methods run in every combination";
            return Err(message.into());
        }
        return Err(format!("is not a key of an experiment file{}", nearest(table, &TABLES)));
    }
    if SIMULATION_KEYS.contains(&name) {
        return Ok(format!("simulation.{name}"));
    }
    let near = nearest(name, &SIMULATION_KEYS);
    Err(format!(
        "is not a key of [simulation]{near}; keys of other tables are written with their table, for \
         example \"model.effects\""
    ))
}

fn nearest(name: &str, known: &[&str]) -> String {
    catalogue::nearest(name, known.iter().copied())
        .map_or(String::new(), |near| format!("; did you mean `{near}`?"))
}

fn values(value: &Value) -> Result<Vec<Value>, String> {
    match value {
        Value::Array(values) if values.is_empty() => Err("has no value; give at least one".into()),
        Value::Array(values) => Ok(values.clone()),
        Value::Table(table) => {
            let range: Range = Value::Table(table.clone())
                .try_into()
                .map_err(|e: toml::de::Error| format!("is not a range: {}", e.message()))?;
            range.values()
        }
        other => Err(format!(
            "= {other} is not a list; write [{other}], {{ count = 100 }}, or {{ from = 0.1, to = 10, \
             steps = 5, log = true }}"
        )),
    }
}

impl Range {
    fn values(&self) -> Result<Vec<Value>, String> {
        match (self.count, &self.from, &self.to, self.steps) {
            (Some(count), from, None, None) if !self.log => {
                let first = match from {
                    None => 1,
                    Some(Value::Integer(first)) => *first,
                    Some(other) => return Err(format!("from = {other} must be a whole number")),
                };
                if count == 0 || count > MOST_CELLS {
                    return Err(format!("count = {count} must lie between 1 and {MOST_CELLS}"));
                }
                let last = first.checked_add(count as i64 - 1);
                let last = last.ok_or_else(|| format!("from = {first} is too large"))?;
                Ok((first..=last).map(Value::Integer).collect())
            }
            (None, Some(from), Some(to), Some(steps)) => self.spaced(from, to, steps),
            _ => {
                Err("is not a range; write { count = 100 } with or without from, or { from = 0.1, \
                      to = 10, steps = 5 } with or without log = true"
                    .into())
            }
        }
    }

    /// Equidistant values, or a geometric progression. Integers stay integers.
    fn spaced(&self, from: &Value, to: &Value, steps: usize) -> Result<Vec<Value>, String> {
        let end = |name: &str, value: &Value| {
            let finite = number(value).filter(|x| x.is_finite());
            finite.ok_or_else(|| format!("{name} = {value} must be a finite number"))
        };
        let (a, b) = (end("from", from)?, end("to", to)?);
        if !(2..=MOST_CELLS).contains(&steps) {
            return Err(format!("steps = {steps} must lie between 2 and {MOST_CELLS}"));
        }
        if self.log && !(a > 0.0 && b > 0.0) {
            return Err("with log = true from and to must be positive".into());
        }
        let place = |k: usize| k as f64 / (steps - 1) as f64;
        let at = |k: usize| match k {
            0 => a,
            k if k == steps - 1 => b,
            k if self.log => a * (b / a).powf(place(k)),
            k => a + (b - a) * place(k),
        };
        let all: Vec<f64> = (0..steps).map(at).collect();
        let whole = from.is_integer() && to.is_integer() && all.iter().all(|x| x.fract() == 0.0);
        let value = |x: f64| if whole { Value::Integer(x as i64) } else { Value::Float(x) };
        Ok(all.into_iter().map(value).collect())
    }
}

#[cfg(test)]
mod tests;
