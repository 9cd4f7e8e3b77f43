//! Tables with a row for each joint, motor or signal, side by side.

use std::collections::HashMap;
use std::path::Path;

use super::keys::{is_label, is_value, labels, time};
use super::{Layout, Style, by_place, value};
use crate::io::IoError;

/// Columns with their names.
type Columns = Vec<(String, Vec<f64>)>;

/// Number of rows from which a long-form table is detected.
const LOOKED_AT: usize = 64;

/// The columns of a table that has a row for each joint, with the name or number of the joint in a column: `velocity`
/// of `left` becomes `velocity.left`. Rows of one time become one row; what a joint does not have at that time is NaN.
/// A quantity that one joint alone has keeps its name, and one that none has is left out: so are messages of several
/// kinds in one table. Of tables that stand one below the other, each from the same time on, the rows of one time are
/// one as well. `None` for any other table.
///
/// # Errors
/// A file that cannot be read.
pub(in crate::io) fn unfold(path: &Path, layout: &Layout) -> Result<Option<Columns>, IoError> {
    let separator = char::from(layout.separator);
    let head = super::rows(path)?.take(LOOKED_AT);
    let head: Vec<Vec<String>> =
        head.map(|(_, _, line)| super::split(&String::from_utf8_lossy(&line), separator)).collect();
    if !may_be_keyed(&layout.names, &head, layout.style) {
        return Ok(None);
    }
    Ok(unfolded(&layout.names, &by_place(path, layout)?, layout.style))
}

/// Whether the first rows have a time and a column that may identify the motor of a row.
pub(in crate::io) fn may_be_keyed(names: &[String], rows: &[Vec<String>], style: Style) -> bool {
    let head: Vec<Vec<String>> = (0..names.len())
        .map(|k| rows.iter().map(|row| row.get(k).map_or("", |c| c.trim()).to_string()).collect())
        .collect();
    let Some(time) = time(&head, style) else { return false };
    (0..names.len()).any(|k| k != time && is_label(&names[k], &head[k], &head[time], style))
}

/// The same of cells that are held, column by column.
pub(in crate::io) fn unfolded(
    names: &[String],
    texts: &[Vec<String>],
    style: Style,
) -> Option<Columns> {
    let head: Vec<Vec<String>> =
        texts.iter().map(|cells| cells.iter().take(LOOKED_AT).cloned().collect()).collect();
    let time = time(&head, style)?;
    let times: Vec<f64> = texts[time].iter().map(|c| value(c, style).unwrap_or(f64::NAN)).collect();
    let labels = labels(names, texts, &head, (time, &times), style);
    if labels.is_empty() {
        return None;
    }
    // numbers that are written down for people, as a table's own, are no quantities of a joint
    let rows = Rows::new(names, texts, &labels, time, style);
    Some(with_numbers(
        rows.side_by_side(&times),
        &rows.quantities.iter().map(|(n, _)| n).collect::<Vec<_>>(),
    ))
}

/// The rows of a table, each of a key.
struct Rows<'a> {
    time: &'a str,
    keys: Vec<String>,
    /// Which key each row has.
    owner: Vec<usize>,
    quantities: Vec<(String, &'a [String])>,
    style: Style,
}

impl<'a> Rows<'a> {
    fn new(
        names: &'a [String],
        texts: &'a [Vec<String>],
        labels: &[usize],
        time: usize,
        style: Style,
    ) -> Self {
        let key = |row: usize| {
            labels.iter().map(|k| texts[*k][row].as_str()).collect::<Vec<_>>().join(".")
        };
        let (mut keys, mut owner): (Vec<String>, Vec<usize>) = (vec![], vec![]);
        for row in 0..texts[time].len() {
            let key = key(row);
            let place = keys.iter().position(|k| *k == key).unwrap_or_else(|| {
                keys.push(key);
                keys.len() - 1
            });
            owner.push(place);
        }
        let quantities = (0..names.len()).filter(|k| *k != time && !labels.contains(k));
        let quantities = quantities.map(|k| (names[k].clone(), &texts[k][..])).collect();
        Self { time: &names[time], keys, owner, quantities, style }
    }

    /// A column for each quantity and key: rows with equal times become one row, unless a key occurs again.
    fn side_by_side(&self, times: &[f64]) -> Columns {
        let count = self.quantities.len();
        let mut names = vec![self.time.to_string()];
        for key in &self.keys {
            names.extend(self.quantities.iter().map(|(name, _)| keyed(name, key)));
        }
        let mut columns: Vec<Vec<f64>> = vec![vec![]; names.len()];
        let mut latest: HashMap<u64, usize> = HashMap::new();
        for (row, t) in times.iter().enumerate() {
            let first = 1 + self.owner[row] * count;
            let is_held = |at: usize| columns[first..first + count].iter().any(|c| !c[at].is_nan());
            // a joint that comes again begins a row of its own, as a log does that has no time between
            let at = match latest.get(&t.to_bits()).copied().filter(|at| !is_held(*at)) {
                Some(at) => at,
                None => {
                    columns.iter_mut().for_each(|c| c.push(f64::NAN));
                    let at = columns[0].len() - 1;
                    columns[0][at] = *t;
                    latest.insert(t.to_bits(), at);
                    at
                }
            };
            for (column, (_, cells)) in columns[first..].iter_mut().zip(&self.quantities) {
                column[at] = value(&cells[row], self.style).unwrap_or(f64::NAN);
            }
        }
        names.into_iter().zip(columns).collect()
    }
}

/// The name of a quantity of a key, with its unit at the end.
fn keyed(name: &str, key: &str) -> String {
    if is_value(name) {
        return key.into();
    }
    match name.find(['[', '(']) {
        Some(at) if at > 0 => format!("{}.{key} {}", name[..at].trim_end(), &name[at..]),
        _ => format!("{name}.{key}"),
    }
}

/// The numeric columns after the first, which is the time. The joints follow each other, each with these quantities in
/// order.
fn with_numbers(columns: Columns, quantities: &[&String]) -> Columns {
    if quantities.is_empty() {
        return columns;
    }
    let is_filled = |(_, values): &(String, Vec<f64>)| values.iter().any(|x| !x.is_nan());
    let filled: Vec<bool> = columns.iter().map(is_filled).collect();
    let joints_with = |quantity: usize| {
        filled.iter().skip(1 + quantity).step_by(quantities.len()).filter(|f| **f).count()
    };
    let numbered = columns.into_iter().enumerate().filter(|(k, _)| *k == 0 || filled[*k]);
    numbered
        .map(|(k, (name, values))| {
            let quantity = k.saturating_sub(1) % quantities.len();
            let alone = k > 0 && joints_with(quantity) == 1;
            (if alone { quantities[quantity].clone() } else { name }, values)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(header: &str, rows: &[String]) -> Option<Columns> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        std::fs::write(&path, format!("{header}\n{}\n", rows.join("\n"))).unwrap();
        unfold(&path, &super::super::layout(&path).unwrap()).unwrap()
    }

    fn names(columns: &Columns) -> Vec<&str> {
        columns.iter().map(|(name, _)| name.as_str()).collect()
    }

    #[test]
    fn the_direction_of_a_wheel_is_no_joint() {
        let row =
            |k: usize| format!("{k},{0},{k},{0},{k}", if k.is_multiple_of(2) { "F" } else { "R" });
        let rows: Vec<String> = (0..40).map(row).collect();
        assert!(read("ms,dirL,rpmL,dirR,rpmR", &rows).is_none());
        assert!(read("ms,direction,rpm,force,x", &rows).is_some());
    }

    #[test]
    fn rows_of_numbered_motors_stand_side_by_side() {
        let rows: Vec<String> =
            (0..40).map(|k| format!("{}.{:04},{},{k}", k / 2, 2 * (k % 2), k % 2 + 1)).collect();
        let found = read("time,motor_id,velocity (rpm)", &rows).unwrap();
        assert_eq!(names(&found), ["time", "velocity.1 (rpm)", "velocity.2 (rpm)"]);
        // without a telling name the times must agree
        assert_eq!(read("time,x,velocity (rpm)", &rows), None);
        let rows: Vec<String> = (0..40).map(|k| format!("{},{},{k}", k / 2, k % 2 + 1)).collect();
        let found = read("time,x,rpm", &rows).unwrap();
        assert_eq!((names(&found), found[1].1.len()), (vec!["time", "rpm.1", "rpm.2"], 20));
    }

    #[test]
    fn tables_one_below_the_other_have_the_same_rows() {
        // result, table, value, time, field, side
        let row = |k: usize| {
            let (field, side) = (["rpm", "A"][k / 100 % 2], ["l", "r"][k / 200]);
            format!(",{},2,{},{field},{side}", k / 100, k % 100)
        };
        let rows: Vec<String> = (0..400).map(row).collect();
        let found = read(",table,_value,_time,_field,side", &rows).unwrap();
        assert_eq!(found[0].1.len(), 100);
        let all = names(&found);
        assert!(all.contains(&"rpm.l") && all.contains(&"A.r"), "{all:?}");
        // nor are those of a clock that starts anew, and those of both wheels
        let of = |header: &str, from: usize, words: [&str; 2]| {
            let row = |k: usize| format!("{},{},{k},3", words[k / 100], from + k % 100);
            read(header, &(0..200).map(row).collect::<Vec<_>>())
        };
        let found = of("motor,t,rpm,amps", 1000, ["L", "R"]).unwrap();
        assert_eq!(names(&found), ["t", "rpm.L", "amps.L", "rpm.R", "amps.R"]);
        assert_eq!(of("motor,t,rpm,amps", 0, ["L", "R"]), None);
        assert_eq!(of("run,t,rpm,amps", 1000, ["A", "B"]), None);
        assert_eq!(of("log,t,rpm_l,rpm_r", 1000, ["A", "B"]), None);
        // a state that changes is none
        let rows: Vec<String> = (0..80).map(|k| format!("{k},{},3", ["a", "b"][k / 40])).collect();
        assert_eq!(read("t,state,x", &rows), None);
    }
}
