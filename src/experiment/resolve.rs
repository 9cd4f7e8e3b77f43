//! From an experiment file to a plan: looks up presets, effects, methods and recordings.

use std::path::Path;
use std::sync::Arc;

use rayon::prelude::*;
use toml::Table;

use super::assemble::{assembled, candidates_are_known, check_track};
use super::copies::check_copies;
use super::custom::{self, Own, add};
use super::drives::Drives;
use super::error::{ExperimentError, Meaning, nearest, words};
use super::file::{
    CandidatesEntry, ColumnEntry, DiagnosisEntry, EmulatorEntry, ExperimentFile, FixedEntry,
    MovementEntry, NamedMovement, SimulationEntry,
};
use super::guess::{assumed_unit, assumed_units};
use super::plan::{DiagnosisPlan, InputSum, MeasuredRecording, MethodPlan, Plan, PlanOptions};
use super::robot_table::{is_built, robot};
use super::source::Source;
use crate::diagnose;
use crate::effects::ParameterKind;
use crate::identify;
use crate::model::Model;
use crate::robot::Robot;
use crate::simulate::{Drive, Gain, Hold, Movement, Recorder};
use crate::study::Role;

/// Reads, or simulates, the recordings of a file at `path`.
fn source(
    path: &Path,
    file: &ExperimentFile,
    robot: &Robot,
    own: &[Own],
    drives: Option<&Drives>,
) -> Result<Source, Meaning> {
    match (&file.recordings, &file.simulation) {
        (Some(entry), _) => {
            let recordings = super::measured::read(path, entry, &file.conditioning, robot)?;
            Ok(Source { hold: entry.hold, ..Source::given(recordings) })
        }
        (None, Some(entry)) => simulated(entry, own, robot, drives),
        (None, None) => Ok(Source { hold: Some(Hold::Linear), ..Source::given(vec![]) }),
    }
}

/// Resolves a file at `path` (recordings are relative to it) with this `text`.
///
/// # Errors
/// Names that do not exist.
pub(super) fn resolve(
    path: &Path,
    text: &str,
    file: &ExperimentFile,
) -> Result<Plan, ExperimentError> {
    resolve_with(path, text, file, &mut None, None)
}

/// The same with the cached recordings of an earlier experiment with the same recordings; otherwise they are
/// read and cached. With `drives` it is a cell of a grid: a motion that an earlier cell has simulated is used, and
/// the quality of simulated recordings, which the tables of a grid do not contain, is not checked.
pub(super) fn resolve_with(
    path: &Path,
    text: &str,
    file: &ExperimentFile,
    kept: &mut Option<Source>,
    drives: Option<&Drives>,
) -> Result<Plan, ExperimentError> {
    let read = |robot: &Robot, own: &[Own]| match kept {
        Some(source) => Ok(source.clone()),
        None => Ok(kept.insert(source(path, file, robot, own, drives)?).clone()),
    };
    plan(path, text, file, read).map_err(|e| e.of(&path.display().to_string()))
}

/// The experiment described by a file with these `keys`, on recordings that are already read. `name` replaces that of
/// the file; `[recordings]` and `[simulation]` are not allowed among the keys. `hold` is the input between the rows;
/// `None` determines it from the data, like a file without `recordings.hold`.
///
/// # Errors
/// Errors in the keys.
///
/// # Examples
/// ```
/// use amigo_ident::experiment::{Reading, compare, fits, plan_of};
/// use amigo_ident::{recording::DriveUnit, robot::Robot, study::Role};
/// let reading = Reading::new(Robot::amigobot(), DriveUnit::NewtonMetre);
/// let train = reading.file(Role::Train, "recordings/simulated_3d/slope/train_1.csv".as_ref())?;
/// let keys = toml::from_str("model.effects = [\"slope\"]\nmethod = [{ name = \"weak_form\" }]")?;
/// let plan = plan_of("slope", &keys, vec![train], None)?;
/// let comparison = compare(&plan, &fits(&plan))?;
/// let (judged, weak_form) = (comparison.judged(), &comparison.methods[0]);
/// assert!(judged.window_rms(&weak_form.performance) < 2.0 * judged.floor());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn plan_of(
    name: &str,
    keys: &Table,
    recordings: Vec<MeasuredRecording>,
    hold: Option<Hold>,
) -> Result<Plan, ExperimentError> {
    let wrong = |message: String| ExperimentError::Meaning { file: name.into(), message };
    for key in ["recordings", "simulation", "grid"] {
        if keys.contains_key(key) {
            return Err(wrong(format!("`{key}`: the recordings are given, so leave it out")));
        }
    }
    let file = ExperimentFile::from_table(keys).map_err(wrong)?;
    file.check_keys(name)?;
    let text = toml::to_string(keys).map_err(|e| wrong(e.to_string()))?;
    let source = Source { hold, ..Source::given(recordings) };
    plan(Path::new(name), &text, &file, |_, _| Ok(source)).map_err(|e| e.of(name))
}

fn plan(
    path: &Path,
    text: &str,
    file: &ExperimentFile,
    read: impl FnOnce(&Robot, &[Own]) -> Result<Source, Meaning>,
) -> Result<Plan, Meaning> {
    let robot = robot(file.robot.as_ref())?;
    let own = custom::effects(&file.model.custom).map_err(words)?;
    let model = model(file, &own, &robot)?;
    let methods = methods(&file.method, file.emulator.gain)?;
    let gain = gain(file)?;
    let diagnosis = diagnosis(file, &own)?;
    check_track(&model, diagnosis.as_ref())?;
    let Source { recordings, hold, seed, truth } = read(&robot, &own)?;
    check_copies(&recordings)?;
    let options = PlanOptions {
        title: title(file),
        methods,
        diagnosis,
        hold,
        gain,
        conditioning: file.conditioning,
        robot_is_built: is_built(file.robot.as_ref()),
        seed,
    };
    Ok(Plan {
        file: text.to_string(),
        source: std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()),
        sums: sums(file),
        assumed: assumed(file),
        robot_is_given: file.robot.is_some(),
        own,
        of_paper: file.simulation.as_ref().is_some_and(is_of_paper),
        truth,
        ..assembled(&name_of(path), model, recordings, options)
    })
}

/// Inputs that are the sum of several columns.
fn sums(file: &ExperimentFile) -> Vec<InputSum> {
    let columns = file.recordings.iter().flat_map(|r| &r.columns);
    let sums = columns.filter(|(_, column)| !column.plus.is_empty());
    sums.map(|(key, column)| InputSum {
        input: key.to_string(),
        columns: std::iter::once(&column.name).chain(&column.plus).cloned().collect(),
    })
    .collect()
}

/// The units in which columns are read although nothing states one.
fn assumed(file: &ExperimentFile) -> Option<String> {
    let recordings = file.recordings.as_ref()?;
    let unit = |(key, column): (&String, &ColumnEntry)| {
        let is_given = column.unit.is_some()
            || column.scale.is_some()
            || column.per_turn.is_some()
            || column.nanoseconds.is_some()
            || column.period.is_some()
            || column.torque_constant.is_some();
        let unit = assumed_unit(key, &column.name, recordings.drive_unit)?;
        (!is_given).then(|| (key.clone(), unit))
    };
    assumed_units(recordings.columns.iter().filter_map(unit))
}

/// The title; an empty one, as in a new file, is ignored.
fn title(file: &ExperimentFile) -> Option<String> {
    file.title.clone().filter(|title| !title.trim().is_empty())
}

/// The name of the result folder: that of the file.
pub(super) fn name_of(path: &Path) -> String {
    path.file_stem().map_or_else(|| "experiment".into(), |s| s.to_string_lossy().into_owned())
}

/// The model of the file: base, effects of the catalogue and custom ones, fixed parameters.
fn model(file: &ExperimentFile, own: &[Own], robot: &Robot) -> Result<Model, Meaning> {
    let mut model = Model::base(robot.clone());
    for id in &file.model.effects {
        model = add(&model, id, own)?;
    }
    for (symbol, entry) in &file.model.fixed {
        let value = match entry {
            FixedEntry::Value(value) => *value,
            FixedEntry::Construction(_) => {
                let index = model.index_of(symbol)?;
                let base = robot.parameters().to_array();
                *base.get(index).ok_or_else(|| {
                    words(format!("model.fixed.{symbol}: the construction data give a1..a5 only"))
                })?
            }
        };
        model = model.fix(symbol, value)?;
    }
    Ok(model)
}

/// The methods of the file. A fuzzy method without a gain of its own is fitted with the gain of `[emulator]`,
/// if specified.
fn methods(tables: &[Table], emulator: Option<f64>) -> Result<Vec<MethodPlan>, Meaning> {
    if tables.is_empty() {
        return Ok(MethodPlan::defaults());
    }
    tables
        .iter()
        .map(|table| {
            let mut options = table.clone();
            match options.remove("name") {
                Some(toml::Value::String(name)) => {
                    let emulates = identify::find(&name).is_some_and(|m| m.fits_emulator());
                    if let (Some(gain), true) = (emulator, emulates)
                        && gain > 0.0
                    {
                        options.entry("gain").or_insert(gain.into());
                    }
                    method(&name, &options)
                }
                Some(other) => Err(words(format!("[[method]]: name = {other} must be text"))),
                None => {
                    Err(words("[[method]] has no name; `experiment methods` lists them".into()))
                }
            }
        })
        .collect()
}

fn method(name: &str, options: &Table) -> Result<MethodPlan, Meaning> {
    let Some(method) = identify::find(name) else {
        let names: Vec<String> = identify::all().iter().map(|m| m.describe().name).collect();
        let known: Vec<&str> = names.iter().map(String::as_str).collect();
        let near = nearest(name, &known);
        return Err(words(format!(
            "[[method]]: no method is called `{name}`{near}; `experiment methods` lists them"
        )));
    };
    let method = method.configure(options)?;
    let written: Vec<String> = options.iter().map(|(k, v)| format!("{k} = {v}")).collect();
    Ok(MethodPlan::boxed(method, written.join(", ")))
}

fn is_of_paper(entry: &SimulationEntry) -> bool {
    entry.movement == MovementEntry::Named(NamedMovement::Paper)
}

/// The gain of the file, if specified.
fn gain(file: &ExperimentFile) -> Result<Option<Gain>, Meaning> {
    let EmulatorEntry { gain, poles, matrix } = file.emulator;
    let by_poles = || poles.map(|[a, b]| Gain::from_poles(a, b));
    let gain = gain.map(Gain::speed).or_else(by_poles).or(matrix.map(Gain));
    gain.map_or(Ok(()), |gain| gain.check())?;
    Ok(gain)
}

fn diagnosis(file: &ExperimentFile, own: &[Own]) -> Result<Option<DiagnosisPlan>, Meaning> {
    let Some(entry) = &file.diagnosis else { return Ok(None) };
    let candidates = match &entry.candidates {
        CandidatesEntry::All(_) => vec![],
        CandidatesEntry::Some(ids) => ids.clone(),
    };
    candidates_are_known(&candidates, own)?;
    let DiagnosisEntry { false_alarm, max_effects, slow_moment, .. } = *entry;
    let own = own.to_vec();
    let settings = diagnose::Settings {
        candidates,
        own,
        false_alarm,
        max_effects,
        ..diagnose::Settings::default()
    };
    Ok(Some(DiagnosisPlan { settings, slow_moment }))
}

/// The model and the true parameters of a simulated robot.
///
/// # Errors
/// Unknown effects and parameters, and shape parameters out of range.
fn simulated_robot(
    entry: &SimulationEntry,
    own: &[Own],
    robot: &Robot,
) -> Result<(Model, Vec<f64>), Meaning> {
    let mut truth = Model::base(robot.clone());
    for id in entry.hidden.keys() {
        truth = add(&truth, id, own)?;
    }
    let mut p = truth.initial();
    for (symbol, value) in &entry.truth {
        p[truth.index_of(symbol)?] = *value;
    }
    for (id, values) in &entry.hidden {
        for (symbol, value) in values {
            let j = truth.index_of(symbol)?;
            let parameter = &truth.parameters()[j];
            if parameter.effect != *id {
                return Err(words(format!(
                    "simulation.hidden.{id}: `{symbol}` belongs to {}",
                    parameter.effect
                )));
            }
            let range = parameter.spec.range;
            if parameter.spec.kind == ParameterKind::Shape
                && !(*value >= range.0 && *value <= range.1)
            {
                return Err(words(format!(
                    "simulation.hidden.{id}.{symbol} = {value} must lie between {} and {}",
                    range.0, range.1
                )));
            }
            p[j] = *value;
        }
    }
    Ok((truth, p))
}

/// Simulated recordings: a robot with base and hidden effects follows the movement.
fn simulated(
    entry: &SimulationEntry,
    own: &[Own],
    robot: &Robot,
    drives: Option<&Drives>,
) -> Result<Source, Meaning> {
    let (truth, p) = simulated_robot(entry, own, robot)?;
    let count = entry.train + entry.validation;
    let recordings = (0..count)
        .into_par_iter()
        .map(|k| {
            let role = if k < entry.train { Role::Train } else { Role::Validation };
            let number = if k < entry.train { k + 1 } else { k + 1 - entry.train };
            let name = format!("simulated {} {number}", role.name());
            let recorder = Recorder {
                rate: entry.rate_hz,
                control_rate: entry.control_rate_hz.max(entry.rate_hz),
                noise: entry.noise.scaled(entry.noise_scale),
                ticks: entry.encoder_ticks,
                seed: entry.seed.wrapping_mul(1000).wrapping_add(k as u64),
            };
            let make = || Drive::new(&truth, &p, &movement(entry, robot, k as u64), &recorder);
            let drive = match drives {
                Some(drives) => drives.get((entry, own, robot), make)?,
                None => Arc::new(make()?),
            };
            let recording = drive.recorded(&name, &recorder)?;
            let findings = match drives {
                Some(_) => vec![],
                None => super::quality::findings(&recording, robot, &[]),
            };
            let (long, sha256, conditioning) = (None, None, vec![]);
            Ok(MeasuredRecording { role, recording, long, sha256, conditioning, findings })
        })
        .collect::<Result<Vec<_>, Meaning>>()?;
    let truth = truth.symbols().into_iter().zip(p).collect();
    Ok(Source { recordings, hold: Some(Hold::Linear), seed: entry.seed, truth })
}

fn movement(entry: &SimulationEntry, robot: &Robot, k: u64) -> Movement {
    match &entry.movement {
        MovementEntry::Segments(segments) => Movement { segments: segments.clone() },
        MovementEntry::Named(NamedMovement::Paper) => Movement::paper(),
        MovementEntry::Named(NamedMovement::Rich) => {
            let seed = entry.seed.wrapping_mul(100).wrapping_add(k);
            Movement::rich(robot, seed, entry.duration_s, entry.top_speed_rad_s)
        }
    }
}
