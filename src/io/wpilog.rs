//! Data logs of WPILib.
//!
//! Every entry of numbers is a column under its name; an array is one column for each element,
//! `name[0]`, `name[1]`, …; booleans are 0 and 1. Entries have time stamps of their own, so the
//! rows stand at the stamps of the most frequent of the entries that the column map names. What a loop
//! writes some microseconds later or earlier is of the same row, and other entries hold their last
//! value; rows begin when all have one. The column `t` \[s\] counts from the first row.
//!
//! ```text
//! file    = "WPILOG" version:u16 length:u32 text  record*
//! record  = lengths:u8 entry:1..4 size:1..4 time:1..8 [us]  payload
//! lengths = bits 0-1 of entry, 2-3 of size, 4-6 of time, each less one
//! entry 0 = control: 0 start entry name type metadata | 1 finish entry | 2 metadata entry text
//! ```
//! All numbers have their low byte first. A last record that was cut off (the robot lost power),
//! and zeros behind it, are passed over.
//!
//! Source: WPILib Data Log File Format Specification, Version 1.0.

use std::collections::HashMap;
use std::path::Path;

use super::IoError;
use super::bytes::{Bytes, Damage, Number};
use super::signals::{Collector, Signals};
use super::whole::{Content, WholeFormat};

/// Largest size of an incomplete last record; a larger missing end is damage.
const CUT_OFF: usize = 1 << 20;
/// Arrays with more elements are not sensor data.
const MOST_ELEMENTS: usize = 64;

/// An entry between its start and its finish.
struct Entry {
    name: String,
    kind: Option<(Number, bool)>,
    /// Indices of the columns in which its elements are collected.
    places: Vec<usize>,
}

pub(super) const FORMAT: WholeFormat = WholeFormat {
    extension: "wpilog",
    magic: b"WPILOG",
    read: |path| read(path).map(Content::Signals),
};

fn read(path: &Path) -> Result<Signals, IoError> {
    let bytes = std::fs::read(path).map_err(|e| IoError::system(path, &e))?;
    let signals = parse(&bytes).map_err(|damage| damage.in_file(path, "WPILOG"))?;
    if signals.is_empty() {
        return Err(IoError::nothing(path, "WPILOG", "entries of numbers", "none"));
    }
    Ok(signals)
}

fn parse(all: &[u8]) -> Result<Signals, Damage> {
    let mut bytes = Bytes::new(all);
    header(&mut bytes)?;
    let mut entries = HashMap::new();
    let mut signals = Collector::default();
    while bytes.left() > 0 {
        let start = bytes.at();
        let Some((id, time, payload)) = record(&mut bytes)? else { break };
        if id == 0 && payload.is_empty() && bytes.rest().iter().all(|b| *b == 0) {
            break;
        }
        let done = if id == 0 {
            control(payload, &mut entries)
        } else {
            data(id, time, payload, &mut entries, &mut signals)
        };
        done.map_err(|d| Damage {
            place: format!("the record at byte {start}, {}", d.place),
            ..d
        })?;
    }
    Ok(signals.finish(1e6))
}

fn header(bytes: &mut Bytes) -> Result<(), Damage> {
    let magic = bytes.take(6, "file header")?;
    if magic != b"WPILOG" {
        return Err(Damage::new("byte 0", "`WPILOG`", "other bytes"));
    }
    let version = bytes.unsigned(2, "version")?;
    if version >> 8 != 1 {
        let found = format!("version {}.{}", version >> 8, version & 0xff);
        return Err(Damage::new("byte 6", "version 1", found));
    }
    let length = bytes.u32("length of the extra header")? as usize;
    bytes.take(length, "extra header").map(|_| ())
}

/// Entry, time stamp [us] and payload of a record.
type Record<'a> = (u32, i64, &'a [u8]);

/// The next record: entry, time [us] and payload; `None` where the file was cut off.
fn record<'a>(bytes: &mut Bytes<'a>) -> Result<Option<Record<'a>>, Damage> {
    let start = bytes.at();
    let lengths = bytes.unsigned(1, "record")? as usize;
    if lengths & 0x80 != 0 {
        let found = format!("{lengths:#04x}");
        return Err(Damage::new(format!("byte {start}"), "a record, its first bit 0", found));
    }
    let sizes = [1 + (lengths & 3), 1 + (lengths >> 2 & 3), 1 + (lengths >> 4 & 7)];
    if bytes.left() < sizes.iter().sum() {
        return Ok(None);
    }
    let id = bytes.unsigned(sizes[0], "entry")? as u32;
    let size = bytes.unsigned(sizes[1], "size")? as usize;
    let time = bytes.unsigned(sizes[2], "time")? as i64;
    if size > bytes.left() && size <= CUT_OFF {
        return Ok(None);
    }
    Ok(Some((id, time, bytes.take(size, "payload")?)))
}

fn control(payload: &[u8], entries: &mut HashMap<u32, Entry>) -> Result<(), Damage> {
    // places count from the start of the payload
    let within = |d: Damage| Damage { place: format!("{} of its payload", d.place), ..d };
    let mut bytes = Bytes::new(payload);
    let kind = bytes.unsigned(1, "control record").map_err(within)?;
    let id = bytes.u32("entry").map_err(within)?;
    match kind {
        0 => {
            let name = text(&mut bytes, "the entry's name").map_err(within)?;
            let kind = text(&mut bytes, "the entry's type").map_err(within)?;
            text(&mut bytes, "the entry's metadata").map_err(within)?;
            entries.insert(id, Entry { name, kind: number(&kind), places: vec![] });
        }
        1 => {
            entries.remove(&id);
        }
        2 => {}
        _ => {
            let expected = "0 (start), 1 (finish) or 2 (metadata)";
            return Err(Damage::new("control record", expected, kind.to_string()));
        }
    }
    Ok(())
}

fn text(bytes: &mut Bytes, what: &str) -> Result<String, Damage> {
    let length = bytes.u32(what)? as usize;
    Ok(String::from_utf8_lossy(bytes.take(length, what)?).into_owned())
}

/// The number type of an entry and whether it is an array; `None` for other types.
fn number(kind: &str) -> Option<(Number, bool)> {
    let plain = kind.strip_suffix("[]");
    let number = match plain.unwrap_or(kind) {
        "boolean" => Number::Boolean,
        "int64" => Number::Signed(8),
        "float" => Number::Float,
        "double" => Number::Double,
        _ => return None,
    };
    Some((number, plain.is_some()))
}

fn data(
    id: u32,
    time: i64,
    payload: &[u8],
    entries: &mut HashMap<u32, Entry>,
    signals: &mut Collector,
) -> Result<(), Damage> {
    let Some(entry) = entries.get_mut(&id) else {
        let found = format!("entry {id}, which was not");
        return Err(Damage::new("its entry", "an entry that was started before", found));
    };
    let Some((number, array)) = entry.kind else { return Ok(()) };
    let size = number.size();
    let whole = if array { payload.len().is_multiple_of(size) } else { payload.len() == size };
    if !whole {
        let each = if array { " for each element" } else { "" };
        let found = format!("{} bytes", payload.len());
        let place = format!("entry `{}`", entry.name);
        return Err(Damage::new(place, format!("{size} bytes{each}"), found));
    }
    if payload.len() / size > MOST_ELEMENTS {
        return Ok(());
    }
    for (j, bytes) in payload.chunks_exact(size).enumerate() {
        if entry.places.len() == j {
            let name = if array { format!("{}[{j}]", entry.name) } else { entry.name.clone() };
            entry.places.push(signals.place(&name));
        }
        signals.push(entry.places[j], time, number.value(bytes, false));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
