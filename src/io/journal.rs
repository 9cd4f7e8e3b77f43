//! A journal of finished work: whole lines, each on disk before the next piece counts as done.

use std::fs::{File, OpenOptions, create_dir_all};
use std::io::{self, BufRead, BufReader, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use super::IoError;
use super::folder::write_whole_by;

/// A file to which threads append whole lines.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: Mutex<File>,
}

impl Journal {
    /// Shows the complete lines of a journal one by one, so that it never is in memory as a whole;
    /// a last one that was torn (without its end of line) is left out. No journal has no lines.
    ///
    /// # Errors
    /// A file that is there and cannot be read.
    pub fn read(path: &Path, mut each: impl FnMut(&str)) -> Result<(), IoError> {
        let each = |line: &str| {
            each(line);
            Ok(())
        };
        lines(path, each).map_err(|e| IoError::system(path, &e))
    }

    /// Starts a journal with those lines of an earlier one that are to be kept, making its folder.
    ///
    /// # Errors
    /// A folder or file that cannot be written.
    pub fn start(path: &Path, mut keep: impl FnMut(&str) -> bool) -> Result<Self, IoError> {
        let wrong = |e: io::Error| IoError::system(path, &e);
        if let Some(folder) = path.parent() {
            create_dir_all(folder).map_err(wrong)?;
        }
        write_whole_by(path, |file| {
            let mut file = BufWriter::new(file);
            lines(path, |line| if keep(line) { writeln!(file, "{line}") } else { Ok(()) })?;
            file.flush()
        })?;
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

/// The complete lines of a file; none where there is no file.
fn lines(path: &Path, mut each: impl FnMut(&str) -> io::Result<()>) -> io::Result<()> {
    let file = match File::open(path) {
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(()),
        file => file?,
    };
    let mut file = BufReader::new(file);
    let mut line = Vec::new();
    while file.read_until(b'\n', &mut line)? > 0 && line.pop() == Some(b'\n') {
        each(&String::from_utf8_lossy(&line))?;
        line.clear();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(path: &Path) -> Vec<String> {
        let mut out = Vec::new();
        Journal::read(path, |line| out.push(line.to_string())).unwrap();
        out
    }

    #[test]
    fn a_torn_last_line_is_left_out_and_the_journal_goes_on_behind_the_kept_ones() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b.jsonl");
        assert!(read(&path).is_empty());
        let journal = Journal::start(&path, |_| true).unwrap();
        journal.append("one").unwrap();
        journal.append("two").unwrap();
        std::fs::write(&path, "one\ntwo\nthr").unwrap();
        assert_eq!(read(&path), ["one", "two"]);
        Journal::start(&path, |line| line == "two").unwrap().append("four").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "two\nfour\n");
    }
}
