//! Several arrays of numpy in one file, as `numpy.savez` writes them: a ZIP archive of `.npy` files.
//!
//! A vector is a column under its name, a matrix `name[0]`, `name[1]`, …, a structured array `name.field`.
//!
//! ```text
//! directory = ("PK\1\2" … method:u16 … packed:u32 unpacked:u32 name:u16 extra:u16 comment:u16 … place:u32 name)*
//! end       = "PK\5\6" … entries:u16 size:u32 place:u32 …
//! ```
//! Source: PKWARE, APPNOTE.TXT 6.3, sections 4.3.7, 4.3.12 and 4.3.16.

use std::io::Read;
use std::path::Path;

use flate2::read::DeflateDecoder;

use super::bytes::{Bytes, Damage};
use super::npy::{Column, columns};
use super::whole::{Content, WholeFormat};
use super::{IoError, npy};

/// Arrays of a file unfold to at most this much \[bytes\].
const MOST_BYTES: usize = 1 << 30;
const END: &[u8] = b"PK\x05\x06";
/// Bytes of the end of the directory without its comment, of an entry without its names, and of the head of a file.
const SIZES: (usize, usize, usize) = (22, 46, 30);

pub(super) const FORMAT: WholeFormat = WholeFormat {
    extension: "npz",
    magic: b"PK\x03\x04",
    read: |path| read(path).map(Content::Columns),
};

fn read(path: &Path) -> Result<Vec<Column>, IoError> {
    let all = std::fs::read(path).map_err(|e| IoError::system(path, &e))?;
    let (columns, names) = arrays(&all).map_err(|d| d.in_file(path, "NPZ"))?;
    if columns.is_empty() {
        let needed = "vectors of numbers (np.savez('run.npz', t=t, speed_right=…))";
        return Err(IoError::nothing(path, "NPZ", needed, &names.join(", ")));
    }
    Ok(columns)
}

/// The columns of all arrays, and the names of the files in the archive.
fn arrays(all: &[u8]) -> Result<(Vec<Column>, Vec<String>), Damage> {
    let (mut found, mut names, mut left) = (vec![], vec![], MOST_BYTES);
    for entry in entries(all)? {
        let data = entry.data(all, left).map_err(|d| d.of(&entry.name))?;
        left -= data.len();
        if let Some(name) = entry.name.strip_suffix(".npy").filter(|_| data.starts_with(npy::MAGIC))
        {
            found.extend(columns(&data, Some(name)).map_err(|d| d.of(&entry.name))?);
        }
        names.push(entry.name);
    }
    Ok((found, names))
}

/// A file of the archive.
struct Entry {
    name: String,
    is_packed: bool,
    size: usize,
    place: usize,
}

/// The directory of an archive.
fn entries(all: &[u8]) -> Result<Vec<Entry>, Damage> {
    let last = all.len().saturating_sub(SIZES.0);
    let end = (0..=last).rev().take(1 << 16).find(|k| all[*k..].starts_with(END));
    let end = end.ok_or_else(|| Damage::new("its end", "the directory of an archive", "none"))?;
    let mut bytes = Bytes::new(&all[end..]);
    bytes.take(10, "end of the directory")?;
    let count = bytes.unsigned(2, "number of files")?;
    bytes.take(4, "size of the directory")?;
    let from = bytes.u32("place of the directory")? as usize;
    let mut bytes = Bytes::new(all.get(from..).unwrap_or_default());
    let mut out = vec![];
    for _ in 0..count {
        let mut head = Bytes::new(bytes.take(SIZES.1, "an entry of the directory")?);
        head.take(10, "signature")?;
        let is_packed = head.unsigned(2, "method")? != 0;
        head.take(8, "date and checksum")?;
        let size = head.u32("size")? as usize;
        head.take(4, "size unpacked")?;
        let [name, extra, comment] = [
            head.unsigned(2, "length of the name")? as usize,
            head.unsigned(2, "length of the extra field")? as usize,
            head.unsigned(2, "length of the comment")? as usize,
        ];
        head.take(8, "attributes")?;
        let place = head.u32("place of the file")? as usize;
        let name = String::from_utf8_lossy(bytes.take(name, "name")?).into_owned();
        bytes.take(extra + comment, "extra field and comment")?;
        out.push(Entry { name, is_packed, size, place });
    }
    Ok(out)
}

impl Entry {
    /// Its bytes, unpacked to at most so many bytes.
    fn data(&self, all: &[u8], most: usize) -> Result<Vec<u8>, Damage> {
        let mut bytes = Bytes::new(all.get(self.place..).unwrap_or_default());
        let mut head = Bytes::new(bytes.take(SIZES.2, "head of the file")?);
        head.take(26, "signature and sizes")?;
        let name = head.unsigned(2, "length of the name")? as usize;
        let extra = head.unsigned(2, "length of the extra field")? as usize;
        bytes.take(name + extra, "name and extra field")?;
        let data = bytes.take(self.size, "data")?;
        let mut out = vec![];
        if self.is_packed {
            let read = DeflateDecoder::new(data).take(most as u64 + 1).read_to_end(&mut out);
            read.map_err(|e| Damage::new("its data", "data compressed by deflate", e.to_string()))?;
        } else {
            out.extend_from_slice(data);
        }
        if out.len() > most {
            let expected = format!("at most {} MiB in the file", MOST_BYTES >> 20);
            return Err(Damage::new("its data", expected, "more"));
        }
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::DeflateEncoder;

    use super::*;

    /// An archive of one array, packed or not.
    fn archive(is_packed: bool) -> Vec<u8> {
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }";
        let length = (header.len() as u16).to_le_bytes();
        let numbers = [1.5_f64, 2.5].map(f64::to_le_bytes).concat();
        let array = [npy::MAGIC, &[1, 0], &length, header.as_bytes(), &numbers].concat();
        let mut packer = DeflateEncoder::new(vec![], Compression::default());
        packer.write_all(&array).unwrap();
        let data = if is_packed { packer.finish().unwrap() } else { array };
        let (method, size) =
            ([if is_packed { 8 } else { 0 }, 0], (data.len() as u32).to_le_bytes());
        let name = b"w.npy";
        let mut out = [&b"PK\x03\x04"[..], &[0; 22], &[5, 0, 0, 0], name, &data].concat();
        let from = (out.len() as u32).to_le_bytes();
        let entry =
            [&b"PK\x01\x02"[..], &[0; 6], &method, &[0; 8], &size, &[0; 4], &[5, 0]].concat();
        out.extend([&entry[..], &[0; 16], name].concat());
        out.extend([END, &[0; 6], &[1, 0], &[0; 4], &from, &[0; 2]].concat());
        out
    }

    #[test]
    fn vectors_are_columns_under_their_names() {
        for is_packed in [false, true] {
            let (columns, names) = arrays(&archive(is_packed)).unwrap();
            assert_eq!(columns, [("w".to_string(), vec![1.5, 2.5])]);
            assert_eq!(names, ["w.npy"]);
        }
        let whole = archive(true);
        assert!(arrays(&whole[..whole.len() - 30]).is_err());
    }
}
