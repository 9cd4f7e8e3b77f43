//! Magnitudes with separate direction columns: `pwmL` and `dirL`.

use std::path::Path;

use super::super::csv::Layout;
use super::super::error::shown;
use super::super::{Column, ColumnMap, IoError};
use super::headers::{Headers, Source};

/// The columns of directions, with the quantities that take their sign from them.
pub(super) const SIGNS: [(&str, &str); 4] = [
    ("dalpha1.sign", "dalpha1"),
    ("dalpha2.sign", "dalpha2"),
    ("M1.sign", "M1"),
    ("M2.sign", "M2"),
];

/// Lets the reader of a text take the words of directions for numbers: -1 where they say backward, else 1.
pub(in crate::io) fn read_words(headers: &mut Headers, columns: &ColumnMap) {
    let Source::Text(layout) = &mut headers.source else { return };
    for (_, key) in SIGNS {
        if let Column { sign: Some(sign), backward: Some(word), .. } = columns.get(key) {
            name_direction(layout, sign, word);
        }
    }
}

/// A number is read as one; a word is a direction.
fn name_direction(layout: &mut Layout, sign: &str, word: &str) {
    let place = layout.names.iter().position(|name| name == sign);
    if let Some(place) = place.filter(|_| word.trim().parse::<f64>().is_err()) {
        layout.directions.push((place, word.trim().into()));
    }
}

/// Gives magnitudes the sign of their direction. A row without a direction has no value.
pub(super) fn give_sign(
    path: &Path,
    (key, column): (&str, &Column),
    values: &mut [f64],
    directions: &[f64],
    first: usize,
) -> Result<(), IoError> {
    let backward: Option<f64> = column.backward.as_ref().and_then(|text| text.trim().parse().ok());
    if directions.iter().all(|d| d.is_nan()) {
        let (file, key, row) = (shown(path), key.to_string(), first + 1);
        let column = column.sign.clone().unwrap_or_default();
        return Err(IoError::NoDirection { file, row, key, column });
    }
    for (value, direction) in values.iter_mut().zip(directions) {
        let is_back = backward.map_or(*direction < 0.0, |b| *direction == b);
        let sign = if is_back { -1.0 } else { 1.0 };
        *value = if direction.is_nan() { f64::NAN } else { sign * *value };
    }
    Ok(())
}
