//! `[grid]`: an experiment repeated over all combinations of values of its keys.
//!
//! Keys are taken in alphabetical order of their names as written; combinations (cells) are counted
//! with the last key varying fastest. A cell sets its values in the experiment file, simulates or reads
//! its recordings, runs the methods and keeps one [`cell::Row`] per method and parameter, no
//! time series. Errors in a key or a type are found before anything is run; a failure in
//! a cell is a row with its reason.

mod cell;
mod competitors;
mod curves;
mod figures;
mod finish;
mod page;
mod resolve;
mod run;
mod shell;
mod summary;
mod table;
mod thumbnail;
mod winner;
mod word;

pub(super) use finish::{finish, merge, run_part};
pub(super) use resolve::resolve_grid;

#[cfg(test)]
mod tests;
