//! Models with every kind of operation, written for other languages, and what their functions are compared with.

use std::process::Command;
use std::sync::Arc;

use amigo_ident::effects::{self, Custom, CustomDefinition, Motion, ParameterSpec, Terms};
use amigo_ident::export::{FuzzyIdentified, Identified, files, fuzzy_files};
use amigo_ident::model::Model;
use amigo_ident::recording::DriveUnit;
use amigo_ident::robot::{Robot, State};
use amigo_ident::simulate::{
    Consequents, Defuzzification, Dynamics, FuzzyDynamics, Hold, Input, PhysicalDynamics,
    Structure, TakagiSugeno, contact,
};

use crate::support::Folder;

/// Every kind of operation: products, cosines, bells, kinks of the input, whole orders, powers.
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
    "actuator_lag",
    // behind the lag, where the order matters; a delay commutes with it
    "torque_saturation",
    "actuator_delay",
    "backlash_deadzone",
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

/// The effects of the catalogue that no other of these models has.
fn others() -> Model {
    let base = Model::base(Robot::amigobot());
    let known = [base.effect_ids(), EFFECTS.map(String::from).to_vec()].concat();
    let left =
        effects::all().into_iter().map(|effect| effect.id()).filter(|id| !known.contains(id));
    // two second bodies cannot be in one model
    left.filter(|id| !matches!(id.as_str(), "wheel_slip" | "compliance"))
        .fold(base, |model, id| model.add(&id).unwrap())
}

/// Two-mass drivetrains with effects on wheels, body and input; the slip relaxes within 0.3 ms, which takes
/// shorter steps than 1 ms.
fn two_mass() -> Vec<Model> {
    let with = |id: &str| {
        let others = ["viscous_friction", "turning_scrub", "slope", "lateral_com", "actuator_lag"];
        let model = Model::with_effects(Robot::amigobot(), &[&[id], &others[..]].concat()).unwrap();
        let (symbol, value) = if id == "wheel_slip" { ("cs", 3.0) } else { ("kt", 5.0) };
        model.starting_at(model.index_of(symbol).unwrap(), value)
    };
    vec![with("wheel_slip"), with("compliance")]
}

/// A fuzzy system that brakes in proportion to the speed, with a wave over the rules, beyond whose range the
/// speeds reach.
fn fuzzy(consequents: Consequents) -> FuzzyDynamics {
    let average = Defuzzification::WeightedAverage;
    let mut system = TakagiSugeno::uniform(6, [(-5.0, 5.0); 2], consequents, average);
    let terms = system.parameters().len() / (2 * system.rules());
    let value = |k: usize| {
        let (output, rule) = (k / (terms * system.rules()), k / terms % system.rules());
        let braking =
            if k.is_multiple_of(terms) { -2.0 * system.centre(rule)[output] } else { 0.0 };
        braking + 0.3 * (1.3 * k as f64).sin()
    };
    let values: Vec<f64> = (0..system.parameters().len()).map(value).collect();
    system.set_parameters(&values);
    FuzzyDynamics::new(system, [[30.0, 2.0], [2.5, 28.0]], 1.0, Structure::Parallel, &[])
}

/// What is written as a function.
pub(crate) enum Exported {
    Physical(Model),
    Fuzzy(FuzzyDynamics),
}

/// All models that every language runs.
pub(crate) fn models() -> Vec<Exported> {
    let physical = std::iter::once(model()).chain(two_mass()).map(Exported::Physical);
    let fuzzy = [Consequents::Constant, Consequents::Affine].map(fuzzy).map(Exported::Fuzzy);
    physical.chain(fuzzy).chain([Exported::Physical(others())]).collect()
}

impl Exported {
    fn files(&self) -> Vec<(String, String)> {
        match self {
            Self::Physical(model) => written(model),
            Self::Fuzzy(dynamics) => fuzzy_files(&FuzzyIdentified {
                dynamics,
                robot: "made",
                drive_unit: DriveUnit::NewtonMetre,
                hold: Hold::Linear,
                experiment: "made",
                method: "fuzzy_gradient",
            }),
        }
    }

    fn dynamics(&self) -> Box<dyn Dynamics> {
        match self {
            Self::Physical(model) => {
                Box::new(PhysicalDynamics { model: model.clone(), p: model.initial() })
            }
            Self::Fuzzy(fuzzy) => Box::new(fuzzy.clone()),
        }
    }

    /// The acceleration at t, alpha1, alpha2, omega1, omega2 under M1, M2.
    fn acceleration(&self, s: &[f64; 7]) -> [f64; 2] {
        let dynamics = self.dynamics();
        // one row: a lag and a delay see it as held for long
        let acting = dynamics.input(&[0.0], &[[s[5], s[6]]])[0];
        let state = State { alpha: [s[1], s[2]], omega: [s[3], s[4]] };
        match self {
            Self::Physical(model) => acceleration(model, &model.initial(), s[0], &state, &acting),
            Self::Fuzzy(_) => dynamics.acceleration(s[0], &state, &acting).unwrap(),
        }
    }

    /// By how much a simulation may differ [rad, rad/s].
    fn tolerance(&self) -> f64 {
        match self {
            // signs are held over a step and a reversal is placed by a secant: measured 3e-4 rad/s at the
            // step of 1 ms, 2e-5 at 0.25 ms, 3e-6 at 0.1 ms
            Self::Physical(_) => 1e-3,
            // Runge-Kutta at 1 ms and at 2 ms, with kinks at the edges of the range
            Self::Fuzzy(_) => 1e-6,
        }
    }
}

pub(crate) fn written(model: &Model) -> Vec<(String, String)> {
    let parameters = model.parameters();
    let units: Vec<String> = parameters.iter().map(|p| p.spec.unit.clone()).collect();
    files(&Identified {
        model,
        values: &model.initial(),
        std_errors: &vec![1e-3; parameters.len()],
        units: &units,
        drive_unit: DriveUnit::NewtonMetre,
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

/// Samples of [`input`].
const SAMPLES: i32 = 3001;

/// t, M1, M2: starts, stops, reversals and rest over 6 s at 500 Hz.
pub(crate) fn input() -> Vec<[f64; 3]> {
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

pub(crate) fn prepared(model: &Exported, main: &str, text: &str) -> Folder {
    let folder = Folder::new();
    for (name, text) in model.files() {
        folder.write(&name, text);
    }
    folder.write(main, text);
    folder.write("states.txt", table(&states())).write("drive.txt", table(&input()));
    folder
}

/// The acceleration of the wheels from a state in which a second body moves with them, if there is one: the rotors
/// then are all the mass, and what acts on the body does not act on them.
fn acceleration(model: &Model, p: &[f64], t: f64, state: &State, acting: &[f64; 2]) -> [f64; 2] {
    let (alpha, omega) = (state.alpha, state.omega);
    let x = Motion::at(t, alpha, omega, model.robot());
    let all = model.terms(&x, p);
    let of = |e: usize| model.effects()[e].coupling(&x, &p[model.slots(e)]);
    let Some(coupling) = model.coupling_effect().and_then(of) else {
        return contact(&all, acting, &omega).unwrap().acceleration;
    };
    let rotor = coupling.rotor_within(&all.mass);
    let mut wheels = Terms::zero();
    for (e, effect) in model.effects().iter().enumerate() {
        if !effect.energy().of_the_body() {
            wheels.add(&effect.terms(&x, &p[model.slots(e)]));
        }
    }
    wheels.mass = [rotor, 0.0, rotor];
    contact(&wheels, acting, &omega).unwrap().acceleration
}

/// What a language printed, against the program's own.
pub(crate) fn agrees(language: &str, model: &Exported, printed: &str) {
    let rows: Vec<Vec<f64>> = printed
        .lines()
        .map(|line| line.split_whitespace().map(|word| word.parse().unwrap()).collect())
        .collect();
    let (states, input) = (states(), input());
    assert_eq!(rows.len(), states.len() + input.len(), "{language}");
    let mut worst = 0.0_f64;
    for (s, found) in states.iter().zip(&rows) {
        let expected = model.acceleration(s);
        let size = expected[0].hypot(expected[1]).max(1.0);
        for i in 0..2 {
            worst = worst.max((found[i] - expected[i]).abs() / size);
        }
    }
    // the same operations in the same order; exp, sin and pow differ in the last bit
    assert!(worst < 1e-12, "{language}: accelerations off by {worst:e}");
    let t: Vec<f64> = input.iter().map(|r| r[0]).collect();
    let torque: Vec<[f64; 2]> = input.iter().map(|r| [r[1], r[2]]).collect();
    let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
    let motion = model.dynamics().simulate(&input, State::default()).unwrap();
    let mut off = [0.0_f64; 2];
    for (state, found) in motion.iter().zip(&rows[states.len()..]) {
        for i in 0..2 {
            off[0] = off[0].max((found[i] - state.alpha[i]).abs());
            off[1] = off[1].max((found[2 + i] - state.omega[i]).abs());
        }
    }
    if matches!(model, Exported::Physical(_)) {
        let still = motion.iter().filter(|s| s.omega == [0.0; 2]).count();
        assert!((10..2000).contains(&still), "the input holds {still} samples of rest");
    }
    println!(
        "{language}: accelerations {worst:.1e}, angles {:.1e} rad, speeds {:.1e} rad/s",
        off[0], off[1]
    );
    let most = model.tolerance();
    assert!(off[0] < most && off[1] < most, "{language}: simulation off by {off:?}");
}
