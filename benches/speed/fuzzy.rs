//! The fuzzy emulators: a simulation, and every method over the paper's range and the range of the data.

use std::sync::LazyLock;

use amigo_ident::identify::Task;
use amigo_ident::identify::fuzzy::{Normal, Problem, Settings};
use amigo_ident::recording::Recording;
use amigo_ident::simulate::{Hold, Movement, NoiseLevel, Recorder, record};
use nalgebra::DVector;

use crate::time::{best, row};
use crate::work::{BASE, MANY, method};

/// Samples of the paper's movement at 100 Hz, at rest before and after: 25 s, as long as the other recordings.
static PAPER: LazyLock<Recording> = LazyLock::new(|| {
    let mut movement = Movement::paper();
    if let Some(last) = movement.segments.last_mut() {
        last.hold_s += 3.0;
    }
    let noise = NoiseLevel { alpha: 1e-3, dalpha: 0.05, torque: 0.005 };
    let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed: 1 };
    record("paper", &BASE, &BASE.initial(), &movement, &recorder).expect("the truth can move")
});

const METHODS: [&str; 7] = [
    "least_squares",
    "levenberg_marquardt",
    "gradient",
    "line_search",
    "nelder_mead",
    "genetic",
    "anfis",
];

fn task() -> Task<'static> {
    Task { model: &BASE, train: std::slice::from_ref(&*PAPER), hold: Hold::Linear, seed: 1 }
}

fn problem() -> (Problem, DVector<f64>) {
    Settings::default().problem(&task(), "benchmark").expect("a robot that moves")
}

fn normal(problem: &Problem, theta: &[f64]) -> Normal {
    problem.normal(theta, false).expect("it stays within bounds")
}

/// Rows of the table.
pub(super) fn ratios(kernel: f64) {
    let (problem, level) = problem();
    let theta = problem.closed_form(&level, 1e-5, "benchmark").expect("a start");
    let steps = (PAPER.len() - 1) as f64;
    let cost = best(|| problem.cost(theta.as_slice())) / steps;
    row("a step of the fuzzy emulator, 36 rules", "Runge-Kutta kernel", cost, kernel);
    let many = vec![theta.as_slice().to_vec(); MANY];
    let side_by_side = best(|| problem.costs(&many)) / (steps * MANY as f64);
    row("the same, many vectors of consequents, per vector", "one", side_by_side, cost);
    let derivatives = best(|| normal(&problem, theta.as_slice())) / steps;
    row(
        "a step with derivatives by 72 consequents and their normal matrix",
        "without",
        derivatives,
        cost,
    );
    for name in METHODS {
        for (range, words) in [("paper", "0 to 30 rad/s"), ("data", "the range of the data")] {
            let options = format!("range = \"{range}\"").parse().expect("TOML");
            let method = method(&format!("fuzzy_{name}")).configure(&options).expect("an option");
            let ise = method.identify(&task()).expect("a fit").traces[0]
                .values
                .last()
                .map_or(0.0, |v| v[0]);
            let time = best(|| method.identify(&task()).expect("a fit"));
            let what = format!("`fuzzy_{name}` over {words}, ISE {ise:.4}");
            row(&what, "a simulation of the emulator", time, cost * steps);
        }
    }
}
