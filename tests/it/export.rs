//! The written functions, run by their own interpreters, against the program.

use std::process::Command;
use std::sync::Arc;

use amigo_ident::effects::{Custom, CustomDefinition, ParameterSpec};
use amigo_ident::export::{Identified, files};
use amigo_ident::model::Model;
use amigo_ident::robot::{Robot, State};
use amigo_ident::simulate::{Dynamics, Hold, Input, PhysicalDynamics};

use crate::support::{Folder, csv, motion, on};

/// Every kind of operation: products, cosines, bells, kinks of the drive, whole orders, powers.
const EFFECTS: [&str; 17] = [
    "slope",
    "viscous_friction",
    "stribeck",
    "turning_scrub",
    "quadratic_drag",
    "caster_drag",
    "torque_offset",
    "friction_warmup",
    "load_transfer_friction",
    "torque_ripple",
    "wheel_radius_mismatch",
    "lateral_com",
    "torque_gain",
    "torque_saturation",
    "backlash_deadzone",
    "actuator_lag",
    "actuator_delay",
];

pub(crate) fn model() -> Model {
    let linear =
        |symbol: &str, value: f64| ParameterSpec::linear(symbol, "size", "N m", (-1.0, 1.0), value);
    let definition = CustomDefinition {
        torque1: "k_x*erf(w/2) + k_y*max(abs(w), 0.1)^k_z*tanh(w)*ln(2 + sqrt(1 + beta^2))".into(),
        parameters: vec![
            linear("k_x", 0.01),
            linear("k_y", -0.003),
            ParameterSpec::shape("k_z", "power", "", (0.1, 3.0), 1.3),
        ],
        ..CustomDefinition::default()
    };
    let custom = Custom::new("odd_drag", definition).unwrap();
    Model::with_effects(Robot::amigobot(), &EFFECTS).unwrap().add_effect(Arc::new(custom)).unwrap()
}

pub(crate) fn written(model: &Model) -> Vec<(String, String)> {
    let parameters = model.parameters();
    let units: Vec<String> = parameters.iter().map(|p| p.spec.unit.clone()).collect();
    files(&Identified {
        model,
        values: &model.initial(),
        std_errors: &vec![1e-3; parameters.len()],
        units: &units,
        drive_unit: "N m",
        hold: Hold::Linear,
        experiment: "made",
        method: "prediction_error",
        missing: &[],
    })
    .files
}

/// t, alpha1, alpha2, omega1, omega2, M1, M2; every fourth state has wheels at rest.
pub(crate) fn states() -> Vec<[f64; 7]> {
    let mut seed = 7_u64;
    let mut uniform = |low: f64, high: f64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((seed >> 11) as f64 / (1_u64 << 53) as f64)
    };
    (0..200)
        .map(|k| {
            let mut row = [0.0; 7];
            row[0] = uniform(0.0, 20.0);
            row[1..3].fill_with(|| uniform(-30.0, 30.0));
            row[3..5].fill_with(|| uniform(-12.0, 12.0));
            row[5..7].fill_with(|| uniform(-0.6, 0.6));
            match k % 16 {
                3 => row[3] = 0.0,
                7 => row[4] = 0.0,
                11 => row[4] = row[3],
                15 => row[3..5].fill(0.0),
                _ => {}
            }
            row
        })
        .collect()
}

/// Samples of [`drive`].
const SAMPLES: i32 = 3001;

/// t, M1, M2: starts, stops, reversals and rest over 6 s at 500 Hz.
pub(crate) fn drive() -> Vec<[f64; 3]> {
    (0..SAMPLES)
        .map(|k| {
            let t = 0.002 * f64::from(k);
            let on = if (3.0..4.0).contains(&t) { 0.2 } else { 1.0 };
            [t, on * 0.35 * (2.1 * t).sin() + 0.03, on * 0.33 * (1.7 * t + 0.4).sin()]
        })
        .collect()
}

fn table<const N: usize>(rows: &[[f64; N]]) -> String {
    let line = |row: &[f64; N]| row.map(|v| format!("{v:?}")).join(" ") + "\n";
    rows.iter().map(line).collect()
}

const PYTHON: &str = r#"
import model
read = lambda name: [[float(v) for v in line.split()] for line in open(name)]
for r in read("states.txt"):
    print(*map(repr, model.acceleration(r[0], r[1:3], r[3:5], r[5:7])))
run = read("drive.txt")
alpha, omega = model.simulate([r[0] for r in run], [r[1:] for r in run], [0.0, 0.0], [0.0, 0.0])
for a, w in zip(alpha, omega):
    print(*map(repr, a + w))
"#;

const OCTAVE: &str = r#"
robot = model();
for r = load("states.txt")'
  printf("%.17g %.17g\n", robot.acceleration(r(1), r(2:3)', r(4:5)', r(6:7)'));
end
run = load("drive.txt");
[alpha, omega] = robot.simulate(run(:, 1), run(:, 2:3), [0, 0], [0, 0]);
printf("%.17g %.17g %.17g %.17g\n", [alpha, omega]');
"#;

const C: &str = r#"
#include <stdio.h>
#include "model.c"
static double t[3001], M[3001][2], alpha[3001][2], omega[3001][2];
int main(void) {
    const double zero[2] = {0.0, 0.0};
    double r[7], a[2];
    int n = 0;
    FILE *in = fopen("states.txt", "r");
    while (fscanf(in, "%lf %lf %lf %lf %lf %lf %lf", r, r + 1, r + 2, r + 3, r + 4, r + 5, r + 6) == 7) {
        model_acceleration(r[0], r + 1, r + 3, r + 5, a);
        printf("%.17g %.17g\n", a[0], a[1]);
    }
    fclose(in);
    in = fopen("drive.txt", "r");
    while (n < 3001 && fscanf(in, "%lf %lf %lf", t + n, M[n], M[n] + 1) == 3) n++;
    fclose(in);
    model_simulate(n, t, M, zero, zero, alpha, omega);
    for (int k = 0; k < n; k++)
        printf("%.17g %.17g %.17g %.17g\n", alpha[k][0], alpha[k][1], omega[k][0], omega[k][1]);
    return 0;
}
"#;

const JAVASCRIPT: &str = r#"
const robot = require("./model.js")();
const read = (name) => require("fs").readFileSync(name, "utf8").trim().split("\n").map((l) => l.split(" ").map(Number));
const say = (row) => console.log(row.join(" "));
for (const r of read("states.txt")) say(robot.acceleration(r[0], r.slice(1, 3), r.slice(3, 5), r.slice(5, 7)));
const run = read("drive.txt");
const { alpha, omega } = robot.simulate(run.map((r) => r[0]), run.map((r) => r.slice(1)), [0, 0], [0, 0]);
alpha.forEach((a, k) => say([...a, ...omega[k]]));
"#;

pub(crate) fn is_here(program: &str) -> bool {
    let found = Command::new(program).arg("--version").output().is_ok_and(|o| o.status.success());
    if !found {
        println!("skipped: {program} is not on this machine");
    }
    found
}

pub(crate) fn run(folder: &Folder, program: &str, arguments: &[&str]) -> String {
    let here = folder.path(".");
    let out = Command::new(program).args(arguments).current_dir(here).output().unwrap();
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{program}: {said}");
    String::from_utf8(out.stdout).unwrap()
}

pub(crate) fn prepared(main: &str, text: &str) -> Folder {
    let folder = Folder::new();
    for (name, text) in written(&model()) {
        folder.write(&name, text);
    }
    folder.write(main, text);
    folder.write("states.txt", table(&states())).write("drive.txt", table(&drive()));
    folder
}

/// What a language printed, against the program's own.
pub(crate) fn agrees(language: &str, printed: &str) {
    let rows: Vec<Vec<f64>> = printed
        .lines()
        .map(|line| line.split_whitespace().map(|word| word.parse().unwrap()).collect())
        .collect();
    let model = model();
    let p = model.initial();
    let right = PhysicalDynamics { model, p };
    let (states, drive) = (states(), drive());
    assert_eq!(rows.len(), states.len() + drive.len(), "{language}");
    let mut worst = 0.0_f64;
    for (s, found) in states.iter().zip(&rows) {
        // one row: a lag and a delay see it as held for long
        let acting = right.drive(&[0.0], &[[s[5], s[6]]])[0];
        let state = State { alpha: [s[1], s[2]], omega: [s[3], s[4]] };
        let expected = right.acceleration(s[0], &state, &acting).unwrap();
        let size = expected[0].hypot(expected[1]).max(1.0);
        for i in 0..2 {
            worst = worst.max((found[i] - expected[i]).abs() / size);
        }
    }
    // the same operations in the same order; exp, sin and pow differ in the last bit
    assert!(worst < 1e-12, "{language}: accelerations off by {worst:e}");
    let t: Vec<f64> = drive.iter().map(|r| r[0]).collect();
    let moment: Vec<[f64; 2]> = drive.iter().map(|r| [r[1], r[2]]).collect();
    let input = Input { t: &t, moment: &moment, hold: Hold::Linear };
    let motion = right.simulate(&input, State::default()).unwrap();
    let mut off = [0.0_f64; 2];
    for (state, found) in motion.iter().zip(&rows[states.len()..]) {
        for i in 0..2 {
            off[0] = off[0].max((found[i] - state.alpha[i]).abs());
            off[1] = off[1].max((found[2 + i] - state.omega[i]).abs());
        }
    }
    let still = motion.iter().filter(|s| s.omega == [0.0; 2]).count();
    assert!((10..2000).contains(&still), "the drive holds {still} samples of rest");
    println!(
        "{language}: accelerations {worst:.1e}, angles {:.1e} rad, speeds {:.1e} rad/s",
        off[0], off[1]
    );
    // signs are held over a step and a reversal is placed by a secant: measured 3e-4 rad/s at the
    // step of 1 ms, 2e-5 at 0.25 ms, 3e-6 at 0.1 ms
    assert!(off[0] < 1e-3 && off[1] < 1e-3, "{language}: simulation off by {off:?}");
}

#[test]
fn the_python_function_moves_as_the_program_does() {
    if is_here("python3") {
        let folder = prepared("main.py", PYTHON);
        agrees("python", &run(&folder, "python3", &["main.py"]));
    }
}

#[test]
fn the_c_function_compiles_as_c99_without_a_warning_and_moves_as_the_program_does() {
    if is_here("gcc") {
        let folder = prepared("main.c", C);
        let strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O2"];
        let files = ["main.c", "-o", "main", "-lm"];
        run(&folder, "gcc", &[&strict[..], &files].concat());
        let program = folder.path("main");
        agrees("c", &run(&folder, program.to_str().unwrap(), &[]));
    }
}

#[test]
fn the_octave_function_moves_as_the_program_does() {
    if is_here("octave-cli") {
        let folder = prepared("main.m", OCTAVE);
        agrees("octave", &run(&folder, "octave-cli", &["--norc", "--quiet", "main.m"]));
    }
}

#[test]
fn the_javascript_function_moves_as_the_program_does() {
    if is_here("node") {
        let folder = prepared("main.js", JAVASCRIPT);
        agrees("javascript", &run(&folder, "node", &["main.js"]));
    }
}

#[test]
fn a_model_with_a_memory_is_written_as_data_with_the_reason_and_not_as_a_function() {
    let ids = ["viscous_friction", "wheel_slip"];
    let model = Model::with_effects(Robot::amigobot(), &ids).unwrap();
    let written = written(&model);
    assert_eq!(written.len(), 1);
    let data: serde_json::Value = serde_json::from_str(&written[0].1).unwrap();
    assert_eq!((&data["schema"], &data["exported"]), (&1.into(), &false.into()));
    let obstacles = data["obstacles"].as_array().unwrap();
    let effects: Vec<&str> = obstacles.iter().map(|o| o["effect"].as_str().unwrap()).collect();
    assert_eq!(effects, &ids[1..]);
    assert!(obstacles[0]["reason"].as_str().unwrap().contains("states of its own"));
    assert_eq!(data["effects"][3]["parameters"][0]["symbol"], "b");
    assert_eq!(data["effects"][0]["parameters"][0]["std_error"], 1e-3);
    assert_eq!(data["robot"]["construction"]["r_m"], Robot::amigobot().r());
}

#[test]
fn every_effect_of_the_catalogue_without_a_memory_or_own_states_is_written() {
    let kept: Vec<String> = amigo_ident::effects::all()
        .iter()
        .map(|effect| effect.id())
        .filter(|id| !amigo_ident::effects::BASE.contains(&id.as_str()))
        .filter(|id| {
            let model = Model::with_effects(Robot::amigobot(), &[id]).unwrap();
            written(&model).len() == 1
        })
        .collect();
    assert_eq!(kept, ["wheel_slip", "compliance"]);
}

#[test]
fn an_experiment_leaves_the_model_and_takes_back_functions_that_no_longer_hold() {
    let folder = Folder::new();
    folder.write("run.csv", csv(&motion()));
    let functions = ["model.py", "model.m", "model.c", "model.mo", "model.js"];
    folder.write("small.toml", on("run.csv") + "\n[model]\neffects = [\"viscous_friction\"]\n");
    folder.run(&["small.toml"]).says(0, &[]);
    let read = |name: &str| folder.read(&format!("reports/small/{name}"));
    let data: serde_json::Value = serde_json::from_str(&read("model.json")).unwrap();
    assert_eq!(
        (&data["exported"], &data["provenance"]["experiment"]),
        (&true.into(), &"small".into())
    );
    assert_eq!(data["effects"][3]["id"], "viscous_friction");
    assert!(functions.iter().all(|name| folder.has(&format!("reports/small/{name}"))));
    assert!(
        read("report.html").contains("model.json, model.py, model.m, model.c, model.mo, model.js")
    );

    folder.write("small.toml", on("run.csv") + "\n[model]\neffects = [\"wheel_slip\"]\n");
    folder.run(&["small.toml"]).says(0, &[]);
    let data: serde_json::Value = serde_json::from_str(&read("model.json")).unwrap();
    assert_eq!(data["exported"], false);
    assert!(!functions.iter().any(|name| folder.has(&format!("reports/small/{name}"))));
    assert!(read("report.html").contains("not written as a function (wheel_slip: "));
}
