//! Sequential reading of bytes, with positions for error messages; reads past the end are errors.

use std::path::Path;

use super::IoError;
use super::error::shown;

/// An error in the content of a binary file, without its name.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Damage {
    /// Where: a byte, an entry, a message.
    pub(super) place: String,
    /// Expected content.
    pub(super) expected: String,
    /// Content found.
    pub(super) found: String,
}

impl Damage {
    pub(super) fn new(
        place: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Self {
        Self { place: place.into(), expected: expected.into(), found: found.into() }
    }

    /// The same error within a named entry or message.
    pub(super) fn of(self, what: &str) -> Self {
        Self { place: format!("{}, {what}", self.place), ..self }
    }

    pub(super) fn in_file(self, path: &Path, format: &'static str) -> IoError {
        let Self { place, expected, found } = self;
        IoError::Damaged { file: shown(path), format, place, expected, found }
    }
}

/// A position in the bytes of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bytes<'a> {
    all: &'a [u8],
    at: usize,
    /// Whether numbers have their high byte first.
    pub(super) big_endian: bool,
}

impl<'a> Bytes<'a> {
    pub(super) fn new(all: &'a [u8]) -> Self {
        Self::ordered(all, false)
    }

    pub(super) fn ordered(all: &'a [u8], big_endian: bool) -> Self {
        Self { all, at: 0, big_endian }
    }

    pub(super) fn at(&self) -> usize {
        self.at
    }

    pub(super) fn left(&self) -> usize {
        self.all.len() - self.at
    }

    pub(super) fn rest(&self) -> &'a [u8] {
        &self.all[self.at..]
    }

    /// The next `count` bytes; `what` names them in the error at the end of the file.
    pub(super) fn take(&mut self, count: usize, what: &str) -> Result<&'a [u8], Damage> {
        let (at, left) = (self.at, self.left());
        if count > left {
            let found = format!("{left} bytes before the end");
            return Err(Damage::new(
                format!("byte {at}"),
                format!("{count} bytes of {what}"),
                found,
            ));
        }
        self.at += count;
        Ok(&self.all[at..at + count])
    }

    /// Advances to a multiple of `size`, counted from the first byte, or to the end.
    pub(super) fn align(&mut self, size: usize) {
        self.at = self.at.next_multiple_of(size).min(self.all.len());
    }

    /// An unsigned number of up to eight bytes.
    pub(super) fn unsigned(&mut self, size: usize, what: &str) -> Result<u64, Damage> {
        let big_endian = self.big_endian;
        Ok(unsigned(self.take(size, what)?, big_endian))
    }

    pub(super) fn u32(&mut self, what: &str) -> Result<u32, Damage> {
        Ok(self.unsigned(4, what)? as u32)
    }

    pub(super) fn f64(&mut self, what: &str) -> Result<f64, Damage> {
        Ok(f64::from_bits(self.unsigned(8, what)?))
    }
}

/// Up to eight bytes as an unsigned number.
pub(super) fn unsigned(bytes: &[u8], big_endian: bool) -> u64 {
    let join = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
    if big_endian { bytes.iter().fold(0, join) } else { bytes.iter().rev().fold(0, join) }
}

/// The kinds of numbers in binary files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    Boolean,
    Signed(usize),
    Unsigned(usize),
    Float,
    Double,
}

impl Number {
    /// Size of one value in bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Self::Boolean => 1,
            Self::Signed(size) | Self::Unsigned(size) => size,
            Self::Float => 4,
            Self::Double => 8,
        }
    }

    /// The value of exactly [`Self::size`] bytes.
    pub(super) fn value(self, bytes: &[u8], big_endian: bool) -> f64 {
        let bits = unsigned(bytes, big_endian);
        match self {
            Self::Boolean => f64::from(u8::from(bits != 0)),
            Self::Unsigned(_) => bits as f64,
            Self::Signed(size) => {
                let shift = 64 - 8 * size as u32;
                ((bits << shift) as i64 >> shift) as f64
            }
            Self::Float => f64::from(f32::from_bits(bits as u32)),
            Self::Double => f64::from_bits(bits),
        }
    }
}
