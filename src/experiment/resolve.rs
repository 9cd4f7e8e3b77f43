//! From an experiment file to a plan: presets, effects, methods and recordings looked up.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};

use rayon::prelude::*;
use toml::Table;

use super::custom::{self, Own, add};
use super::error::{ExperimentError, Meaning};
use super::file::{
    CandidatesEntry, DiagnosisEntry, ExperimentFile, FixedEntry, MovementEntry, RecordingsEntry,
    SimulationEntry,
};
use super::plan::{DiagnosisPlan, Measured, MethodPlan, Plan};
use crate::diagnose::Settings;
use crate::effects::ParameterKind;
use crate::identify;
use crate::io::{ColumnMap, read_long_recording, read_recording};
use crate::model::Model;
use crate::robot::{Construction, Robot};
use crate::simulate::{Gain, Hold, Movement, Recorder, record};
use crate::study::Role;

/// Methods that are compared where the file names none.
const DEFAULT_METHODS: [&str; 3] = ["prediction_error", "output_error", "torque_regression"];

/// Resolves a file at `path` (recordings are relative to it) whose text is `text`.
///
/// # Errors
/// Whatever names something that is not there.
pub(super) fn resolve(
    path: &Path,
    text: &str,
    file: &ExperimentFile,
) -> Result<Plan, ExperimentError> {
    let shown = path.display().to_string();
    plan(path, text, file).map_err(|e| match e {
        Meaning::Io(e) => e.into(),
        other => ExperimentError::Meaning { file: shown, message: other.to_string() },
    })
}

fn plan(path: &Path, text: &str, file: &ExperimentFile) -> Result<Plan, Meaning> {
    let robot = robot(file.robot.as_ref())?;
    let own = custom::effects(&file.model.custom).map_err(words)?;
    let model = model(file, &own, &robot)?;
    let methods = methods(&file.method, file.emulator.gain)?;
    let gain = gain(file)?;
    let diagnosis = diagnosis(file, &own)?;
    let (recordings, hold, seed, truth) = match (&file.recordings, &file.simulation) {
        (Some(entry), _) => (measured(path, entry, &robot)?, entry.hold, 1, vec![]),
        (None, Some(entry)) => made(entry, &own, &robot)?,
        (None, None) => (vec![], Hold::Linear, 1, vec![]),
    };
    let name = name_of(path);
    Ok(Plan {
        title: title(file, &name),
        name,
        file: text.to_string(),
        remarks: vec![],
        model,
        own,
        recordings,
        hold,
        methods,
        gain,
        diagnosis,
        seed,
        truth,
        grid: None,
    })
}

/// The heading; one that is left empty, as in a new file, counts as none.
fn title(file: &ExperimentFile, name: &str) -> String {
    let written = file.title.clone().filter(|title| !title.trim().is_empty());
    written.unwrap_or_else(|| name.replace(['_', '-'], " "))
}

/// The name of the result folder: that of the file.
pub(super) fn name_of(path: &Path) -> String {
    path.file_stem().map_or_else(|| "experiment".into(), |s| s.to_string_lossy().into_owned())
}

fn robot(table: Option<&Table>) -> Result<Robot, Meaning> {
    let Some(table) = table else { return Ok(Robot::amigobot()) };
    let mut rest = table.clone();
    let base = match rest.remove("preset") {
        None => None,
        Some(toml::Value::String(name)) => Some(preset(&name)?),
        Some(other) => return Err(words(format!("[robot]: preset = {other} must be a name"))),
    };
    if rest.is_empty()
        && let Some(robot) = base
    {
        return Ok(robot);
    }
    let known: Vec<&str> = Construction::amigobot().values().map(|(key, _)| key).collect();
    if let Some(unknown) = rest.keys().find(|k| !known.contains(&k.as_str())) {
        let near = nearest(unknown, &known);
        return Err(words(format!("[robot]: unknown key `{unknown}`{near}")));
    }
    if let Some((key, value)) = rest.iter().find(|(_, v)| !v.is_float() && !v.is_integer()) {
        return Err(words(format!("[robot]: {key} = {value} must be a number")));
    }
    // keys that are written replace those of the preset; without one all must be there
    let mut values = Table::new();
    if let Some(robot) = &base {
        for (key, value) in robot.construction.values() {
            values.insert(key.into(), value.into());
        }
    }
    values.extend(rest);
    let construction: Construction = toml::Value::Table(values)
        .try_into()
        .map_err(|e: toml::de::Error| {
            let remedy = if base.is_some() {
                ""
            } else {
                "; without a preset all construction data must be there, or add preset = \"amigobot\""
            };
            words(format!("[robot]: {}{remedy}", e.message()))
        })?;
    let name = base.map_or_else(|| "custom".into(), |r| format!("{} (changed)", r.name));
    Ok(Robot::new(name, construction)?)
}

fn preset(name: &str) -> Result<Robot, Meaning> {
    Robot::from_preset(name).ok_or_else(|| {
        let presets = crate::robot::presets();
        let known: Vec<&str> = presets.iter().map(|p| p.name).collect();
        let near = nearest(name, &known);
        words(format!("[robot]: no preset `{name}`{near}; there are {}", known.join(", ")))
    })
}

fn words(message: String) -> Meaning {
    Meaning::Words(message)
}

fn nearest(name: &str, known: &[&str]) -> String {
    known
        .iter()
        .map(|k| (strsim::jaro_winkler(k, name), k))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(score, _)| *score > 0.75)
        .map_or(String::new(), |(_, k)| format!("; did you mean `{k}`?"))
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
            FixedEntry::Construction(word) if word == "construction" => {
                let index = model.index_of(symbol)?;
                let base = robot.parameters().to_array();
                *base.get(index).ok_or_else(|| {
                    words(format!("model.fixed.{symbol}: the construction data give a1..a5 only"))
                })?
            }
            FixedEntry::Construction(word) => {
                return Err(words(format!(
                    "model.fixed.{symbol} = \"{word}\" must be a number or \"construction\""
                )));
            }
        };
        model = model.fix(symbol, value)?;
    }
    Ok(model)
}

/// The methods of the file. A fuzzy method that states no gain of its own is fitted in the emulator
/// that the file states, if that has one.
fn methods(tables: &[Table], emulator: Option<f64>) -> Result<Vec<MethodPlan>, Meaning> {
    if tables.is_empty() {
        return DEFAULT_METHODS
            .iter()
            .filter(|name| identify::find(name).is_some())
            .map(|name| method(name, &Table::new()))
            .collect();
    }
    tables
        .iter()
        .map(|table| {
            let mut options = table.clone();
            match options.remove("name") {
                Some(toml::Value::String(name)) => {
                    if let (Some(gain), true) = (emulator, name.starts_with("fuzzy_"))
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
    Ok(MethodPlan {
        name: name.into(),
        title: method.describe().title,
        options: written.join(", "),
        method,
    })
}

fn gain(file: &ExperimentFile) -> Result<Gain, Meaning> {
    let entry = &file.emulator;
    let gain = if let Some(k) = entry.gain {
        Gain::speed(k)
    } else if let Some([a, b]) = entry.poles {
        Gain::from_poles(a, b)
    } else if let Some(matrix) = entry.matrix {
        Gain(matrix)
    } else {
        Gain::ZERO
    };
    gain.check()?;
    Ok(gain)
}

fn diagnosis(file: &ExperimentFile, own: &[Own]) -> Result<Option<DiagnosisPlan>, Meaning> {
    let Some(entry) = &file.diagnosis else { return Ok(None) };
    let candidates = match &entry.candidates {
        CandidatesEntry::All(_) => vec![],
        CandidatesEntry::Some(ids) => ids.clone(),
    };
    for id in &candidates {
        // the model's own message names the effect that was meant
        add(&Model::base(Robot::amigobot()), id, own)?;
    }
    let DiagnosisEntry { false_alarm, max_effects, slow_moment, .. } = *entry;
    let settings = Settings { candidates, own: own.to_vec(), false_alarm, max_effects };
    Ok(Some(DiagnosisPlan { settings, slow_moment }))
}

fn measured(path: &Path, entry: &RecordingsEntry, robot: &Robot) -> Result<Vec<Measured>, Meaning> {
    if entry.hold_rows < 1000 {
        let found = entry.hold_rows;
        return Err(words(format!("recordings.hold_rows = {found} must be 1000 or more")));
    }
    let mut columns = ColumnMap::new(entry.drive_unit, Some(robot.r()));
    for (key, column) in &entry.columns {
        columns.put(key, column.clone().into())?;
    }
    let folder = path.parent().unwrap_or_else(|| Path::new("."));
    let train = entry.train.iter().map(|f| (Role::Train, f));
    let all: Vec<_> = train.chain(entry.validation.iter().map(|f| (Role::Validation, f))).collect();
    let measured = in_threads(&all, |(role, file)| {
        let file: PathBuf = folder.join(file);
        let unit = entry.drive_unit;
        let (recording, long, sha256) =
            match read_long_recording(&file, &columns, unit, entry.hold_rows)? {
                Some((windows, long, sha256)) => (windows, Some(long), sha256),
                None => {
                    let (recording, sha256) = read_recording(&file, &columns, unit)?;
                    (recording, None, sha256)
                }
            };
        let mut findings = super::quality::findings(&recording, robot);
        if let Some(long) = &long {
            findings.insert(0, super::long::finding(&recording, long));
        }
        Ok(Measured { role: *role, recording, long, sha256: Some(sha256), findings })
    })?;
    let train = measured.iter().filter(|m| m.role == Role::Train).map(|m| &m.recording);
    if super::quality::without_drive(train) {
        return Err(words(format!(
            "recordings.train: M1 and M2 are zero throughout ({}); without a drive the parameters \
             have no scale, so record the moments, or name their columns",
            entry.train.join(", ")
        )));
    }
    Ok(measured)
}

/// Does the same with every item in threads of its own, in their order; the first error in that
/// order. Not in those of rayon: a thread of rayon that waits for polars, which has its own, begins
/// the next item meanwhile, and the one after, until files and stack are used up.
fn in_threads<T: Sync, R: Send>(
    items: &[T],
    work: impl Fn(&T) -> Result<R, Meaning> + Sync,
) -> Result<Vec<R>, Meaning> {
    let (next, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
    let worker = || {
        let mut done = Vec::new();
        while !failed.load(Relaxed) {
            let k = next.fetch_add(1, Relaxed);
            let Some(item) = items.get(k) else { break };
            let result = work(item);
            failed.fetch_or(result.is_err(), Relaxed);
            done.push((k, result));
        }
        done
    };
    let workers = rayon::current_num_threads().min(items.len());
    let mut done: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..workers).map(|_| scope.spawn(worker)).collect();
        let joined = threads.into_iter().map(|thread| thread.join());
        joined.flat_map(|done| done.unwrap_or_else(|e| std::panic::resume_unwind(e))).collect()
    });
    // items are taken in order, so that all before the first error are done
    done.sort_by_key(|(k, _)| *k);
    done.into_iter().map(|(_, result)| result).collect()
}

type Made = (Vec<Measured>, Hold, u64, Vec<(String, f64)>);

/// Made recordings: a truth of base and hidden effects drives the movement.
fn made(entry: &SimulationEntry, own: &[Own], robot: &Robot) -> Result<Made, Meaning> {
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
    let count = entry.train + entry.validation;
    let recordings = (0..count)
        .into_par_iter()
        .map(|k| {
            let role = if k < entry.train { Role::Train } else { Role::Validation };
            let number = if k < entry.train { k + 1 } else { k + 1 - entry.train };
            let name = format!("made {} {number}", role.name());
            let recording = record(
                &name,
                &truth,
                &p,
                &movement(entry, robot, k as u64),
                &Recorder {
                    rate: entry.rate_hz,
                    control_rate: entry.control_rate_hz.max(entry.rate_hz),
                    noise: entry.noise.scaled(entry.noise_scale),
                    ticks: entry.encoder_ticks,
                    seed: entry.seed.wrapping_mul(1000).wrapping_add(k as u64),
                },
            )?;
            let findings = super::quality::findings(&recording, robot);
            Ok(Measured { role, recording, long: None, sha256: None, findings })
        })
        .collect::<Result<Vec<_>, Meaning>>()?;
    let truth = truth.symbols().into_iter().zip(p).collect();
    Ok((recordings, Hold::Linear, entry.seed, truth))
}

fn movement(entry: &SimulationEntry, robot: &Robot, k: u64) -> Movement {
    match &entry.movement {
        MovementEntry::Segments(segments) => Movement { segments: segments.clone() },
        MovementEntry::Named(name) if name == "paper" => Movement::paper(),
        MovementEntry::Named(_) => {
            let seed = entry.seed.wrapping_mul(100).wrapping_add(k);
            Movement::rich(robot, seed, entry.duration_s, entry.top_speed_rad_s)
        }
    }
}
