//! Units in brackets after the name of a column.

use std::path::Path;

use super::super::{Column, ColumnMap, IoError, is_side};
use crate::io::error::shown;

/// The name without the unit behind it.
pub(super) fn bare(name: &str) -> &str {
    let name = without_port(name).0;
    match opening(name).filter(|_| !is_element(name)) {
        Some(at) => name[..at].trim(),
        None if is_element(name) => name,
        None => name.trim(),
    }
}

/// A name and the number behind its unit: Simulink writes that of the port of the block, `Speed (rad/s):1`. The quote that
/// npTDMS writes behind the unit, `/'Motors'/'Speed (rad/s)'`, is left out too.
#[must_use]
pub fn without_port(name: &str) -> (&str, Option<&str>) {
    let unquoted = name.trim_end().strip_suffix('\'');
    if let Some(front) = unquoted.filter(|front| front.ends_with([']', ')'])) {
        return (front, None);
    }
    let is_number = |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_digit());
    match name.trim_end().rsplit_once(':') {
        Some((front, port)) if front.ends_with([']', ')']) && is_number(port) => {
            (front, Some(port))
        }
        _ => (name, None),
    }
}

/// The unit in brackets behind a name; the word of a side is none.
pub(super) fn bracketed(name: &str) -> Option<&str> {
    let name = without_port(name).0;
    let unit = name[opening(name)? + 1..].trim_end_matches([']', ')']).trim();
    (!unit.is_empty() && !is_element(name) && !is_side(unit)).then_some(unit)
}

/// The place of the first bracket that holds no index: of `drivers[0]/speed [rpm]` that of the unit.
#[must_use]
pub fn opening(name: &str) -> Option<usize> {
    let holds_index = |after: &str| {
        let inner = after.split([']', ')']).next().unwrap_or(after);
        inner.len() < after.len() && !inner.is_empty() && inner.chars().all(is_of_index)
    };
    name.match_indices(['[', '(']).map(|(at, _)| at).find(|at| !holds_index(&name[at + 1..]))
}

/// Whether a character may be part of an index, as in `[0]` and `(:,1)`.
fn is_of_index(c: char) -> bool {
    c.is_ascii_digit() || c == ':' || c == ','
}

/// Factor and offset of a column; the unit behind its name counts where the map gives none.
pub(super) fn conversion(
    path: &Path,
    columns: &ColumnMap,
    key: &str,
    name: &str,
) -> Result<(f64, f64), IoError> {
    let unit = bracketed(name);
    columns.conversion(key, columns.get(key), unit).map_err(|e| match (e, unit) {
        (IoError::Unit { .. }, Some(unit)) if columns.get(key).unit.is_none() => {
            IoError::HeaderUnit {
                file: shown(path),
                column: name.into(),
                unit: unit.into(),
                si: columns.unit_of(key),
                key: key.into(),
            }
        }
        (e, _) => e,
    })
}

/// The unit that the header states behind a name, where it is none of that quantity.
#[must_use]
pub fn unknown_unit<'a>(map: &ColumnMap, key: &str, name: &'a str) -> Option<&'a str> {
    let unit = bracketed(name)?;
    let found = map.conversion(key, &Column::new(name), Some(unit));
    matches!(found, Err(IoError::Unit { .. })).then_some(unit)
}

/// Whether the brackets behind a name hold an index, as in `name[0]` and `name(:,1)`.
fn is_element(name: &str) -> bool {
    let inner = name.strip_suffix([']', ')']).and_then(|n| n.rsplit_once(['[', '(']));
    inner.is_some_and(|(_, i)| !i.is_empty() && i.chars().all(is_of_index))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_hold_a_unit_or_an_index() {
        assert_eq!((bare("speed [rpm]"), bracketed("speed [rpm]")), ("speed", Some("rpm")));
        assert_eq!((bare("i (A)"), bracketed("i (A)")), ("i", Some("A")));
        assert_eq!((bare("velocity(:,1)"), bracketed("velocity(:,1)")), ("velocity(:,1)", None));
        assert_eq!((bare("t"), bracketed("t []")), ("t", None));
        let inner = "drivers[0]/speed [rpm]";
        assert_eq!((bare(inner), bracketed(inner)), ("drivers[0]/speed", Some("rpm")));
        assert_eq!(bracketed("drivers[0]/speed"), None);
        let port = "Speed (rad/s):1";
        assert_eq!((bare(port), bracketed(port)), ("Speed", Some("rad/s")));
        assert_eq!(
            (without_port("Data:1"), without_port("a[0]:2")),
            (("Data:1", None), ("a[0]", Some("2")))
        );
        assert_eq!((bracketed("omega 1 (rechts)"), bracketed("speed [R]")), (None, None));
        let quoted = "/'Motors'/'Speed (rad/s)'";
        assert_eq!((bare(quoted), bracketed(quoted)), ("/'Motors'/'Speed", Some("rad/s")));
        let unknown =
            |key: &str, name: &'static str| unknown_unit(&ColumnMap::default(), key, name);
        assert_eq!(unknown("M1", "torque [0.1%]"), Some("0.1%"));
        assert_eq!((unknown("M1", "torque [oz-in]"), unknown("M1", "i [A]")), (None, None));
    }
}
