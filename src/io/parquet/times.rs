//! Stamps of a calendar and durations: whole numbers with a unit that the footer states. polars is built without
//! types for them, so it reads the file with a footer that does not name them, and the unit is a factor.

use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

use polars::prelude::{
    ArrowDataType, ArrowTimeUnit, Column, DataFrame, DataType, ParquetReader, PolarsResult,
    SerReader,
};

use super::{
    Bytes, Damage, FORMAT, IoError, MAGIC, footer, guarded, length, reopened, signed, value, varint,
};

/// Fields of the format: the list of columns and the words of other programs, of the whole; of a column its name, and
/// both ways in which its type is stated.
const COLUMNS: i64 = 2;
const WORDS: i64 = 5;
const NAME: i64 = 4;
const TYPES: [i64; 2] = [6, 10];

/// The columns that hold times, with the seconds of one.
pub(super) fn of(
    path: &Path,
    file: &File,
    names: &[String],
) -> Result<Vec<(String, f64)>, IoError> {
    let file = file.try_clone().and_then(reopened).map_err(|e| IoError::system(path, &e))?;
    let schema = guarded(path, || ParquetReader::new(file).schema())?;
    let seconds = |name: &String| {
        let unit = match &schema.get(name)?.dtype {
            ArrowDataType::Timestamp(unit, _)
            | ArrowDataType::Duration(unit)
            | ArrowDataType::Time32(unit)
            | ArrowDataType::Time64(unit) => unit,
            _ => return None,
        };
        let one = match unit {
            ArrowTimeUnit::Second => 1.0,
            ArrowTimeUnit::Millisecond => 1e-3,
            ArrowTimeUnit::Microsecond => 1e-6,
            ArrowTimeUnit::Nanosecond => 1e-9,
        };
        Some((name.clone(), one))
    };
    Ok(names.iter().filter_map(seconds).collect())
}

/// The file in memory, with whole numbers in place of these times.
pub(super) fn as_numbers(
    path: &Path,
    file: &mut File,
    times: &[(String, f64)],
) -> Result<Cursor<Vec<u8>>, IoError> {
    let system = |e| IoError::system(path, &e);
    let size = file.metadata().map_err(system)?.len();
    let before = footer(file, size).map_err(system)?.unwrap_or_default();
    let names: Vec<&[u8]> = times.iter().map(|(name, _)| name.as_bytes()).collect();
    let after = plain(&before, &names).map_err(|damage| damage.in_file(path, FORMAT))?;
    let mut bytes = Vec::new();
    let mut file = reopened(file.try_clone().map_err(system)?).map_err(system)?;
    file.read_to_end(&mut bytes).map_err(system)?;
    bytes.truncate(bytes.len().saturating_sub(before.len() + 8));
    bytes.extend(&after);
    bytes.extend((after.len() as u32).to_le_bytes());
    bytes.extend(MAGIC);
    Ok(Cursor::new(bytes))
}

/// Puts seconds in place of the whole numbers.
pub(super) fn in_seconds(mut frame: DataFrame, times: &[(String, f64)]) -> PolarsResult<DataFrame> {
    for (name, seconds) in times {
        let numbers = frame.column(name)?.cast(&DataType::Float64)?;
        let column: Column = (numbers.as_materialized_series() * *seconds).into();
        frame.with_column(column)?;
    }
    Ok(frame)
}

/// A field of a structure: its number, the kind of its value, and where that stands.
type Field<'a> = (i64, u64, &'a [u8]);

fn fields<'a>(all: &'a [u8], bytes: &mut Bytes) -> Result<Vec<Field<'a>>, Damage> {
    let (mut out, mut id) = (vec![], 0);
    loop {
        let head = bytes.unsigned(1, "a field")?;
        if head == 0 {
            return Ok(out);
        }
        id = if head >> 4 == 0 { signed(bytes)? } else { id + (head >> 4) as i64 };
        let (kind, from) = (head & 0xf, bytes.at());
        // of a boolean field the kind is the value
        if kind > 2 {
            value(bytes, kind, 0)?;
        }
        out.push((id, kind, &all[from..bytes.at()]));
    }
}

fn written<'a>(fields: impl Iterator<Item = (i64, u64, &'a [u8])>, out: &mut Vec<u8>) {
    let mut last = 0;
    for (id, kind, value) in fields {
        let next = id - last;
        if (1..16).contains(&next) {
            out.push((next as u8) << 4 | kind as u8);
        } else {
            out.push(kind as u8);
            let mut left = (id << 1 ^ id >> 63) as u64;
            while left > 0x7f {
                out.push(left as u8 | 0x80);
                left >>= 7;
            }
            out.push(left as u8);
        }
        out.extend(value);
        last = id;
    }
    out.push(0);
}

/// A footer in which the columns of these names are whole numbers.
fn plain(all: &[u8], names: &[&[u8]]) -> Result<Vec<u8>, Damage> {
    let whole = fields(all, &mut Bytes::new(all))?;
    let listed = whole.iter().find(|(id, ..)| *id == COLUMNS).map_or(&[][..], |(.., list)| list);
    let columns = columns(listed, names)?;
    let mut out = vec![];
    let kept = whole.iter().copied().filter(|(id, ..)| *id != WORDS);
    let with = kept.map(|f| if f.0 == COLUMNS { (f.0, f.1, &columns[..]) } else { f });
    written(with, &mut out);
    Ok(out)
}

/// The list of the columns, without the types of those of these names.
fn columns(list: &[u8], names: &[&[u8]]) -> Result<Vec<u8>, Damage> {
    let mut bytes = Bytes::new(list);
    let head = bytes.unsigned(1, "a list")?;
    let count = if head >> 4 == 15 { varint(&mut bytes)? } else { head >> 4 };
    let mut out = list[..bytes.at()].to_vec();
    for _ in 0..count {
        let fields = fields(list, &mut bytes)?;
        let is_one = |(id, _, value): &Field| {
            let mut text = Bytes::new(value);
            let name = length(&mut text, "bytes").and_then(|length| text.take(length, "text"));
            *id == NAME && name.is_ok_and(|name| names.contains(&name))
        };
        let is_time = fields.iter().any(is_one);
        let kept = fields.iter().filter(|(id, ..)| !(is_time && TYPES.contains(id)));
        written(kept.copied(), &mut out);
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::io::preview;

    /// Written by pyarrow 26: stamps of nanoseconds in UTC and a duration of microseconds, both of 20 ms a row, and a
    /// column of numbers.
    const STAMPS: &[u8] = include_bytes!("../../../tests/data/stamps.parquet");

    #[test]
    fn stamps_and_durations_are_seconds() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("stamps.parquet");
        std::fs::write(&path, STAMPS).unwrap();
        let columns = preview(&path).unwrap();
        let of = |name: &str| &columns.iter().find(|c| c.name == name).unwrap().values;
        for k in 0..8 {
            let t = 0.02 * k as f64;
            assert!((of("stamp")[k] - 1_718_020_983.0 - t).abs() < 1e-6, "{:?}", of("stamp"));
            assert!((of("since")[k] - t).abs() < 1e-12, "{:?}", of("since"));
            assert_eq!(of("w")[k], 0.5 * k as f64);
        }
        let rows = super::super::read_rows(&path, vec!["stamp".into()], 3, 2).unwrap();
        let found = rows.column("stamp").unwrap().f64().unwrap().get(0).unwrap();
        assert!((found - 1_718_020_983.06).abs() < 1e-6);
    }

    /// Every byte of the footer in turn is another one: nothing panics.
    #[test]
    fn a_damaged_footer_is_refused_or_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("damaged.parquet");
        for k in (STAMPS.len() / 2..STAMPS.len()).step_by(3) {
            let mut bytes = STAMPS.to_vec();
            bytes[k] ^= 0x15;
            std::fs::write(&path, &bytes).unwrap();
            let _ = preview(Path::new(&path));
        }
    }
}
