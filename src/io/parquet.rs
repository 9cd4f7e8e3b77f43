//! Parquet: the numbers of a file that say how much is to be read are checked against its size
//! before polars uses them.
//!
//! A changed bit in the number of rows makes polars ask for more memory than there is, which ends
//! the program; what else it meets in damaged data makes it panic, which is caught.
//!
//! Source: the Parquet format, parquet.thrift; Apache Thrift, compact protocol.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use polars::prelude::{DataFrame, ParquetReader, PolarsResult, SerReader};

mod times;

use super::IoError;
use super::bytes::{Bytes, Damage};
use super::error::{caught, format_error};

const FORMAT: &str = "Parquet";
const MAGIC: &[u8] = b"PAR1";
/// Rows that a byte of a file can stand for at most; columns of equal values shrink to nothing, but
/// time increases.
const ROWS_PER_BYTE: u64 = 1000;
/// Rows at most, whatever the size of the file.
const MOST_ROWS: u64 = 1 << 31;
/// A page may unfold to this many bytes and a thousand times its size.
const PAGE: u64 = 1 << 24;
/// Bytes in which the header of a page is looked for first.
const HEADER: u64 = 1 << 12;
/// Depth of structures in structures; those of the format have 6.
const DEEPEST: usize = 16;

/// The names of the columns.
pub(super) fn names(path: &Path) -> Result<Vec<String>, IoError> {
    let file = checked(path, &[])?;
    let schema = guarded(path, || ParquetReader::new(file).schema())?;
    Ok(schema.iter_names().map(ToString::to_string).collect())
}

/// The columns of those names.
pub(super) fn read(path: &Path, names: Vec<String>) -> Result<DataFrame, IoError> {
    table(path, checked(path, &names)?, names, None)
}

/// The columns of those names; times are in seconds.
fn table(
    path: &Path,
    mut file: File,
    names: Vec<String>,
    rows: Option<(usize, usize)>,
) -> Result<DataFrame, IoError> {
    let times = times::of(path, &file, &names)?;
    if times.is_empty() {
        let file = reopened(file).map_err(|e| IoError::system(path, &e))?;
        let reader = ParquetReader::new(file).with_columns(Some(names));
        return guarded(path, || reader.with_slice(rows).finish());
    }
    let bytes = times::as_numbers(path, &mut file, &times)?;
    let reader = ParquetReader::new(bytes).with_columns(Some(names));
    guarded(path, || times::in_seconds(reader.with_slice(rows).finish()?, &times))
}

/// Number of rows according to the footer.
pub(super) fn rows(path: &Path) -> Result<usize, IoError> {
    let file = checked(path, &[])?;
    guarded(path, || ParquetReader::new(file).num_rows())
}

/// Checks the numbers in the pages of these columns; see the head of this file.
pub(super) fn check(path: &Path, names: &[String]) -> Result<(), IoError> {
    checked(path, names).map(|_| ())
}

/// So many rows, at most, of the columns of those names; the file was checked.
pub(super) fn read_rows(
    path: &Path,
    names: Vec<String>,
    from: usize,
    count: usize,
) -> Result<DataFrame, IoError> {
    let file = File::open(path).map_err(|e| IoError::system(path, &e))?;
    table(path, file, names, Some((from, count)))
}

/// Calls polars on a file that may be damaged, and returns panics as errors.
fn guarded<T>(path: &Path, read: impl FnOnce() -> PolarsResult<T>) -> Result<T, IoError> {
    caught(read).map_err(|e| format_error(path, FORMAT, &e))
}

/// Opens a file whose numbers are possible, in its footer and in the pages of these columns.
fn checked(path: &Path, names: &[String]) -> Result<File, IoError> {
    let system = |e| IoError::system(path, &e);
    let mut file = File::open(path).map_err(system)?;
    let size = file.metadata().map_err(system)?.len();
    let footer = match footer(&mut file, size).map_err(system)? {
        Some(footer) => footer,
        // polars has its own words for what is no Parquet at all
        None => return reopened(file).map_err(system),
    };
    let damaged = |damage: Damage| damage.in_file(path, FORMAT);
    let chunks = chunks(&footer, size, names).map_err(damaged)?;
    for chunk in chunks {
        chunk.check(&mut file).map_err(system)?.map_err(damaged)?;
    }
    reopened(file).map_err(system)
}

fn reopened(mut file: File) -> std::io::Result<File> {
    file.rewind()?;
    Ok(file)
}

/// The bytes of the footer; none where the file has no such thing.
fn footer(file: &mut File, size: u64) -> std::io::Result<Option<Vec<u8>>> {
    let mut end = [0; 8];
    if size < 12 {
        return Ok(None);
    }
    file.seek(SeekFrom::End(-8))?;
    file.read_exact(&mut end)?;
    let length = u64::from(u32::from_le_bytes([end[0], end[1], end[2], end[3]]));
    if &end[4..] != MAGIC || length > size - 12 {
        return Ok(None);
    }
    part(file, size - 8 - length, length).map(Some)
}

fn part(file: &mut File, from: u64, length: u64) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.seek(SeekFrom::Start(from))?;
    file.take(length).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// A value of the compact protocol, as far as it is needed.
#[derive(Debug)]
enum Value<'a> {
    Whole(i64),
    Bytes(&'a [u8]),
    List(Vec<Value<'a>>),
    Struct(Vec<(i64, Value<'a>)>),
    Other,
}

impl<'a> Value<'a> {
    fn field(&self, id: i64) -> Option<&Value<'a>> {
        let Self::Struct(fields) = self else { return None };
        fields.iter().find(|(known, _)| *known == id).map(|(_, value)| value)
    }

    fn list(&self, id: i64) -> &[Value<'a>] {
        if let Some(Self::List(values)) = self.field(id) { values } else { &[] }
    }

    /// A number that counts something: zero where it is left out.
    fn count(&self, id: i64, what: &str, most: u64) -> Result<u64, Damage> {
        let Some(Self::Whole(value)) = self.field(id) else { return Ok(0) };
        let fits = u64::try_from(*value).ok().filter(|v| *v <= most);
        let expected = || format!("at most {most} for a file of its size");
        fits.ok_or_else(|| Damage::new(what, expected(), value.to_string()))
    }
}

fn varint(bytes: &mut Bytes) -> Result<u64, Damage> {
    let mut value = 0;
    for k in 0..10 {
        let byte = bytes.unsigned(1, "a number")?;
        value |= (byte & 0x7f) << (7 * k);
        if byte & 0x80 == 0 {
            return Ok(value);
        }
    }
    Err(Damage::new(format!("byte {} of it", bytes.at()), "a number", "one without an end"))
}

fn signed(bytes: &mut Bytes) -> Result<i64, Damage> {
    let value = varint(bytes)?;
    Ok((value >> 1) as i64 ^ -((value & 1) as i64))
}

/// A length that fits in the remaining bytes.
fn length(bytes: &mut Bytes, what: &str) -> Result<usize, Damage> {
    let value = varint(bytes)?;
    let left = bytes.left();
    let fits = usize::try_from(value).ok().filter(|v| *v <= left);
    let place = format!("byte {} of it", bytes.at());
    fits.ok_or_else(|| Damage::new(place, format!("at most {left} {what}"), value.to_string()))
}

fn structure<'a>(bytes: &mut Bytes<'a>, depth: usize) -> Result<Value<'a>, Damage> {
    let mut fields = Vec::new();
    let mut id = 0;
    loop {
        let head = bytes.unsigned(1, "a field")?;
        if head == 0 {
            return Ok(Value::Struct(fields));
        }
        id = if head >> 4 == 0 { signed(bytes)? } else { id + (head >> 4) as i64 };
        let kind = head & 0xf;
        // of a boolean field the kind is the value
        let value = if kind <= 2 { Value::Other } else { value(bytes, kind, depth)? };
        fields.push((id, value));
    }
}

fn value<'a>(bytes: &mut Bytes<'a>, kind: u64, depth: usize) -> Result<Value<'a>, Damage> {
    let place = |bytes: &Bytes| format!("byte {} of it", bytes.at());
    if depth > DEEPEST {
        return Err(Damage::new(place(bytes), "shallow structures", "one too deep"));
    }
    match kind {
        1..=3 => bytes.take(1, "a byte").map(|_| Value::Other),
        4..=6 => signed(bytes).map(Value::Whole),
        7 => bytes.take(8, "a number").map(|_| Value::Other),
        8 => {
            let length = length(bytes, "bytes")?;
            bytes.take(length, "text").map(Value::Bytes)
        }
        9 | 10 => {
            let head = bytes.unsigned(1, "a list")?;
            let short = (head >> 4) as usize;
            let count = if short == 15 { length(bytes, "values")? } else { short };
            let all = (0..count).map(|_| value(bytes, head & 0xf, depth + 1));
            all.collect::<Result<_, _>>().map(Value::List)
        }
        12 => structure(bytes, depth + 1),
        _ => Err(Damage::new(place(bytes), "a kind of value", format!("kind {kind}"))),
    }
}

/// The values of one column in one group of rows.
struct Chunk {
    column: String,
    from: u64,
    to: u64,
    values: u64,
}

/// The chunks of these columns, with what the footer says checked on the way.
fn chunks(footer: &[u8], size: u64, names: &[String]) -> Result<Vec<Chunk>, Damage> {
    let most = size.saturating_mul(ROWS_PER_BYTE).min(MOST_ROWS);
    let meta = structure(&mut Bytes::new(footer), 0).map_err(|d| d.of("the footer"))?;
    let rows = meta.count(3, "the number of rows", most)?;
    let elements = meta.list(2);
    for element in elements {
        element.count(5, "the number of columns", elements.len() as u64)?;
    }
    let (mut chunks, mut grouped) = (Vec::new(), 0);
    for group in meta.list(4) {
        grouped += group.count(3, "the rows of a group", most)?;
        for column in group.list(1).iter().filter_map(|c| c.field(3)) {
            let chunk = chunk(column, size, most)?;
            if names.contains(&chunk.column) {
                chunks.push(chunk);
            }
        }
    }
    if grouped != rows {
        let expected = format!("{rows} rows, as stated in the footer");
        return Err(Damage::new("its groups of rows", expected, grouped.to_string()));
    }
    Ok(chunks)
}

fn chunk(meta: &Value, size: u64, most: u64) -> Result<Chunk, Damage> {
    let path = meta.list(3).iter().filter_map(|part| match part {
        Value::Bytes(bytes) => Some(String::from_utf8_lossy(bytes)),
        _ => None,
    });
    let column = path.collect::<Vec<_>>().join(".");
    let count = |id, what: &str, most| meta.count(id, &format!("{what} of column {column}"), most);
    let values = count(5, "the values", most)?;
    let length = count(7, "the size", size)?;
    let (data, dictionary) = (count(9, "the place", size)?, count(11, "the dictionary", size)?);
    let from = if dictionary > 0 { data.min(dictionary) } else { data };
    if from + length > size {
        let found = format!("byte {}", from + length);
        let place = format!("the end of column {column}");
        return Err(Damage::new(place, format!("byte {size} or before"), found));
    }
    Ok(Chunk { column, from, to: from + length, values })
}

impl Chunk {
    /// Walks over the headers of the pages.
    fn check(&self, file: &mut File) -> std::io::Result<Result<(), Damage>> {
        let (mut at, mut values) = (self.from, 0);
        while at < self.to {
            let left = self.to - at;
            let mut head = part(file, at, HEADER.min(left))?;
            let mut page = self.page(&head, left);
            if page.is_err() && left > HEADER {
                head = part(file, at, left)?;
                page = self.page(&head, left);
            }
            match page {
                Ok((size, found)) => {
                    at += size;
                    values += found;
                }
                Err(damage) => return Ok(Err(damage.of(&format!("column {}", self.column)))),
            }
        }
        let expected = || format!("{} values, as stated in the footer", self.values);
        let place = || format!("the pages of column {}", self.column);
        let sound = values == self.values;
        Ok(if sound { Ok(()) } else { Err(Damage::new(place(), expected(), values.to_string())) })
    }

    /// Size of a page with its header, and the values in it.
    fn page(&self, bytes: &[u8], left: u64) -> Result<(u64, u64), Damage> {
        let mut bytes = Bytes::new(bytes);
        let header = structure(&mut bytes, 0).map_err(|d| d.of("the header of a page"))?;
        let head = bytes.at() as u64;
        let size = header.count(3, "the size of a page", left.saturating_sub(head))?;
        header.count(2, "the unfolded size of a page", PAGE + 1000 * size)?;
        let count = |id| match header.field(id) {
            Some(page) => page.count(1, "the values of a page", self.values),
            None => Ok(0),
        };
        count(7)?;
        Ok((head + size, count(5)? + count(8)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{TableColumn, write_parquet_pieces, write_parquet_table};

    fn columns(rows: usize) -> Vec<TableColumn> {
        let numbers = (0..rows).map(|k| (k as f64).sin()).collect();
        let texts = (0..rows).map(|k| format!("{}", k % 3)).collect();
        vec![TableColumn::Number("x".into(), numbers), TableColumn::Text("s".into(), texts)]
    }

    fn checked_bytes(bytes: &[u8]) -> Result<File, IoError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.parquet");
        std::fs::write(&path, bytes).unwrap();
        checked(&path, &["x".into(), "s".into()])
    }

    #[test]
    fn sound_files_pass_whatever_their_groups_and_pages() {
        let path = Path::new("a.parquet");
        for rows in [1, 40, 300_000] {
            checked_bytes(&write_parquet_table(path, &columns(rows)).unwrap()).unwrap();
        }
        let pieces = [columns(10), columns(2000)];
        checked_bytes(&write_parquet_pieces(path, pieces.into_iter()).unwrap()).unwrap();
        let constant = vec![TableColumn::Number("x".into(), vec![1.0; 1_000_000])];
        checked_bytes(&write_parquet_table(path, &constant).unwrap()).unwrap();
    }

    /// Every varint of the footer in turn becomes one of 2^58, which polars would allocate.
    #[test]
    fn a_number_of_rows_that_no_file_of_its_size_has_is_refused() {
        let bytes = write_parquet_table(Path::new("a.parquet"), &columns(40)).unwrap();
        let footer = bytes.len()
            - 8
            - u32::from_le_bytes(bytes[bytes.len() - 8..][..4].try_into().unwrap()) as usize;
        let rows = 80; // 40 in zigzag
        let at = footer + bytes[footer..].iter().position(|b| *b == rows).unwrap();
        let huge = [0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x07];
        let mut changed = bytes.clone();
        changed.splice(at..=at, huge);
        let length = (bytes.len() - 8 - footer + huge.len() - 1) as u32;
        let end = changed.len() - 8;
        changed[end..end + 4].copy_from_slice(&length.to_le_bytes());
        let e = checked_bytes(&changed).unwrap_err().to_string();
        assert!(e.contains("rows") && e.contains("at most"), "{e}");
    }
}
