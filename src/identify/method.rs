//! What a method is: a name, options, and a way from a task to a fit.

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde::de::DeserializeOwned;

use super::Fit;
use crate::model::{Model, ModelError};
use crate::recording::{LongRecording, Recording};
use crate::simulate::{Hold, SimulateError};

/// What is to be identified, from what.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// The model; its fixed parameters stay.
    pub model: &'a Model,
    /// Training recordings; at least one, all with the same drive unit.
    pub train: &'a [Recording],
    /// The drive between samples.
    pub hold: Hold,
    /// Seed of everything random in the method.
    pub seed: u64,
}

/// What the catalogue prints of a method.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct MethodDescription {
    /// Name in experiment files.
    pub name: String,
    /// In words.
    pub title: String,
    /// What it computes, with its equation, in plain text.
    pub equation: String,
    /// Where it comes from.
    pub source: String,
    /// When to use it.
    pub use_when: String,
    /// When not to.
    pub avoid_when: String,
    /// Options: key, default, meaning.
    pub options: Vec<(String, String, String)>,
}

/// An option of a `[[method]]` block that is not understood.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("method `{method}`: {message}")]
pub struct OptionError {
    /// Method.
    pub method: String,
    /// What is wrong, with what was expected.
    pub message: String,
}

/// Why a method has no fit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// The data do not excite what is asked for.
    #[error("{method}: the data cannot give {parameters} (rank {rank} of {columns}); {remedy}")]
    NotExcited {
        /// Method.
        method: String,
        /// Symbols.
        parameters: String,
        /// Numerical rank.
        rank: usize,
        /// Parameters asked for.
        columns: usize,
        /// Which motion to record.
        remedy: String,
    },
    /// Nothing is left after samples near rest and at ends were dropped.
    #[error(
        "{method}: {usable} usable samples are left of {samples} (the wheels stand still or the pieces are too short); record longer motion"
    )]
    TooFewSamples {
        /// Method.
        method: String,
        /// Left.
        usable: usize,
        /// Recorded.
        samples: usize,
    },
    /// No finite cost at the start or anywhere near.
    #[error("{method}: no start is found from which the model can be simulated: {reason}")]
    NoStart {
        /// Method.
        method: String,
        /// Why the last try failed.
        reason: String,
    },
    /// The method does not treat this model.
    #[error("{method}: {reason}")]
    Unsupported {
        /// Method.
        method: String,
        /// What it cannot do, and what to use instead.
        reason: String,
    },
    /// Rows that were there when the recording was checked cannot be read any more.
    #[error("{method}: the rows cannot be read again: {reason}")]
    Rows {
        /// Method.
        method: String,
        /// Why.
        reason: String,
    },
    /// Simulation failed.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The model is not one.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// An identification method.
pub trait Identifier: Send + Sync {
    /// Names, equation, source, when to use.
    fn describe(&self) -> MethodDescription;

    /// The JSON schema of the options of its `[[method]]` block, from the type that reads them.
    fn schema(&self) -> Schema;

    /// The same method with the options of a `[[method]]` block (without its `name`).
    ///
    /// # Errors
    /// Unknown keys and wrong types, in words.
    fn configure(&self, options: &toml::Table) -> Result<Box<dyn Identifier>, OptionError>;

    /// Identifies the model of the task from its recordings.
    ///
    /// # Errors
    /// Only where there is no fit at all; see [`IdentifyError`].
    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError>;

    /// As [`Self::identify`] from every row of recordings that are too long to be held: `task` has
    /// windows of them, and `long` a way to read them for each training recording that is one.
    /// `None` if the method, so configured, needs all rows at once.
    ///
    /// # Errors
    /// As [`Self::identify`], and if the rows cannot be read any more.
    fn identify_long(
        &self,
        _task: &Task,
        _long: &[Option<&LongRecording>],
    ) -> Option<Result<Fit, IdentifyError>> {
        None
    }
}

/// Reads a method with `#[serde(default, deny_unknown_fields)]` from its options.
///
/// # Errors
/// [`OptionError`] with serde's words.
pub fn from_options<M: DeserializeOwned>(
    method: &str,
    options: &toml::Table,
) -> Result<M, OptionError> {
    toml::Value::Table(options.clone()).try_into().map_err(|e: toml::de::Error| OptionError {
        method: method.into(),
        message: e.message().to_string(),
    })
}

/// The JSON schema of what [`from_options`] reads.
#[must_use]
pub fn options_schema<M: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft07().with(|s| s.inline_subschemas = true);
    settings.into_generator().into_root_schema_for::<M>()
}
