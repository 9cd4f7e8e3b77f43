//! Accuracy of the estimators on healthy robots of every size: coverage of their 95 % intervals and
//! their 2 s simulation error beside that of the true parameters.
//!
//! ```text
//! cargo bench --bench estimators -- presets [SETS] [METHOD] [OPTIONS]   own simulator, every preset
//! cargo bench --bench estimators -- worlds FOLDER [METHOD] [OPTIONS]    healthy cases of a folder as
//!                                                     described in ../shared/worlds/README.md
//! ```
//! `--json FILE` after either writes the row of all robots to a file, with which the pages are compared.
//! Everything is seeded; results do not depend on the number of threads.
#![allow(clippy::print_stdout)]

mod cases;
mod table;

use std::path::Path;
use std::time::Instant;

use amigo_ident::compare::{simulate_recording, window_rms};
use amigo_ident::identify::{self, Identifier, Task};
use amigo_ident::model::Model;
use amigo_ident::recording::Recording;
use amigo_ident::simulate::{Hold, PhysicalDynamics};
use rayon::prelude::*;

use cases::Case;
use table::{Figures, Row, print};

/// Default number of sets per preset.
const SETS: u64 = 40;

fn main() {
    let mut arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let json = arguments.iter().position(|a| a == "--json");
    let json = json.and_then(|at| arguments.drain(at..).nth(1));
    let word = |n: usize| arguments.get(n).map(String::as_str);
    let (name, options) = (word(2).unwrap_or("prediction_error"), word(3).unwrap_or(""));
    let options = toml::from_str(options).expect("options as in an experiment file");
    let method = identify::find(name).expect("a registered method");
    let method = method.configure(&options).expect("options of the method");
    let cases = match word(0) {
        Some("worlds") => cases::of_folder(Path::new(word(1).unwrap_or("../shared/worlds/robots"))),
        Some("presets") | None => {
            cases::of_presets(word(1).and_then(|n| n.parse().ok()).unwrap_or(SETS))
        }
        Some(other) => panic!("`{other}` is neither presets nor worlds"),
    };
    let rows: Vec<Row> = cases.par_iter().map(|case| judge(case, &*method)).collect();
    print(name, &rows);
    if let Some(file) = json {
        let text = format!("{:#}\n", Figures::of(&rows.iter().collect::<Vec<_>>()).json(name));
        std::fs::write(&file, text).expect("the file can be written");
    }
}

/// Fits a case and compares it with the true parameters.
fn judge(case: &Case, method: &dyn Identifier) -> Row {
    let task = Task { model: &case.model, train: &case.train, hold: Hold::Linear, seed: 1 };
    let start = Instant::now();
    let fit = method.identify(&task);
    let seconds = start.elapsed().as_secs_f64();
    let floor = error_of(&case.model, &case.truth, &case.held_out);
    let Ok(fit) = fit else { return Row::failed(case, seconds) };
    let p: Vec<f64> = fit.estimates.iter().map(|e| e.value).collect();
    let ratio = error_of(&case.model, &p, &case.held_out) / floor;
    let estimates = fit.estimates.iter().zip(&case.truth).collect::<Vec<_>>();
    Row::new(case, &estimates, ratio, seconds, &fit)
}

/// Root mean square of the 2 s simulation error of the speeds [rad/s].
fn error_of(model: &Model, p: &[f64], recording: &Recording) -> f64 {
    let dynamics = PhysicalDynamics { model: model.clone(), p: p.to_vec() };
    simulate_recording(&dynamics, recording, Hold::Linear)
        .map_or(f64::INFINITY, |simulated| window_rms(recording, &simulated.windows))
}
