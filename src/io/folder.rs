//! Whole files or none: text in, results out.

use std::fs;
use std::io::{ErrorKind, Read, Write};
use std::path::{Component, Path, PathBuf};
use std::time::Duration;

use sha2::{Digest, Sha256};

use super::IoError;

/// Whether there is a file at a path.
#[must_use]
pub fn exists(path: &Path) -> bool {
    path.is_file()
}

/// A path without symbolic links and steps back, as far as it is there; from the current folder where it is relative.
#[must_use]
pub fn resolved(path: &Path) -> PathBuf {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let known = whole.ancestors().find_map(|p| Some((p, p.canonicalize().ok()?)));
    let Some((there, known)) = known else { return whole };
    whole.strip_prefix(there).map_or(known.clone(), |rest| known.join(rest).components().collect())
}

/// The path of a file from a folder, neither of which need be there.
#[must_use]
pub fn path_from(folder: &Path, file: &Path) -> PathBuf {
    let (folder, file) = (resolved(folder), resolved(file));
    let common = folder.components().zip(file.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().skip(common).map(|_| Component::ParentDir);
    up.chain(file.components().skip(common)).collect()
}

/// The text of a file.
///
/// # Errors
/// A directory, a file that cannot be read or is no text.
pub fn read_text(path: &Path) -> Result<String, IoError> {
    if path.is_dir() {
        return Err(IoError::directory(path));
    }
    fs::read_to_string(path).map_err(|e| IoError::system(path, &e))
}

/// The names of the entries of a folder, in no order; none if there is no folder.
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

/// Makes a folder, with those above it, where it is not there.
///
/// # Errors
/// A place that cannot be written.
pub fn make_folder(path: &Path) -> Result<(), IoError> {
    fs::create_dir_all(path).map_err(|e| IoError::unwritable(path, &e))
}

/// Writes a file atomically: into a temporary file in the same folder, which is then renamed.
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
    let wrong = |e: std::io::Error| IoError::unwritable(path, &e);
    let file = tempfile::Builder::new().prefix(UNFINISHED).tempfile_in(folder);
    // the error of the crate names its own temporary file
    let mut file = file.map_err(|e| match e.kind() {
        ErrorKind::NotFound => {
            let reason = format!("the folder {} does not exist", folder.display());
            IoError::System { file: path.display().to_string(), reason }
        }
        kind => wrong(kind.into()),
    })?;
    write(file.as_file_mut()).map_err(wrong)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let readable = fs::Permissions::from_mode(0o644);
        file.as_file().set_permissions(readable).map_err(wrong)?;
    }
    // else a power failure could leave the name without the bytes
    file.as_file().sync_all().map_err(wrong)?;
    file.persist(path).map_err(|e| wrong(e.error))?;
    sync_folder(folder);
    Ok(())
}

/// Waits until the names in a folder are on the disk, where the system offers it.
fn sync_folder(folder: &Path) {
    #[cfg(unix)]
    {
        // some network file systems refuse; the files themselves are safe by then
        let _ = fs::File::open(folder).and_then(|folder| folder.sync_all());
    }
    #[cfg(not(unix))]
    let _ = folder;
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
    tempfile::tempfile_in(there).map(|_| ()).map_err(|e| IoError::unwritable(there, &e))
}

/// Files of an identified model, which a run may or may not write.
const FUNCTIONS: [&str; 6] =
    ["model.json", "model.py", "model.m", "model.c", "model.mo", "model.js"];

/// The file whose presence marks a result folder as complete.
const COMPLETE: &str = "results.json";
/// Prefix of incomplete files and folders, including those left by a killed run.
const UNFINISHED: &str = ".unfinished-";
/// Age beyond which no run is still at it.
const ABANDONED: Duration = Duration::from_secs(3600);

/// The folder of an experiment's results. Files are collected in memory and written at the end; a
/// folder with a `results.json` is complete and of one run, whenever the program was stopped.
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

    /// A file of an earlier run, if it is there.
    #[must_use]
    pub fn earlier_bytes(&self, name: &str) -> Option<Vec<u8>> {
        fs::read(self.path.join(name)).ok()
    }

    /// Writes all files beside those of an earlier run, and when all are on the disk gives them their
    /// names, `results.json` last. If they cannot be written, the earlier ones stay as they are.
    /// Pictures and model functions that this run does not have are removed.
    ///
    /// # Errors
    /// A folder that cannot be made or written, a full disk.
    pub fn write(self) -> Result<PathBuf, IoError> {
        fs::create_dir_all(&self.path).map_err(|e| IoError::unwritable(&self.path, &e))?;
        self.remove_abandoned();
        let staged = self.stage();
        if staged.is_err() {
            // only where it is empty: no run has left anything here
            let _ = fs::remove_dir(&self.path);
        }
        let staged = staged?;
        self.publish(staged.path())?;
        Ok(self.path)
    }

    fn stage(&self) -> Result<tempfile::TempDir, IoError> {
        let made = tempfile::Builder::new().prefix(UNFINISHED).tempdir_in(&self.path);
        let staged = made.map_err(|e| IoError::unwritable(&self.path, &e))?;
        for (name, bytes) in &self.files {
            fs::File::create(staged.path().join(name))
                .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
                .map_err(|e| IoError::system(&self.path.join(name), &e))?;
        }
        Ok(staged)
    }

    /// From here on only names change, which needs no room. Between the first and the last of them
    /// the folder has no `results.json`.
    fn publish(&self, staged: &Path) -> Result<(), IoError> {
        let paths = self.files.iter().map(|(name, _)| self.path.join(name));
        if let Some(folder) = paths.into_iter().find(|path| path.is_dir()) {
            let path = folder.display().to_string();
            return Err(IoError::NotAFile { path });
        }
        let complete = self.path.join(COMPLETE);
        match fs::remove_file(&complete) {
            Err(e) if e.kind() != ErrorKind::NotFound => {
                return Err(IoError::system(&complete, &e));
            }
            _ => self.remove_old_files(),
        }
        let (last, first): (Vec<_>, Vec<_>) = self.files.iter().partition(|(n, _)| n == COMPLETE);
        // `results.json` gets its name when all others have theirs on the disk
        for names in [first, last] {
            sync_folder(&self.path);
            for (name, _) in names {
                let path = self.path.join(name);
                fs::rename(staged.join(name), &path).map_err(|e| IoError::system(&path, &e))?;
            }
        }
        sync_folder(&self.path);
        Ok(())
    }

    /// Removes what runs left that were killed while they wrote.
    fn remove_abandoned(&self) {
        for name in file_names(&self.path).iter().filter(|name| name.starts_with(UNFINISHED)) {
            let path = self.path.join(name);
            let written = fs::metadata(&path).and_then(|m| m.modified()).ok();
            if written.and_then(|t| t.elapsed().ok()).is_some_and(|age| age > ABANDONED) {
                let _ = fs::remove_dir_all(&path).or_else(|_| fs::remove_file(&path));
            }
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(out: &Path, files: &[(&str, &str)]) -> ResultFolder {
        let mut folder = ResultFolder::new(out, "run");
        files.iter().for_each(|(name, text)| folder.add(*name, *text));
        folder
    }

    fn names(path: &Path) -> Vec<String> {
        let mut names = file_names(path);
        names.sort();
        names
    }

    #[test]
    fn a_path_from_a_folder_leads_back_to_the_file() {
        let root = tempfile::tempdir().unwrap();
        fs::create_dir(root.path().join("a")).unwrap();
        fs::write(root.path().join("a/run.toml"), "").unwrap();
        let [folder, file] = ["out/run", "a/run.toml"].map(|p| root.path().join(p));
        let path = path_from(&folder, &file);
        assert_eq!(path, Path::new("../../a/run.toml"));
        // the folder is made later
        fs::create_dir_all(&folder).unwrap();
        assert_eq!(resolved(&folder.join(path)), file.canonicalize().unwrap());
        assert_eq!(
            path_from(Path::new("reports/x"), Path::new("x.toml")),
            Path::new("../../x.toml")
        );
    }

    #[test]
    fn a_run_takes_the_place_of_the_one_before_and_leaves_what_others_put_there() {
        let out = tempfile::tempdir().unwrap();
        let old = [("results.json", "1"), ("old.png", "1"), ("model.c", "1"), ("a.svg", "1")];
        let path = folder(out.path(), &old).write().unwrap();
        fs::write(path.join("notes.txt"), "mine").unwrap();
        folder(out.path(), &[("results.json", "2"), ("a.svg", "2")]).write().unwrap();
        assert_eq!(names(&path), ["a.svg", "notes.txt", "results.json"]);
        assert_eq!(fs::read_to_string(path.join("a.svg")).unwrap(), "2");
    }

    #[test]
    fn what_cannot_be_written_leaves_the_results_before_as_they_are() {
        let out = tempfile::tempdir().unwrap();
        let path = folder(out.path(), &[("results.json", "1"), ("a.svg", "1")]).write().unwrap();
        // a name in a folder that is not there stands for a disk that is full
        let bad = folder(out.path(), &[("a.svg", "2"), ("no/such", "2"), ("results.json", "2")]);
        assert!(bad.write().unwrap_err().to_string().contains("no/such"));
        assert_eq!(names(&path), ["a.svg", "results.json"]);
        assert_eq!(fs::read_to_string(path.join("a.svg")).unwrap(), "1");
        // and where there was no run before, no empty folder stays
        let mut first = ResultFolder::new(out.path(), "first");
        first.add("no/such", "2");
        assert!(first.write().is_err() && !out.path().join("first").exists());
    }
}
