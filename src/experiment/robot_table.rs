//! The `[robot]` table of an experiment file.

use toml::Table;

use super::error::{ExperimentError, Meaning, nearest, words};
use crate::robot::{Construction, Robot};

/// The robot of a `[robot]` table: a preset, construction data, or both.
///
/// # Errors
/// Unknown presets and keys, values out of range.
pub fn robot_of(table: &Table) -> Result<Robot, ExperimentError> {
    robot(Some(table)).map_err(|e| e.of("[robot]"))
}

pub(super) fn robot(table: Option<&Table>) -> Result<Robot, Meaning> {
    let Some(whole) = table else { return Ok(Robot::amigobot()) };
    let robot = built(whole)?;
    let assumed = (!is_built(table)).then(|| AMIGOBOT.to_owned());
    Ok(Robot { assumed, ..robot })
}

/// The robot with the data of a table, and those of its preset for the others.
fn built(table: &Table) -> Result<Robot, Meaning> {
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
    check_keys(&rest, base.is_some())?;
    // keys in the file replace those of the preset
    let mut values = Table::new();
    if let Some(robot) = &base {
        for (key, value) in robot.construction.values() {
            values.insert(key.into(), value.into());
        }
    }
    values.extend(rest);
    let construction: Construction = toml::Value::Table(values)
        .try_into()
        .map_err(|e: toml::de::Error| words(format!("[robot]: {}", e.message())))?;
    let given = |key: &str| table.get(key).is_some();
    let name = match base {
        None => "custom".into(),
        Some(r) if r.name != UNKNOWN => format!("{} (changed)", r.name),
        Some(_) if given("r_m") && given("l1_m") => "custom".into(),
        // with the radius, metres can be converted; without the track there is no path
        Some(_) if given("r_m") => UNKNOWN_TRACK.into(),
        Some(_) => UNKNOWN.into(),
    };
    Ok(Robot::new(name, construction)?)
}

/// Checks that the construction data of a table are known keys with numbers, and complete unless a preset gives the
/// others.
fn check_keys(rest: &Table, has_preset: bool) -> Result<(), Meaning> {
    let known: Vec<&str> = Construction::amigobot().values().map(|(key, _)| key).collect();
    if let Some(unknown) = rest.keys().find(|k| !known.contains(&k.as_str())) {
        let near = nearest(unknown, &known);
        return Err(words(format!("[robot]: unknown key `{unknown}`{near}")));
    }
    if let Some((key, value)) = rest.iter().find(|(_, v)| !v.is_float() && !v.is_integer()) {
        return Err(words(format!("[robot]: {key} = {value} must be a number")));
    }
    let is_missing = |key: &&str| !rest.contains_key(*key) && is_required(key);
    let missing: Vec<&str> = known.iter().copied().filter(is_missing).collect();
    if !has_preset && !missing.is_empty() {
        return Err(words(format!(
            "[robot]: {} missing; without a preset all construction data are required. If they are not known, add preset = \"unknown\", or the preset of a similar robot, whose values are then used",
            and(&missing)
        )));
    }
    Ok(())
}

/// Name of a robot with unknown construction; where a length is needed, that of the AmigoBot is used, and
/// results that depend on it are omitted.
pub(super) const UNKNOWN: &str = "unknown";

/// The robot whose construction stands in for an unknown one.
const AMIGOBOT: &str = "AmigoBot";

/// The same if the radius of the wheels is known.
const UNKNOWN_TRACK: &str = "unknown (with its wheel radius)";

/// Whether the track of a robot is unknown, and therefore its heading and path.
pub(super) fn has_no_track(robot: &Robot) -> bool {
    robot.name == UNKNOWN || robot.name == UNKNOWN_TRACK
}

/// Whether masses and inertias are those of the robot: from a preset, or all specified. Without a table the
/// robot is that of the paper.
pub(super) fn is_built(table: Option<&Table>) -> bool {
    let Some(table) = table else { return true };
    let unknown = table.get("preset").is_some_and(|preset| preset.as_str() == Some(UNKNOWN));
    let written = |key: &str| table.contains_key(key) || !is_required(key);
    !unknown || Construction::amigobot().values().all(|(key, _)| written(key))
}

/// Whether a key of the construction data is required; those of the caster are optional.
fn is_required(key: &str) -> bool {
    let whole = Construction::amigobot();
    let others = whole.values().filter(|(k, _)| *k != key);
    let others = others.map(|(k, value)| (k.to_string(), toml::Value::Float(value)));
    let others = toml::Value::Table(others.collect());
    others.try_into::<Construction>().is_err()
}

/// Keys as the subject of a sentence: `a, b and c are`.
fn and(keys: &[&str]) -> String {
    match keys {
        [one] => format!("{one} is"),
        [rest @ .., last] => format!("{} and {last} are", rest.join(", ")),
        [] => String::new(),
    }
}

fn preset(name: &str) -> Result<Robot, Meaning> {
    if name == UNKNOWN {
        return Ok(Robot::new(UNKNOWN, Robot::amigobot().construction)?);
    }
    Robot::from_preset(name).ok_or_else(|| {
        let presets = crate::robot::presets();
        let known: Vec<&str> = presets.iter().map(|p| p.name).collect();
        let near = nearest(name, &known);
        words(format!("[robot]: no preset `{name}`{near}; there are {}", known.join(", ")))
    })
}
