//! The robots of the benchmark: every preset, and robots drawn over decades of scale.

use amigo_ident::robot::{Construction, Robot, preset, presets};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Standard acceleration of gravity [m/s^2].
pub const GRAVITY: f64 = 9.806_65;
/// Largest relative error of masses, inertias and friction in the construction data that a user has.
const UNKNOWN: f64 = 0.1;

/// A robot and its speed and acceleration limits.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Name in the id of a case.
    pub name: String,
    /// Construction data as a user has them; they are written to the experiment file.
    pub known: Construction,
    /// The simulated robot.
    pub truth: Construction,
    /// Top speed of a wheel [rad/s].
    pub speed: f64,
    /// Largest commanded wheel acceleration [rad/s^2].
    pub acceleration: f64,
}

/// Top speed [rad/s] and acceleration [rad/s^2] of a preset, from data sheets and usual practice.
fn pace(name: &str) -> (f64, f64) {
    match name {
        "amigobot" => (12.0, 12.0),
        "pioneer_3dx" => (12.0, 10.0),
        // 0.22 m/s on wheels of 33 mm
        "turtlebot3_burger" => (6.6, 20.0),
        // 1000 steps/s of 1000 a turn
        "e_puck" => (6.2, 25.0),
        // cleaning speed of 0.3 m/s on wheels of 36 mm
        "create_2" => (8.0, 15.0),
        // 0.9 m/s on wheels of 30 mm
        "regbot" => (30.0, 80.0),
        // 1.15 m/s indoors on wheels of 76 mm
        "frc_tank_drive" => (15.0, 30.0),
        _ => (10.0, 12.0),
    }
}

impl Machine {
    /// The robot of a name: a preset, or `random_K`. `None` for other names.
    pub fn of(name: &str) -> Option<Self> {
        if let Some(number) = name.strip_prefix("random_") {
            return number.parse().ok().map(Self::random);
        }
        let known = preset(name)?.construction;
        let (speed, acceleration) = pace(name);
        Some(Self::built(name, known, speed, acceleration))
    }

    /// The names of all presets.
    pub fn presets() -> Vec<String> {
        presets().into_iter().map(|p| p.name.to_string()).collect()
    }

    /// The K-th random robot: mass from 0.1 to 150 kg and deceleration by friction a4/(a1 + a2) from 1 to
    /// 60 rad/s^2, both spread evenly over their logarithms by multiples of irrational numbers; sizes
    /// with the cube root of the mass; speeds with the root of gravity times wheel radius (Froude).
    pub fn random(number: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(0x5eed_0000 + number);
        let spread = |irrational: f64| (0.5 + number as f64 * irrational).fract();
        let mass = 0.1 * 1500_f64.powf(spread(0.618_033_988_749_895));
        let deceleration = 60_f64.powf(spread(std::f64::consts::SQRT_2));
        let l1 = 0.12 * (mass / 5.0_f64).cbrt() * rng.random_range(0.8..1.3);
        let r = l1 * rng.random_range(0.25..0.7);
        let wheel = mass * rng.random_range(0.02..0.08);
        let frame = mass - 2.0 * wheel;
        let (length, width) =
            (2.0 * l1 * rng.random_range(0.8..1.6), 2.0 * l1 * rng.random_range(0.7..1.0));
        let l2 = l1 * rng.random_range(-0.5..0.5);
        // the caster is on the side of the centre of mass and carries what the weight tips onto it
        let l5 = 0.9 * l1 * if l2 < 0.0 { -1.0 } else { 1.0 };
        let load = frame * GRAVITY * l2 / l5;
        let on_a_wheel = 0.5 * (mass * GRAVITY - load);
        let disc = 0.5 * wheel * r * r;
        // a motor behind a gear turns with more inertia than the wheel, or with next to none
        let gear = disc * 0.05 * 100_f64.powf(rng.random_range(0.0..1.0));
        let mut known = Construction {
            l1_m: l1,
            l2_m: l2,
            l3_m: 0.0,
            l4_m: 0.0,
            l5_m: l5,
            r_m: r,
            r3_m: 0.0,
            m1_kg: wheel,
            m2_kg: wheel,
            m3_kg: 0.0,
            m4_kg: frame,
            ix1_kg_m2: 0.5 * disc,
            ix3_kg_m2: 0.0,
            iz1_kg_m2: disc + gear,
            iz3_kg_m2: 0.0,
            iz4_kg_m2: frame * (length * length + width * width) / 12.0,
            n1_n: on_a_wheel,
            n2_n: on_a_wheel,
            n3_n: load,
            f1_m: 0.0,
            f2_m: 0.0,
            f3_m: 0.0,
        };
        let a = known.parameters();
        let arm = deceleration * (a.a1 + a.a2) / on_a_wheel;
        (known.f1_m, known.f2_m) = (arm, arm);
        let speed = rng.random_range(0.3..1.2) * (GRAVITY * r).sqrt() / r;
        let acceleration = speed / rng.random_range(0.25..1.0);
        Self::built(&format!("random_{number}"), known, speed, acceleration)
    }

    /// A robot that differs from its construction data by up to 10 %, by the same amounts each time.
    fn built(name: &str, known: Construction, speed: f64, acceleration: f64) -> Self {
        let number = name.bytes().fold(7_u64, |h, b| h.wrapping_mul(31).wrapping_add(u64::from(b)));
        let mut rng = ChaCha8Rng::seed_from_u64(number);
        let mut about = |value: f64| value * rng.random_range(1.0 - UNKNOWN..1.0 + UNKNOWN);
        let wheel = about(known.m1_kg);
        let truth = Construction {
            m1_kg: wheel,
            m2_kg: wheel,
            m4_kg: about(known.m4_kg),
            ix1_kg_m2: about(known.ix1_kg_m2),
            iz1_kg_m2: about(known.iz1_kg_m2),
            iz4_kg_m2: about(known.iz4_kg_m2),
            f1_m: about(known.f1_m),
            f2_m: about(known.f2_m),
            ..known.clone()
        };
        Self { name: name.into(), known, truth, speed, acceleration }
    }

    /// The simulated robot.
    pub fn robot(&self) -> Robot {
        Robot::new(self.name.clone(), self.truth.clone()).expect("a machine can be built")
    }

    /// Deceleration by friction a4/(a1 + a2) [rad/s^2].
    pub fn deceleration(&self) -> f64 {
        let a = self.truth.parameters();
        a.a4 / (a.a1 + a.a2)
    }

    /// Total mass [kg].
    pub fn mass(&self) -> f64 {
        self.truth.m1_kg + self.truth.m2_kg + self.truth.m4_kg
    }
}
