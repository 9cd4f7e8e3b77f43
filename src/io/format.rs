//! File formats: determined by the extension, and checked by the first bytes.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::error::shown;
use super::whole::WholeFormat;
use super::{IoError, WHOLE};

/// A format of recordings.
#[derive(Clone, Copy)]
pub(super) enum Format {
    /// Text, read block by block where it is long.
    Csv,
    /// Read block by block where it is long.
    Parquet,
    /// JSON, with several recordings in a file.
    SysId,
    /// Any other.
    Whole(&'static WholeFormat),
}

/// Format, extension, and first bytes if they identify the format.
type Known = (Format, &'static str, &'static [u8]);

const CSV: Known = (Format::Csv, "csv", b"");

fn known() -> impl Iterator<Item = Known> {
    let own: [Known; 3] =
        [CSV, (Format::Parquet, "parquet", b"PAR1"), (Format::SysId, "json", b"")];
    own.into_iter().chain(WHOLE.iter().map(|w| (Format::Whole(w), w.extension, w.magic)))
}

/// First bytes of unsupported formats, their names, and remedies.
const FOREIGN: [(&[u8], &str, &str); 9] = [
    (b"\x1f\x8b", "compressed (gzip)", "unpack it with `gunzip` first"),
    (b"BZh", "compressed (bzip2)", "unpack it with `bunzip2` first"),
    (b"\x28\xb5\x2f\xfd", "compressed (zstd)", "unpack it with `unzstd` first"),
    (b"\xfd7zXZ", "compressed (xz)", "unpack it with `unxz` first"),
    (
        b"ULog\x01\x12\x35",
        "a ULog of PX4",
        "convert it with `ulog2csv` (pyulog) and give the CSV file of one topic",
    ),
    (b"SQLite format 3\0", "a ROS 2 bag in SQLite", "convert it with `ros2 bag convert` to mcap"),
    (b"#ROSBAG V", "a ROS 1 bag", "convert it with `rosbags-convert` to a ROS 2 bag in mcap"),
    (b"PK\x03\x04", "a spreadsheet or an archive", "save it as CSV"),
    (
        b"TDSm",
        "a TDMS file of LabVIEW",
        "export it as CSV or as .lvm (npTDMS: `tdmsinfo`, `TdmsFile.as_dataframe().to_csv`)",
    ),
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
        let extension = path.extension().unwrap_or_default();
        let named = known().find(|(_, e, _)| extension.eq_ignore_ascii_case(e)).unwrap_or(CSV);
        // an archive of arrays has the first bytes of any archive
        let foreign =
            FOREIGN.iter().find(|(magic, ..)| head.starts_with(magic) && named.2 != *magic);
        if let Some((_, is, remedy)) = foreign {
            let reason = format!("it is {is}; {remedy}");
            return Err(IoError::Format { file: shown(path), format: "recording".into(), reason });
        }
        match known().find(|(_, _, magic)| !magic.is_empty() && head.starts_with(magic)) {
            Some((_, found, _)) if found != named.1 => {
                Err(IoError::OtherFormat { file: shown(path), extension: found.into() })
            }
            _ => Ok(named.0),
        }
    }
}
