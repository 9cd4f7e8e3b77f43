//! Long comparisons of the fuzzy methods, with the figures they gave.

use std::fmt::Write;
use std::time::Instant;

use super::tests::{ise, made, run};
use crate::robot::Robot;
use crate::simulate::{Movement, Structure};

fn table(gains: &[f64], cases: &[(&str, &str)]) -> String {
    let train = [made(&Movement::paper(), 1)];
    let repeat = made(&Movement::paper(), 2);
    let other = made(&Movement::rich(&Robot::amigobot(), 3, 25.0, 12.0), 3);
    let mut out = String::new();
    for (name, options) in cases {
        for gain in gains {
            let start = Instant::now();
            let fit = run(name, &format!("gain = {gain:?}\n{options}"), &train, 1);
            let seconds = start.elapsed().as_secs_f64();
            let fuzzy = fit.dynamics.fuzzy();
            let structure = fuzzy.map_or(Structure::Parallel, |f| f.structure);
            let at = |recording| ise(&fit, recording, *gain, structure);
            let _ = writeln!(
                out,
                "{name} {} K={gain} ISE {:.4} repeat {:.4} other {:.3} free {:.4} | {} ev {seconds:.2} s {:?}",
                options.replace('\n', ", "),
                at(&train[0]),
                at(&repeat),
                at(&other),
                ise(&fit, &train[0], 0.0, Structure::Parallel),
                fit.work.evaluations,
                fit.status,
            );
        }
    }
    out
}

#[test]
#[ignore = "a measurement, about a minute"]
fn optimisers_compared() {
    let cases = [
        ("fuzzy_least_squares", ""),
        ("fuzzy_levenberg_marquardt", ""),
        ("fuzzy_levenberg_marquardt", "continuation = false"),
        ("fuzzy_gradient", ""),
        ("fuzzy_line_search", ""),
        ("fuzzy_nelder_mead", ""),
        ("fuzzy_genetic", ""),
        ("fuzzy_anfis", ""),
    ];
    panic!("{}", table(&[0.0, 1.0, 2.0], &cases));
}

#[test]
#[ignore = "a measurement, some seconds"]
fn systems_compared() {
    let name = "fuzzy_levenberg_marquardt";
    let cases = [
        (name, "range = \"paper\""),
        (name, "range = \"paper\"\nconsequents = \"affine\""),
        (name, "consequents = \"affine\""),
        (name, "defuzzification = \"weighted_sum\""),
        (name, "input_gain = \"fitted\""),
        (name, "memberships = 9"),
        (name, "structure = \"serial_parallel\""),
        ("fuzzy_anfis", "range = \"paper\""),
    ];
    panic!("{}", table(&[0.0, 1.0, 2.0, 10.0], &cases));
}

#[test]
#[ignore = "a measurement, some seconds"]
fn ridges_compared() {
    let name = "fuzzy_levenberg_marquardt";
    let cases = [
        (name, "ridge = 1e-8"),
        (name, "ridge = 1e-7"),
        (name, "ridge = 1e-6"),
        (name, "ridge = 1e-5"),
        (name, "ridge = 1e-4"),
        (name, "ridge = 1e-3"),
        (name, "ridge = 1e-6\nconsequents = \"affine\""),
        (name, "ridge = 1e-5\nconsequents = \"affine\""),
        (name, "ridge = 1e-4\nconsequents = \"affine\""),
        (name, "ridge = 1e-3\nconsequents = \"affine\""),
        ("fuzzy_least_squares", "ridge = 1e-5"),
        ("fuzzy_least_squares", "ridge = 1e-4"),
        ("fuzzy_least_squares", "ridge = 1e-3"),
    ];
    panic!("{}", table(&[0.0, 1.0, 2.0], &cases));
}
