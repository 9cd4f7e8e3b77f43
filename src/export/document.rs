//! The exported files: `model.json`, and the model as a function if possible.

use serde_json::{Value, json};

use super::fill::{Constant, Content};
use super::language::JAVASCRIPT;
use super::traced::{Obstacle, Traced, trace};
use crate::model::Model;
use crate::recording::DriveUnit;
use crate::simulate::Hold;

/// Version of the layout of `model.json`.
pub const SCHEMA: u32 = 1;

/// The equation of every model as text.
const EQUATION: &str = "mass matrix (m11 m12; m12 m22) times the wheel accelerations + resisting \
                        torques + sum over the directions d = (1,0), (0,1), (1,-1), (1,1) of d \
                        level sgn(d . omega) = acting torques";

/// A model with the identified values and their origin.
#[derive(Clone, Copy, Debug)]
pub struct Identified<'a> {
    /// The identified model.
    pub model: &'a Model,
    /// One value per parameter.
    pub values: &'a [f64],
    /// One standard error per parameter; zero if it is fixed.
    pub std_errors: &'a [f64],
    /// One unit per parameter, for the input unit of the recordings.
    pub units: &'a [String],
    /// Unit of the recorded torques.
    pub drive_unit: DriveUnit,
    /// The input between two samples.
    pub hold: Hold,
    /// Name of the experiment.
    pub experiment: &'a str,
    /// The method that estimated the values.
    pub method: &'a str,
    /// Effects found by the diagnosis that are not in the model.
    pub missing: &'a [String],
}

/// Exported files of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFiles {
    /// Files as name and text, `model.json` first.
    pub files: Vec<(String, String)>,
    /// Why there is no function, if there is none.
    pub obstacles: Vec<Obstacle>,
}

impl ModelFiles {
    /// Description of the files in a sentence.
    #[must_use]
    pub fn words(&self) -> String {
        let names: Vec<&str> = self.files.iter().map(|(name, _)| name.as_str()).collect();
        let names = names.join(", ");
        if self.obstacles.is_empty() {
            return names;
        }
        format!("{names}; not written as a function ({})", reasons(&self.obstacles))
    }
}

/// The obstacles as text.
#[must_use]
pub fn reasons(obstacles: &[Obstacle]) -> String {
    let because = |o: &Obstacle| format!("{}: {}", o.effect, o.reason);
    obstacles.iter().map(because).collect::<Vec<_>>().join("; ")
}

/// Writes `model.json`, and `model.py`, `model.m`, `model.c`, `model.mo`, `model.js` if every effect is a
/// function of the present state.
///
/// # Panics
/// If values, errors or units do not have one entry per parameter.
#[must_use]
pub fn files(identified: &Identified) -> ModelFiles {
    let n = identified.model.parameters().len();
    assert!(identified.values.len() == n && identified.std_errors.len() == n);
    assert_eq!(identified.units.len(), n);
    let traced = traced(identified);
    let (functions, obstacles) = match &traced {
        Ok(traced) => (content(identified, traced).files(), vec![]),
        Err(obstacles) => (vec![], obstacles.clone()),
    };
    let names: Vec<&str> = functions.iter().map(|(name, _): &(String, _)| name.as_str()).collect();
    let data = json(identified, &names, &obstacles);
    let data = serde_json::to_string_pretty(&data).unwrap_or_default() + "\n";
    let mut files = vec![("model.json".to_owned(), data)];
    files.extend(functions);
    ModelFiles { files, obstacles }
}

/// The model as a function in JavaScript: the text of `model.js`.
///
/// # Errors
/// Every effect that is not a function of the present state.
pub fn javascript(identified: &Identified) -> Result<String, Vec<Obstacle>> {
    Ok(content(identified, &traced(identified)?).fill(&JAVASCRIPT))
}

fn content<'a>(identified: &Identified, traced: &'a Traced) -> Content<'a> {
    let (constants, header) = (constants(identified), header(identified, traced));
    Content { traced, header, constants, hold: identified.hold }
}

fn traced(identified: &Identified) -> Result<Traced, Vec<Obstacle>> {
    if identified.values.iter().all(|v| v.is_finite()) {
        return trace(identified.model, identified.values);
    }
    let reason = "a parameter has no finite value".into();
    Err(vec![Obstacle { effect: "all".into(), reason }])
}

fn json(it: &Identified, functions: &[&str], obstacles: &[Obstacle]) -> Value {
    let effects = it.model.effects().iter().enumerate().map(|(e, effect)| {
        let d = effect.description();
        let parameters = it.model.slots(e).map(|j| {
            let parameter = &it.model.parameters()[j];
            json!({
                "symbol": parameter.spec.symbol,
                "meaning": parameter.spec.meaning,
                "value": it.values[j],
                "std_error": it.std_errors[j],
                "unit": it.units[j],
                "fixed": parameter.fixed.is_some(),
            })
        });
        json!({
            "id": d.id,
            "title": d.title,
            "equation": d.equation,
            "parameters": parameters.collect::<Vec<_>>(),
        })
    });
    let robot = it.model.robot();
    json!({
        "schema": SCHEMA,
        "exported": obstacles.is_empty(),
        "functions": functions,
        "obstacles": obstacles,
        "equation": EQUATION,
        "drive": { "unit": it.drive_unit, "hold": it.hold },
        "effects": effects.collect::<Vec<_>>(),
        "robot": { "name": robot.name, "construction": robot.construction },
        "provenance": {
            "experiment": it.experiment,
            "method": it.method,
            "missing_effects": it.missing,
            "program": { "name": env!("CARGO_PKG_NAME"), "version": env!("CARGO_PKG_VERSION") },
        },
    })
}

/// Names of the parameters in the functions, with a prefix that avoids keywords of the languages.
fn names<'a>(it: &'a Identified) -> impl Iterator<Item = String> + 'a {
    it.model.parameters().iter().map(|p| format!("p_{}", p.spec.symbol))
}

fn constants(it: &Identified) -> Vec<Constant> {
    let constant = |(j, name): (usize, String)| {
        let unit = if it.units[j].is_empty() { "1" } else { &it.units[j] };
        let parameter = &it.model.parameters()[j];
        let error = match (parameter.fixed, it.std_errors[j]) {
            (Some(_), _) => "fixed".to_owned(),
            (None, error) if error.is_finite() => format!("+- {error:.2e}"),
            (None, _) => "not identifiable from these data".to_owned(),
        };
        let remark = format!("[{unit}] {error}; {}", parameter.spec.meaning);
        Constant { name, value: it.values[j], remark }
    };
    names(it).enumerate().map(constant).collect()
}

/// Header comment of a function.
fn header(it: &Identified, traced: &Traced) -> Vec<String> {
    let mut lines = vec![
        format!("Identified model of the robot \"{}\".", it.model.robot().name),
        format!(
            "Experiment {}, method {}, {} {}.",
            it.experiment,
            it.method,
            env!("CARGO_PKG_NAME"),
            env!("CARGO_PKG_VERSION")
        ),
        String::new(),
        "    A(x) dw + torque(x) + sum_j d_j level_j(x) sgn(d_j . w) = M".into(),
        String::new(),
        "A: symmetric mass matrix (m11, m12, m22); dry friction acts along wheel 1, wheel 2,"
            .into(),
        "turning (1,-1) and forward (1,1). Wheel 1 is the right one; t [s] counts from the start,"
            .into(),
        format!("alpha [rad], w = omega [rad/s], M recorded torques [{}].", it.drive_unit.symbol()),
        "Effects, torques that add up on the left unless they change M:".into(),
    ];
    for effect in it.model.effects() {
        let d = effect.description();
        lines.push(format!("    {}: {}", d.id, d.equation));
    }
    if !it.missing.is_empty() {
        let missing = it.missing.join(", ");
        lines.push(format!("The diagnosis found effects that are not in here: {missing}."));
    }
    if !traced.body.outputs.is_empty() {
        lines.extend(TWO_MASS.iter().map(|line| (*line).to_owned()));
    }
    lines.extend(REST.iter().map(|line| (*line).to_owned()));
    lines
}

/// Description of the state of a two-mass drivetrain.
const TWO_MASS: [&str; 7] = [
    "",
    "Two-mass drivetrain: the state has eight numbers, y = (alpha1, alpha2, omega1, omega2, u1, u2, phi1,",
    "phi2), with the speeds u [rad/s] and twists phi [rad] of the body, body = (u1, u2, phi1, phi2) in the",
    "formulas. terms contains the terms on the wheels, with the rotors as mass and the torque transmitted to the",
    "body; the following function contains the rates of u and phi. A simulation starts with u = w, phi = 0,",
    "and acceleration is evaluated in that state; rates accepts any. Its step is at most half the time",
    "constant of the coupling.",
];

/// Description of the treatment of rest.
const REST: [&str; 13] = [
    "",
    "Rest: a direction whose speed is exactly zero stays at rest while friction within its level",
    "can hold it (determined by sweeps over the directions at rest), otherwise it",
    "breaks away against friction. The integrator is Runge-Kutta 4 at a fixed step of at most",
    "1 ms; signs and stuck directions are constant over a step, a reversal inside it is located by a",
    "secant and set to zero speed there. Accuracy: a breakaway is detected at the next step,",
    "up to 1 ms late, and the error of a reversal is of second order in the step.",
    "",
    "Lag and delay of the input, if any, act in the simulation; an acceleration is evaluated at",
    "one instant, for torques that have been constant.",
    "",
    "Generated from the formulas that the program fits; the equations are in terms and",
    "drive.",
];
