//! Motions from the second simulator: explicit midpoint rule, set-points of a joystick, a PI controller
//! with feed-forward at a sampling rate of its own, motors with a current loop.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::hidden::{Outside, Values};
use super::logger::{EXACT, Exact};
use super::mechanics::{ANGLE, Mechanics, SPEED, State};
use super::robots::Machine;

/// Rates of controllers [Hz].
const CONTROLLERS: [u32; 4] = [100, 200, 250, 500];
/// Steps per unit of the fastest rate; the midpoint rule is stable up to 2.
const STEP: f64 = 0.7;
/// Time constant of the current loop, whose torque is recorded [s].
const CURRENT: f64 = 0.003;
/// Noise of the speeds that the controller measures, as a share of the top speed.
const SEEN: f64 = 5e-4;

/// Set-points of a driver: jumps of a joystick at random times behind a second-order filter.
struct Joystick {
    stick: [f64; 2],
    wanted: [f64; 2],
    rate: [f64; 2],
    bandwidth: f64,
    next: f64,
}

impl Joystick {
    fn new() -> Self {
        Self { stick: [0.0; 2], wanted: [0.0; 2], rate: [0.0; 2], bandwidth: 1.0, next: 0.3 }
    }

    /// Set-points and their derivatives after `step` seconds.
    fn after(&mut self, t: f64, step: f64, end: f64, machine: &Machine, rng: &mut ChaCha8Rng) {
        if t >= self.next {
            self.jump(t, end, machine, rng);
        }
        for i in 0..2 {
            let pull = self.bandwidth * (self.stick[i] - self.wanted[i]) - 2.0 * self.rate[i];
            self.rate[i] += step * self.bandwidth * pull;
            self.wanted[i] += step * self.rate[i];
        }
    }

    fn jump(&mut self, t: f64, end: f64, machine: &Machine, rng: &mut ChaCha8Rng) {
        let before = self.stick;
        let mut size = || machine.speed * rng.random_range(0.1..0.9);
        let (forward, turn) = (size(), 0.6 * size());
        let [ahead, left] = [0, 1].map(|_| if rng.random::<bool>() { 1.0 } else { -1.0 });
        self.stick = match rng.random_range(0..8) {
            _ if t > end - 1.2 => [0.0; 2],
            0 => [0.0; 2],
            1 | 2 => [ahead * forward; 2],
            3 => [left * turn, -left * turn],
            _ => {
                let (v, b) = (ahead * forward, left * turn);
                let most = (v.abs() + b.abs()).max(0.9 * machine.speed) / (0.9 * machine.speed);
                [(v + b) / most, (v - b) / most]
            }
        };
        let change = [0, 1].map(|i| (self.stick[i] - before[i]).abs());
        let change = change[0].max(change[1]).max(0.05 * machine.speed);
        // the peak rate of a critically damped step is its height times bandwidth over e
        let peak = machine.acceleration * rng.random_range(0.3..1.0);
        self.bandwidth = (std::f64::consts::E * peak / change).clamp(1.0, 60.0);
        self.next = t + rng.random_range(0.4..2.0) + 2.0 / self.bandwidth;
    }
}

/// PI controller with feed-forward of friction and of the wheel's inertia, both from the construction data.
struct Controller {
    step: f64,
    gain: f64,
    inertia: f64,
    friction: [f64; 2],
    slow: f64,
    most: f64,
    integral: [f64; 2],
}

impl Controller {
    fn new(machine: &Machine, rng: &mut ChaCha8Rng) -> Self {
        let a = machine.known.parameters();
        let rate = f64::from(CONTROLLERS[rng.random_range(0..CONTROLLERS.len())]);
        let inertia = a.a1 + a.a2.abs();
        Self {
            step: 1.0 / rate,
            gain: inertia * rng.random_range(5.0..10.0),
            inertia: a.a1,
            friction: [a.a4, a.a5],
            slow: 0.05 * machine.speed,
            // the motors were chosen for friction and twice the acceleration
            most: 1.5 * a.a4 + 2.0 * inertia * machine.acceleration,
            integral: [0.0; 2],
        }
    }

    fn command(&mut self, stick: &Joystick, seen: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| {
            let error = stick.wanted[i] - seen[i];
            let forward = self.friction[i] * (stick.wanted[i] / self.slow).tanh()
                + self.inertia * stick.rate[i];
            let command = forward + self.gain * error + self.integral[i];
            // the integral rests where the motor is at its limit
            if command.abs() < self.most {
                self.integral[i] += 2.0 * self.gain * self.step * error;
            }
            command.clamp(-self.most, self.most)
        })
    }
}

/// Effects between the recorded and the acting torque.
struct Actuator {
    gain: f64,
    limit: f64,
    dead: f64,
    lag: f64,
    late: Vec<[f64; 2]>,
    place: usize,
    held: [f64; 2],
}

impl Actuator {
    fn new(values: &Values, step: f64) -> Self {
        let value = |symbol: &str| values.iter().find(|(s, _)| *s == symbol).map(|(_, v)| *v);
        let rows = (value("delay").unwrap_or(0.0) / step).round() as usize;
        Self {
            gain: value("g").unwrap_or(0.0),
            limit: value("limit").unwrap_or(f64::INFINITY),
            dead: value("d").unwrap_or(0.0),
            lag: value("tau").map_or(1.0, |tau| 1.0 - (-step / tau).exp()),
            late: vec![[0.0; 2]; rows],
            place: 0,
            held: [0.0; 2],
        }
    }

    /// The acting torque of the next step.
    fn acting(&mut self, recorded: [f64; 2]) -> [f64; 2] {
        let mut m = recorded;
        if !self.late.is_empty() {
            m = std::mem::replace(&mut self.late[self.place], m);
            self.place = (self.place + 1) % self.late.len();
        }
        for i in 0..2 {
            self.held[i] += self.lag * (m[i] - self.held[i]);
        }
        let m = [(1.0 + self.gain) * self.held[0], self.held[1]];
        m.map(|m| m.clamp(-self.limit, self.limit)).map(|m| m - m.clamp(-self.dead, self.dead))
    }
}

/// Simulates `machine` with hidden effects of these values; `torque`: its usual torque [N m].
pub fn input(
    machine: &Machine,
    values: &Values,
    mut outside: Option<Outside>,
    torque: f64,
    duration: f64,
    seed: u64,
) -> Exact {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let light = Mechanics::new(machine, values, torque);
    let heavy = light.loaded(outside.as_ref().map_or(0.0, Outside::extra_mass));
    let substeps = (heavy.rate() / EXACT / STEP).ceil().max(4.0) as usize;
    let step = 1.0 / EXACT / substeps as f64;
    let mut stick = Joystick::new();
    let mut controller = Controller::new(machine, &mut rng);
    let mut actuator = Actuator::new(values, step);
    let (mut y, mut command, mut motor): (State, _, _) = ([0.0; 9], [0.0; 2], [0.0; 2]);
    let mut exact = Exact::default();
    let every = (controller.step * EXACT).round() as usize;
    for k in 0..=(duration * EXACT) as usize {
        let t = k as f64 / EXACT;
        stick.after(t, 1.0 / EXACT, duration, machine, &mut rng);
        if k % every == 0 {
            let mut noise = || -> f64 { StandardNormal.sample(&mut rng) };
            let seen = [0, 1].map(|i| y[SPEED + i] + SEEN * machine.speed * noise());
            command = controller.command(&stick, seen);
        }
        exact.alpha.push([y[ANGLE], y[ANGLE + 1]]);
        exact.omega.push([y[SPEED], y[SPEED + 1]]);
        exact.torque.push(motor);
        let mechanics = if t > 0.5 * duration { &heavy } else { &light };
        let besides = outside.as_mut().map_or([0.0; 2], |o| {
            let turned = machine.truth.r_m / (2.0 * machine.truth.l1_m) * (y[ANGLE] - y[ANGLE + 1]);
            o.torque(t, 1.0 / EXACT, turned, [y[SPEED], y[SPEED + 1]])
        });
        for n in 0..substeps {
            let now = t + n as f64 * step;
            let follow = 1.0 - (-step / CURRENT).exp();
            let acting = actuator.acting(motor);
            let acting = [acting[0] + besides[0], acting[1] + besides[1]];
            y = midpoint(mechanics, now, step, &y, acting);
            motor = [0, 1].map(|i| motor[i] + follow * (command[i] - motor[i]));
        }
    }
    exact
}

/// One step of the explicit midpoint rule under a constant torque.
fn midpoint(mechanics: &Mechanics, t: f64, step: f64, y: &State, torque: [f64; 2]) -> State {
    let moved = |by: f64, rates: &State| std::array::from_fn(|n| y[n] + by * rates[n]);
    let first = mechanics.rates(t, y, torque);
    let middle: State = moved(0.5 * step, &first);
    moved(step, &mechanics.rates(t + 0.5 * step, &middle, torque))
}

/// Speeds of the second simulator without its controller, at every millisecond, under recorded torques that are
/// linear between the milliseconds, from wheels that turn at `start` [rad/s]: for comparison with other
/// simulators.
pub fn follow(
    machine: &Machine,
    values: &Values,
    torques: &[[f64; 2]],
    start: [f64; 2],
) -> Vec<[f64; 2]> {
    let mechanics = Mechanics::new(machine, values, f64::INFINITY);
    let substeps = (mechanics.rate() / EXACT / STEP).ceil().max(4.0) as usize;
    let step = 1.0 / EXACT / substeps as f64;
    let mut y = mechanics.rolling(start);
    let mut actuator = Actuator::new(values, step);
    (actuator.held, actuator.late) = (torques[0], vec![torques[0]; actuator.late.len()]);
    let mut out = vec![start];
    for (k, pair) in torques.windows(2).enumerate() {
        for n in 0..substeps {
            // the torque of the middle of the step
            let c = (n as f64 + 0.5) / substeps as f64;
            let torque = [0, 1].map(|i| pair[0][i] + c * (pair[1][i] - pair[0][i]));
            let t = k as f64 / EXACT + n as f64 * step;
            y = midpoint(&mechanics, t, step, &y, actuator.acting(torque));
        }
        out.push([y[SPEED], y[SPEED + 1]]);
    }
    out
}
