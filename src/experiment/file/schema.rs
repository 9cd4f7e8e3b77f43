//! The keys of an experiment file.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use toml::Table;

use super::column::{ColumnEntry, columns};
use crate::conditioning::Settings;
use crate::diagnose;
use crate::recording::DriveUnit;
use crate::simulate::{Hold, NoiseLevel, Segment};
use crate::verdict::Basis;

/// An experiment: recordings or a simulation, a model, methods to compare, and a diagnosis.
#[derive(Clone, Debug, Default, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ExperimentFile {
    /// Title of the report.
    pub title: Option<String>,
    /// Preset or construction data; default: the AmigoBot.
    #[schemars(schema_with = "super::key_schema::robot")]
    pub robot: Option<Table>,
    /// Measured data.
    pub recordings: Option<RecordingsEntry>,
    /// Corrections of faults of sensors and loggers; all are enabled by default.
    pub conditioning: Settings,
    /// Synthetic data.
    pub simulation: Option<SimulationEntry>,
    /// Effects, fixed parameters and formulas.
    pub model: ModelEntry,
    /// Methods to compare.
    #[schemars(schema_with = "super::key_schema::methods")]
    pub method: Vec<Table>,
    /// Emulator of eq. (19).
    pub emulator: EmulatorEntry,
    /// Search for missing effects; not run without this table.
    pub diagnosis: Option<DiagnosisEntry>,
    /// The experiment is repeated over all combinations of these keys.
    #[schemars(schema_with = "super::key_schema::grid")]
    pub grid: Option<Table>,
}

/// `[recordings]`.
#[derive(Clone, Debug, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RecordingsEntry {
    /// Training files.
    #[schemars(length(min = 1))]
    pub train: Vec<String>,
    /// Validation files.
    #[serde(default)]
    pub validation: Vec<String>,
    /// Columns whose names or units differ from the standard ones.
    #[serde(default, deserialize_with = "columns")]
    #[schemars(schema_with = "super::key_schema::columns")]
    pub columns: BTreeMap<String, ColumnEntry>,
    /// Unit of the input.
    #[serde(default)]
    pub drive_unit: DriveUnit,
    /// The input between samples; linear by default; `check` reports if the motion fits a held input better.
    #[serde(default)]
    pub hold: Option<Hold>,
    /// Largest number of rows of a recording that is kept in memory. Of a longer one (CSV, Parquet) only
    /// windows are kept; torque_regression reads every row of it, block by block.
    #[serde(default = "hold_rows")]
    #[schemars(range(min = 1000))]
    pub hold_rows: usize,
}

pub(in crate::experiment) fn hold_rows() -> usize {
    1_000_000
}

/// `[simulation]`.
#[derive(Clone, Debug, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SimulationEntry {
    /// `paper`, `rich`, or a list of segments.
    pub movement: MovementEntry,
    /// Effects of the simulated robot that the model may not contain: effect, then parameter = value.
    #[schemars(schema_with = "super::key_schema::hidden")]
    pub hidden: BTreeMap<String, BTreeMap<String, f64>>,
    /// Standard deviations of the noise.
    pub noise: NoiseLevel,
    /// Seed of noise and rich movements.
    pub seed: u64,
    /// Number of training recordings.
    #[schemars(range(min = 1))]
    pub train: usize,
    /// Number of validation recordings.
    pub validation: usize,
    /// Sampling rate \[Hz\].
    #[schemars(range(min = 1.0, max = 1e5))]
    pub rate_hz: f64,
    /// Rate of the robot's controller \[Hz\].
    #[schemars(range(min = 1.0, max = 1e5))]
    pub control_rate_hz: f64,
    /// Length of a rich movement \[s\].
    #[schemars(range(min = 2.0, max = 1e5))]
    pub duration_s: f64,
    /// Largest wheel speed of a rich movement [rad/s].
    #[schemars(range(min = 0.1, max = 1e4))]
    pub top_speed_rad_s: f64,
    /// Counts of the encoder per turn.
    #[schemars(range(min = 1.0))]
    pub encoder_ticks: Option<f64>,
    /// True values of base parameters that differ from the construction.
    #[schemars(schema_with = "super::key_schema::truth")]
    pub truth: BTreeMap<String, f64>,
    /// Factor on all noise, for grids.
    #[schemars(range(min = 0.0))]
    pub noise_scale: f64,
}

impl Default for SimulationEntry {
    fn default() -> Self {
        Self {
            movement: MovementEntry::Named(NamedMovement::Rich),
            hidden: BTreeMap::new(),
            noise: NoiseLevel::default(),
            seed: 1,
            train: 2,
            validation: 1,
            rate_hz: 100.0,
            control_rate_hz: 1000.0,
            duration_s: 25.0,
            top_speed_rad_s: 12.0,
            encoder_ticks: None,
            truth: BTreeMap::new(),
            noise_scale: 1.0,
        }
    }
}

/// A movement by name, or as segments.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, schemars::JsonSchema)]
#[serde(
    untagged,
    expecting = "expected \"paper\", \"rich\", or a list of segments { speed_m_s, turn_rad_s, blend_s, hold_s }"
)]
pub enum MovementEntry {
    /// `paper` or `rich`.
    Named(NamedMovement),
    /// Segments in their order.
    Segments(Vec<Segment>),
}

/// A movement with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NamedMovement {
    /// The movement of the paper: start, straight, circle, brake.
    Paper,
    /// Random speeds and turn rates that excite all parameters.
    Rich,
}

/// `[model]`.
#[derive(Clone, Debug, Default, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ModelEntry {
    /// Effects added to the base.
    #[schemars(schema_with = "super::key_schema::effects")]
    pub effects: Vec<String>,
    /// Fixed parameters, at a value or at that of the construction data.
    #[schemars(schema_with = "super::key_schema::fixed")]
    pub fixed: BTreeMap<String, FixedEntry>,
    /// Effects defined by formulas.
    pub custom: Vec<CustomEntry>,
}

/// A value, or `"construction"`.
#[derive(Clone, Debug, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(untagged, expecting = "expected a number or \"construction\"")]
pub enum FixedEntry {
    /// At this value.
    Value(f64),
    /// At the value of the construction data.
    Construction(ConstructionWord),
}

/// Keyword for the construction data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ConstructionWord {
    /// At the value of the construction data.
    Construction,
}

/// `[[model.custom]]`.
#[derive(Clone, Debug, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CustomEntry {
    /// Id by which `[model] effects` and `[simulation] hidden` refer to it.
    pub id: String,
    /// Resisting torque on wheel 1 [N m].
    pub torque1: String,
    /// Resisting torque on wheel 2 [N m]; default: the same formula with the wheels exchanged.
    pub torque2: Option<String>,
    /// Parameters by symbol.
    pub parameters: BTreeMap<String, CustomParameter>,
    /// Description, for the report.
    #[serde(default)]
    pub description: String,
}

/// A parameter of a custom effect.
#[derive(Clone, Debug, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct CustomParameter {
    /// Unit in tables and on axes; not converted.
    pub unit: String,
    /// Smallest and largest value.
    pub range: (f64, f64),
    /// Typical value.
    pub typical: f64,
    /// Whether it is a shape parameter, in which the torque is not linear.
    pub shape: bool,
}

impl Default for CustomParameter {
    fn default() -> Self {
        Self { unit: String::new(), range: (-1e6, 1e6), typical: 0.01, shape: false }
    }
}

/// `[emulator]`.
#[derive(Clone, Debug, Default, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(extend("maxProperties" = 1))]
pub struct EmulatorEntry {
    /// K on the wheel speeds [1/s].
    pub gain: Option<f64>,
    /// Two poles of each wheel's error [1/s].
    pub poles: Option<[f64; 2]>,
    /// K as a whole, on errors of (alpha1, alpha2, omega1, omega2).
    pub matrix: Option<[[f64; 4]; 4]>,
}

/// `[diagnosis]`.
#[derive(Clone, Debug, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct DiagnosisEntry {
    /// `"all"` or a list of ids.
    pub candidates: CandidatesEntry,
    /// False-alarm rate.
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 1.0))]
    pub false_alarm: f64,
    /// Largest number of added effects.
    #[schemars(range(min = 1))]
    pub max_effects: usize,
    /// Whether a slow unknown torque (up to 1 s) is treated as noise. `false` for a test bench with an
    /// accurately known input: constant and slow effects are detected better, but coloured noise causes false
    /// alarms.
    pub slow_moment: bool,
}

impl Default for DiagnosisEntry {
    fn default() -> Self {
        let diagnose::Settings { max_effects, .. } = diagnose::Settings::default();
        let Basis { false_alarm, slow_moment, .. } = Basis::new(&[], &[], Hold::default());
        let candidates = CandidatesEntry::All(AllCandidates::All);
        Self { candidates, false_alarm, max_effects, slow_moment }
    }
}

/// `"all"` or ids.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, schemars::JsonSchema)]
#[serde(untagged, expecting = "expected \"all\" or a list of effects")]
pub enum CandidatesEntry {
    /// The whole catalogue.
    All(AllCandidates),
    /// Ids.
    Some(#[schemars(schema_with = "super::key_schema::candidates")] Vec<String>),
}

/// Keyword for the whole catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AllCandidates {
    /// Every effect of the catalogue, and the formulas of the file.
    All,
}
