//! The written functions, run by their own interpreters, against the program.

use std::sync::Arc;

use amigo_ident::effects::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use amigo_ident::math::Real;
use amigo_ident::model::Model;
use amigo_ident::robot::Robot;

use crate::exported::{agrees, is_here, models, prepared, run, written};
use crate::support::{Folder, csv, motion, on};

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

#[test]
fn the_python_function_moves_as_the_program_does() {
    for model in models().iter().filter(|_| is_here("python3")) {
        let folder = prepared(model, "main.py", PYTHON);
        agrees("python", model, &run(&folder, "python3", &["main.py"]));
    }
}

#[test]
fn the_c_function_compiles_as_c99_without_a_warning_and_moves_as_the_program_does() {
    for model in models().iter().filter(|_| is_here("gcc")) {
        let folder = prepared(model, "main.c", C);
        let strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O2"];
        let files = ["main.c", "-o", "main", "-lm"];
        run(&folder, "gcc", &[&strict[..], &files].concat());
        let program = folder.path("main");
        agrees("c", model, &run(&folder, program.to_str().unwrap(), &[]));
    }
}

#[test]
fn the_octave_function_moves_as_the_program_does() {
    for model in models().iter().filter(|_| is_here("octave-cli")) {
        let folder = prepared(model, "main.m", OCTAVE);
        agrees("octave", model, &run(&folder, "octave-cli", &["--norc", "--quiet", "main.m"]));
    }
}

#[test]
fn the_javascript_function_moves_as_the_program_does() {
    for model in models().iter().filter(|_| is_here("node")) {
        let folder = prepared(model, "main.js", JAVASCRIPT);
        agrees("javascript", model, &run(&folder, "node", &["main.js"]));
    }
}

/// Friction whose equation is another above a speed.
struct Branching;

impl Physics for Branching {
    fn description(&self) -> Description {
        Description {
            id: "branching".into(),
            title: "Branching friction".into(),
            equation: "k_b above 1 rad/s".into(),
            cause: String::new(),
            signature: String::new(),
            excitation: String::new(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::linear("k_b", "size", "N m", (0.0, 1.0), 0.01)]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        let torque = if x.omega[0].value() > 1.0 { p[0] } else { T::from(0.0) };
        Terms { torque: [torque, torque], ..Terms::zero() }
    }
}

#[test]
fn a_model_that_is_no_function_is_written_as_data_with_the_reason() {
    let base = Model::with_effects(Robot::amigobot(), &["viscous_friction"]).unwrap();
    let model = base.add_effect(Arc::new(Branching)).unwrap();
    let written = written(&model);
    assert_eq!(written.len(), 1);
    let data: serde_json::Value = serde_json::from_str(&written[0].1).unwrap();
    assert_eq!((&data["schema"], &data["exported"]), (&1.into(), &false.into()));
    let obstacles = data["obstacles"].as_array().unwrap();
    let effects: Vec<&str> = obstacles.iter().map(|o| o["effect"].as_str().unwrap()).collect();
    assert_eq!(effects, ["branching"]);
    assert!(obstacles[0]["reason"].as_str().unwrap().contains("branches on a value"));
    assert_eq!(data["effects"][3]["parameters"][0]["symbol"], "b");
    assert_eq!(data["effects"][0]["parameters"][0]["std_error"], 1e-3);
    assert_eq!(data["robot"]["construction"]["r_m"], Robot::amigobot().r());
}

#[test]
fn every_effect_of_the_catalogue_is_written() {
    for effect in amigo_ident::effects::all() {
        let base = Model::base(Robot::amigobot());
        let model = base.add(&effect.id()).unwrap_or(base);
        assert_eq!(written(&model).len(), 6, "{}", effect.id());
    }
}

#[test]
fn an_experiment_leaves_the_model_and_takes_back_what_no_longer_holds() {
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

    // a fuzzy system is no model of the robot's parameters
    folder.write("small.toml", on("run.csv").replace("prediction_error", "fuzzy_least_squares"));
    folder.run(&["small.toml"]).says(0, &[]);
    assert!(!folder.has("reports/small/model.json"));
    assert!(read("model.py").contains("method fuzzy_least_squares"));
}

#[test]
fn an_experiment_without_a_physical_fit_leaves_its_fuzzy_system_as_a_function() {
    let folder = Folder::new();
    folder.write("run.csv", csv(&motion()));
    folder.write("fuzzy.toml", on("run.csv").replace("prediction_error", "fuzzy_least_squares"));
    folder.run(&["fuzzy.toml"]).says(0, &[]);
    let python = folder.read("reports/fuzzy/model.py");
    assert!(python.contains("method fuzzy_least_squares"), "{python}");
    assert!(python.contains("36 rules over w1"), "{python}");
    assert!(!folder.has("reports/fuzzy/model.json"));
}
