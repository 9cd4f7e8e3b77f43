//! The only module that touches files: recordings, text, result folders.

mod bytes;
mod columns;
mod csv;
mod error;
mod folder;
mod format;
mod in_memory;
mod journal;
mod json;
mod long;
mod mcap_table;
mod parquet;
mod preview;
mod protobuf;
mod rate;
mod recording;
mod second_header;
mod signals;
mod summary;
mod sysid;
mod table;
mod text_log;
mod uneven;
mod uneven_rows;
mod whole;
mod words;

whole::formats! {
    wpilog,
    mcap,
    mat,
    npy,
    npz,
}

pub use columns::{Column, ColumnMap, contract_units, spellings};
pub use csv::is_owner;
pub use error::IoError;
pub use folder::{
    ResultFolder, check_writable, exists, file_names, make_folder, path_from, read_text, resolved,
    sha256, sha256_text, write_whole,
};
pub use in_memory::{needed_columns, table_channels};
pub use journal::Journal;
pub use long::read_long_recording;
pub use mcap_table::write_mcap_table;
pub use preview::{PreviewColumn, preview};
pub use rate::stated_period;
pub use recording::{
    Headers, RawChannels, headers, opening, part_of_second, parts, read_channels, read_recording,
    stated_radius, unknown_unit, without_port,
};
pub use summary::{group_rows, read_parquet_table, write_csv_table};
pub use table::{TableColumn, write_csv, write_parquet_pieces, write_parquet_table};
pub use text_log::foreign_encoding;
pub use uneven_rows::uneven_rows;
pub use words::{WheelSide, is_side, side, words};

#[cfg(test)]
mod tests;
