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
mod table;
mod time;
mod work;

use std::hint::black_box;

use kernels::{kernel, kernel_of_fourth_order};
use work::{
    BASE, MANY, RUN, fit, found, likelihood, made, methods, run_many, run_pass, run_scalar,
    run_sensitive, scattered, three, with_effects,
};

/// Counts the allocations of the benchmarks.
#[global_allocator]
static ALLOCATOR: divan::AllocProfiler = divan::AllocProfiler::system();

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

fn main() {
    // one thread, this one: ratios are of work, and allocations are counted
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    one.build_global().expect("no pool before this");
    divan::main();
    let filter = std::env::args().skip(1).find(|a| !a.starts_with("--"));
    match filter.as_deref() {
        None | Some("ratios") => table::ratios(),
        Some("emulators") => table::fuzzy_ratios(),
        Some("diagnosis") => table::of_diagnosis_alone(),
        Some("filter") => table::of_filter(),
        Some(_) => (),
    }
}
