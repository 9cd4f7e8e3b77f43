//! Tables whose cells contain lists, as tables of ROS messages do: `"(0.1, 0.2)"`, `"[0.1 0.2]"`.

use std::path::Path;

use super::{Layout, by_place, split, value};
use crate::io::IoError;

/// Columns with their names.
type Columns = Vec<(String, Vec<f64>)>;

/// Number of rows from which lists in cells are detected.
const LOOKED_AT: usize = 8;
/// Largest number of elements of a list that become columns; longer lists are images and maps.
const ELEMENTS: usize = 64;

/// The columns of a table in which some cells hold lists: an element of a list is a column, `position[0]`, under the
/// name of its joint where a list of as many words stands in the row, `wheel_left.position`. `None` for any other
/// table.
///
/// # Errors
/// A file that cannot be read.
pub(in crate::io) fn lists(path: &Path, layout: &Layout) -> Result<Option<Columns>, IoError> {
    let separator = char::from(layout.separator);
    let head: Vec<Vec<String>> = super::rows(path)?
        .take(LOOKED_AT)
        .map(|(_, _, line)| split(&String::from_utf8_lossy(&line), separator))
        .collect();
    let holds = |k: &usize| {
        !head.is_empty()
            && head.iter().all(|row| row.get(*k).is_some_and(|c| elements(c).is_some()))
    };
    let places: Vec<usize> = (0..layout.names.len()).filter(holds).collect();
    if places.is_empty() {
        return Ok(None);
    }
    let texts = by_place(path, layout)?;
    let words = places.iter().find_map(|k| joints(texts[*k].first()?));
    let mut columns = vec![];
    for (k, name) in layout.names.iter().enumerate() {
        if places.contains(&k) {
            columns.extend(of_cells(name, &texts[k], words.as_deref()));
        } else {
            let number = |cell: &String| value(cell, layout.style).unwrap_or(f64::NAN);
            columns.push((name.clone(), texts[k].iter().map(number).collect()));
        }
    }
    if let Some(words) = words {
        name_elements(&mut columns, &words);
    }
    Ok(Some(columns))
}

/// Gives columns that are the elements of a list, `position_0`, `position_1`, the names of the joints, where there are
/// as many.
fn name_elements(columns: &mut Columns, joints: &[String]) {
    let parted = |name: &str| -> Option<(String, usize)> {
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let number = name[stem.len()..].parse().ok()?;
        Some((stem.strip_suffix(['_', '.'])?.to_string(), number))
    };
    let places: Vec<_> = columns.iter().map(|(name, _)| parted(name)).collect();
    let is_whole = |list: &str| {
        let of = places.iter().flatten().filter(|(stem, _)| stem == list);
        let numbers: std::collections::BTreeSet<usize> = of.map(|(_, number)| *number).collect();
        numbers.iter().copied().eq(0..joints.len())
    };
    for (column, place) in columns.iter_mut().zip(&places) {
        if let Some((list, number)) = place.as_ref().filter(|(list, _)| is_whole(list)) {
            column.0 = format!("{}.{list}", joints[*number]);
        }
    }
}

/// The elements of a cell that is a list of numbers or of quoted words; a time in brackets is not a list.
fn elements(cell: &str) -> Option<Vec<&str>> {
    // as Python prints the arrays of messages
    let cell = cell.trim();
    let typed =
        cell.strip_prefix("array(").and_then(|c| Some(c.strip_suffix(')')?.split_once(", ")?.1));
    let cell = typed.unwrap_or(cell).trim();
    let inner = cell
        .strip_prefix('[')
        .and_then(|c| c.strip_suffix(']'))
        .or_else(|| cell.strip_prefix('(').and_then(|c| c.strip_suffix(')')))?;
    let is_element = |e: &&str| e.parse::<f64>().is_ok() || e.starts_with(['\'', '"']);
    let elements: Vec<&str> =
        inner.split([',', ' ']).map(str::trim).filter(|e| !e.is_empty()).collect();
    elements.iter().all(is_element).then_some(elements)
}

/// The words of a list in which no element is a number.
fn joints(cell: &str) -> Option<Vec<String>> {
    let words = elements(cell)?;
    let bare = |word: &&str| word.trim_matches(['\'', '"']).to_string();
    let is_word = |word: &&str| word.parse::<f64>().is_err();
    (!words.is_empty() && words.iter().all(is_word)).then(|| words.iter().map(bare).collect())
}

/// The elements of the lists of a column, one column per element; empty for lists of words.
fn of_cells(name: &str, cells: &[String], joints: Option<&[String]>) -> Columns {
    let number = |cell: &String, j: usize| -> f64 {
        let list = elements(cell);
        list.and_then(|list| list.get(j)?.parse().ok()).unwrap_or(f64::NAN)
    };
    let width = cells.iter().filter_map(|cell| Some(elements(cell)?.len())).max().unwrap_or(0);
    let named = |j: usize| match joints {
        Some(joints) if joints.len() == width => format!("{}.{name}", joints[j]),
        _ => format!("{name}[{j}]"),
    };
    (0..width.min(ELEMENTS))
        .map(|j| (named(j), cells.iter().map(|cell| number(cell, j)).collect::<Vec<f64>>()))
        .filter(|(_, values)| values.iter().any(|x| !x.is_nan()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_elements_have_the_names_of_a_list_of_as_many_words() {
        let row = |k: i32| format!("0.{k},\"['left', 'right']\",1.{k},2,3,7,8,9\n");
        let names = "t,name,position_0,position_1,k_0,effort_0,effort_1,effort_2\n";
        let found = read(&(names.to_string() + &(0..5).map(row).collect::<String>())).unwrap();
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        let others = ["k_0", "effort_0", "effort_1", "effort_2"];
        assert_eq!(names[..3], ["t", "left.position", "right.position"]);
        assert_eq!(names[3..], others);
    }

    fn read(text: &str) -> Option<Columns> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        std::fs::write(&path, text).unwrap();
        lists(&path, &super::super::layout(&path).unwrap()).unwrap()
    }

    #[test]
    fn an_element_of_a_list_is_a_column_under_the_name_of_its_joint() {
        let row = |k: i32| {
            format!("{k},\"['wheel_left', 'wheel_right']\",\"({k}.5, -{k})\",\"[1.0 2.0 3.0]\",7\n")
        };
        let rows: String = (0..9).map(row).collect();
        let found = read(&format!("Time,name,velocity,pose,seq\n{rows}")).unwrap();
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(
            names,
            [
                "Time",
                "wheel_left.velocity",
                "wheel_right.velocity",
                "pose[0]",
                "pose[1]",
                "pose[2]",
                "seq"
            ]
        );
        assert_eq!((found[1].1[4], found[2].1[4], found[5].1[0]), (4.5, -4.0, 3.0));
        let row = |k: i32| format!("{k},\"array('d', [{k}.5, -{k}])\"\n");
        let rows: String = (0..9).map(row).collect();
        assert_eq!(read(&format!("t,velocity\n{rows}")).unwrap()[1].1[4], 4.5);
        assert_eq!(read("t,a\n0,1\n1,2\n"), None);
        assert_eq!(read("t,a\n[12:00:01.5],1\n[12:00:02.5],2\n"), None);
    }
}
