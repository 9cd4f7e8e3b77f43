//! The files: `model.json`, and the model as a function where it can be one.

use serde_json::{Value, json};

use super::language::{JAVASCRIPT, LANGUAGES, Language};
use super::print::{Printed, number, print};
use super::traced::{MOMENTS, MOTION, Obstacle, Traced, trace};
use crate::model::Model;
use crate::simulate::Hold;

/// Version of the layout of `model.json`.
pub const SCHEMA: u32 = 1;

/// The equation of every model, in words.
const EQUATION: &str = "mass matrix (m11 m12; m12 m22) times the wheel accelerations + resisting \
                        torques + sum over the directions d = (1,0), (0,1), (1,-1), (1,1) of d \
                        level sgn(d . omega) = acting torques";

/// A model with the values that were identified, and where they come from.
#[derive(Clone, Copy, Debug)]
pub struct Identified<'a> {
    /// The model.
    pub model: &'a Model,
    /// One value a parameter.
    pub values: &'a [f64],
    /// One standard error a parameter; zero where it is fixed.
    pub std_errors: &'a [f64],
    /// One unit a parameter, for the input unit of the recordings.
    pub units: &'a [String],
    /// Unit of the recorded torques.
    pub drive_unit: &'a str,
    /// The input between two samples.
    pub hold: Hold,
    /// Name of the experiment.
    pub experiment: &'a str,
    /// The method that found the values.
    pub method: &'a str,
    /// Effects that the diagnosis found and the model does not have.
    pub missing: &'a [String],
}

/// What is written of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// Files as name and text, `model.json` first.
    pub files: Vec<(String, String)>,
    /// Why there is no function, if so.
    pub obstacles: Vec<Obstacle>,
}

impl Written {
    /// The files in a sentence.
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

/// Obstacles in words.
#[must_use]
pub fn reasons(obstacles: &[Obstacle]) -> String {
    let because = |o: &Obstacle| format!("{}: {}", o.effect, o.reason);
    obstacles.iter().map(because).collect::<Vec<_>>().join("; ")
}

/// Writes `model.json`, and `model.py`, `model.m`, `model.c`, `model.mo`, `model.js` where every effect can be
/// written as a function of the present instant.
///
/// # Panics
/// If values, errors or units do not have one entry a parameter.
#[must_use]
pub fn files(identified: &Identified) -> Written {
    let n = identified.model.parameters().len();
    assert!(identified.values.len() == n && identified.std_errors.len() == n);
    assert_eq!(identified.units.len(), n);
    let traced = traced(identified);
    let function =
        |traced: &Traced, l: &Language| (l.file.to_owned(), write(identified, traced, l));
    let (functions, obstacles) = match &traced {
        Ok(traced) => (LANGUAGES.iter().map(|l| function(traced, l)).collect(), vec![]),
        Err(obstacles) => (vec![], obstacles.clone()),
    };
    let names: Vec<&str> = functions.iter().map(|(name, _): &(String, _)| name.as_str()).collect();
    let data = json(identified, &names, &obstacles);
    let data = serde_json::to_string_pretty(&data).unwrap_or_default() + "\n";
    let mut files = vec![("model.json".to_owned(), data)];
    files.extend(functions);
    Written { files, obstacles }
}

/// The model as a function in JavaScript: the text of `model.js`.
///
/// # Errors
/// Every effect that is no function of the present instant.
pub fn javascript(identified: &Identified) -> Result<String, Vec<Obstacle>> {
    Ok(write(identified, &traced(identified)?, &JAVASCRIPT))
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

/// The frame of a language with its places filled.
fn write(it: &Identified, traced: &Traced, language: &Language) -> String {
    let terms = print_terms(it, traced, language);
    let drive = print_drive(it, traced, language);
    let counts = [terms.temporaries, drive.temporaries].map(|n| n.to_string());
    let time = |parameter: Option<usize>| {
        parameter.and_then(|j| names(it).nth(j)).unwrap_or_else(|| number(0.0))
    };
    // rows that a delay takes in a language that keeps them: at steps of 1 ms
    let delay_rows = traced.delay.map_or(0, |j| (it.values[j] / 1e-3 + 1e-9) as usize) + 2;
    let inline = [
        ("{{linear}}", language.truth[usize::from(it.hold == Hold::Linear)]),
        ("{{terms_temporaries}}", &counts[0]),
        ("{{drive_temporaries}}", &counts[1]),
        ("{{lag}}", &time(traced.lag)),
        ("{{delay}}", &time(traced.delay)),
        ("{{delay_rows}}", &delay_rows.to_string()),
    ];
    let blocks = [
        ("{{header}}", header(it, language)),
        ("{{parameters}}", parameters(it, language)),
        ("{{terms}}", terms.statements),
        ("{{drive}}", drive.statements),
    ];
    let mut out = String::new();
    for line in language.frame.lines() {
        let place = line.trim_start();
        let indent = &line[..line.len() - place.len()];
        match blocks.iter().find(|(mark, _)| *mark == place) {
            Some((_, lines)) => lines.iter().for_each(|l| out += &format!("{indent}{l}\n")),
            None => {
                let fill = |text: String, (mark, value): &(&str, &str)| text.replace(mark, value);
                out += &inline.iter().fold(line.to_owned(), fill);
                out.push('\n');
            }
        }
    }
    out
}

fn print_terms(it: &Identified, traced: &Traced, language: &Language) -> Printed {
    let place = language.syntax.place;
    let motion = ["alpha", "omega"].into_iter().flat_map(|a| [place(a, 0), place(a, 1)]);
    let inputs: Vec<String> =
        std::iter::once("t".to_owned()).chain(motion).chain(names(it)).collect();
    debug_assert_eq!(inputs.len(), MOTION + it.values.len());
    let targets: Vec<String> = [("mass", 3), ("torque", 2), ("level", 4)]
        .into_iter()
        .flat_map(|(array, size)| (0..size).map(move |k| place(array, k)))
        .collect();
    print(&traced.terms, &inputs, &targets, &language.syntax)
}

fn print_drive(it: &Identified, traced: &Traced, language: &Language) -> Printed {
    let place = language.syntax.place;
    let now = [place("M", 0), place("M", 1)];
    let unused = [String::new(), String::new()]; // the sample before: no formula depends on it
    let inputs: Vec<String> = unused.into_iter().chain(now).chain(names(it)).collect();
    debug_assert_eq!(inputs.len(), MOMENTS + it.values.len());
    let targets = [place("acting", 0), place("acting", 1)];
    print(&traced.drive, &inputs, &targets, &language.syntax)
}

/// Names of the parameters in the functions: a prefix keeps them off the words of any language.
fn names<'a>(it: &'a Identified) -> impl Iterator<Item = String> + 'a {
    it.model.parameters().iter().map(|p| format!("p_{}", p.spec.symbol))
}

fn parameters(it: &Identified, language: &Language) -> Vec<String> {
    let lines = names(it).enumerate().map(|(j, name)| {
        let unit = if it.units[j].is_empty() { "1" } else { &it.units[j] };
        let parameter = &it.model.parameters()[j];
        let error = match (parameter.fixed, it.std_errors[j]) {
            (Some(_), _) => "fixed".to_owned(),
            (None, error) if error.is_finite() => format!("+- {error:.2e}"),
            (None, _) => "this data cannot give it".to_owned(),
        };
        let remark = one_line(&format!("[{unit}] {error}; {}", parameter.spec.meaning));
        (language.constant)(&name, &number(it.values[j]), &remark)
    });
    lines.collect()
}

/// What a reader of a function must know, as comments.
fn header(it: &Identified, language: &Language) -> Vec<String> {
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
        format!("alpha [rad], w = omega [rad/s], M recorded torques [{}].", it.drive_unit),
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
    lines.extend(REST.iter().map(|line| (*line).to_owned()));
    lines
        .iter()
        .map(|line| format!("{} {}", language.comment, one_line(line)).trim_end().to_owned())
        .collect()
}

/// How rest is handled, in words.
const REST: [&str; 13] = [
    "",
    "Rest: a direction whose speed is exactly zero stays at rest while friction within its level",
    "can hold it (which ones do is found by sweeps over the directions at rest), else it",
    "breaks away against friction. The integrator is Runge-Kutta 4 at a fixed step of at most",
    "1 ms; signs and stuck directions are held over a step, a reversal inside it is placed by a",
    "secant and set to zero speed there. What that costs: a breakaway is noticed at the next step,",
    "up to 1 ms late, and a reversal is off by the square of the step.",
    "",
    "Lag and delay of the input, where there are any, act in the simulation; an acceleration is asked for at",
    "one instant and takes its torques as held for long.",
    "",
    "Written by the program from the same formulas that it fits; the equations stand in terms and",
    "drive.",
];

/// Text that stays within a comment of one line, in C too, where a backslash would go on.
fn one_line(text: &str) -> String {
    text.replace(['\n', '\r', '\\'], " ")
}
