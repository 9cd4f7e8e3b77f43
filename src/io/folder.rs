//! Whole files or none: text in, results out.

use std::fs;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::IoError;

/// The text of a file.
///
/// # Errors
/// A directory, a file that cannot be read or is no text.
pub fn read_text(path: &Path) -> Result<String, IoError> {
    if path.is_dir() {
        return Err(IoError::Directory { file: path.display().to_string() });
    }
    fs::read_to_string(path).map_err(|e| IoError::system(path, &e))
}

/// The names of what lies in a folder, in no order; none where there is no folder.
#[must_use]
pub fn file_names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
}

/// SHA-256 of a file, in hexadecimal.
///
/// # Errors
/// A file that cannot be read.
pub fn sha256(path: &Path) -> Result<String, IoError> {
    let mut file = fs::File::open(path).map_err(|e| IoError::system(path, &e))?;
    let mut hash = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        let count = file.read(&mut buffer).map_err(|e| IoError::system(path, &e))?;
        if count == 0 {
            return Ok(hash.finalize().iter().map(|b| format!("{b:02x}")).collect());
        }
        hash.update(&buffer[..count]);
    }
}

/// SHA-256 of a text, in hexadecimal.
#[must_use]
pub fn sha256_text(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().map(|b| format!("{b:02x}")).collect()
}

/// Writes a file as a whole: into a temporary one beside it, which then takes its place.
///
/// # Errors
/// A folder that cannot be written.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), IoError> {
    write_whole_by(path, |file| file.write_all(bytes))
}

/// Writes a file as a whole, piece by piece.
pub(super) fn write_whole_by(
    path: &Path,
    write: impl FnOnce(&mut fs::File) -> std::io::Result<()>,
) -> Result<(), IoError> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let wrong = |e: std::io::Error| IoError::system(path, &e);
    let mut file = tempfile::NamedTempFile::new_in(folder).map_err(wrong)?;
    write(file.as_file_mut()).map_err(wrong)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let readable = fs::Permissions::from_mode(0o644);
        file.as_file().set_permissions(readable).map_err(wrong)?;
    }
    file.persist(path).map_err(|e| wrong(e.error))?;
    Ok(())
}

/// Checks that files can be written into a folder, or that it can be made; makes nothing.
///
/// # Errors
/// A file in its place or above it, and a folder that cannot be written.
pub fn check_writable(folder: &Path) -> Result<(), IoError> {
    let there = folder.ancestors().find(|p| p.exists() && !p.as_os_str().is_empty());
    let there = there.unwrap_or(Path::new("."));
    if !there.is_dir() {
        return Err(IoError::NotAFolder { path: there.display().to_string() });
    }
    tempfile::tempfile_in(there).map(|_| ()).map_err(|e| IoError::system(there, &e))
}

/// Files of an identified model, which a run may or may not write.
const FUNCTIONS: [&str; 5] = ["model.json", "model.py", "model.m", "model.c", "model.mo"];

/// The folder of an experiment's results. Files are collected in memory and written at the end,
/// `results.json` last: a folder with a `results.json` of a run is complete.
#[derive(Debug)]
pub struct ResultFolder {
    path: PathBuf,
    files: Vec<(String, Vec<u8>)>,
}

impl ResultFolder {
    /// A folder `name` under `out`; nothing is written yet.
    #[must_use]
    pub fn new(out: &Path, name: &str) -> Self {
        Self { path: out.join(name), files: vec![] }
    }

    /// Where it will be.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Adds a file.
    pub fn add(&mut self, name: impl Into<String>, bytes: impl Into<Vec<u8>>) {
        self.files.push((name.into(), bytes.into()));
    }

    /// The text of a file of an earlier run, if it is there.
    #[must_use]
    pub fn earlier(&self, name: &str) -> Option<String> {
        fs::read_to_string(self.path.join(name)).ok()
    }

    /// Writes all files, each one whole, in the order in which they were added; pictures and model
    /// functions of an earlier run that this one does not have are removed first.
    ///
    /// # Errors
    /// A folder that cannot be made or written.
    pub fn write(self) -> Result<PathBuf, IoError> {
        fs::create_dir_all(&self.path).map_err(|e| IoError::system(&self.path, &e))?;
        self.remove_old_files();
        for (name, bytes) in &self.files {
            write_whole(&self.path.join(name), bytes)?;
        }
        Ok(self.path)
    }

    fn remove_old_files(&self) {
        for name in file_names(&self.path) {
            let picture = name.ends_with(".png") || name.ends_with(".svg");
            let model = FUNCTIONS.contains(&name.as_str());
            if (picture || model) && !self.files.iter().any(|(n, _)| *n == name) {
                let _ = fs::remove_file(self.path.join(name));
            }
        }
    }
}
