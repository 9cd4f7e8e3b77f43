//! Tests of the parts that the fuzzy methods share, and of the methods on short recordings.

use nalgebra::{DMatrix, DVector};

use super::{Journal, Limits, Penalty, Problem, Settings, continuation, levenberg_marquardt};
use super::{NamedRange, Range};
use crate::identify::{Fit, Note, Task, find};
use crate::model::Model;
use crate::recording::{Channels, DriveUnit, Recording};
use crate::robot::Robot;
use crate::simulate::{Consequents, Gain, Hold, Movement, NoiseLevel, Recorder, Structure};
use crate::simulate::{emulate, record};

/// Noise level N2.
pub(super) const NOISE: NoiseLevel = NoiseLevel { dalpha: 0.05, alpha: 1e-3, torque: 0.005 };

/// A simulated recording at noise level N2.
pub(super) fn made(movement: &Movement, seed: u64) -> Recording {
    let model = Model::base(Robot::amigobot());
    let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise: NOISE, ticks: None, seed };
    record("made", &model, &model.initial(), movement, &recorder).unwrap()
}

/// Start, straight, curve and braking in 5 s.
fn short(seed: u64) -> Recording {
    let mut movement = Movement::paper();
    let holds = [0.3, 0.8, 0.8, 0.1, 0.3];
    for (segment, hold) in movement.segments.iter_mut().zip(holds) {
        segment.hold_s = hold;
        segment.blend_s = segment.blend_s.min(0.6);
    }
    made(&movement, seed)
}

/// Runs a method with options written as in an experiment file.
pub(super) fn run(name: &str, options: &str, train: &[Recording], seed: u64) -> Fit {
    let model = Model::base(Robot::amigobot());
    let task = Task { model: &model, train, hold: Hold::Linear, seed };
    let options: toml::Table = options.parse().unwrap();
    find(name).unwrap().configure(&options).unwrap().identify(&task).unwrap()
}

fn problem(settings: &Settings, train: &[Recording]) -> (Problem, DVector<f64>) {
    let model = Model::base(Robot::amigobot());
    let task = Task { model: &model, train, hold: Hold::Linear, seed: 0 };
    settings.problem(&task, "test").unwrap()
}

/// ∫ e1² + e2² dt of the emulator of eq. (19) as the rest of the program runs it.
pub(super) fn ise(fit: &Fit, recording: &Recording, k: f64, structure: Structure) -> f64 {
    let dynamics = fit.dynamics.as_ref();
    let Ok(motion) = emulate(dynamics, recording, &Gain::speed(k), structure, Hold::Linear) else {
        return f64::INFINITY;
    };
    let square = |j: usize| -> f64 {
        (0..2).map(|i| (recording.omega()[j][i] - motion[j].omega[i]).powi(2)).sum()
    };
    let t = recording.t();
    (1..t.len()).map(|j| 0.5 * (t[j] - t[j - 1]) * (square(j - 1) + square(j))).sum()
}

#[test]
fn the_closed_form_is_the_dense_least_squares_of_differenced_columns() {
    let train = [short(1)];
    let settings = Settings { memberships: 3, gain: 2.0, ..Settings::default() };
    let (problem, level) = problem(&settings, &train);
    let problem = problem.with_structure(Structure::SerialParallel);
    let theta = problem.closed_form(&level, 1e-7, "test").unwrap();
    // the ISE is a parabola in theta: its gradient and Hessian from differences of the cost, which
    // are exact for a parabola up to rounding
    let n = theta.len();
    let at = |steps: &[(usize, f64)]| {
        let mut x = level.clone();
        steps.iter().for_each(|(j, h)| x[*j] += h);
        problem.cost(x.as_slice())
    };
    let zero = at(&[]);
    let up: Vec<f64> = (0..n).map(|j| at(&[(j, 1.0)])).collect();
    let h = DMatrix::from_fn(n, n, |i, j| {
        if i == j {
            0.5 * (up[i] - 2.0 * zero + at(&[(i, -1.0)]))
        } else {
            0.5 * (at(&[(i, 1.0), (j, 1.0)]) - up[i] - up[j] + zero)
        }
    });
    let g = DVector::from_fn(n, |j, _| 0.5 * (zero - up[j]) + 0.5 * h[(j, j)]);
    let weight = 1e-7 * h.trace() / n as f64;
    let dense = (&h + DMatrix::identity(n, n) * weight).lu().solve(&g).unwrap();
    let difference = (&theta - &level - &dense).amax();
    // rounding of costs of size 100 (1e-14) over the smallest eigenvalue that the ridge leaves
    assert!(difference < 1e-3 * dense.amax(), "{difference} of {}", dense.amax());
    let (a, b) = (problem.cost(theta.as_slice()), problem.cost((&level + dense).as_slice()));
    assert!((a - b).abs() < 1e-7 * a, "{a} {b}");
}

#[test]
fn gradients_to_consequents_and_premises_equal_differences_in_both_structures() {
    let train = [short(2)];
    for structure in [Structure::Parallel, Structure::SerialParallel] {
        for consequents in [Consequents::Constant, Consequents::Affine] {
            let settings =
                Settings { memberships: 3, structure, consequents, ..Settings::default() };
            let (problem, level) = problem(&settings, &train);
            let theta = level.map(|x| 0.5 * x + 0.3);
            let normal = problem.normal(theta.as_slice(), true).unwrap();
            let cost = problem.cost(theta.as_slice());
            assert!((normal.cost - cost).abs() < 1e-12 * cost);
            let premises = problem.system.premises();
            let size = normal.g.amax();
            for k in 0..normal.g.len() {
                let at = |h: f64| {
                    let (mut moved, mut x) = (problem.clone(), theta.clone());
                    if k < theta.len() {
                        x[k] += h;
                    } else {
                        let mut p = premises.clone();
                        p[k - theta.len()] += h;
                        moved.system.set_premises(&p);
                    }
                    moved.cost(x.as_slice())
                };
                let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
                // truncation 1e-10 times third derivatives, rounding 1e-14 / 1e-5
                assert!(
                    (slope + 2.0 * normal.g[k]).abs() < 1e-6 * size,
                    "{structure:?} {consequents:?} {k}: {slope} {}",
                    -2.0 * normal.g[k]
                );
            }
        }
    }
}

#[test]
fn derivatives_over_the_reached_consequents_are_those_over_all() {
    let train = [short(2)];
    let settings = Settings { range: Range::Named(NamedRange::Paper), ..Settings::default() };
    let (problem, level) = problem(&settings, &train);
    let some = problem.over_reached();
    let free = some.free();
    assert!(free.len() < 20 && problem.free().len() == 72, "{free:?}");
    let (all, some) =
        (problem.normal(level.as_slice(), false), some.normal(level.as_slice(), false));
    let (all, some) = (all.unwrap(), some.unwrap());
    assert_eq!(all.cost, some.cost);
    for (k, &j) in free.iter().enumerate() {
        // the same sums in blocks of another size
        assert!((all.g[j] - some.g[k]).abs() < 1e-12 * all.g.amax());
        assert!((all.h[(j, j)] - some.h[(k, k)]).abs() < 1e-12 * all.h.amax());
    }
    // what is left out is a millionth of the curvature, its strength squared
    let left_out = all.h.trace() - some.h.trace();
    assert!(left_out < 1e-5 * all.h.trace(), "{left_out}");
}

#[test]
fn costs_side_by_side_and_slopes_along_one_consequent_are_those_of_the_cost() {
    let train = [short(2), short(3)];
    for structure in [Structure::Parallel, Structure::SerialParallel] {
        let settings = Settings { structure, ..Settings::default() };
        let (problem, level) = problem(&settings, &train);
        let mut thetas: Vec<Vec<f64>> = (0..6_usize)
            .map(|v| level.iter().enumerate().map(|(k, x)| x + ((k + v) as f64).sin()).collect())
            .collect();
        thetas[1] = vec![1e6; level.len()]; // leaves all bounds
        let one_by_one: Vec<f64> = thetas.iter().map(|theta| problem.cost(theta)).collect();
        for (a, b) in one_by_one.iter().zip(problem.costs(&thetas)) {
            // rounding of 500 steps
            assert!((a - b).abs() < 1e-11 * a, "{a} {b}");
        }
        let normal = problem.normal(&thetas[0], false).unwrap();
        let (cost, gradient) = problem.gradient(&thetas[0]).unwrap();
        assert!((cost - one_by_one[0]).abs() < 1e-11 * cost);
        for j in problem.reached() {
            let [cost, slope, curvature] = problem.along(&thetas[0], j).unwrap();
            assert!((cost - one_by_one[0]).abs() < 1e-11 * cost);
            // the same derivatives in another order of summation
            assert!((slope + 2.0 * normal.g[j]).abs() < 1e-10 * normal.g.amax());
            assert!((slope - gradient[j]).abs() < 1e-10 * gradient.amax());
            assert!((curvature - 2.0 * normal.h[(j, j)]).abs() < 1e-10 * normal.h.amax());
        }
    }
}

#[test]
fn the_cost_is_the_ise_of_the_emulator_that_the_rest_of_the_program_runs() {
    let train = [short(3)];
    for structure in [Structure::Parallel, Structure::SerialParallel] {
        let settings = Settings { structure, ..Settings::default() };
        let (problem, level) = problem(&settings, &train);
        let theta = problem.closed_form(&level, 1e-7, "test").unwrap();
        let journal = Journal::default();
        let status = crate::identify::Status::Converged;
        let fit = super::finish::finish("test", &problem, theta.as_slice(), status, 1, &journal);
        let (a, b) = (problem.cost(theta.as_slice()), ise(&fit, &train[0], 1.0, structure));
        // steps of 10 ms here, 5 ms there, through rules that bend within 0.5 rad/s
        assert!((a - b).abs() < 1e-3 * b, "{structure:?} {a} {b}");
    }
}

#[test]
fn levenberg_marquardt_reaches_the_noise_floor_of_the_training_data() {
    let train = [short(4), short(5)];
    let (problem, level) = problem(&Settings::default(), &train);
    let journal = Journal::default();
    let limits = Limits { iterations: 60, tolerance: 1e-6 };
    let penalty = Penalty { about: &level, weight: problem.penalty(1e-7) };
    let descend = |problem: &Problem, theta: &DVector<f64>, limits| {
        Ok(levenberg_marquardt(problem, theta, penalty, limits, &journal))
    };
    let (theta, ..) =
        continuation(&problem, &level, 1e-7, limits, &journal, "test", descend).unwrap();
    let ratio = problem.cost(theta.as_slice()) / problem.noise_floor;
    // the start value is noisy too, which costs sigma²/K = 0.005 of a floor of 0.05 in all
    assert!(ratio < 1.2, "{ratio}");
}

#[test]
fn every_method_lowers_the_cost_of_its_start_and_its_curve_never_rises() {
    let train = [short(6)];
    let (problem, level) = problem(&Settings::default(), &train);
    for (name, options) in [
        ("fuzzy_least_squares", ""),
        ("fuzzy_levenberg_marquardt", ""),
        ("fuzzy_gradient", "start = \"friction\"\niterations = 40"),
        ("fuzzy_line_search", "sweeps = 2"),
        ("fuzzy_nelder_mead", "start = \"friction\"\niterations = 400"),
        ("fuzzy_genetic", "generations = 10\npopulation = 20"),
        ("fuzzy_anfis", "epochs = 3"),
    ] {
        let fit = run(name, options, &train, 1);
        assert!(fit.estimates.is_empty() && fit.dynamics.fuzzy().is_some(), "{name}");
        let fuzzy = fit.dynamics.fuzzy().unwrap();
        let own = problem.with_structure(fuzzy.structure);
        let (start, end) = (own.cost(level.as_slice()), own.cost(fuzzy.system.parameters()));
        let curve = &fit.traces[0].values;
        assert!(curve.windows(2).all(|w| w[1][0] <= w[0][0]), "{name}");
        // the learnt premises are not those of `problem`
        assert!(name == "fuzzy_anfis" || end < start, "{name} {end} {start}");
        let is_fed =
            matches!(fit.notes[0], Note::Emulator { fed: Some((_, gain)), .. } if gain == 1.0);
        assert!(is_fed, "{}", fit.notes[0]);
    }
}

#[test]
fn the_membership_functions_are_adapted() {
    let train = [short(7)];
    let options = "memberships = 3\nepochs = 15";
    let fixed = run("fuzzy_levenberg_marquardt", "memberships = 3", &train, 1);
    let learnt = run("fuzzy_anfis", options, &train, 1);
    let cost = |fit: &Fit| ise(fit, &train[0], 1.0, Structure::Parallel);
    assert!(cost(&learnt) < cost(&fixed), "{} {}", cost(&learnt), cost(&fixed));
}

#[test]
fn the_same_seed_gives_the_same_result_on_one_thread_and_on_three() {
    let train = [short(8), short(9)];
    for (name, options) in [
        ("fuzzy_levenberg_marquardt", "memberships = 4"),
        ("fuzzy_genetic", "memberships = 4\ngenerations = 5\npopulation = 12"),
    ] {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let fit = pool.install(|| run(name, options, &train, 7));
            fit.dynamics.fuzzy().unwrap().system.parameters().to_vec()
        };
        assert_eq!(on(1), on(3), "{name}");
    }
    let genetic = |seed| {
        let fit = run("fuzzy_genetic", "generations = 2\npopulation = 8", &train, seed);
        fit.dynamics.fuzzy().unwrap().system.parameters().to_vec()
    };
    assert_ne!(genetic(1), genetic(2));
}

#[test]
fn options_that_are_not_understood_are_refused_in_words() {
    let refuse = |name: &str, options: &str| {
        let table: toml::Table = options.parse().unwrap();
        find(name).unwrap().configure(&table).err().unwrap().to_string()
    };
    let message = refuse("fuzzy_line_search", "sweps = 3");
    assert!(message.contains("unknown option `sweps`") && message.contains("sweeps"), "{message}");
    assert!(refuse("fuzzy_anfis", "memberships = 40").contains("at least 2, at most 16"));
    assert!(refuse("fuzzy_gradient", "gain = -1").contains("not strictly stable"));
    assert!(refuse("fuzzy_gradient", "range = [3, 3]").contains("low < high"));
    assert!(refuse("fuzzy_least_squares", "structure = \"parallel\"").contains("serial-parallel"));
    // every default that is described is understood
    for method in crate::identify::all().iter().filter(|m| m.fits_emulator()) {
        let lines: Vec<String> =
            method.options().iter().map(|o| format!("{} = {}", o.key, o.default)).collect();
        let table: toml::Table = lines.join("\n").parse().unwrap();
        assert!(method.configure(&table).is_ok(), "{}", method.describe().name);
    }
}

#[test]
fn rules_that_no_recording_excites_are_not_trained() {
    let train = [short(10)];
    let fit = run("fuzzy_least_squares", "range = \"paper\"", &train, 0);
    let fuzzy = fit.dynamics.fuzzy().unwrap();
    // speeds up to 5 rad/s touch the functions at 0 and 6 rad/s alone
    assert!(fuzzy.trained.iter().filter(|t| **t).count() <= 4);
    let of_36 = |n: &Note| matches!(n, Note::ExcitedRules { count: 1..=4, of: 36 });
    assert!(fit.notes.iter().any(of_36), "{:?}", fit.notes);
    assert!(fit.notes.iter().any(|n| matches!(n, Note::ForwardOnly)), "{:?}", fit.notes);
}

/// The same motion with other columns.
fn changed(
    recording: &Recording,
    unit: DriveUnit,
    row: impl Fn(usize) -> (f64, [f64; 2], [f64; 2]),
) -> Recording {
    let rows: Vec<_> = (0..recording.len()).map(row).collect();
    let channels = Channels {
        t: rows.iter().map(|r| r.0).collect(),
        alpha: None,
        omega: Some(rows.iter().map(|r| r.1).collect()),
        torque: rows.iter().map(|r| r.2).collect(),
    };
    Recording::new("changed", channels, unit).unwrap()
}

#[test]
fn inputs_in_volts_get_a_fitted_gain_and_reach_the_same_ise() {
    let rich = made(&Movement::rich(&Robot::amigobot(), 4, 15.0, 8.0), 11);
    let volts = changed(&rich, DriveUnit::Volt, |k| {
        (rich.t()[k], rich.omega()[k], rich.torque()[k].map(|m| 20.0 * m))
    });
    let name = "fuzzy_levenberg_marquardt";
    let newton = run(name, "input_gain = \"fitted\"", &[rich], 0);
    let volt = run(name, "", &[volts], 0);
    let g = |fit: &Fit| fit.dynamics.fuzzy().unwrap().input_gain[0][0];
    // the two likelihood fits differ in their measured angles and noise start
    assert!((20.0 * g(&volt) / g(&newton) - 1.0).abs() < 0.01, "{} {}", g(&volt), g(&newton));
}

#[test]
fn gaps_in_time_and_a_wheel_that_stands_still_are_no_obstacle() {
    let whole = short(12);
    let odd = changed(&whole, DriveUnit::NewtonMetre, |k| {
        let t = whole.t()[k] + if k > 200 { 3.0 } else { 0.0 };
        (t, [whole.omega()[k][0], 0.0], whole.torque()[k])
    });
    for name in ["fuzzy_least_squares", "fuzzy_levenberg_marquardt", "fuzzy_anfis"] {
        let fit = run(name, "", std::slice::from_ref(&odd), 0);
        let parameters = fit.dynamics.fuzzy().unwrap().system.parameters();
        assert!(parameters.iter().all(|p| p.is_finite()), "{name}");
    }
}
