//! The command line of the benchmark.

use std::path::PathBuf;
use std::str::FromStr;

use hidden_effects::case::{Case, SIZES, Simulator, Size};
use hidden_effects::hidden::{EFFECTS, OUTSIDE};
use hidden_effects::logger::{LOGS, Log};
use hidden_effects::robots::Machine;

/// Options of the command line.
pub(crate) struct Options {
    /// Cases to run, in order.
    pub(crate) cases: Vec<Case>,
    /// False-alarm rates of cases without hidden effects.
    pub(crate) rates: Vec<f64>,
    /// Whether the model is given the hidden effects, and its parameters are estimated.
    pub(crate) given: bool,
    /// Number of cases at a time.
    pub(crate) jobs: usize,
    /// File of all outcomes, one per line; cases in it are not run again.
    pub(crate) json: Option<PathBuf>,
    /// Folder to which recordings and experiment files are written, in place of a run.
    pub(crate) write: Option<PathBuf>,
    /// Whether the recordings are written as CSV.
    pub(crate) csv: bool,
    /// Number of seconds after which no case is started.
    pub(crate) seconds: f64,
}

fn argument(name: &str) -> Option<String> {
    let mut arguments = std::env::args();
    arguments.by_ref().find(|a| a == name)?;
    arguments.next()
}

fn number<T: FromStr>(name: &str, default: T) -> Result<T, String> {
    let Some(text) = argument(name) else { return Ok(default) };
    text.parse().map_err(|_| format!("{name} {text}: expected a number"))
}

fn list(name: &str, default: &str) -> Vec<String> {
    let text = argument(name).unwrap_or(default.into());
    text.split(',').filter(|s| !s.is_empty()).map(str::to_string).collect()
}

impl Options {
    /// Reads the arguments of the process.
    pub(crate) fn read() -> Result<Self, String> {
        let cases = match argument("--case") {
            Some(ids) => ids.split(',').map(str::parse).collect::<Result<_, _>>()?,
            None => cases()?,
        };
        let rates = list("--rates", "0.01,0.05,0.2");
        let rates = rates.iter().map(|s| s.parse().map_err(|_| format!("--rates {s}")));
        Ok(Self {
            cases,
            rates: rates.collect::<Result<_, _>>()?,
            given: std::env::args().any(|a| a == "--given"),
            jobs: number("--jobs", 1)?,
            json: argument("--json").map(PathBuf::from),
            write: argument("--write").map(PathBuf::from),
            csv: std::env::args().any(|a| a == "--csv"),
            seconds: 60.0 * number("--minutes", f64::INFINITY)?,
        })
    }
}

/// The robots of `--robots`: names of presets, `random_K`, `presets`, and `random:N` for the first N.
fn robots() -> Result<Vec<String>, String> {
    let mut out = Vec::new();
    for name in list("--robots", "presets,random:10") {
        match (name.as_str(), name.strip_prefix("random:")) {
            ("presets", _) => out.extend(Machine::presets()),
            (_, Some(count)) => {
                let count: u64 = count.parse().map_err(|_| format!("--robots {name}"))?;
                out.extend((0..count).map(|k| format!("random_{k}")));
            }
            _ if Machine::of(&name).is_some() => out.push(name),
            _ => return Err(format!("--robots: no robot is called {name}")),
        }
    }
    Ok(out)
}

/// The selected cases, seed by seed, so that a part of them covers all robots.
fn cases() -> Result<Vec<Case>, String> {
    let robots = robots()?;
    let simulators: Vec<Simulator> = list("--simulator", "own,second")
        .iter()
        .map(|name| match name.as_str() {
            "own" => Ok(Simulator::Own),
            "second" => Ok(Simulator::Second),
            other => Err(format!("--simulator {other}: expected own or second")),
        })
        .collect::<Result<_, _>>()?;
    let logs: Vec<Log> = match argument("--logs").as_deref() {
        Some("all") => LOGS.to_vec(),
        _ => list("--logs", "100hz")
            .iter()
            .map(|name| Log::of(name).ok_or(format!("--logs: no log is called {name}")))
            .collect::<Result<_, _>>()?,
    };
    let (seeds, from): (u64, u64) = (number("--seeds", 1)?, number("--from", 0)?);
    let every: usize = number("--every", 1)?;
    let mut out = Vec::new();
    for seed in from..from + seeds {
        for hidden in hidden(seed)? {
            for robot in &robots {
                for &simulator in &simulators {
                    for &log in &logs {
                        let (hidden, size) = hidden.clone();
                        out.push(Case { robot: robot.clone(), simulator, log, hidden, size, seed });
                    }
                }
            }
        }
    }
    Ok(out.into_iter().step_by(every.max(1)).collect())
}

/// Hidden effects in the cases of a seed, by `--what`.
fn hidden(seed: u64) -> Result<Vec<(Vec<String>, Size)>, String> {
    let mut out = Vec::new();
    let effects = list("--effects", &EFFECTS.join(","));
    for what in list("--what", "healthy") {
        match what.as_str() {
            "healthy" => out.push((vec![], Size::Moderate)),
            "single" => {
                for effect in &effects {
                    out.extend(SIZES.map(|size| (vec![effect.clone()], size)));
                }
            }
            // a walk through the pairs that another seed continues
            "two" => {
                for k in 0..effects.len() {
                    let other = (k + 1 + seed as usize % (EFFECTS.len() - 1)) % EFFECTS.len();
                    let pair = vec![effects[k].clone(), EFFECTS[other].to_string()];
                    if pair[0] != pair[1] {
                        out.push((pair, Size::Moderate));
                    }
                }
            }
            "outside" => {
                out.extend(OUTSIDE.map(|kind| (vec![kind.to_string()], Size::Moderate)));
            }
            other => {
                return Err(format!("--what {other}: expected healthy, single, two or outside"));
            }
        }
    }
    Ok(out)
}
