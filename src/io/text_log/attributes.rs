//! Lines of a header that state an attribute of all columns, and are no names.

use crate::io::csv::{Style, is_units, value};

/// First cells of a line of units in which they alternate with that word.
const UNITS: [&str; 4] = ["Unit", "Units", "unit", "units"];
/// Name of a column of times in the lines of TwinCAT Scope, where the word stands before the name of each signal.
const NAME: &str = "Name";

/// The units of cells that alternate between one word and units, `Unit,deg/s,Unit,Nm`, with an empty cell in place of
/// that word. Behind the word for a unit they may be unknown ones.
pub(super) fn alternating_units(cells: &[String]) -> Option<Vec<String>> {
    let is_unit = |cell: &String| is_units(std::slice::from_ref(cell));
    let word = cells.first().filter(|word| cells.len() > 3 && !is_unit(word))?;
    let others = || cells.iter().skip(1).step_by(2);
    let is_keyword = UNITS.contains(&word.as_str());
    let are_units = others().all(|cell| cell.is_empty() || is_unit(cell) || is_keyword)
        && others().any(is_unit)
        && cells.iter().step_by(2).all(|c| c == word);
    let unit = |(k, cell): (usize, &String)| if k % 2 == 1 { cell.clone() } else { String::new() };
    are_units.then(|| cells.iter().enumerate().map(unit).collect())
}

/// The known units of a line of units, and an empty cell in place of any other: the word before them, as in
/// `unit,s,rad/s`.
pub(super) fn known_units(cells: &[String]) -> Vec<String> {
    let is_one = |cell: &String| is_units(std::slice::from_ref(cell));
    cells.iter().map(|cell| if is_one(cell) { cell.clone() } else { String::new() }).collect()
}

/// Names in which the times before the signals are called so: TwinCAT Scope writes `Name` in their place.
pub(super) fn times_named(cells: &[String]) -> Vec<String> {
    let is_one = cells.len() > 3
        && cells.len().is_multiple_of(2)
        && cells.iter().enumerate().all(|(k, cell)| (k % 2 == 0) == (cell == NAME));
    let named = |cell: &String| if is_one && cell == NAME { "Time".into() } else { cell.clone() };
    cells.iter().map(named).collect()
}

/// Whether all cells that hold something begin with the same word and a colon, `Type: double,Type: single`: an attribute
/// of the columns as Simulink writes it.
pub(super) fn are_of_one_key(cells: &[String]) -> bool {
    let held = || cells.iter().filter(|cell| !cell.is_empty());
    let key = |cell: &String| cell.split_once(": ").map(|(key, _)| key.to_owned());
    let first = held().next().and_then(key);
    first.is_some() && held().count() > 1 && held().all(|cell| key(cell) == first)
}

/// Whether cells are an attribute of the columns and no names: every second cell is the same word and the others repeat
/// themselves, or are numbers or empty; or half of the cells are empty.
pub(super) fn is_attribute(cells: &[String]) -> bool {
    let filled = cells.iter().filter(|c| !c.is_empty()).count();
    let (mut labels, values) = (cells.iter().step_by(2), cells.iter().skip(1).step_by(2));
    let is_same = cells.len() > 3 && labels.all(|c| *c == cells[0]) && !cells[0].is_empty();
    let values: Vec<&String> = values.collect();
    let distinct = values.iter().collect::<std::collections::BTreeSet<_>>().len();
    let are_numbers = values.iter().all(|c| c.is_empty() || value(c, Style::Either).is_some());
    cells.len() > 2 && 2 * filled <= cells.len()
        || is_same && (distinct < values.len() || are_numbers)
        || are_of_one_key(cells)
}
