//! Arrays of numpy, as `numpy.save` writes them.
//!
//! A structured array has one column for each of its fields. A matrix has a column for each of its columns (of its
//! rows, where it is wider than high), `column1`, `column2`, …, and so has a vector.
//!
//! ```text
//! file  = "\x93NUMPY" version:u8 u8  length:u16 (u32 from version 2)  header, numbers
//! header = {'descr': '<f8' or [('t', '<f8'), …], 'fortran_order': False, 'shape': (1000, 5), }
//! ```
//! Source: NumPy Enhancement Proposal 1, 2007.

use std::path::Path;

use super::IoError;
use super::bytes::{Bytes, Damage, Number};
use super::whole::{Content, WholeFormat};

pub(super) const MAGIC: &[u8] = b"\x93NUMPY";
/// Matrices with more columns are not recordings.
const MOST_COLUMNS: usize = 64;

/// A column with its name.
pub(super) type Column = (String, Vec<f64>);

pub(super) const FORMAT: WholeFormat =
    WholeFormat { extension: "npy", magic: MAGIC, read: |path| read(path).map(Content::Columns) };

fn read(path: &Path) -> Result<Vec<Column>, IoError> {
    let all = std::fs::read(path).map_err(|e| IoError::system(path, &e))?;
    let columns = columns(&all, None).map_err(|d| d.in_file(path, "NPY"))?;
    if columns.is_empty() {
        let needed = "rows of numbers (a matrix of one row per sample, or a structured array)";
        return Err(IoError::nothing(path, "NPY", needed, "no array of this kind"));
    }
    Ok(columns)
}

/// A field of a row: name, kind of number, whether its high byte comes first.
type Field = (String, Number, bool);

/// The columns of an array, under the `name` of the array where it has one. An array of other values than numbers has
/// none.
pub(super) fn columns(all: &[u8], name: Option<&str>) -> Result<Vec<Column>, Damage> {
    let mut bytes = Bytes::new(all);
    bytes.take(MAGIC.len(), "first bytes")?;
    let version = bytes.unsigned(2, "version")? & 0xff;
    let length = bytes.unsigned(if version < 2 { 2 } else { 4 }, "length of the header")?;
    let header = String::from_utf8_lossy(bytes.take(length as usize, "header")?).into_owned();
    let (Some(fields), Some(shape)) = (fields(&header), shape(&header)) else { return Ok(vec![]) };
    let (rows, across) = match shape[..] {
        [rows] => (rows, 1),
        [rows, across] if fields.len() == 1 => (rows, across),
        _ => return Ok(vec![]),
    };
    let size: usize = fields.iter().map(|(_, number, _)| number.size()).sum();
    let count = rows.checked_mul(across).and_then(|n| n.checked_mul(size)).unwrap_or(usize::MAX);
    let data = bytes.take(count, "numbers")?;
    if fields.len() > 1 {
        return Ok(of_fields(data, size, &fields, name));
    }
    let (field, number, big_endian) = &fields[0];
    let values: Vec<f64> = data.chunks_exact(size).map(|b| number.value(b, *big_endian)).collect();
    let is_by_column = header.contains("'fortran_order': True");
    let name = name.filter(|_| field.is_empty()).or((!field.is_empty()).then_some(field.as_str()));
    Ok(of_matrix(&values, rows, across, is_by_column, name))
}

/// The columns of a structured array, which is stored row after row.
fn of_fields(data: &[u8], size: usize, fields: &[Field], name: Option<&str>) -> Vec<Column> {
    let mut from = 0;
    let column = |(field, number, big_endian): &Field| {
        let place = from..from + number.size();
        from = place.end;
        let values =
            data.chunks_exact(size).map(|row| number.value(&row[place.clone()], *big_endian));
        let prefix = name.map_or(String::new(), |name| format!("{name}."));
        (format!("{prefix}{field}"), values.collect())
    };
    fields.iter().map(column).collect()
}

/// The columns of a matrix, or its rows where it is wider than high.
fn of_matrix(
    values: &[f64],
    rows: usize,
    across: usize,
    is_by_column: bool,
    name: Option<&str>,
) -> Vec<Column> {
    let at = |i: usize, j: usize| values[if is_by_column { j * rows + i } else { i * across + j }];
    let (long, short) = (rows.max(across), rows.min(across));
    if long < 2 || short == 0 || short > MOST_COLUMNS {
        return vec![];
    }
    let is_wide = across > rows;
    let column = |j: usize| {
        let values = (0..long).map(|i| if is_wide { at(j, i) } else { at(i, j) }).collect();
        let name = match name {
            Some(name) if short == 1 => name.to_owned(),
            Some(name) => format!("{name}[{j}]"),
            None => format!("column{}", j + 1),
        };
        (name, values)
    };
    (0..short).map(column).collect()
}

/// The text of a key in the header, up to the next key.
fn entry<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let (_, behind) = header.split_once(&format!("'{key}':"))?;
    let end = ["'descr':", "'fortran_order':", "'shape':"].iter().filter_map(|k| behind.find(k));
    Some(behind[..end.min().unwrap_or(behind.len())].trim())
}

/// The fields of a row; `None` where one is no number.
fn fields(header: &str) -> Option<Vec<Field>> {
    let described = entry(header, "descr")?;
    if !described.starts_with('[') {
        let (number, big_endian) = kind(described.split('\'').nth(1)?)?;
        return Some(vec![(String::new(), number, big_endian)]);
    }
    let field = |text: &str| {
        // ('t', '<f8')
        let mut quoted = text.split('\'').skip(1).step_by(2);
        let (name, kind) = (quoted.next()?, kind(quoted.next()?)?);
        Some((name.to_owned(), kind.0, kind.1))
    };
    let fields: Option<Vec<Field>> = described.split('(').skip(1).map(field).collect();
    fields.filter(|fields| !fields.is_empty())
}

/// The kind of number of `<f8`, and whether its high byte comes first.
fn kind(text: &str) -> Option<(Number, bool)> {
    let number = match text.get(1..)? {
        "f8" => Number::Double,
        "f4" => Number::Float,
        "b1" => Number::Boolean,
        "i1" => Number::Signed(1),
        "i2" => Number::Signed(2),
        "i4" => Number::Signed(4),
        "i8" => Number::Signed(8),
        "u1" => Number::Unsigned(1),
        "u2" => Number::Unsigned(2),
        "u4" => Number::Unsigned(4),
        "u8" => Number::Unsigned(8),
        _ => return None,
    };
    Some((number, text.starts_with('>')))
}

/// The numbers of `(1000, 5)`.
fn shape(header: &str) -> Option<Vec<usize>> {
    let inner = entry(header, "shape")?.split_once('(')?.1.split_once(')')?.0;
    inner.split(',').map(str::trim).filter(|n| !n.is_empty()).map(|n| n.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file with this header and these bytes behind it.
    fn file(header: &str, data: &[u8]) -> Vec<u8> {
        let length = (header.len() as u16).to_le_bytes();
        [MAGIC, &[1, 0], &length, header.as_bytes(), data].concat()
    }

    fn doubles(values: &[f64]) -> Vec<u8> {
        values.iter().flat_map(|v| v.to_le_bytes()).collect()
    }

    #[test]
    fn matrices_and_structured_arrays_have_columns() {
        let data = doubles(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        let matrix = |order: &str, shape: &str| {
            let header =
                format!("{{'descr': '<f8', 'fortran_order': {order}, 'shape': ({shape}), }}");
            columns(&file(&header, &data), None).unwrap()
        };
        let expected =
            [("column1".to_string(), vec![0.0, 2.0, 4.0]), ("column2".into(), vec![1.0, 3.0, 5.0])];
        assert_eq!(matrix("False", "3, 2"), expected);
        assert_eq!(matrix("True", "2, 3"), expected);
        assert_eq!(matrix("False", "6,")[0].1.len(), 6);
        let header =
            "{'descr': [('t', '<f8'), ('n', '>i2')], 'fortran_order': False, 'shape': (2,), }";
        let rows = [&doubles(&[0.5])[..], &[0, 7], &doubles(&[0.6]), &[255, 255]].concat();
        let expected = [("t".to_string(), vec![0.5, 0.6]), ("n".to_string(), vec![7.0, -1.0])];
        assert_eq!(columns(&file(header, &rows), None).unwrap(), expected);
    }

    #[test]
    fn a_file_that_is_cut_and_text_are_no_columns() {
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }";
        assert!(columns(&file(header, &doubles(&[1.0])), None).is_err());
        let header = "{'descr': '<U5', 'fortran_order': False, 'shape': (3,), }";
        assert_eq!(columns(&file(header, &[]), None), Ok(vec![]));
        let header =
            "{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999, 9999999999), }";
        assert!(columns(&file(header, &[]), None).is_err());
    }
}
