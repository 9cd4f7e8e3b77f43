//! A journal of finished work: whole lines, each on disk before the next piece counts as done.

use std::fs::{File, OpenOptions, create_dir_all};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use super::{IoError, write_whole};

/// A file to which threads append whole lines.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: Mutex<File>,
}

impl Journal {
    /// The complete lines of an earlier journal; one that was torn (without its end of line) is
    /// left out. None where there is no journal.
    #[must_use]
    pub fn lines(path: &Path) -> Vec<String> {
        let bytes = std::fs::read(path).unwrap_or_default();
        let complete = bytes.iter().rposition(|b| *b == b'\n').map_or(0, |end| end + 1);
        String::from_utf8_lossy(&bytes[..complete]).lines().map(str::to_string).collect()
    }

    /// Starts a journal with the lines to keep, making its folder.
    ///
    /// # Errors
    /// A folder or file that cannot be written.
    pub fn start(path: &Path, keep: &[String]) -> Result<Self, IoError> {
        let wrong = |e: std::io::Error| IoError::system(path, &e);
        if let Some(folder) = path.parent() {
            create_dir_all(folder).map_err(wrong)?;
        }
        let kept: String = keep.iter().map(|line| format!("{line}\n")).collect();
        write_whole(path, kept.as_bytes())?;
        let file = OpenOptions::new().append(true).open(path).map_err(wrong)?;
        Ok(Self { path: path.to_path_buf(), file: Mutex::new(file) })
    }

    /// Appends a line, whole and unbuffered.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn append(&self, line: &str) -> Result<(), IoError> {
        let bytes = format!("{line}\n");
        let mut file = self.file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        file.write_all(bytes.as_bytes())
            .and_then(|()| file.flush())
            .map_err(|e| IoError::system(&self.path, &e))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_torn_last_line_is_left_out_and_the_journal_goes_on_behind_the_kept_ones() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b.jsonl");
        assert!(Journal::lines(&path).is_empty());
        let journal = Journal::start(&path, &[]).unwrap();
        journal.append("one").unwrap();
        journal.append("two").unwrap();
        std::fs::write(&path, "one\ntwo\nthr").unwrap();
        let kept = Journal::lines(&path);
        assert_eq!(kept, ["one", "two"]);
        Journal::start(&path, &kept).unwrap().append("four").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "one\ntwo\nfour\n");
    }
}
