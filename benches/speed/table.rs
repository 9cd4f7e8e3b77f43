//! The table of ratios.

use std::hint::black_box;
use std::time::Instant;

use crate::fuzzy;
use crate::kernels::{
    kernel, kernel_of_eight, kernel_of_fourth_order, output_error_by_differences,
};
use crate::time::{best, row};
use crate::work::{
    BASE, EXACT, MANY, RUN, fit, fit_in_blocks, found, likelihood, made, methods, run_many,
    run_pass, run_scalar, run_sensitive, scattered, three, with_effects,
};

pub(crate) fn ratios() {
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
pub(crate) fn of_diagnosis_alone() {
    println!("| what | over | ratio | time |\n|---|---|---:|---:|");
    let fit_of_one = best(|| fit("prediction_error", std::slice::from_ref(&*RUN)));
    row("fit by `prediction_error`, 25 s", "itself", fit_of_one, fit_of_one);
    of_diagnosis(fit_of_one);
}

/// A step of the filter, with and without derivatives, over the Runge-Kutta kernel, and the default fit.
pub(crate) fn of_filter() {
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
pub(crate) fn fuzzy_ratios() {
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
