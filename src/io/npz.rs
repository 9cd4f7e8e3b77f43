//! Several arrays of numpy in one file, as `numpy.savez` writes them: a ZIP archive of `.npy` files.
//!
//! A vector is a column under its name, a matrix `name[0]`, `name[1]`, …, a structured array `name.field`.

use std::io::{Cursor, Read};
use std::path::Path;

use zip::ZipArchive;
use zip::result::ZipError;

use super::bytes::Damage;
use super::npy::{Column, columns};
use super::whole::{Content, WholeFormat};
use super::{IoError, npy};

/// Arrays of a file unfold to at most this much \[bytes\].
const MOST_BYTES: usize = 1 << 30;

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
    let damaged = |e: ZipError| Damage::new("its directory", "a ZIP archive", e.to_string());
    let mut archive = ZipArchive::new(Cursor::new(all)).map_err(damaged)?;
    let (mut found, mut names, mut left) = (vec![], vec![], MOST_BYTES);
    for k in 0..archive.len() {
        let mut file = archive.by_index(k).map_err(damaged)?;
        let name = file.name().map_err(damaged)?.into_owned();
        let data = unpacked(&mut file, left).map_err(|d| d.of(&name))?;
        left -= data.len();
        if let Some(array) = name.strip_suffix(".npy").filter(|_| data.starts_with(npy::MAGIC)) {
            found.extend(columns(&data, Some(array)).map_err(|d| d.of(&name))?);
        }
        names.push(name);
    }
    Ok((found, names))
}

/// The bytes of a file of the archive, at most so many.
fn unpacked(file: &mut impl Read, most: usize) -> Result<Vec<u8>, Damage> {
    let mut out = vec![];
    let count = file.take(most as u64 + 1).read_to_end(&mut out);
    count.map_err(|e| Damage::new("its data", "data compressed by deflate", e.to_string()))?;
    if out.len() > most {
        let expected = format!("at most {} MiB in the file", MOST_BYTES >> 20);
        return Err(Damage::new("its data", expected, "more"));
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use zip::CompressionMethod;
    use zip::write::{SimpleFileOptions, ZipWriter};

    use super::*;

    /// An archive of one array.
    fn archive(method: CompressionMethod) -> Vec<u8> {
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }";
        let length = (header.len() as u16).to_le_bytes();
        let numbers = [1.5_f64, 2.5].map(f64::to_le_bytes).concat();
        let array = [npy::MAGIC, &[1, 0], &length, header.as_bytes(), &numbers].concat();
        let mut writer = ZipWriter::new(Cursor::new(vec![]));
        let options = SimpleFileOptions::default().compression_method(method);
        writer.start_file("w.npy", options).unwrap();
        writer.write_all(&array).unwrap();
        writer.finish().unwrap().into_inner()
    }

    #[test]
    fn vectors_are_columns_under_their_names() {
        for method in [CompressionMethod::Stored, CompressionMethod::Deflated] {
            let (columns, names) = arrays(&archive(method)).unwrap();
            assert_eq!(columns, [("w".to_string(), vec![1.5, 2.5])]);
            assert_eq!(names, ["w.npy"]);
        }
        let whole = archive(CompressionMethod::Deflated);
        assert!(arrays(&whole[..whole.len() - 30]).is_err());
    }
}
