//! Motions from the program's own simulator.

use amigo_ident::model::Model;
use amigo_ident::robot::Robot;
use amigo_ident::robot::kinematics::heading;
use amigo_ident::simulate::{Movement, NoiseLevel, Recorder, Segment, record_disturbed};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::hidden::{Outside, Values};
use super::logger::{EXACT, Exact};
use super::robots::Machine;

/// Segments up to the speed and acceleration of the robot: straights, curves, pivots, reversals, rests.
fn movement(machine: &Machine, rng: &mut ChaCha8Rng, duration: f64) -> Movement {
    let (r, l1) = (machine.truth.r_m, machine.truth.l1_m);
    let rest = |blend_s, hold_s| Segment { speed_m_s: 0.0, turn_rad_s: 0.0, blend_s, hold_s };
    let mut segments = vec![rest(0.0, 0.3)];
    let (mut time, mut before) = (0.3, [0.0_f64; 2]);
    while time < duration - 1.5 {
        let mut speed = || machine.speed * rng.random_range(0.15..0.95);
        let (one, other) = (speed(), speed());
        let side = if rng.random::<bool>() { 1.0 } else { -1.0 };
        let w = match rng.random_range(0..10) {
            0 => [0.0; 2],
            1 | 2 => [side * one; 2],
            3 | 4 => [side * one, -side * one],
            5 | 6 => [side * one, -side * other],
            _ => [side * one, side * other],
        };
        let change = (w[0] - before[0]).abs().max((w[1] - before[1]).abs());
        // the peak rate of a quintic blend is 1.875 times its mean
        let rate = machine.acceleration * rng.random_range(0.3..1.0);
        let blend_s = (1.875 * change / rate).max(0.1);
        let hold_s = rng.random_range(0.2..1.5);
        let (speed_m_s, turn_rad_s) = (0.5 * r * (w[0] + w[1]), 0.5 * r / l1 * (w[0] - w[1]));
        segments.push(Segment { speed_m_s, turn_rad_s, blend_s, hold_s });
        time += blend_s + hold_s;
        before = w;
    }
    segments.push(rest((1.875 * machine.speed / machine.acceleration).max(0.3), 0.3));
    Movement { segments }
}

/// Simulates `robot` with hidden `effects`: exact stick and slip under a controller at 1 kHz
/// that uses the construction data of the robot.
pub fn input(
    machine: &Machine,
    robot: Robot,
    effects: &[(String, Values)],
    mut outside: Option<Outside>,
    duration: f64,
    seed: u64,
) -> Result<Exact, String> {
    let ids: Vec<&str> = effects.iter().map(|(id, _)| id.as_str()).collect();
    let model = Model::with_effects(robot.clone(), &ids).map_err(|e| e.to_string())?;
    let mut p = model.initial();
    for (id, values) in effects {
        for (j, parameter) in model.parameters().iter().enumerate() {
            let own = values.iter().find(|(symbol, _)| *symbol == parameter.spec.symbol);
            if let (true, Some((_, value))) = (parameter.effect == *id, own) {
                p[j] = *value;
            }
        }
    }
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let movement = movement(machine, &mut rng, duration);
    let noise = NoiseLevel::default();
    let recorder = Recorder { rate: EXACT, control_rate: EXACT, noise, ticks: None, seed };
    let a = robot.parameters();
    let mut disturbance = |t: f64, state: &amigo_ident::robot::State| {
        let Some(outside) = outside.as_mut() else { return [0.0; 2] };
        let mut torque = outside.torque(t, 1.0 / EXACT, heading(&robot, state.alpha), state.omega);
        // the load of the second half: inertia by the acceleration that is wanted, and friction
        let extra = if t > 0.5 * duration { outside.extra_mass() } else { 0.0 };
        let [d1, d2] = movement.reference(&robot, t).acceleration;
        let inertia = [a.a1 * d1 + a.a2 * d2, a.a2 * d1 + a.a1 * d2];
        for i in 0..2 {
            let dry = [a.a4, a.a5][i] * (state.omega[i] / (0.02 * machine.speed)).tanh();
            torque[i] -= extra * (inertia[i] + dry);
        }
        torque
    };
    let made = record_disturbed("exact", &model, &p, &movement, &recorder, &mut disturbance)
        .map_err(|e| e.to_string())?;
    Ok(Exact {
        alpha: made.alpha().to_vec(),
        omega: made.omega().to_vec(),
        torque: made.torque().to_vec(),
    })
}
