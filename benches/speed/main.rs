//! Speed, as ratios measured in one run on one thread.
//!
//! ```text
//! cargo bench --bench speed               divan's figures, then the table of ratios
//! cargo bench --bench speed -- ratios     the table alone
//! cargo bench --bench speed -- emulators  the rows of the fuzzy methods alone
//! cargo bench --bench speed -- filter     the rows of the filter and of the default fit alone
//! cargo bench --bench speed -- simulation divan's figures of one group alone
//! ```
//! Ratios vary less between machines than times.
#![allow(clippy::print_stdout)]

mod fuzzy;
mod kernels;

use std::hint::black_box;
use std::sync::LazyLock;
use std::time::Instant;

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
use kernels::{kernel, kernel_of_eight, kernel_of_fourth_order, output_error_by_differences};

/// Counts the allocations of the benchmarks.
#[global_allocator]
static ALLOCATOR: divan::AllocProfiler = divan::AllocProfiler::system();

/// Effects in the order in which the benchmark adds them to the base model.
const ADDED: [&str; 8] = [
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
const MANY: usize = 64;
/// Noise of the filter passes, as a fit estimates it on such recordings.
const NOISE: ProcessNoise = ProcessNoise { sigma_m: 0.005, sigma_d: 0.002, tau_d: 0.2, later: 0.5 };

/// A recording at 200 Hz of the robot, or of one with `hidden` effects, under a 1 kHz controller.
fn made(hidden: &[&str], seconds: f64, seed: u64) -> Recording {
    let truth = Model::with_effects(Robot::amigobot(), hidden).expect("registered effects");
    let movement = Movement::rich(truth.robot(), seed, seconds, 12.0);
    let noise = NoiseLevel { alpha: 1e-3, dalpha: 0.05, torque: 0.005 };
    let recorder = Recorder { rate: 200.0, control_rate: 1000.0, noise, ticks: None, seed };
    record("made", &truth, &truth.initial(), &movement, &recorder).expect("the truth can move")
}

static BASE: LazyLock<Model> = LazyLock::new(|| Model::base(Robot::amigobot()));
/// 25 s at 200 Hz.
static RUN: LazyLock<Recording> = LazyLock::new(|| made(&[], 25.0, 1));

/// 25 s at 100 Hz with exact torques: the data of output error.
static EXACT: LazyLock<Recording> = LazyLock::new(|| {
    let movement = Movement::rich(BASE.robot(), 1, 25.0, 12.0);
    let noise = NoiseLevel { alpha: 1e-3, dalpha: 0.02, torque: 0.0 };
    let recorder = Recorder { rate: 100.0, control_rate: 100.0, noise, ticks: None, seed: 1 };
    record("exact", &BASE, &BASE.initial(), &movement, &recorder).expect("the truth can move")
});

fn with_effects(count: usize) -> Model {
    Model::with_effects(Robot::amigobot(), &ADDED[..count]).expect("registered effects")
}

fn input(recording: &Recording) -> Input<'_> {
    Input { t: recording.t(), torque: recording.torque(), hold: Hold::Linear }
}

fn likelihood(recordings: &[Recording]) -> Likelihood<'_> {
    let prepared = recordings.iter().map(prepare).collect();
    Likelihood { prepared, hold: Hold::Linear, slow_moment: true, timing: false }
}

fn method(name: &str) -> Box<dyn Identifier> {
    identify::find(name).expect("registered method")
}

fn fit(name: &str, train: &[Recording]) -> f64 {
    let task = Task { model: &BASE, train, hold: Hold::Linear, seed: 1 };
    method(name).identify(&task).expect("a fit").estimates.len() as f64
}

fn methods() -> Vec<String> {
    identify::all().iter().map(|method| method.describe().name).collect()
}

/// 64 vectors scattered around the construction values.
fn scattered() -> Vec<Vec<f64>> {
    let p = BASE.initial();
    let factor = |n: usize, j: usize| 1.0 + 0.2 * ((n * 7 + j * 3) as f64).sin();
    (0..MANY).map(|n| p.iter().enumerate().map(|(j, a)| a * factor(n, j)).collect()).collect()
}

fn run_scalar(model: &Model, recording: &Recording) -> usize {
    let p = model.initial();
    simulate(model, &p, &input(recording), State::default()).expect("it moves").len()
}

fn run_sensitive(model: &Model, recording: &Recording) -> usize {
    let p = model.initial();
    let run = simulate_with_sensitivities(model, &p, &input(recording), State::default());
    run.expect("it moves").0.len()
}

fn run_many(recording: &Recording, vectors: &[Vec<f64>]) -> f64 {
    let start = State::default();
    let found = ise_of_many(&BASE, vectors, &input(recording), start, recording.omega());
    found.into_iter().map(|ise| ise.expect("it moves")).sum()
}

fn run_pass(model: &Model, likelihood: &Likelihood, derivatives: bool) -> f64 {
    let passes = likelihood.passes(model, &model.initial(), &NOISE, derivatives, &[]);
    passes.expect("a likelihood").iter().map(|pass| pass.log_likelihood).sum()
}

mod simulation {
    use super::*;
    use divan::{Bencher, counter::ItemsCount};

    fn steps(bencher: Bencher, each: usize, run: impl Fn() -> f64 + Sync) {
        let steps = ItemsCount::new(each * (RUN.len() - 1));
        bencher.counter(steps).bench(run);
    }

    #[divan::bench]
    fn a_kernel_semi_implicit(bencher: Bencher) {
        let p = BASE.initial();
        steps(bencher, 1, || kernel(black_box(&p), &RUN));
    }
    #[divan::bench]
    fn b_kernel_runge_kutta(bencher: Bencher) {
        let p = BASE.initial();
        steps(bencher, 1, || kernel_of_fourth_order(black_box(&p), &RUN));
    }
    #[divan::bench]
    fn c_simulate(bencher: Bencher) {
        steps(bencher, 1, || run_scalar(&BASE, &RUN) as f64);
    }
    #[divan::bench]
    fn d_ise_of_64(bencher: Bencher) {
        let vectors = scattered();
        steps(bencher, MANY, || run_many(&RUN, black_box(&vectors)));
    }
    #[divan::bench]
    fn e_with_sensitivities(bencher: Bencher) {
        steps(bencher, 1, || run_sensitive(&BASE, &RUN) as f64);
    }
}

/// One fit of one recording of 25 s at 200 Hz.
#[divan::bench(args = methods(), sample_size = 1, max_time = 2)]
fn fits(bencher: divan::Bencher, name: &str) {
    let train = std::slice::from_ref(&*RUN);
    bencher.bench(|| fit(name, train));
}

mod length {
    use super::*;

    const SAMPLES: [usize; 3] = [1_000, 10_000, 100_000];

    #[divan::bench(args = SAMPLES, sample_size = 1, max_time = 2)]
    fn pass_with_derivatives(bencher: divan::Bencher, samples: usize) {
        let recordings = [made(&[], samples as f64 / 200.0, 2)];
        let likelihood = likelihood(&recordings);
        bencher.bench(|| run_pass(&BASE, &likelihood, true));
    }

    /// The column "max alloc" is the memory used in addition to the recording.
    #[divan::bench(args = [1_000, 10_000, 100_000, 1_000_000], sample_size = 1, max_time = 2)]
    fn torque_regression(bencher: divan::Bencher, samples: usize) {
        let recordings = [made(&[], samples as f64 / 200.0, 2)];
        bencher.bench(|| fit("torque_regression", &recordings));
    }
}

mod effects {
    use super::*;

    #[divan::bench(args = [0, 2, 4, 8])]
    fn simulation(bencher: divan::Bencher, count: usize) {
        let model = with_effects(count);
        bencher.bench(|| run_scalar(&model, &RUN));
    }
    #[divan::bench(args = [0, 2, 4, 8])]
    fn sensitivities(bencher: divan::Bencher, count: usize) {
        let model = with_effects(count);
        bencher.bench(|| run_sensitive(&model, &RUN));
    }
    #[divan::bench(args = [0, 2, 4, 8])]
    fn pass_with_derivatives(bencher: divan::Bencher, count: usize) {
        let model = with_effects(count);
        let likelihood = likelihood(std::slice::from_ref(&*RUN));
        bencher.bench(|| run_pass(&model, &likelihood, true));
    }
}

/// Three recordings of 60 s at 200 Hz, and the whole catalogue.
mod diagnosis {
    use super::*;

    #[divan::bench(sample_count = 1, sample_size = 1)]
    fn of_hidden_scrub(bencher: divan::Bencher) {
        let recordings = three(&["turning_scrub"]);
        bencher.bench(|| found(&recordings));
    }
}

/// Three recordings of 60 s.
fn three(hidden: &[&str]) -> Vec<Recording> {
    (3..6).map(|seed| made(hidden, 60.0, seed)).collect()
}

/// Effects that a diagnosis of the base model finds.
fn found(recordings: &[Recording]) -> Vec<String> {
    let task = Task { model: &BASE, train: recordings, hold: Hold::Linear, seed: 1 };
    let first = start::start(&task, "benchmark").expect("moving recordings");
    let data = Data { train: recordings, validation: &[], hold: Hold::Linear, corrected_s: 0.0 };
    let diagnosis = diagnose(&BASE, &[first], &data, &Settings::default());
    diagnosis.expect("a fit").found()
}

/// Time of one run [s]: the shortest of those within 0.4 s, or the mean processor time over them
/// where that is less (other processes lengthen every run of some milliseconds).
fn best<T>(mut work: impl FnMut() -> T) -> f64 {
    let (mut shortest, mut total, mut runs) = (f64::INFINITY, 0.0, 0.0);
    let used = processor_time();
    while total < 0.4 {
        let begin = Instant::now();
        black_box(work());
        let wall = begin.elapsed().as_secs_f64();
        (shortest, total, runs) = (shortest.min(wall), total + wall, runs + 1.0);
    }
    let used = processor_time().zip(used).map(|(after, before)| (after - before) / runs);
    used.map_or(shortest, |used| shortest.min(used))
}

/// Time that this thread has run on a processor [s], where the system reports it (Linux).
fn processor_time() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse::<f64>().ok().map(|nanoseconds| 1e-9 * nanoseconds)
}

fn row(what: &str, over: &str, time: f64, unit: f64) {
    let ratio = time / unit;
    let digits = if ratio < 9.95 { 2 } else { 0 };
    let (scaled, name) = match time {
        t if t < 1e-6 => (t * 1e9, "ns"),
        t if t < 1e-3 => (t * 1e6, "us"),
        t if t < 1.0 => (t * 1e3, "ms"),
        t => (t, "s"),
    };
    println!("| {what} | {over} | {ratio:.digits$} | {scaled:.3} {name} |");
}

fn ratios() {
    println!("\n## Ratios, one thread\n");
    println!("| what | over | ratio | time |\n|---|---|---:|---:|");
    let steps = (RUN.len() - 1) as f64;
    let (p, vectors) = (BASE.initial(), scattered());
    let straight = best(|| kernel(black_box(&p), &RUN)) / steps;
    let fourth = best(|| kernel_of_fourth_order(black_box(&p), &RUN)) / steps;
    let scalar = best(|| run_scalar(&BASE, &RUN)) / steps;
    let many = best(|| run_many(&RUN, &vectors)) / (steps * MANY as f64);
    let sensitive = best(|| run_sensitive(&BASE, &RUN)) / steps;
    row("a step of a hand-written semi-implicit kernel", "itself", straight, straight);
    row("a step of a hand-written Runge-Kutta kernel", "semi-implicit kernel", fourth, straight);
    row("a step of `simulate`", "semi-implicit kernel", scalar, straight);
    row("a step of `simulate`", "Runge-Kutta kernel", scalar, fourth);
    row("a step of `ise_of_many`, per vector", "`simulate`", many, scalar);
    row("a step of `ise_of_many`, per vector", "Runge-Kutta kernel", many, fourth);
    row("a step with sensitivities", "`simulate`", sensitive, scalar);
    let one = std::slice::from_ref(&*RUN);
    let filter = likelihood(one);
    let plain = best(|| run_pass(&BASE, &filter, false)) / steps;
    let full = best(|| run_pass(&BASE, &filter, true)) / steps;
    row("a step of the filter", "`simulate`", plain, scalar);
    row("a step of the filter with derivatives", "`simulate`", full, scalar);
    let simulation = scalar * steps;
    let default = best(|| fit("prediction_error", one));
    for name in methods() {
        let time = best(|| fit(&name, one));
        row(&format!("fit by `{name}`"), "`simulate` of the same 25 s", time, simulation);
    }
    for count in [2, 4, 8] {
        let model = with_effects(count);
        let over = "the base model";
        let time = best(|| run_scalar(&model, &RUN));
        row(&format!("`simulate` with {count} effects more"), over, time, simulation);
        let time = best(|| run_sensitive(&model, &RUN)) / steps;
        row(&format!("sensitivities with {count} effects more"), over, time, sensitive);
        let time = best(|| run_pass(&model, &filter, true)) / steps;
        row(&format!("filter with derivatives, {count} effects more"), over, time, full);
    }
    of_peers();
    fuzzy::ratios(fourth);
    of_length();
    of_diagnosis(default);
}

/// The rows of the diagnosis and of the default fit alone.
fn of_diagnosis_alone() {
    println!("| what | over | ratio | time |\n|---|---|---:|---:|");
    let fit_of_one = best(|| fit("prediction_error", std::slice::from_ref(&*RUN)));
    row("fit by `prediction_error`, 25 s", "itself", fit_of_one, fit_of_one);
    of_diagnosis(fit_of_one);
}

/// A step of the filter, with and without derivatives, over the Runge-Kutta kernel, and the default fit.
fn of_filter() {
    println!("| what | over | ratio | time |\n|---|---|---:|---:|");
    let steps = (RUN.len() - 1) as f64;
    let p = BASE.initial();
    let kernel = best(|| kernel_of_fourth_order(black_box(&p), &RUN)) / steps;
    let filter = likelihood(std::slice::from_ref(&*RUN));
    let over = "Runge-Kutta kernel";
    row("a step of the filter", over, best(|| run_pass(&BASE, &filter, false)) / steps, kernel);
    for (what, model) in [
        ("a step of the filter with derivatives", with_effects(0)),
        ("a step with derivatives, 8 effects more", with_effects(8)),
        ("a step with derivatives, wheel slip", BASE.add("wheel_slip").expect("an effect")),
    ] {
        row(what, over, best(|| run_pass(&model, &filter, true)) / steps, kernel);
    }
    let fit_of_one = best(|| fit("prediction_error", std::slice::from_ref(&*RUN)));
    row("fit by `prediction_error`, 25 s", over, fit_of_one, kernel * steps);
}

/// The rows of the fuzzy methods alone.
fn fuzzy_ratios() {
    println!("| what | over | ratio | time |\n|---|---|---:|---:|");
    let p = BASE.initial();
    let steps = (RUN.len() - 1) as f64;
    fuzzy::ratios(best(|| kernel_of_fourth_order(black_box(&p), &RUN)) / steps);
}

/// Ratios to kernels of the same work.
fn of_peers() {
    let eight = with_effects(8);
    let p = eight.initial();
    let peer = best(|| kernel_of_eight(black_box(&p), &RUN));
    let time = best(|| run_scalar(&eight, &RUN));
    row("`simulate` with 8 effects more", "Runge-Kutta kernel of the same effects", time, peer);
    let exact = std::slice::from_ref(&*EXACT);
    let peer = best(|| output_error_by_differences(black_box(&EXACT)));
    let time = best(|| fit("output_error", exact));
    let over = "five Gauss-Newton steps by differences of the Runge-Kutta kernel";
    row("fit by `output_error`, 25 s at 100 Hz, exact torques", over, time, peer);
}

fn of_length() {
    let mut before: Option<(f64, f64)> = None;
    for samples in [1_000, 10_000, 100_000] {
        let recordings = [made(&[], samples as f64 / 200.0, 2)];
        let likelihood = likelihood(&recordings);
        let pass = best(|| run_pass(&BASE, &likelihood, true));
        let regression = best(|| fit("torque_regression", &recordings));
        let blocks = best(|| fit_in_blocks(&recordings));
        let what = format!("`torque_regression` in blocks, {samples} samples");
        row(&what, "in memory", blocks, regression);
        if let Some((one, other)) = before.replace((pass, regression)) {
            let over = format!("{} samples", samples / 10);
            row(&format!("filter with derivatives, {samples} samples"), &over, pass, one);
            row(&format!("`torque_regression`, {samples} samples"), &over, regression, other);
        }
    }
}

/// The computation for a recording that is too long to be held.
fn fit_in_blocks(train: &[Recording]) -> f64 {
    let (samples, duration) = (train[0].len(), train[0].duration());
    let rows = Box::new(train[0].clone());
    let long = LongRecording { rows, samples, duration, windows: 1 };
    let task = Task { model: &BASE, train, hold: Hold::Linear, seed: 1 };
    let fit = method("torque_regression").identify_long(&task, &[Some(&long)]);
    fit.expect("it reads blocks").expect("a fit").estimates.len() as f64
}

/// Three recordings of 60 s; the whole catalogue. A single run.
fn of_diagnosis(fit_of_one: f64) {
    let two = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    for hidden in [&[][..], &["turning_scrub"][..]] {
        let recordings = three(hidden);
        let mut names = vec![];
        let alone = best(|| names = found(&recordings));
        let named = if names.is_empty() { "nothing".into() } else { names.join(", ") };
        let what = format!("diagnosis of 3 x 60 s that finds {named}");
        row(&what, "`prediction_error` of 25 s", alone, fit_of_one);
        let begin = Instant::now();
        two.install(|| black_box(found(&recordings)));
        let both = begin.elapsed().as_secs_f64();
        row(&format!("{what}, two threads, one run"), "one thread", both, alone);
    }
}

fn main() {
    // one thread, this one: ratios are of work, and allocations are counted
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    one.build_global().expect("no pool before this");
    divan::main();
    let filter = std::env::args().skip(1).find(|a| !a.starts_with("--"));
    match filter.as_deref() {
        None | Some("ratios") => ratios(),
        Some("emulators") => fuzzy_ratios(),
        Some("diagnosis") => of_diagnosis_alone(),
        Some("filter") => of_filter(),
        Some(_) => (),
    }
}
