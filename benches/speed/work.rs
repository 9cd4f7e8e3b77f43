//! The recordings and models that are measured, and one unit of each kind of work.

use std::sync::LazyLock;

use amigo_ident::diagnose::{Data, Settings, diagnose};
use amigo_ident::filter::{Likelihood, ProcessNoise, prepare};
use amigo_ident::identify::{self, Identifier, Task, start};
use amigo_ident::model::Model;
use amigo_ident::recording::{LongRecording, Recording};
use amigo_ident::robot::{Robot, State};
use amigo_ident::simulate::{
    Hold, Input, Movement, NoiseLevel, Recorder, ise_of_many, record, simulate,
    simulate_with_sensitivities,
};

/// Effects in the order in which the benchmark adds them to the base model.
pub(crate) const ADDED: [&str; 8] = [
    "viscous_friction",
    "torque_offset",
    "turning_scrub",
    "quadratic_drag",
    "yaw_viscous",
    "caster_drag",
    "lateral_com",
    "stribeck",
];
/// Number of parameter vectors that are simulated together.
pub(crate) const MANY: usize = 64;
/// Noise of the filter passes, as a fit estimates it on such recordings.
pub(crate) const NOISE: ProcessNoise =
    ProcessNoise { sigma_m: 0.005, sigma_d: 0.002, tau_d: 0.2, later: 0.5 };

/// A recording at 200 Hz of the robot, or of one with `hidden` effects, under a 1 kHz controller.
pub(crate) fn made(hidden: &[&str], seconds: f64, seed: u64) -> Recording {
    let truth = Model::with_effects(Robot::amigobot(), hidden).expect("registered effects");
    let movement = Movement::rich(truth.robot(), seed, seconds, 12.0);
    let noise = NoiseLevel { alpha: 1e-3, dalpha: 0.05, torque: 0.005 };
    let recorder = Recorder { rate: 200.0, control_rate: 1000.0, noise, ticks: None, seed };
    record("made", &truth, &truth.initial(), &movement, &recorder).expect("the truth can move")
}

pub(crate) static BASE: LazyLock<Model> = LazyLock::new(|| Model::base(Robot::amigobot()));
/// 25 s at 200 Hz.
pub(crate) static RUN: LazyLock<Recording> = LazyLock::new(|| made(&[], 25.0, 1));

/// 25 s at 100 Hz with exact torques: the data of output error.
pub(crate) static EXACT: LazyLock<Recording> = LazyLock::new(|| {
    let movement = Movement::rich(BASE.robot(), 1, 25.0, 12.0);
    let noise = NoiseLevel { alpha: 1e-3, dalpha: 0.02, torque: 0.0 };
    let recorder = Recorder { rate: 100.0, control_rate: 100.0, noise, ticks: None, seed: 1 };
    record("exact", &BASE, &BASE.initial(), &movement, &recorder).expect("the truth can move")
});

pub(crate) fn with_effects(count: usize) -> Model {
    Model::with_effects(Robot::amigobot(), &ADDED[..count]).expect("registered effects")
}

pub(crate) fn input(recording: &Recording) -> Input<'_> {
    Input { t: recording.t(), torque: recording.torque(), hold: Hold::Linear }
}

pub(crate) fn likelihood(recordings: &[Recording]) -> Likelihood<'_> {
    let prepared = recordings.iter().map(prepare).collect();
    Likelihood { prepared, hold: Hold::Linear, slow_moment: true, timing: false, step_scatter: 1.0 }
}

pub(crate) fn method(name: &str) -> Box<dyn Identifier> {
    identify::find(name).expect("registered method")
}

pub(crate) fn fit(name: &str, train: &[Recording]) -> f64 {
    let task = Task { model: &BASE, train, hold: Hold::Linear, seed: 1 };
    method(name).identify(&task).expect("a fit").estimates.len() as f64
}

pub(crate) fn methods() -> Vec<String> {
    identify::all().iter().map(|method| method.describe().name).collect()
}

/// 64 vectors scattered around the construction values.
pub(crate) fn scattered() -> Vec<Vec<f64>> {
    let p = BASE.initial();
    let factor = |n: usize, j: usize| 1.0 + 0.2 * ((n * 7 + j * 3) as f64).sin();
    (0..MANY).map(|n| p.iter().enumerate().map(|(j, a)| a * factor(n, j)).collect()).collect()
}

pub(crate) fn run_scalar(model: &Model, recording: &Recording) -> usize {
    let p = model.initial();
    simulate(model, &p, &input(recording), State::default()).expect("it moves").len()
}

pub(crate) fn run_sensitive(model: &Model, recording: &Recording) -> usize {
    let p = model.initial();
    let run = simulate_with_sensitivities(model, &p, &input(recording), State::default());
    run.expect("it moves").0.len()
}

pub(crate) fn run_many(recording: &Recording, vectors: &[Vec<f64>]) -> f64 {
    let start = State::default();
    let found = ise_of_many(&BASE, vectors, &input(recording), start, recording.omega());
    found.into_iter().map(|ise| ise.expect("it moves")).sum()
}

pub(crate) fn run_pass(model: &Model, likelihood: &Likelihood, derivatives: bool) -> f64 {
    let passes = likelihood.passes(model, &model.initial(), &NOISE, derivatives, &[]);
    passes.expect("a likelihood").iter().map(|pass| pass.log_likelihood).sum()
}

/// Three recordings of 60 s.
pub(crate) fn three(hidden: &[&str]) -> Vec<Recording> {
    (3..6).map(|seed| made(hidden, 60.0, seed)).collect()
}

/// Effects that a diagnosis of the base model finds.
pub(crate) fn found(recordings: &[Recording]) -> Vec<String> {
    let task = Task { model: &BASE, train: recordings, hold: Hold::Linear, seed: 1 };
    let first = start::start(&task, "benchmark").expect("moving recordings");
    let data = Data { train: recordings, validation: &[], hold: Hold::Linear, corrected_s: 0.0 };
    let diagnosis = diagnose(&BASE, &[first], &data, &Settings::default());
    diagnosis.expect("a fit").found()
}

/// The computation for a recording that is too long to be held.
pub(crate) fn fit_in_blocks(train: &[Recording]) -> f64 {
    let (samples, duration) = (train[0].len(), train[0].duration());
    let rows = Box::new(train[0].clone());
    let long = LongRecording { rows, samples, duration, windows: 1 };
    let task = Task { model: &BASE, train, hold: Hold::Linear, seed: 1 };
    let fit = method("torque_regression").identify_long(&task, &[Some(&long)]);
    fit.expect("it reads blocks").expect("a fit").estimates.len() as f64
}
