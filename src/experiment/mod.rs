//! Runs the stages of an experiment; the only module that depends on all others.

mod align;
mod assemble;
mod between_rows;
mod check;
mod combinations;
mod comparison;
mod contradiction;
mod copies;
mod custom;
mod diagnosis;
mod drives;
mod error;
mod estimates;
mod execute;
mod export;
mod file;
mod fits;
mod fitted;
mod fuzzy_study;
mod grid;
mod guess;
mod index;
mod input_time;
mod interrupt;
mod long;
mod loop_commands;
mod measured;
mod model_out;
mod models;
mod new_file;
mod no_motion;
mod options;
mod origin;
mod overlay;
mod plan;
mod quality;
mod reading;
mod remark;
mod remarks;
mod resolve;
mod robot_table;
mod run;
mod shard;
mod source;
mod stages;
mod together;
mod unrepaired;
mod what_if;

pub use check::check;
pub use combinations::GridPlan;
pub use comparison::{Comparison, compare};
pub use diagnosis::{Diagnosed, diagnose};
pub use error::{ExperimentError, RunError};
pub use execute::{Outcome, execute, load, load_all, load_recordings, merge, write};
pub use export::{ExportFormat, export};
pub use file::{
    AllCandidates, CandidatesEntry, ColumnEntry, ConstructionWord, CustomEntry, CustomParameter,
    DiagnosisEntry, EmulatorEntry, ExperimentFile, FileError, FixedEntry, GridAxis, ModelEntry,
    MovementEntry, NamedMovement, RecordingsEntry, SimulationEntry, json_schema,
};
pub use fits::{MethodFit, fits};
pub use fitted::{FittedModel, FittedModels};
pub use index::write_index;
pub use interrupt::say_on_interrupt;
pub use loop_commands::add_effect;
pub use new_file::new_file;
pub use options::{Done, RunOptions};
pub use overlay::{Overlay, overlay};
pub use plan::{DiagnosisPlan, InputSum, MeasuredRecording, MethodPlan, Plan, PlanOptions};
pub use reading::Reading;
pub use remark::{FixedMovement, Remark};
pub use resolve::plan_of;
pub use robot_table::robot_of;
pub use run::{run, study};
pub use shard::{Shard, ShardError};
pub use together::{Unread, together};
