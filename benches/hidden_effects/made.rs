//! Recordings of a case: simulated at the controller's 1 kHz, then sampled, disturbed and
//! quantised here.

use amigo_ident::model::Model;
use amigo_ident::recording::{Channels, DriveUnit, Recording};
use amigo_ident::robot::kinematics::heading;
use amigo_ident::robot::{Robot, State};
use amigo_ident::simulate::{Movement, NoiseLevel, Recorder, record_disturbed};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::cases::{Case, HIDDEN, Stranger, World};

/// Recordings to fit; one more is held out.
const TRAIN: u64 = 4;
/// Length of a recording [s].
const DURATION: f64 = 25.0;
/// Rate of the speed controller [Hz].
const CONTROL: f64 = 1000.0;
/// Ticks a turn of the encoders.
const TICKS: f64 = 9550.0;
/// Size of what is outside the catalogue [N m], a tenth to a fifth of the moments.
const STRANGE: f64 = 0.03;

/// The recordings to fit and the one held out.
pub(crate) fn recordings(case: &Case) -> (Vec<Recording>, Recording) {
    let model = Model::with_effects(Robot::amigobot(), &case.hidden).expect("registered effects");
    let p = parameters(&model, case);
    let mut all: Vec<Recording> = (0..=TRAIN).map(|r| one(case, &model, &p, r)).collect();
    let held_out = all.pop().expect("five recordings");
    (all, held_out)
}

fn parameters(model: &Model, case: &Case) -> Vec<f64> {
    let mut p = model.initial();
    for (j, parameter) in model.parameters().iter().enumerate() {
        let Some((_, values)) = HIDDEN
            .iter()
            .find(|(id, _)| parameter.effect == *id && case.hidden.iter().any(|h| h == id))
        else {
            continue;
        };
        let symbol = parameter.spec.symbol.as_str();
        let value = values.iter().find(|(s, _)| *s == symbol).map(|v| v.1);
        let value = value.unwrap_or(parameter.spec.typical);
        p[j] = match symbol {
            "limit" => value * case.size.powf(-0.35),
            "ws" | "tw" | "n" | "dt" => value,
            // the stiffer, the smaller the effect
            "cs" | "kt" => value / case.size,
            _ => value * case.size,
        };
    }
    p
}

fn one(case: &Case, model: &Model, p: &[f64], r: u64) -> Recording {
    let movement = match case.world {
        World::Paper => Movement::paper(),
        _ => Movement::rich(model.robot(), case.seed * 10 + r, DURATION, 12.0),
    };
    let noise = NoiseLevel { alpha: 0.0, dalpha: 0.0, moment: 0.0 };
    let recorder = Recorder { rate: CONTROL, control_rate: CONTROL, noise, ticks: None, seed: 0 };
    let mut rng = ChaCha8Rng::seed_from_u64(case.seed * 1000 + r);
    let mut strange = strange(case.stranger, model, p, &movement, &mut rng);
    let exact = record_disturbed("made", model, p, &movement, &recorder, &mut *strange)
        .expect("the truth can move");
    logged(case, &exact, &mut rng)
}

/// What the logger writes of the exact motion.
fn logged(case: &Case, exact: &Recording, rng: &mut ChaCha8Rng) -> Recording {
    let mut normal = || -> f64 { StandardNormal.sample(rng) };
    let noise = case.noise();
    let every = if case.world == World::Slow { 20 } else { 10 };
    let late = if case.world == World::Skewed { every / 2 } else { 0 };
    let encoder = matches!(case.world, World::Quantised | World::Differenced);
    let tick = std::f64::consts::TAU / TICKS;
    let mut drift = [0.0; 2];
    let (mut alpha, mut omega) = (Vec::new(), Vec::new());
    let mut channels = Channels::default();
    for k in (late..exact.len()).step_by(every) {
        channels.t.push(exact.t()[k]);
        alpha.push(exact.alpha()[k].map(|a| match encoder {
            true => (a / tick).round() * tick,
            false => a + noise.alpha * normal(),
        }));
        omega.push(exact.omega()[k].map(|w| w + noise.dalpha * normal()));
        drift = drift.map(|d| match case.world {
            World::Autocorrelated => 0.95 * d + (1.0 - 0.95_f64.powi(2)).sqrt() * normal(),
            _ => normal(),
        });
        let moment = exact.moment()[k - late];
        channels.moment.push([0, 1].map(|i| moment[i] + noise.moment * drift[i]));
    }
    channels.alpha = Some(alpha);
    channels.omega = (case.world != World::Differenced).then_some(omega);
    Recording::new("made", channels, DriveUnit::NewtonMetre)
        .expect("a made recording has increasing time and finite values")
}

type Disturbance<'a> = Box<dyn FnMut(f64, &State) -> [f64; 2] + 'a>;

/// Moments on the wheels that no effect of the catalogue makes.
fn strange<'a>(
    kind: Option<Stranger>,
    model: &'a Model,
    p: &'a [f64],
    movement: &'a Movement,
    rng: &mut ChaCha8Rng,
) -> Disturbance<'a> {
    let robot = model.robot();
    // friction in the direction of motion, smooth near rest so that a step of 1 ms can hold it
    let against = |w: f64| -(w / 0.2).tanh();
    match kind {
        None => Box::new(|_, _| [0.0; 2]),
        Some(Stranger::Carpet) => Box::new(move |_, s| {
            let wave = (2.0 * heading(robot, s.alpha)).cos();
            s.omega.map(|w| STRANGE * wave * against(w))
        }),
        Some(Stranger::Resonance) => Box::new(move |_, s| {
            s.omega.map(|w| STRANGE * against(w) * (-((w.abs() - 6.0) / 1.5).powi(2)).exp())
        }),
        Some(Stranger::Hysteresis) => {
            let mut bent = [0.0_f64; 2];
            Box::new(move |_, s| {
                for (z, w) in bent.iter_mut().zip(s.omega) {
                    *z += (w - w.abs() * *z) / CONTROL;
                }
                bent.map(|z| -STRANGE * z)
            })
        }
        Some(Stranger::Payload) => Box::new(move |t, s| {
            if t < 0.5 * DURATION {
                return [0.0; 2];
            }
            let acceleration = movement.reference(robot, t).acceleration;
            let inertia = [
                p[0] * acceleration[0] + p[1] * acceleration[1],
                p[1] * acceleration[0] + p[0] * acceleration[1],
            ];
            let friction = [p[3], p[4]];
            [0, 1].map(|i| 0.25 * (friction[i] * against(s.omega[i]) - inertia[i]))
        }),
        Some(Stranger::Bumps) => {
            let times: Vec<f64> = (0..12).map(|_| rng.random_range(1.0..DURATION)).collect();
            Box::new(move |t, s| {
                let on = times.iter().any(|at| (t - at).abs() < 0.15);
                s.omega.map(|w| if on { 2.0 * STRANGE * against(w) } else { 0.0 })
            })
        }
    }
}
