//! MATLAB files of level 5, as `save` writes them with `-v6` and `-v7`.
//!
//! A vector of numbers is a column under its name; a matrix is one column for each of its columns,
//! `name(:,1)`, `name(:,2)`, or, where it is wider than high, for each of its rows, `name(1,:)`.
//! The fields of a structure `s` are `s.field`, those of a list of structures, as Simulink exports
//! signals, `s(1).field`; where such a structure has a text `Name` or `label` beside its `Data` or `values`, that text is
//! the name of the column. The cells of a cell array `c` are `c{1}`, `c{2}`. The columns of a matrix have the texts of a
//! list beside it as their names (`mat/listed.rs`). Single numbers, complex and sparse matrices and text are no columns.
//!
//! ```text
//! file    = text:116 bytes  8 bytes  version:u16  "IM" or "MI"  element*
//! element = type:u32 size:u32 data, filled up to 8 bytes | size:u16 type:u16 data:4 bytes
//! matrix  = type 14: flags and class, dimensions, name, real part, [imaginary part]
//! type 15 = an element compressed by zlib
//! ```
//! Source: MathWorks, MAT-File Format, 2019, chapter 1.

mod listed;

use std::io::Read;
use std::path::Path;

use flate2::read::ZlibDecoder;

use super::IoError;
use super::bytes::{Bytes, Damage, Number};
use super::error::shown;
use super::whole::{Content, WholeFormat};

const HEADER: usize = 128;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Compressed variables of a file unfold to at most this much \[bytes\].
const MOST_BYTES: usize = 1 << 30;
/// Matrices with more columns are not recordings.
const MOST_COLUMNS: usize = 64;

/// A column with its name.
type Column = (String, Vec<f64>);

/// A variable of the file.
struct Variable {
    name: String,
    class: &'static str,
    columns: Vec<Column>,
    /// The text of a variable that is one, in a line.
    text: Option<String>,
    /// The texts of a cell array that contains nothing else, or the rows of a character array.
    texts: Vec<String>,
}

pub(super) const FORMAT: WholeFormat = WholeFormat {
    extension: "mat",
    magic: b"MATLAB ",
    read: |path| read(path).map(Content::Columns),
};

fn read(path: &Path) -> Result<Vec<Column>, IoError> {
    let all = std::fs::read(path).map_err(|e| IoError::system(path, &e))?;
    let big_endian = header(path, &all)?;
    let mut variables = variables(&all, big_endian).map_err(|d| d.in_file(path, "MAT"))?;
    listed::name_columns(&mut variables);
    let kinds: Vec<String> =
        variables.iter().map(|v| format!("{} ({})", v.name, v.class)).collect();
    let columns: Vec<Column> = variables.into_iter().flat_map(|v| v.columns).collect();
    if columns.is_empty() {
        let found = if kinds.is_empty() { "none".into() } else { kinds.join(", ") };
        let is_of = |class: &str| variables_have(&kinds, class);
        let needed = if is_of(TABLE) {
            "vectors of numbers (a table or an object T: S = table2struct(T, 'ToScalar', true); save(file, '-struct', \
             'S', '-v7'))"
        } else if is_of(CELL) {
            "vectors of numbers (a cell array c of single values: m = cell2mat(c); save(file, 'm', '-v7'))"
        } else {
            "vectors of numbers (save the fields of a structure s with save(file, '-struct', 's', '-v7'))"
        };
        return Err(IoError::nothing(path, "MAT", needed, &found));
    }
    Ok(columns)
}

/// Whether one of the variables, written as `name (class)`, is of a class.
fn variables_have(kinds: &[String], class: &str) -> bool {
    kinds.iter().any(|kind| kind.ends_with(&format!("({class})")))
}

/// Whether numbers have their high byte first.
fn header(path: &Path, all: &[u8]) -> Result<bool, IoError> {
    let old = |reason: &str| {
        let reason = format!("{reason}; save it with save(file, …, '-v7') or '-v6'");
        Err(IoError::Format { file: shown(path), format: "MAT".into(), reason })
    };
    let hdf5 = |at: usize| all.get(at..).is_some_and(|b| b.starts_with(b"\x89HDF\r\n\x1a\n"));
    if all.starts_with(b"MATLAB 7.3") || hdf5(0) || hdf5(512) {
        return old("it is of version 7.3 (HDF5), which this program does not read");
    }
    match all.get(HEADER - 4..HEADER) {
        Some([0, 1, b'I', b'M']) => Ok(false),
        Some([1, 0, b'M', b'I']) => Ok(true),
        _ => old("bytes 124 to 127 are not those of level 5"),
    }
}

fn variables(all: &[u8], big_endian: bool) -> Result<Vec<Variable>, Damage> {
    let mut bytes = Bytes::ordered(all, big_endian);
    bytes.take(HEADER, "header")?;
    let mut variables = vec![];
    let mut room = MOST_BYTES;
    while bytes.left() > 0 {
        let start = bytes.at();
        let here =
            |d: Damage| Damage { place: format!("the variable at byte {start}, {}", d.place), ..d };
        let (kind, data) = element(&mut bytes, "a variable")?;
        let variable = match kind {
            MATRIX => matrix(data, big_endian).map_err(here)?,
            COMPRESSED => {
                let unfolded = unfold(data, room).map_err(here)?;
                room -= unfolded.len();
                let mut inner = Bytes::ordered(&unfolded, big_endian);
                match element(&mut inner, "a variable").map_err(here)? {
                    (MATRIX, data) => matrix(data, big_endian).map_err(here)?,
                    _ => None,
                }
            }
            _ => None,
        };
        variables.extend(variable);
    }
    Ok(variables)
}

/// The next element: its type and its data.
fn element<'a>(bytes: &mut Bytes<'a>, what: &str) -> Result<(u32, &'a [u8]), Damage> {
    let tag = bytes.u32(what)?;
    if tag >> 16 != 0 {
        let size = (tag >> 16) as usize;
        let data = bytes.take(4, what)?;
        let place = || format!("byte {}", bytes.at() - 8);
        let data = data.get(..size).ok_or_else(|| {
            Damage::new(place(), format!("at most 4 bytes of {what}"), format!("{size}"))
        })?;
        return Ok((tag & 0xffff, data));
    }
    let size = bytes.u32(what)? as usize;
    let data = bytes.take(size, what)?;
    if tag != COMPRESSED {
        bytes.align(8);
    }
    Ok((tag, data))
}

fn unfold(data: &[u8], room: usize) -> Result<Vec<u8>, Damage> {
    let mut out = vec![];
    let count = ZlibDecoder::new(data).take(room as u64 + 1).read_to_end(&mut out);
    count.map_err(|e| Damage::new("its data", "data compressed by zlib", e.to_string()))?;
    if out.len() > room {
        let expected = format!("at most {} MiB in the file", MOST_BYTES >> 20);
        return Err(Damage::new("its data", expected, "more"));
    }
    Ok(out)
}

/// A variable; `None` for one without a name, as MATLAB keeps for itself.
fn matrix(data: &[u8], big_endian: bool) -> Result<Option<Variable>, Damage> {
    named_matrix(data, big_endian, "", 0)
}

/// The same for the field of a structure, which has no name of its own.
fn named_matrix(
    data: &[u8],
    big_endian: bool,
    field: &str,
    depth: usize,
) -> Result<Option<Variable>, Damage> {
    if data.is_empty() {
        return Ok(None); // an empty field
    }
    let mut bytes = Bytes::ordered(data, big_endian);
    let (_, flags) = element(&mut bytes, "array flags")?;
    let flags = Bytes::ordered(flags, big_endian).u32("array flags")?;
    let (_, size) = element(&mut bytes, "dimensions")?;
    let size: Vec<usize> =
        size.chunks_exact(4).map(|d| Number::Unsigned(4).value(d, big_endian) as usize).collect();
    let (_, name) = element(&mut bytes, "name")?;
    let name = String::from_utf8_lossy(name).into_owned();
    let name = if name.is_empty() { field.to_string() } else { name };
    if name.is_empty() {
        return Ok(None);
    }
    let class = class(flags);
    let mut variable = Variable { name, class, columns: vec![], text: None, texts: vec![] };
    if class == STRUCTURE && depth < DEEPEST {
        let count = size.iter().try_fold(1_usize, |n, d| n.checked_mul(*d)).unwrap_or(0);
        // a structure that is written in another way is no column, as before
        let fields = fields(&mut bytes, &variable.name, count.min(MOST_COLUMNS), depth);
        variable.columns = fields.unwrap_or_default();
        return Ok(Some(variable));
    }
    if class == CELL && depth < DEEPEST {
        let count = size.iter().try_fold(1_usize, |n, d| n.checked_mul(*d)).unwrap_or(0);
        let cells = cells(&mut bytes, &variable.name, count.min(MOST_COLUMNS), depth);
        let cells = cells.unwrap_or_default();
        variable.texts = listed::texts(&cells);
        variable.columns = cells.into_iter().flat_map(|v| v.columns).collect();
        return Ok(Some(variable));
    }
    if class == TEXT {
        let rows = size.first().copied().unwrap_or_default();
        let all = text(&mut bytes);
        variable.texts = all.as_ref().map_or(vec![], |all| listed::rows(all, rows));
        variable.text = all.map(|all| all.trim().to_owned());
        return Ok(Some(variable));
    }
    if let [rows, columns] = size[..]
        && class == NUMERIC
    {
        let place = format!("variable `{}`", variable.name);
        let values = numbers(&mut bytes, rows, columns, &place)?;
        variable.columns = split(&variable.name, rows, columns, values);
    }
    Ok(Some(variable))
}

/// The cells of a cell array that are not empty.
fn cells(
    bytes: &mut Bytes,
    name: &str,
    count: usize,
    depth: usize,
) -> Result<Vec<Variable>, Damage> {
    let mut out = vec![];
    for k in 0..count {
        let (kind, data) = element(bytes, "a cell")?;
        if kind == MATRIX {
            let place = format!("{name}{{{}}}", k + 1);
            out.extend(named_matrix(data, bytes.big_endian, &place, depth + 1)?);
        }
    }
    Ok(out)
}

/// The text of a character array; `None` where it is of a type that is not known or without a letter.
fn text(bytes: &mut Bytes) -> Option<String> {
    let (kind, data) = element(bytes, "text").ok()?;
    let wide = |pair: &[u8]| Number::Unsigned(2).value(pair, bytes.big_endian) as u16;
    let text = match kind {
        4 | 17 => String::from_utf16_lossy(&data.chunks_exact(2).map(wide).collect::<Vec<_>>()),
        1 | 2 | 16 => String::from_utf8_lossy(data).into_owned(),
        _ => return None,
    };
    Some(text).filter(|text| text.chars().any(char::is_alphabetic))
}

const NUMERIC: &str = "numbers";
const TEXT: &str = "text";
const CELL: &str = "cell";
const TABLE: &str = "object";
const STRUCTURE: &str = "struct";
/// Structures within structures that are looked into.
const DEEPEST: usize = 4;

/// The columns of the fields of so many structures, one behind the other.
fn fields(
    bytes: &mut Bytes,
    name: &str,
    count: usize,
    depth: usize,
) -> Result<Vec<Column>, Damage> {
    let (_, length) = element(bytes, "length of the field names")?;
    let length =
        Bytes::ordered(length, bytes.big_endian).u32("length of the field names")? as usize;
    let (_, names) = element(bytes, "field names")?;
    let text = |raw: &[u8]| {
        let end = raw.iter().position(|b| *b == 0).unwrap_or(raw.len());
        String::from_utf8_lossy(&raw[..end]).into_owned()
    };
    let names: Vec<String> = names.chunks_exact(length.max(1)).map(text).collect();
    let mut out = vec![];
    for k in 0..count {
        let (mut label, mut found, mut inside) = (None, vec![], vec![]);
        for field in &names {
            let place = if count == 1 {
                format!("{name}.{field}")
            } else {
                format!("{name}({}).{field}", k + 1)
            };
            let (kind, data) = element(bytes, "a field")?;
            if kind == MATRIX {
                let inner = named_matrix(data, bytes.big_endian, &place, depth + 1)?;
                let Some(mut inner) = inner else { continue };
                let is_label = LABELS.contains(&field.to_lowercase().as_str());
                label = label.or(inner.text.take().filter(|_| is_label));
                found.push((place, field));
                inside.push(inner);
            }
        }
        listed::name_columns(&mut inside);
        let columns = found.into_iter().zip(inside).flat_map(|(found, inner)| {
            inner.columns.into_iter().map(move |column| (found.clone(), column))
        });
        out.extend(columns.map(|((place, field), (name, values))| {
            let of_label =
                label.as_ref().filter(|_| VALUES.contains(&field.to_lowercase().as_str()));
            let index = name.strip_prefix(&place).unwrap_or_default();
            (of_label.map_or_else(|| name.clone(), |label| format!("{label}{index}")), values)
        }));
    }
    Ok(out)
}

/// Fields with the name of a signal, and those with its values, in lower case.
const LABELS: [&str; 3] = ["name", "label", "signalname"];
const VALUES: [&str; 2] = ["data", "values"];

fn class(flags: u32) -> &'static str {
    match flags & 0xff {
        6..=15 if flags & 0x0800 != 0 => "complex",
        6..=15 => NUMERIC,
        1 => CELL,
        2 => STRUCTURE,
        4 => TEXT,
        5 => "sparse",
        _ => TABLE,
    }
}

/// The real part, column after column; MATLAB stores it in the smallest type that holds it.
fn numbers(
    bytes: &mut Bytes,
    rows: usize,
    columns: usize,
    place: &str,
) -> Result<Vec<f64>, Damage> {
    let (kind, data) = element(bytes, "numbers").map_err(|d| d.of(place))?;
    let number = match kind {
        1 => Number::Signed(1),
        2 => Number::Unsigned(1),
        3 => Number::Signed(2),
        4 => Number::Unsigned(2),
        5 => Number::Signed(4),
        6 => Number::Unsigned(4),
        7 => Number::Float,
        9 => Number::Double,
        12 => Number::Signed(8),
        13 => Number::Unsigned(8),
        _ => return Err(Damage::new(place, "a type of numbers", format!("type {kind}"))),
    };
    if rows.checked_mul(columns).and_then(|n| n.checked_mul(number.size())) != Some(data.len()) {
        let expected = format!("{rows} x {columns} numbers of {} bytes", number.size());
        return Err(Damage::new(place, expected, format!("{} bytes", data.len())));
    }
    let values = data.chunks_exact(number.size());
    Ok(values.map(|b| number.value(b, bytes.big_endian)).collect())
}

/// A matrix, stored column after column, as columns of a recording.
fn split(name: &str, rows: usize, columns: usize, values: Vec<f64>) -> Vec<Column> {
    let (long, short) = (rows.max(columns), rows.min(columns));
    if long < 2 || short == 0 || short > MOST_COLUMNS {
        return vec![];
    }
    if short == 1 {
        return vec![(name.into(), values)];
    }
    if rows >= columns {
        let each = values.chunks_exact(rows).enumerate();
        return each.map(|(j, v)| (format!("{name}(:,{})", j + 1), v.to_vec())).collect();
    }
    let row = |i: usize| values.iter().skip(i).step_by(rows).copied().collect();
    (0..rows).map(|i| (format!("{name}({},:)", i + 1), row(i))).collect()
}

#[cfg(test)]
mod tests;
