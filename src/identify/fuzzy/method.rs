//! Common implementation of the fuzzy methods: options, problem, journal and fit. A method adds its
//! search for the consequents.

use std::fmt::Debug;

use nalgebra::DVector;
use schemars::{JsonSchema, Schema};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::finish::finish;
use super::problem::{Journal, Problem};
use super::settings::{Settings, Start};
use crate::identify::{
    Fit, Identifier, IdentifyError, MethodDescription, NoStart, OptionError, Status, Task,
    from_options, options_schema,
};
use crate::simulate::Structure;

/// Search of one fuzzy method; the type holds its options, with defaults and ranges.
pub trait Search:
    Clone + Debug + Default + Serialize + DeserializeOwned + JsonSchema + Send + Sync + 'static
{
    /// Name in experiment files.
    const NAME: &'static str;

    /// The structure, if the method has only one; `structure` is then not an option.
    const STRUCTURE: Option<Structure> = None;

    /// Title, equation, source, when to use.
    fn describe() -> MethodDescription;

    /// Searches the consequents; a search that moves the premises too changes the job's problem.
    ///
    /// # Errors
    /// If there is no start, or no unique solution.
    fn search(&self, job: &mut Job) -> Result<Found, IdentifyError>;
}

/// Input of a search.
pub struct Job {
    /// The cost.
    pub problem: Problem,
    /// Consequents at the friction level.
    pub level: DVector<f64>,
    /// Weight of the penalty on the distance from the friction level, relative to the mean square sensitivity.
    pub ridge: f64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Record of the evaluations.
    pub journal: Journal,
    method: &'static str,
}

impl Job {
    /// Initial consequents of the search [rad/s²].
    ///
    /// # Errors
    /// See [`Problem::closed_form`].
    pub fn start(&self, start: Start) -> Result<DVector<f64>, IdentifyError> {
        start.of(&self.problem, &self.level, self.ridge, self.method)
    }

    /// The error of a search without initial consequents.
    #[must_use]
    pub fn no_start(&self, reason: NoStart) -> IdentifyError {
        IdentifyError::NoStart { method: self.method.into(), reason }
    }
}

/// Result of a search.
pub struct Found {
    /// Consequents [rad/s²].
    pub theta: Vec<f64>,
    /// Number of steps, sweeps, generations or epochs.
    pub iterations: usize,
    /// Status of the search.
    pub status: Status,
}

/// A fuzzy method: the common options and a search.
#[derive(Clone, Debug, Default)]
pub struct Fuzzy<S> {
    /// Options of all fuzzy methods.
    pub settings: Settings,
    /// The search with its own options.
    pub search: S,
}

impl<S: Search> Identifier for Fuzzy<S> {
    fn describe(&self) -> MethodDescription {
        S::describe()
    }

    fn schema(&self) -> Schema {
        schema_with::<S>()
    }

    fn fits_emulator(&self) -> bool {
        true
    }

    fn configure(&self, options: &toml::Table) -> Result<Box<dyn Identifier>, OptionError> {
        let (settings, search) = split::<S>(options)?;
        Ok(Box::new(Self { settings, search }))
    }

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        let (problem, level) = self.settings.problem(task, S::NAME)?;
        let mut job = Job {
            problem: match S::STRUCTURE {
                Some(structure) => problem.with_structure(structure),
                None => problem,
            },
            level,
            ridge: self.settings.ridge,
            seed: task.seed,
            journal: Journal::default(),
            method: S::NAME,
        };
        let found = self.search.search(&mut job)?;
        let Found { theta, iterations, status } = found;
        Ok(finish(S::NAME, &job.problem, &theta, status, iterations, &job.journal))
    }
}

/// Splits the options of a block into those shared by all fuzzy methods and the search's own.
///
/// # Errors
/// Unknown keys, wrong types and values out of range.
fn split<S: Search>(options: &toml::Table) -> Result<(Settings, S), OptionError> {
    let (method, shared_keys) = (S::NAME, keys::<Settings>());
    let own_keys = keys::<S>();
    if S::STRUCTURE.is_some() && options.contains_key(STRUCTURE) {
        let message = "unknown option `structure`; this method is always serial-parallel, use \
                       fuzzy_levenberg_marquardt for the parallel one";
        return Err(OptionError { method: method.into(), message: message.into() });
    }
    let (mut shared, mut own) = (toml::Table::new(), toml::Table::new());
    for (key, value) in options {
        if shared_keys.contains_key(key) {
            shared.insert(key.clone(), value.clone());
        } else if own_keys.contains_key(key) {
            own.insert(key.clone(), value.clone());
        } else {
            let all: Vec<&str> =
                shared_keys.keys().chain(own_keys.keys()).map(String::as_str).collect();
            let message = format!("unknown option `{key}`; expected {}", all.join(", "));
            return Err(OptionError { method: method.into(), message });
        }
    }
    let settings: Settings = from_options(method, &shared)?;
    settings.check(method)?;
    Ok((settings, from_options(method, &own)?))
}

/// The JSON schema of what [`split`] reads.
fn schema_with<S: Search>() -> schemars::Schema {
    let mut all = keys::<Settings>();
    if S::STRUCTURE.is_some() {
        all.remove(STRUCTURE);
    }
    all.extend(keys::<S>());
    let mut schema = options_schema::<S>();
    schema.insert("properties".into(), all.into());
    schema
}

/// The option that is left out for searches with one structure only.
const STRUCTURE: &str = "structure";

/// The properties of an options schema.
fn keys<T: JsonSchema>() -> serde_json::Map<String, serde_json::Value> {
    let schema = options_schema::<T>();
    schema.get("properties").and_then(|p| p.as_object().cloned()).unwrap_or_default()
}
