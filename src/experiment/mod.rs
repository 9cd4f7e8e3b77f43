//! Runs the stages of an experiment; the only room that sees all.

mod check;
mod custom;
mod diagnosis;
mod error;
mod estimates;
mod execute;
mod file;
mod fuzzy_study;
mod grid;
mod guess;
mod long;
mod loop_commands;
mod model_out;
mod options;
mod plan;
mod quality;
mod remarks;
mod resolve;
mod run;

pub use check::check;
pub use error::{ExperimentError, RunError};
pub use execute::{Outcome, execute, load, load_all, merge, write_index};
pub use file::{
    CandidatesEntry, ColumnEntry, CustomEntry, CustomParameter, DiagnosisEntry, EmulatorEntry,
    ExperimentFile, FileError, FixedEntry, ModelEntry, MovementEntry, RecordingsEntry,
    SimulationEntry, json_schema,
};
pub use grid::{GridAxis, GridPlan, Shard, ShardError};
pub use loop_commands::{add_effect, new_file};
pub use options::{Done, RunOptions};
pub use plan::{DiagnosisPlan, Measured, MethodPlan, Plan};
pub use run::run;
