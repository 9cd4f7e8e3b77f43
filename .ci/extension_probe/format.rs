//! A dummy format, by the recipe of CONTRIBUTING.md; `.ci/extension` adds it to a scratch copy.

use std::path::Path;

use super::IoError;
use super::error::shown;
use super::whole::{Content, WholeFormat};

/// A word, then a name and its values per line.
pub(super) const FORMAT: WholeFormat = WholeFormat {
    extension: "probe",
    magic: b"PROBE",
    read: |path| read(path).map(Content::Columns),
};

fn read(path: &Path) -> Result<Vec<(String, Vec<f64>)>, IoError> {
    let wrong =
        |reason: String| IoError::Format { file: shown(path), format: "probe".into(), reason };
    let text = std::fs::read_to_string(path).map_err(|e| wrong(e.to_string()))?;
    let column = |line: &str| {
        let (name, values) =
            line.split_once(' ').ok_or_else(|| wrong("a line without values".into()))?;
        let values: Result<Vec<f64>, _> = values.split(' ').map(str::parse).collect();
        Ok((name.to_string(), values.map_err(|e| wrong(e.to_string()))?))
    };
    text.lines().skip(1).map(column).collect()
}

#[test]
fn a_file_of_the_format_is_read_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.probe");
    std::fs::write(&path, "PROBE\nt 0 1\nalpha1 0 0.5\n").unwrap();
    assert_eq!(crate::io::headers(&path).unwrap().names, ["t", "alpha1"]);
    let renamed = folder.path().join("run.mat");
    std::fs::rename(&path, &renamed).unwrap();
    assert!(crate::io::headers(&renamed).is_err());
}
