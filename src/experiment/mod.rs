//! Runs the stages of an experiment; the only room that sees all.

mod diagnosis;
mod file;
mod plan;
mod run;

pub use file::{ExperimentFile, FileError};
pub use plan::{DiagnosisPlan, Measured, MethodPlan, Plan};
pub use run::{RunError, run};
