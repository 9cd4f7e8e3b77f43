//! Which format a file is in: its name says so, and its first bytes must agree.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::IoError;
use super::error::shown;

/// A format of recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Csv,
    Parquet,
    Wpilog,
    Mcap,
    Mat,
    SysId,
}

/// Format, extension, first bytes where they say so.
const FORMATS: [(Format, &str, &[u8]); 6] = [
    (Format::Csv, "csv", b""),
    (Format::Parquet, "parquet", b"PAR1"),
    (Format::Wpilog, "wpilog", b"WPILOG"),
    (Format::Mcap, "mcap", b"\x89MCAP0\r\n"),
    (Format::Mat, "mat", b"MATLAB "),
    (Format::SysId, "json", b""),
];

/// First bytes of what this program does not read, what it is, and what to do.
const FOREIGN: [(&[u8], &str, &str); 3] = [
    (b"SQLite format 3\0", "a ROS 2 bag in SQLite", "convert it with `ros2 bag convert` to mcap"),
    (b"#ROSBAG V", "a ROS 1 bag", "convert it with `rosbags-convert` to a ROS 2 bag in mcap"),
    (b"PK\x03\x04", "a spreadsheet or an archive", "save it as CSV"),
];

impl Format {
    /// The format of a file; text of any name is CSV.
    pub(super) fn of(path: &Path) -> Result<Self, IoError> {
        let system = |e| IoError::system(path, &e);
        let mut head = Vec::new();
        File::open(path).and_then(|f| f.take(16).read_to_end(&mut head)).map_err(system)?;
        if head.is_empty() {
            return Err(IoError::Empty { file: shown(path) });
        }
        let foreign = FOREIGN.iter().find(|(magic, ..)| head.starts_with(magic));
        if let Some((_, is, remedy)) = foreign {
            let reason = format!("it is {is}; {remedy}");
            return Err(IoError::Format { file: shown(path), format: "recording".into(), reason });
        }
        let extension = path.extension().unwrap_or_default();
        let named = FORMATS.iter().find(|(_, e, _)| extension.eq_ignore_ascii_case(e));
        let named = named.map_or(Self::Csv, |(format, ..)| *format);
        match FORMATS.iter().find(|(_, _, magic)| !magic.is_empty() && head.starts_with(magic)) {
            Some((found, extension, _)) if *found != named => {
                Err(IoError::OtherFormat { file: shown(path), extension: (*extension).into() })
            }
            _ => Ok(named),
        }
    }
}
