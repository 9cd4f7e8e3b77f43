//! The only room that touches files: recordings, text, result folders.

mod columns;
mod csv;
mod error;
mod folder;
mod recording;
mod table;

pub use columns::{Column, ColumnMap};
pub use error::IoError;
pub use folder::{ResultFolder, check_writable, read_text, sha256, write_whole};
pub use recording::{Headers, headers, read_recording};
pub use table::{TableColumn, write_csv, write_parquet_table};
