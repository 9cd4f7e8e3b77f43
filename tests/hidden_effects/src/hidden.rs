//! Hidden effects: parameters that give a stated size, and torques that no effect of the catalogue produces.

use amigo_ident::robot::Construction;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

use super::case::Size;
use super::logger::{EXACT, Exact};
use super::robots::Machine;

/// Effects of the catalogue that may be hidden; of effects with equal equations only one.
pub const EFFECTS: [&str; 25] = [
    "viscous_friction",
    "viscous_friction_1",
    "viscous_friction_2",
    "viscous_asymmetry",
    "torque_offset",
    "stribeck",
    "quadratic_drag",
    "slope",
    "turning_scrub",
    "yaw_viscous",
    "caster_drag",
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
    "sliding_caster",
];

/// Effects outside the catalogue.
pub const OUTSIDE: [&str; 5] = ["carpet", "resonance", "hysteresis", "load_change", "bumps"];

/// Root mean squares of a motion, which scale the effects.
#[derive(Clone, Debug)]
pub struct Extent {
    /// Torque [N m].
    pub torque: f64,
    /// Wheel speed [rad/s].
    speed: f64,
    /// Its square [rad^2/s^2].
    square: f64,
    /// Wheel acceleration, means over 20 ms [rad/s^2].
    acceleration: f64,
    /// Difference of the wheel speeds [rad/s].
    turning: f64,
    /// Difference of their squares [rad^2/s^2].
    lateral: f64,
    /// Magnitudes of the torques in ascending order [N m].
    magnitudes: Vec<f64>,
    /// Length [s].
    duration: f64,
}

impl Extent {
    /// The extent of a simulated motion.
    pub fn of(exact: &Exact) -> Self {
        let rms = |values: &mut dyn Iterator<Item = f64>| {
            let (sum, n) = values.fold((0.0, 0.0), |(s, n), v| (s + v * v, n + 1.0));
            (sum / f64::max(n, 1.0)).sqrt()
        };
        let w = || exact.omega.iter();
        let step = (0.02 * EXACT) as usize;
        let far = exact.omega.iter().skip(step);
        let slope = |(a, b): (&[f64; 2], &[f64; 2])| (b[0] - a[0]) * EXACT / step as f64;
        let mut magnitudes: Vec<f64> = exact.torque.iter().flatten().map(|m| m.abs()).collect();
        magnitudes.sort_by(f64::total_cmp);
        Self {
            torque: rms(&mut exact.torque.iter().flatten().copied()),
            speed: rms(&mut w().flatten().copied()),
            square: rms(&mut w().flatten().map(|w| w * w)),
            acceleration: rms(&mut w().zip(far).map(slope)),
            turning: rms(&mut w().map(|w| w[0] - w[1])),
            lateral: rms(&mut w().map(|w| w[0] * w[0] - w[1] * w[1])),
            magnitudes,
            duration: exact.omega.len() as f64 / EXACT,
        }
    }

    /// Quantile of the torque magnitude [N m].
    fn quantile(&self, share: f64) -> f64 {
        let last = self.magnitudes.len() - 1;
        self.magnitudes[(share * last as f64) as usize]
    }
}

/// Values of the parameters of a hidden effect, by their symbols in the catalogue.
pub type Values = Vec<(&'static str, f64)>;

/// The parameters of `effect` on a robot whose healthy motion has this extent: its root mean square torque is
/// the size's share of that of the input, within the physical limits. Times of lags, springs and slip are
/// those of usual hardware. Effects on both wheels differ between them.
pub fn values(
    effect: &str,
    size: Size,
    machine: &Machine,
    extent: &Extent,
    rng: &mut ChaCha8Rng,
) -> Values {
    let share = size.share() * rng.random_range(0.85..1.15);
    let torque = share * extent.torque;
    let a = machine.truth.parameters();
    let (inertia, smallest) = (a.a1 + a.a2, (a.a1 - a.a2).min(a.a1 + a.a2));
    let side = if rng.random::<bool>() { 1.0 } else { -1.0 };
    let uneven = rng.random_range(0.6..0.9);
    let of = |weak: f64, moderate: f64, strong: f64| match size {
        Size::Weak => weak,
        Size::Moderate => moderate,
        Size::Strong => strong,
    };
    let root = std::f64::consts::SQRT_2;
    match effect {
        "viscous_friction" => vec![("b", torque / extent.speed)],
        "viscous_friction_1" => vec![("b1", root * torque / extent.speed)],
        "viscous_friction_2" => vec![("b2", root * torque / extent.speed)],
        "viscous_asymmetry" => {
            let ba = side * torque / extent.speed;
            vec![("ba1", ba), ("ba2", -uneven * ba)]
        }
        "torque_offset" => vec![("o1", side * torque), ("o2", uneven * torque)],
        // slow rows are few
        "stribeck" => {
            let exponent = if rng.random::<bool>() { 1.0 } else { 2.0 };
            let (level, speed) = (3.0 * torque, 0.15 * machine.speed);
            vec![("fs", level), ("ws", speed), ("fsd", 0.0), ("fse", exponent)]
        }
        "quadratic_drag" => vec![("c", torque / extent.square)],
        "slope" => {
            let heading = rng.random_range(0.0..std::f64::consts::TAU);
            let c = &machine.truth;
            let lever = c.l2_m / c.l1_m * c.m4_kg / (c.m4_kg + c.m1_kg + c.m2_kg);
            let along = [heading.cos(), heading.sin()].map(|along| root * torque * along);
            vec![("g_c", along[0]), ("g_s", along[1]), ("k_g", lever)]
        }
        "turning_scrub" => vec![("f_t", torque)],
        "yaw_viscous" => vec![("d_y", torque / extent.turning)],
        "caster_drag" => vec![("f_c", torque)],
        "sliding_caster" => vec![("f_k", torque), ("d_k", rng.random_range(0.6..1.6))],
        // not farther to the side than a quarter of the smallest inertia
        "lateral_com" => {
            vec![("m", side * (torque / extent.acceleration).min(0.25 * smallest))]
        }
        // worn by a twelfth at most
        "wheel_radius_mismatch" => {
            let own = 2.0 * (a.a1 - machine.truth.iz1_kg_m2);
            vec![("eps", side * (torque / (own * extent.acceleration)).min(0.08))]
        }
        "actuator_lag" => vec![("tau", of(0.01, 0.02, 0.05))],
        "actuator_delay" => vec![("delay", of(0.01, 0.02, 0.05))],
        "torque_gain" => vec![("g", side * root * share)],
        "torque_saturation" => vec![("limit", extent.quantile(of(0.97, 0.9, 0.75)))],
        "backlash_deadzone" => vec![("d", torque)],
        "torque_ripple" => {
            let order = rng.random_range(3..13);
            let mut out = waves(["rs1", "rc1", "rs2", "rc2"], root * torque, uneven, rng);
            out.push(("n", f64::from(order)));
            out
        }
        "wheel_eccentricity" => waves(["es1", "ec1", "es2", "ec2"], root * torque, uneven, rng),
        "friction_warmup" => {
            vec![("fw", 2.0 * torque), ("tw", 0.3 * extent.duration), ("fwd", 0.0)]
        }
        // the inner wheel keeps a level above zero
        "load_transfer_friction" => {
            let most = 0.9 * a.a4.min(a.a5) / (machine.speed * machine.speed);
            vec![("cl", (torque / extent.lateral).min(most))]
        }
        "wheel_slip" => {
            let gear = gear(smallest, uneven);
            let reduced = gear * inertia / (gear + inertia);
            vec![("cs", reduced / of(0.01, 0.025, 0.06)), ("jw", gear)]
        }
        "compliance" => {
            let (gear, rate) = (gear(smallest, uneven), of(45.0, 25.0, 14.0));
            let reduced = gear * inertia / (gear + inertia);
            vec![("kt", reduced * rate * rate), ("dt", 0.2 * reduced * rate), ("jr", gear)]
        }
        _ => vec![],
    }
}

/// Sine and cosine amplitudes of both wheels.
fn waves(symbols: [&'static str; 4], amplitude: f64, uneven: f64, rng: &mut ChaCha8Rng) -> Values {
    let phases = [0, 1].map(|_| rng.random_range(0.0..std::f64::consts::TAU));
    let sizes = [amplitude, uneven * amplitude];
    let value = |n: usize| match n % 2 {
        0 => sizes[n / 2] * phases[n / 2].cos(),
        _ => sizes[n / 2] * phases[n / 2].sin(),
    };
    symbols.into_iter().enumerate().map(|(n, symbol)| (symbol, value(n))).collect()
}

/// Inertia of motor and gear in front of a spring or a slipping wheel [kg m^2]: about half of the rest.
fn gear(smallest: f64, uneven: f64) -> f64 {
    0.6 * uneven * smallest
}

/// The construction data with motor and gear of a two-mass drivetrain added.
pub fn with_gear(truth: &Construction, values: &Values) -> Construction {
    let gear = values.iter().find(|(symbol, _)| matches!(*symbol, "jw" | "jr"));
    Construction { iz1_kg_m2: truth.iz1_kg_m2 + gear.map_or(0.0, |(_, j)| *j), ..truth.clone() }
}

/// Torques on the wheels that no effect of the catalogue describes.
pub struct Outside {
    kind: String,
    /// Size [N m].
    level: f64,
    /// Speed below which friction decreases [rad/s].
    slow: f64,
    /// Top speed [rad/s].
    top: f64,
    bent: [f64; 2],
    times: Vec<f64>,
}

impl Outside {
    /// `None` where no such effect is hidden.
    pub fn of(
        hidden: &[String],
        size: Size,
        machine: &Machine,
        extent: &Extent,
        rng: &mut ChaCha8Rng,
    ) -> Option<Self> {
        let kind = hidden.iter().find(|h| OUTSIDE.contains(&h.as_str()))?.clone();
        let count = (extent.duration / 2.0) as usize;
        let times = (0..count).map(|_| rng.random_range(1.0..extent.duration)).collect();
        let level = std::f64::consts::SQRT_2 * size.share() * extent.torque;
        let (slow, top) = (0.02 * machine.speed, machine.speed);
        Some(Self { kind, level, slow, top, bent: [0.0; 2], times })
    }

    /// Mass added in the second half, as a share of the mass.
    pub fn extra_mass(&self) -> f64 {
        if self.kind == "load_change" { 0.25 } else { 0.0 }
    }

    /// Torques of the next `step` seconds [N m], without that of the added mass.
    pub fn torque(&mut self, t: f64, step: f64, heading: f64, w: [f64; 2]) -> [f64; 2] {
        let against = |w: f64| -(w / self.slow).tanh();
        match self.kind.as_str() {
            // friction that changes twice in a turn of the heading, as on a carpet with a nap
            "carpet" => w.map(|w| self.level * (2.0 * heading).cos() * against(w)),
            // drag in a band of wheel speeds
            "resonance" => w.map(|w| {
                let away = (w.abs() - 0.5 * self.top) / (0.12 * self.top);
                2.0 * self.level * against(w) * (-away * away).exp()
            }),
            // friction that builds up over a radian of travel
            "hysteresis" => {
                for (z, w) in self.bent.iter_mut().zip(w) {
                    *z += step * (w - w.abs() * *z);
                }
                self.bent.map(|z| -self.level * z)
            }
            // short resistances at random times
            "bumps" => {
                let on = self.times.iter().any(|at| (t - at).abs() < 0.15);
                w.map(|w| if on { 2.0 * self.level * against(w) } else { 0.0 })
            }
            _ => [0.0; 2],
        }
    }
}
