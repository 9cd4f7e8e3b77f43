//! Columns with an index in their names, where another column contains the name of the joint of that index:
//! the messages of `rostopic echo -p`, PlotJuggler and Foxglove.

use std::collections::BTreeSet;
use std::path::Path;

use super::{Layout, split, value};
use crate::io::{IoError, is_owner, words};

/// Rows in which the cells are the same.
const LOOKED_AT: usize = 64;

/// The name of a joint or motor, and the names of its columns.
struct Owner {
    /// The text before the index: `field.` of `field.name0`, and the index; or all of `field.motors0.`.
    before: String,
    index: Option<String>,
    label: String,
}

/// Puts the words of `name0`, `name[0]`, `motors0.device_name` in the place of the index of the columns beside them:
/// `field.position0` becomes `wheel_left.position` where `field.name0` is `wheel_left` in all rows.
///
/// # Errors
/// A file that cannot be read.
pub(in crate::io) fn named_by_cells(path: &Path, layout: Layout) -> Result<Layout, IoError> {
    if !layout.names.iter().any(|name| is_label(last_part(name).1)) {
        return Ok(layout);
    }
    let separator = char::from(layout.separator);
    let rows: Vec<Vec<String>> = super::rows(path)?
        .take(LOOKED_AT)
        .map(|(_, _, line)| split(&String::from_utf8_lossy(&line), separator))
        .collect();
    let label = |k: usize| -> Option<String> {
        let first = rows.first()?.get(k)?;
        let is_same = rows.iter().all(|row| row.get(k) == Some(first));
        let is_word = first.contains(char::is_alphabetic) && value(first, layout.style).is_none();
        (is_same && is_word).then(|| first.clone())
    };
    let owners: Vec<Owner> =
        layout.names.iter().enumerate().filter_map(|(k, name)| owner(name, label(k)?)).collect();
    let labels: BTreeSet<&String> = owners.iter().map(|owner| &owner.label).collect();
    if owners.len() < 2 || labels.len() < owners.len() {
        return Ok(layout);
    }
    let named: Vec<String> = layout
        .names
        .iter()
        .map(|name| {
            owners.iter().find_map(|owner| owner.named(name)).unwrap_or_else(|| name.clone())
        })
        .collect();
    let is_unique = named.iter().collect::<BTreeSet<_>>().len() == named.len();
    Ok(if is_unique { Layout { names: named, ..layout } } else { layout })
}

/// The owner that a column of labels names.
fn owner(name: &str, label: String) -> Option<Owner> {
    let (before, last) = last_part(name);
    let (stem, index) = indexed(last);
    if !is_label(stem) {
        return None;
    }
    let is_list = || indexed(before.trim_end_matches(['.', '/'])).1.is_some();
    match index {
        Some(index) => Some(Owner { before: before.into(), index: Some(index.into()), label }),
        None => is_list().then(|| Owner { before: before.into(), index: None, label }),
    }
}

impl Owner {
    /// The name of a column of this owner, with the label in the place of the index.
    fn named(&self, name: &str) -> Option<String> {
        let rest = name.strip_prefix(&self.before)?;
        let own = match &self.index {
            Some(index) => {
                let (stem, own) = indexed(rest);
                let is_own = own == Some(index.as_str()) && !stem.contains(['.', '/']);
                is_own.then_some(stem)?
            }
            None => rest,
        };
        Some(format!("{}.{}", self.label, own.trim_end_matches(['_', ' '])))
    }
}

/// The text before the last part of a path, and that part.
fn last_part(name: &str) -> (&str, &str) {
    name.split_at(name.rfind(['.', '/']).map_or(0, |at| at + 1))
}

/// A name without its trailing index, and the index: `name0`, `name[0]`, `name_0`.
fn indexed(name: &str) -> (&str, Option<&str>) {
    let inner = name.strip_suffix(']').unwrap_or(name);
    let stem = inner.trim_end_matches(|c: char| c.is_ascii_digit());
    let index = &inner[stem.len()..];
    if index.is_empty() { (name, None) } else { (stem.trim_end_matches(['[', '_']), Some(index)) }
}

/// Whether the part of a name is that of names of joints or motors.
fn is_label(part: &str) -> bool {
    let stem = indexed(part).0;
    is_owner(stem) || words(stem).last().is_some_and(|word| word == "name" || word == "names")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(header: &str, row: &str) -> Vec<String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        std::fs::write(&path, format!("{header}\n{}", format!("{row}\n").repeat(9))).unwrap();
        named_by_cells(&path, super::super::layout(&path).unwrap()).unwrap().names
    }

    #[test]
    fn words_in_cells_name_the_columns_of_their_index() {
        let found = read("%time,f.name0,f.name1,f.position0,f.position1", "1,left,right,2,3");
        assert_eq!(found[3..], ["left.position", "right.position"]);
        let found = read("t,/j.name[0],/j.name[1],/j.vel[0],/j.vel[1],x[0]", "1,right,left,2,3,4");
        assert_eq!(found[3..], ["right.vel", "left.vel", "x[0]"]);
        let header = "t,f.m0.device_name,f.m0.speed,f.m1.device_name,f.m1.speed,f.frame_id";
        let found = read(header, "1,left,2,right,3,base");
        assert_eq!((found[2].as_str(), found[4].as_str()), ("left.speed", "right.speed"));
        assert_eq!(found[5], "f.frame_id");
    }

    #[test]
    fn cells_that_do_not_tell_joints_apart_name_none() {
        let header = "t,s0.name,s0.level,s1.name,s1.level";
        assert_eq!(read(header, "1,OK,2,OK,3")[2], "s0.level");
        assert_eq!(read("t,name,w0,w1", "1,robot,2,3")[2], "w0");
    }
}
