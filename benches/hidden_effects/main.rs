//! Hidden-effect benchmark: the diagnosis of recordings with and without hidden effects.
//!
//! ```text
//! cargo bench --bench hidden_effects -- [--what healthy,single,two,outside] [--robots presets,random:10]
//!     [--simulator own,second] [--logs 100hz | all] [--effects ID,...] [--seeds N] [--from SEED] [--every K]
//!     [--rates 0.01,0.05,0.2] [--jobs N] [--minutes M] [--json OUT] [--case ID,...] [--write DIR [--csv]] [--given]
//! ```
//! Every case is determined by its id, `robot/simulator/log/effect/size/seed`: `--case ID` runs it, `--write DIR`
//! writes its recordings and an experiment file instead. With `--json` every outcome is a line of that file, and cases
//! that it already contains are not run again, so that a long run can be made in slices of `--minutes`. With `--given`
//! the model contains the hidden effects, and the intervals of its parameters are judged in place of the diagnosis. The
//! tables cover all selected cases that have an outcome.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod given;
mod options;
mod tables;

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::Instant;

use hidden_effects::case::Case;
use hidden_effects::judge::{Outcome, estimate, judge};
use hidden_effects::scenario::Scenario;
use options::Options;

/// False-alarm rate of cases with hidden effects: the program's default.
const DEFAULT_RATE: f64 = 0.05;

fn main() -> Result<(), String> {
    let options = Options::read()?;
    if let Some(folder) = &options.write {
        return write(&options.cases, folder, options.csv);
    }
    let done = match &options.json {
        Some(path) => read(path)?,
        None => BTreeMap::new(),
    };
    let outcomes = run(&options, done)?;
    let known = options.cases.into_iter().filter_map(|case| {
        let outcome = outcomes.get(&case.to_string())?.clone();
        Some((case, outcome))
    });
    let known: Vec<(Case, Outcome)> = known.collect();
    match options.given {
        true => given::print(&known),
        false => tables::print(&known, &options.rates),
    }
    Ok(())
}

/// The outcomes that a file holds, by case.
fn read(path: &Path) -> Result<BTreeMap<String, Outcome>, String> {
    let Ok(text) = std::fs::read_to_string(path) else { return Ok(BTreeMap::new()) };
    // an interrupted run may have left a part of a line
    let outcomes = text.lines().filter_map(|line| serde_json::from_str::<Outcome>(line).ok());
    Ok(outcomes.map(|outcome| (outcome.case.clone(), outcome)).collect())
}

/// Runs the cases without an outcome.
fn run(
    options: &Options,
    done: BTreeMap<String, Outcome>,
) -> Result<BTreeMap<String, Outcome>, String> {
    let begin = Instant::now();
    let file = options.json.as_ref().map(|path| {
        let file = std::fs::OpenOptions::new().create(true).append(true).open(path);
        file.map_err(|e| format!("{}: {e}", path.display()))
    });
    let file = Mutex::new(file.transpose()?);
    let wanted: Vec<&Case> =
        options.cases.iter().filter(|case| !done.contains_key(&case.to_string())).collect();
    let (next, fresh) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let one = |case: &Case| {
        let rates = if case.hidden.is_empty() { &options.rates[..] } else { &[DEFAULT_RATE] };
        let outcome = if options.given { estimate(case) } else { judge(case, rates) };
        let line = if options.given { given::line } else { tables::line };
        println!("{}", line(case, &outcome));
        if let (Ok(mut file), Ok(line)) = (file.lock(), serde_json::to_string(&outcome))
            && let Some(file) = file.as_mut()
        {
            let _ = writeln!(file, "{line}");
        }
        fresh.lock().expect("no thread panics while it holds the list").push(outcome);
    };
    // threads of their own: one of rayon that waits for a file begins the next case meanwhile
    std::thread::scope(|scope| {
        for _ in 0..options.jobs.max(1) {
            scope.spawn(|| {
                while begin.elapsed().as_secs_f64() < options.seconds {
                    let Some(case) = wanted.get(next.fetch_add(1, Relaxed)) else { break };
                    one(case);
                }
            });
        }
    });
    let fresh = fresh.into_inner().map_err(|e| e.to_string())?;
    Ok(done.into_iter().chain(fresh.into_iter().map(|o| (o.case.clone(), o))).collect())
}

/// Writes every case into a folder of its own, and its hidden effects into `truth.json`.
fn write(cases: &[Case], folder: &Path, csv: bool) -> Result<(), String> {
    let mut truth = serde_json::Map::new();
    for case in cases {
        let name = case.to_string().replace('/', "_");
        let scenario = Scenario::new(case)?;
        let toml = scenario.write(&folder.join(&name), csv)?;
        println!("{case}\n  experiment {}", toml.display());
        let values =
            |own: &hidden_effects::hidden::Values| -> serde_json::Map<String, serde_json::Value> {
                own.iter().map(|(symbol, value)| ((*symbol).to_string(), (*value).into())).collect()
            };
        let parameters: serde_json::Map<_, _> =
            scenario.effects.iter().map(|(id, own)| (id.clone(), values(own).into())).collect();
        let size = (!case.hidden.is_empty()).then(|| case.size.name());
        let entry = serde_json::json!({
            "case": case.to_string(), "kind": case.kind(), "robot": case.robot, "size": size,
            "hidden": case.hidden, "parameters": parameters, "a": scenario.truth,
        });
        truth.insert(name, entry);
    }
    let text = serde_json::to_string_pretty(&truth).map_err(|e| e.to_string())?;
    let path = folder.join("truth.json");
    std::fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))
}
