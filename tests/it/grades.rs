//! The grade of a model against its error on a drive that neither the fit nor the grade has seen.

use amigo_ident::compare::{simulate_recording, window_rms};
use amigo_ident::experiment::{Plan, load, run};
use amigo_ident::simulate::PhysicalDynamics;
use amigo_ident::study::{Grade, Study};
use rayon::prelude::*;

use crate::support::{Folder, root};

/// What simulated robots have and the fitted model lacks, each from nothing to far too much.
const MISSING: [(&str, &[f64]); 4] = [
    ("viscous_friction = { b = SIZE }", &[0.0, 2e-4, 1e-3, 5e-3, 2e-2, 5e-2]),
    ("turning_scrub = { f_t = SIZE }", &[5e-4, 2e-3, 5e-3, 2e-2, 0.1, 0.5]),
    ("slope = { g_c = SIZE, g_s = 0.0 }", &[3e-4, 2e-3, 5e-3, 2e-2, 0.1]),
    ("actuator_delay = { delay = SIZE }", &[3e-3, 0.01, 0.03]),
];

/// Another drive shows what is missing more or less than that of the grade: the factor to either side.
const ANOTHER_DRIVE: f64 = 1.3;

const SIMULATION: &str = "[simulation]\nmovement = \"rich\"\nnoise = { dalpha = 0.05, alpha = 0.001, M = 0.005 }\n\
     seed = 3\ntrain = 2\nvalidation = 1\nhidden = { HIDDEN }\n\n[[method]]\nname = \"weak_form\"\n";

/// What a model was called, and how it does later.
#[derive(Debug)]
struct Judged {
    missing: String,
    grade: Grade,
    /// 2 s simulation error of a later drive without noise [rad/s]: all of it is the model's.
    later: f64,
    floor: f64,
    top_speed: f64,
}

fn judged(missing: &str) -> Judged {
    let folder = Folder::new();
    folder.write("it.toml", SIMULATION.replace("HIDDEN", missing));
    let file = folder.path("it.toml");
    let plan = load(&file, &[]).unwrap();
    let study = run(&plan).unwrap();
    let later = ["simulation.noise_scale=0", "simulation.seed=77"].map(str::to_owned);
    let later = load(&file, &later).unwrap();
    Judged {
        missing: missing.to_owned(),
        grade: study.grade().unwrap(),
        later: error_on(&study, &plan, &later),
        floor: study.judged_floor(),
        top_speed: study.top_speed(),
    }
}

fn error_on(study: &Study, plan: &Plan, later: &Plan) -> f64 {
    let parameters = &study.given.as_ref().unwrap().parameters;
    let p = parameters.iter().map(|p| p.estimate.value).collect();
    let dynamics = PhysicalDynamics { model: plan.fitted_model(), p };
    let recording = &later.recordings[0].recording;
    let simulated = simulate_recording(&dynamics, recording, later.hold);
    simulated.map_or(f64::INFINITY, |s| window_rms(recording, &s.windows))
}

/// Limits of the grades as the guide states them: two of the floor, then three shares of the top speed.
fn stated() -> [f64; 5] {
    let guide = std::fs::read_to_string(root().join("docs/guide.md")).unwrap();
    let row = |grade: &str| {
        let start = format!("| {grade} | ");
        guide.lines().find_map(|line| line.strip_prefix(&start)).unwrap().to_owned()
    };
    let number = |row: &str, before: &str, behind: &str| -> f64 {
        let text = row.split(before).nth(1).unwrap().split(behind).next().unwrap();
        text.trim().parse().unwrap()
    };
    let near = row("near the noise floor");
    [
        number(&row("at the noise floor"), "e ≤", "floor"),
        number(&near, "e ≤", "floor"),
        0.01 * number(&near, "sqrt(e² - floor²) ≤", "%"),
        0.01 * number(&row("useful"), "e ≤", "%"),
        0.01 * number(&row("poor"), "e ≤", "%"),
    ]
}

/// The errors [rad/s] between which the guide puts a grade.
fn range(j: &Judged) -> (f64, f64) {
    let [at, near, excess, useful, poor] = stated();
    let small = j.floor.hypot(excess * j.top_speed);
    let limits =
        [0.0, at * j.floor, small.max(near * j.floor), useful * j.top_speed, poor * j.top_speed];
    let n = j.grade as usize;
    (limits[n], limits.get(n + 1).copied().unwrap_or(f64::INFINITY))
}

#[test]
fn a_grade_says_how_far_off_the_model_is_on_a_later_drive() {
    let sizes = MISSING.iter().flat_map(|(it, sizes)| sizes.iter().map(move |size| (it, size)));
    let missing: Vec<String> =
        sizes.map(|(it, size)| it.replace("SIZE", &size.to_string())).collect();
    let mut all: Vec<Judged> = missing.par_iter().map(|missing| judged(missing)).collect();
    for j in &all {
        // measured with the noise of the recordings that were judged
        let error = j.later.hypot(j.floor);
        let (least, most) = range(j);
        assert!(
            least / ANOTHER_DRIVE <= error && error <= most * ANOTHER_DRIVE,
            "{}: {error} {j:?}",
            j.missing
        );
    }
    all.sort_by_key(|j| j.grade);
    for pair in all.chunk_by(|a, b| a.grade == b.grade).collect::<Vec<_>>().windows(2) {
        let worst = pair[0].iter().max_by(|a, b| a.later.total_cmp(&b.later)).unwrap();
        let best = pair[1].iter().min_by(|a, b| a.later.total_cmp(&b.later)).unwrap();
        assert!(worst.later < best.later, "{worst:?} {best:?}");
    }
    let grades: Vec<Grade> = all.chunk_by(|a, b| a.grade == b.grade).map(|c| c[0].grade).collect();
    assert_eq!(grades.len(), 5, "every grade is given: {grades:?}");
}
