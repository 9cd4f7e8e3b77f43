//! Contract tests for every registered effect.

mod mirror;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::math::Dual;
use crate::model::{Model, solve_mass};
use crate::robot::{Robot, State};
use crate::simulate::{Hold, Input, simulate, simulate_with_sensitivities};

/// A state of ordinary driving.
fn motion<'a>(robot: &'a Robot, rng: &mut ChaCha8Rng) -> Motion<'a, f64> {
    let mut draw = |most: f64| [0, 1].map(|_| rng.random_range(-most..most));
    let (alpha, omega) = (draw(20.0), draw(12.0));
    let variance = if rng.random_bool(0.5) { [1e-6, 1e-6, 1e-2, 1e-2] } else { [0.0; 4] };
    Motion { t: rng.random_range(0.0..30.0), alpha, omega, variance, robot }
}

/// Parameters within their ranges: up to three times the typical value, of either sign if the range includes
/// both.
fn parameters(effect: &dyn Effect, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let draw = |spec: ParameterSpec| {
        let (low, high) = spec.range;
        let sign = if low < 0.0 && rng.random_bool(0.5) { -1.0 } else { 1.0 };
        (sign * spec.typical.abs() * rng.random_range(0.3..3.0)).clamp(low, high)
    };
    effect.parameters().into_iter().map(draw).collect()
}

/// Runs a check on every registered effect with reproducible draws.
fn each(times: usize, check: impl Fn(&dyn Effect, &str, &Robot, &mut ChaCha8Rng)) {
    let robot = Robot::amigobot();
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for effect in all() {
        let id = effect.id();
        (0..times).for_each(|_| check(effect.as_ref(), &id, &robot, &mut rng));
    }
}

/// The entries of [`Terms`] as one list.
fn flat<T: Copy>(terms: &Terms<T>) -> Vec<T> {
    [&terms.mass[..], &terms.torque, &terms.level].concat()
}

/// Non-uniform samples with torques of both signs.
fn recorded(rng: &mut ChaCha8Rng) -> (Vec<f64>, Vec<[f64; 2]>) {
    let mut t = vec![0.3_f64];
    (1..200).for_each(|k| t.push(t[k - 1] + rng.random_range(0.004..0.02)));
    let m = t.iter().map(|t| [0.45 * (5.0 * t).sin(), 0.4 * (3.0 * t + 1.0).cos()]).collect();
    (t, m)
}

#[test]
fn ids_are_file_names_and_unique_and_the_texts_are_complete() {
    let ids: Vec<String> = all().iter().map(|e| e.id()).collect();
    for (k, effect) in all().iter().enumerate() {
        let d = effect.description();
        assert!(!ids[..k].contains(&d.id), "{} stands twice", d.id);
        let file = format!("{}/src/effects/{}.rs", env!("CARGO_MANIFEST_DIR"), d.id);
        assert!(std::path::Path::new(&file).exists(), "{} has no file of its own", d.id);
        for text in [&d.title, &d.equation, &d.cause, &d.signature, &d.excitation] {
            assert!(!text.is_empty() && text.is_ascii() && !text.contains("  "), "{}", d.id);
        }
        for other in &d.equivalent {
            let other_effect = find(other).unwrap_or_else(|| panic!("{}: no effect {other}", d.id));
            let mutual = other_effect.description().equivalent.contains(&d.id);
            assert!(mutual || BASE.contains(&other.as_str()), "{} and {other}", d.id);
        }
    }
    for id in CONTRACT {
        assert!(ids.iter().any(|i| i == id), "{id} is not registered");
    }
}

/// Ids on which experiment files may rely; a new effect need not be listed here.
const CONTRACT: [&str; 29] = [
    "inertia",
    "centrifugal",
    "coulomb_friction",
    "viscous_friction",
    "viscous_friction_1",
    "viscous_friction_2",
    "back_emf",
    "coulomb_asymmetry",
    "stribeck",
    "quadratic_drag",
    "torque_offset",
    "slope",
    "turning_scrub",
    "yaw_viscous",
    "caster_drag",
    "payload",
    "lateral_com",
    "wheel_radius_mismatch",
    "actuator_lag",
    "actuator_delay",
    "torque_gain",
    "torque_saturation",
    "backlash_deadzone",
    "torque_ripple",
    "wheel_eccentricity",
    "friction_warmup",
    "load_transfer_friction",
    "wheel_slip",
    "compliance",
];

#[test]
fn symbols_are_unique_over_the_catalogue_and_typical_values_lie_in_their_ranges() {
    let mut seen = Vec::new();
    for effect in all() {
        let specs = effect.parameters();
        assert!(!specs.is_empty() && specs.len() <= MOST_PARAMETERS, "{}", effect.id());
        for spec in specs {
            assert!(!seen.contains(&spec.symbol), "{}: {} is taken", effect.id(), spec.symbol);
            let (low, high) = spec.range;
            assert!(low < spec.typical && spec.typical < high, "{}", spec.symbol);
            let finite = low.is_finite() && high.is_finite();
            assert!(spec.kind == ParameterKind::Linear || finite, "{}", spec.symbol);
            seen.push(spec.symbol);
        }
    }
}

#[test]
fn the_energy_role_holds() {
    each(500, |effect, id, robot, rng| {
        let x = motion(robot, rng);
        let p = parameters(effect, rng);
        let terms = effect.terms(&x, &p);
        let [w1, w2] = x.omega;
        let parts = [terms.torque[0] * w1, terms.torque[1] * w2];
        let power: f64 = parts[0] + parts[1];
        // the two products cancel: rounding of the larger one
        let tiny = 1e-13 * parts[0].abs();
        let friction: f64 = (0..4).map(|j| terms.level[j] * along(j, &x.omega).abs()).sum();
        match effect.energy() {
            Energy::Dissipates => assert!(power + friction >= -tiny, "{id} gives energy"),
            Energy::DoesNoWork => {
                assert!(power.abs() <= tiny && terms.level == [0.0; 4], "{id} does work");
            }
            // stored energy is returned if the motion runs backward: the power is even in the speeds
            Energy::Stores => {
                let back = Motion { omega: [-w1, -w2], ..x };
                assert_eq!(terms, effect.terms(&back, &p), "{id} keeps energy");
                assert_eq!(terms.level, [0.0; 4], "{id} has friction");
            }
            Energy::Supplies => assert!(flat(&terms).iter().all(|v| v.is_finite()), "{id}"),
        }
    });
}

#[test]
fn linear_parameters_enter_linearly() {
    each(50, |effect, id, robot, rng| {
        let x = motion(robot, rng);
        let (t, m) = recorded(rng);
        let p = parameters(effect, rng);
        // all that the effect changes, with the linear parameters scaled one by one
        let change = |scale: &dyn Fn(usize) -> f64| {
            let scaled = |(j, spec): (usize, ParameterSpec)| match spec.kind {
                ParameterKind::Linear => p[j] * scale(j),
                ParameterKind::Shape => p[j],
            };
            let q: Vec<f64> = effect.parameters().into_iter().enumerate().map(scaled).collect();
            let mut all = flat(&effect.terms(&x, &q));
            let acting = effect.input(&t, &m, &q).unwrap_or(m.clone());
            all.extend((0..t.len()).map(|k| acting[k][0] - m[k][0]));
            all
        };
        if effect.parameters().iter().all(|spec| spec.kind == ParameterKind::Shape) {
            return;
        }
        let factor = |j: usize| 0.5 + j as f64;
        let whole = change(&factor);
        let mut sum = change(&|_| 0.0);
        assert!(sum.iter().all(|v| *v == 0.0), "{id} acts at zero");
        for j in 0..p.len() {
            let linear = effect.parameters()[j].kind == ParameterKind::Linear;
            let part = change(&|k| if k == j && linear { 1.0 } else { 0.0 });
            sum.iter_mut().zip(part).for_each(|(s, v)| *s += factor(j) * v);
        }
        for (w, s) in whole.iter().zip(&sum) {
            assert!((w - s).abs() < 1e-12 * (1.0 + w.abs()), "{id}: {w} {s}"); // rounding
        }
    });
}

/// Step of a central difference and its tolerance: truncation h^2, rounding eps/h.
fn near(x: f64) -> f64 {
    1e-6 * x.abs().max(1e-3)
}

#[test]
fn the_partials_of_the_terms_equal_central_differences() {
    each(50, |effect, id, robot, rng| {
        let x = motion(robot, rng);
        let p = parameters(effect, rng);
        let jet = Motion {
            t: x.t.into(),
            alpha: [Jet::variable(x.alpha[0], 0), Jet::variable(x.alpha[1], 1)],
            omega: [Jet::variable(x.omega[0], 2), Jet::variable(x.omega[1], 3)],
            variance: x.variance,
            robot,
        };
        let jets: Vec<Jet> = p
            .iter()
            .enumerate()
            .map(|(k, &v)| if k < DIFFERENTIATED { Dual::variable(v, 4 + k) } else { v.into() })
            .collect();
        let exact = flat(&effect.terms_jet(&jet, &jets));
        let values = flat(&effect.terms(&x, &p));
        assert_eq!(exact.iter().map(|v| v.value).collect::<Vec<_>>(), values, "{id}");
        for slot in 0..4 + p.len() {
            let at = |sign: f64| {
                let (mut x, mut p) = (x, p.clone());
                let place = match slot {
                    0 | 1 => &mut x.alpha[slot],
                    2 | 3 => &mut x.omega[slot - 2],
                    _ => &mut p[slot - 4],
                };
                let h = near(*place);
                *place += sign * h;
                (flat(&effect.terms(&x, &p)), h)
            };
            let ((up, h), (down, _)) = (at(1.0), at(-1.0));
            for (i, (u, d)) in up.iter().zip(&down).enumerate() {
                let difference = (u - d) / (2.0 * h);
                let partial = exact[i].partial.get(slot).copied().unwrap_or(0.0);
                let allowed = 1e-6 * partial.abs() + 1e-15 * (1.0 + u.abs()) / h + 1e-9;
                assert!((difference - partial).abs() < allowed, "{id}, {slot}, {i}");
            }
        }
    });
}

#[test]
fn the_partials_of_the_input_equal_central_differences() {
    each(5, |effect, id, _, rng| {
        let (t, m) = recorded(rng);
        let p = parameters(effect, rng);
        let own: Vec<Own> = p.iter().enumerate().map(|(k, &v)| Dual::variable(v, k % 4)).collect();
        let constant: Vec<[Own; 2]> = m.iter().map(|row| row.map(Own::constant)).collect();
        let (plain, exact) = (effect.input(&t, &m, &p), effect.input_own(&t, &constant, &own));
        assert_eq!(plain.is_some(), effect.acts_on_input(), "{id}");
        let (Some(plain), Some(exact)) = (plain, exact) else { return };
        for j in 0..p.len() {
            let at = |sign: f64| {
                let mut q = p.clone();
                q[j] += sign * near(q[j]);
                effect.input(&t, &m, &q).unwrap()
            };
            let (up, down) = (at(1.0), at(-1.0));
            for k in 0..t.len() {
                for i in 0..2 {
                    assert_eq!(exact[k][i].value, plain[k][i], "{id}");
                    let difference = (up[k][i] - down[k][i]) / (2.0 * near(p[j]));
                    let partial = exact[k][i].partial[j];
                    // rounding eps/h, and a delay whose shift crosses a sample
                    assert!((difference - partial).abs() < 1e-6 * (1.0 + partial.abs()), "{id}");
                }
            }
        }
    });
}

/// The base with one effect at typical values.
fn with(id: &str) -> (Model, Vec<f64>) {
    let base = Model::base(Robot::amigobot());
    let model = if BASE.contains(&id) { base } else { base.add(id).unwrap() };
    let p = model.initial();
    (model, p)
}

#[test]
fn forward_dynamics_undo_inverse_dynamics() {
    each(20, |_, id, robot, rng| {
        let (model, p) = with(id);
        let x = motion(robot, rng);
        let terms = model.terms(&x, &p);
        let wanted = [0, 1].map(|_| rng.random_range(-50.0..50.0));
        let sign = [0, 1, 2, 3].map(|j| crate::math::sgn(along(j, &x.omega)));
        let torque = terms.total_torque(&wanted, &sign);
        let found = crate::simulate::contact(&terms, &torque, &x.omega).unwrap().acceleration;
        assert!(solve_mass(&terms.mass, &[1.0, 1.0]).is_ok(), "{id}");
        for i in 0..2 {
            // condition of the mass matrix below 2, torques near 1 over inertias near 0.03
            assert!((found[i] - wanted[i]).abs() < 1e-12, "{id}: {found:?} {wanted:?}");
        }
    });
}

/// Five seconds with starts, stops and reversals.
fn lively() -> (Vec<f64>, Vec<[f64; 2]>) {
    let t: Vec<f64> = (0..501).map(|k| 0.01 * f64::from(k)).collect();
    let m = t
        .iter()
        .map(|t| [0.35 * (2.1 * t).sin() + 0.05, 0.3 * (1.7 * t + 0.4).sin() * (0.3 * t).cos()])
        .collect();
    (t, m)
}

#[test]
fn an_effect_of_typical_size_shows_in_the_motion() {
    let (t, torque) = lively();
    let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
    let run = |id: &str| {
        let (model, p) = with(id);
        simulate(&model, &p, &input, State::default()).unwrap()
    };
    let base = run("inertia");
    let ids = all().into_iter().map(|effect| effect.id());
    for id in ids.filter(|id| !BASE.contains(&id.as_str())) {
        let motion = run(&id);
        let differences = motion
            .iter()
            .zip(&base)
            .flat_map(|(u, v)| [0, 1].map(|i| (u.omega[i] - v.omega[i]).powi(2)).into_iter());
        let rms = (differences.sum::<f64>() / (2.0 * t.len() as f64)).sqrt();
        // between the resolution of an encoder of 0.02 rad/s over 1000 samples and a diverged simulation
        assert!(rms > 1e-3 && rms < 5.0, "{id}: {rms} rad/s");
    }
}

#[test]
fn sensitivities_of_every_effect_equal_differences_of_the_motion() {
    let (t, torque) = lively();
    let input = Input { t: &t[..120], torque: &torque[..120], hold: Hold::Linear };
    let start = State { alpha: [0.3, -0.1], omega: [3.0, 2.0] };
    // derivatives of a second body are differences of simulations
    for effect in all().into_iter().filter(|effect| effect.change() != Change::TwoMass) {
        let id = effect.id();
        let (model, mut p) = with(&id);
        // a delay of whole samples is not differentiable: choose another value
        p.iter_mut().skip(5).for_each(|v| *v *= 0.93);
        let (_, exact) = simulate_with_sensitivities(&model, &p, &input, start).unwrap();
        for j in 0..p.len() {
            let at = |sign: f64| {
                let mut q = p.clone();
                q[j] += sign * 1e-5 * q[j].abs();
                simulate(&model, &q, &input, start).unwrap()[119].omega
            };
            let (up, down) = (at(1.0), at(-1.0));
            for i in 0..2 {
                // rad/s for a change of the parameter by its own size
                let difference = (up[i] - down[i]) / 2e-5;
                let found = exact.at(119, 2 + i, j) * p[j].abs();
                // truncation, and steps of order h where a clipped input changes its sample
                let allowed = 1e-3 * difference.abs() + 1e-5;
                assert!((found - difference).abs() <= allowed, "{id} {j}: {found} {difference}");
            }
        }
    }
}
