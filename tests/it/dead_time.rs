//! A dead time that logging does not explain is in the fit of every method, with its interval, and in what is exported.

use std::fmt::Write as _;

use amigo_ident::conditioning::Kind;
use amigo_ident::experiment::{fits, load};
use amigo_ident::recording::Recording;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::support::Folder;

/// A robot whose input acts `delay` \[s\] after it is recorded, or at once for zero, and a model without that time.
fn late(delay: f64, seed: u64, methods: &[&str], more: &str) -> String {
    let methods: Vec<String> =
        methods.iter().map(|name| format!("[[method]]\nname = \"{name}\"\n")).collect();
    let hidden = match delay {
        0.0 => String::new(),
        delay => format!("hidden = {{ actuator_delay = {{ delay = {delay} }} }}\n"),
    };
    format!(
        "[simulation]\nmovement = \"rich\"\nduration_s = 15\n{hidden}\
         noise = {{ dalpha = 0.02, alpha = 5e-4, M = 0.002 }}\nseed = {seed}\ntrain = 1\nvalidation = 1\n\
         {}{more}",
        methods.concat()
    )
}

/// A command of the simulated controller is held for a millisecond, which delays it by half of that \[s\].
const COMMAND: f64 = 0.0005;

#[test]
fn every_physical_method_fits_it_and_a_diagnosis_still_names_it() {
    let methods = ["prediction_error", "torque_regression", "output_error", "weak_form"];
    let asked = "[diagnosis]\ncandidates = [\"actuator_delay\", \"viscous_friction\"]\n";
    let folder = Folder::new();
    folder
        .write("late.toml", late(0.025, 3, &methods, asked))
        .run(&["late.toml", "--out", "out"])
        .says(0, &[]);
    let results = folder.results("out/late");
    for method in results["methods"].as_array().unwrap() {
        let estimates = method["parameters"].as_array().unwrap();
        let of = |symbol: &str| estimates.iter().find(|e| e["symbol"] == symbol).unwrap();
        let delay = of("delay");
        let [value, error] = ["value", "std_error"].map(|key| delay[key].as_f64().unwrap());
        // 3.3 standard errors: one of a thousand
        assert!((value - 0.025 - COMMAND).abs() < 3.3 * error, "{}: {delay}", method["method"]);
        assert!(error > 0.0 && error < 0.001, "{}: {delay}", method["method"]);
    }
    let model: serde_json::Value =
        serde_json::from_str(&folder.read("out/late/model.json")).unwrap();
    let has = |key: &str| model[key].to_string().contains("actuator_delay");
    assert!(has("effects") && !has("missing_effects"), "{model}");
    assert!(results["diagnosis"].to_string().contains("actuator_delay"));
}

#[test]
#[ignore = "a measurement: the coverage of delays and inertias over 60 seeds each, minutes"]
#[expect(clippy::print_stdout, reason = "a measurement that is run by hand")]
fn the_intervals_of_fitted_delays_cover_the_true_value() {
    let folder = Folder::new();
    for delay in [0.0, 0.020, 0.023, 0.025, 0.030] {
        let mut inside = [[0; 3]; 2];
        for seed in 100..160 {
            let methods = ["prediction_error", "torque_regression"];
            folder.write("late.toml", late(delay, seed, &methods, ""));
            let plan = load(&folder.path("late.toml"), &[]).unwrap();
            let of_robot = plan.model.initial();
            for (fit, inside) in fits(&plan).into_iter().zip(&mut inside) {
                let fit = fit.fit.unwrap();
                let truth = [("delay", delay + COMMAND), ("a1", of_robot[0]), ("a4", of_robot[3])];
                for ((symbol, truth), inside) in truth.into_iter().zip(inside) {
                    // without a delay no method estimates one
                    let interval = fit.estimate(symbol).map(|estimate| estimate.interval);
                    let covers = interval.is_none_or(|(low, high)| (low..=high).contains(&truth));
                    *inside += usize::from(covers);
                }
            }
        }
        println!("{:.0} ms: of 60, delay, a1, a4 by method: {inside:?}", 1e3 * delay);
        // of 60 true 95 % intervals 50 or fewer cover it once in two thousand times
        assert!(inside[0].iter().all(|count| *count > 50), "{delay}: {inside:?}");
    }
}

/// Rows at 100 Hz of a simulation at 1 kHz, with speeds that are `lag` rows of it late, and noise of 0.5 mrad, 0.02 rad/s
/// and 0.002 N m.
fn with_late_speeds(fine: &Recording, lag: usize, seed: u64) -> String {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let mut noise = |sigma: f64| -> f64 {
        let one: f64 = StandardNormal.sample(&mut rng);
        sigma * one
    };
    let mut out = String::from("t,alpha1,alpha2,dalpha1,dalpha2,M1,M2\n");
    for k in (lag..fine.len()).step_by(10) {
        let (alpha, omega, torque) = (fine.alpha()[k], fine.omega()[k - lag], fine.torque()[k]);
        let row = [alpha.map(|x| x + noise(5e-4)), omega.map(|x| x + noise(0.02))];
        let row = [row[0], row[1], torque.map(|x| x + noise(0.002))].concat();
        let row: Vec<String> = row.iter().map(|x| format!("{x:.6}")).collect();
        let _ = writeln!(out, "{:.3},{}", fine.t()[k], row.join(","));
    }
    out
}

#[test]
#[ignore = "a measurement: the coverage of lags and delays over 60 seeds each, minutes"]
#[expect(clippy::print_stdout, reason = "a measurement that is run by hand")]
fn the_intervals_of_lags_of_the_speeds_and_of_the_delay_cover_the_true_values() {
    let folder = Folder::new();
    let fine = "[simulation]\nmovement = \"rich\"\nduration_s = 15\nrate_hz = 1000\ntrain = 1\nvalidation = 0\n\
                hidden = { actuator_delay = { delay = 0.025 } }\n";
    let used = "[recordings]\ntrain = [\"run.csv\"]\n\n[[method]]\nname = \"prediction_error\"\n";
    folder.write("used.toml", used);
    for lag in [4, 13, 37] {
        let (mut inside, mut used) = ([0; 3], 0);
        for seed in 100..160 {
            folder.write("fine.toml", format!("{fine}seed = {seed}\n"));
            let made = load(&folder.path("fine.toml"), &[]).unwrap();
            let log = with_late_speeds(&made.recordings[0].recording, lag, seed);
            folder.write("run.csv", log);
            let plan = load(&folder.path("used.toml"), &[]).unwrap();
            let found = plan.recordings[0].conditioning.iter().find_map(|f| match f.kind {
                Kind::Lag { lag_s, std_error_s } | Kind::Filtered { lag_s, std_error_s } => {
                    Some((lag_s, std_error_s))
                }
                _ => None,
            });
            used += usize::from(plan.recordings[0].recording.measured().omega);
            let is_in =
                |(lag_s, error): (f64, f64)| (lag_s - 1e-3 * lag as f64).abs() < 1.96 * error;
            inside[0] += usize::from(found.is_some_and(is_in));
            let fit = fits(&plan).remove(0).fit.unwrap();
            let truths = [("delay", 0.025 + COMMAND), ("a1", plan.model.initial()[0])];
            for ((symbol, truth), inside) in truths.into_iter().zip(&mut inside[1..]) {
                let interval = fit.estimate(symbol).map(|estimate| estimate.interval);
                let covers = interval.is_some_and(|(low, high)| (low..=high).contains(&truth));
                *inside += usize::from(covers);
            }
        }
        println!("speeds {lag} ms late: of 60, lag, delay, a1: {inside:?}; {used} used");
        // of 60 true 95 % intervals 50 or fewer cover it once in two thousand times
        assert!(inside.iter().all(|count| *count > 50), "{lag}: {inside:?}");
    }
}
