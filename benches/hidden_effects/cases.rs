//! What is hidden, how large, and under which conditions it is recorded.

use std::fmt;

use amigo_ident::effects::find;
use amigo_ident::simulate::NoiseLevel;

/// Hidden effects at moderate size: parameters that make an effect of some 5-10 % of the moment.
pub(crate) const HIDDEN: [(&str, &[(&str, f64)]); 23] = [
    ("viscous_friction", &[("b", 2e-3)]),
    ("viscous_friction_1", &[("b1", 2e-3)]),
    ("viscous_friction_2", &[("b2", 2e-3)]),
    ("torque_offset", &[("o1", 0.012), ("o2", 0.008)]),
    ("stribeck", &[("fs", 0.03), ("ws", 0.8)]),
    ("quadratic_drag", &[("c", 2e-4)]),
    ("slope", &[("g_c", 0.015), ("g_s", 0.01)]),
    ("turning_scrub", &[("f_t", 0.012)]),
    ("yaw_viscous", &[("d_y", 1.2e-3)]),
    ("caster_drag", &[("f_c", 0.012)]),
    ("lateral_com", &[("m", 4e-4)]),
    ("wheel_radius_mismatch", &[("eps", 0.03)]),
    ("actuator_lag", &[("tau", 0.02)]),
    ("actuator_delay", &[("delay", 0.02)]),
    ("torque_gain", &[("g", 0.05)]),
    ("torque_saturation", &[("limit", 0.3)]),
    ("backlash_deadzone", &[("d", 0.01)]),
    ("torque_ripple", &[("n", 6.0)]),
    ("wheel_eccentricity", &[]),
    ("friction_warmup", &[("fw", 0.03), ("tw", 8.0)]),
    ("load_transfer_friction", &[("cl", 1.5e-4)]),
    ("wheel_slip", &[("cs", 0.1)]),
    ("compliance", &[("kt", 2.0), ("dt", 0.02)]),
];

/// Sizes, as factors of the moderate one.
pub(crate) const SIZES: [(&str, f64); 3] = [("weak", 0.4), ("moderate", 1.0), ("strong", 2.5)];

/// Something outside the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stranger {
    /// Friction that changes twice in a turn of the heading, as on a carpet with a nap.
    Carpet,
    /// Drag in a band of wheel speeds, as from a resonance.
    Resonance,
    /// Friction that builds up over radians of travel.
    Hysteresis,
    /// A quarter more mass from the middle of each recording on.
    Payload,
    /// Short resistances at random times.
    Bumps,
}

/// All of them.
pub(crate) const STRANGERS: [Stranger; 5] = [
    Stranger::Carpet,
    Stranger::Resonance,
    Stranger::Hysteresis,
    Stranger::Payload,
    Stranger::Bumps,
];

/// How the recordings differ from what the noise model assumes, or from ordinary driving.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum World {
    /// White noise, 100 Hz.
    Stated,
    /// The noise of the moments is an AR(1) process with 0.95 from row to row.
    Autocorrelated,
    /// Angles in steps of an encoder with 9550 ticks a turn.
    Quantised,
    /// Speeds as differences of such angles, without a measurement of their own.
    Differenced,
    /// Logged at 50 Hz; the controller stays at 1 kHz.
    Slow,
    /// Moments half a sample late against the speeds.
    Skewed,
    /// As stated, on the paper's movement: mostly straight, with equal moments on both wheels.
    Paper,
}

/// All of them.
pub(crate) const WORLDS: [World; 7] = [
    World::Stated,
    World::Autocorrelated,
    World::Quantised,
    World::Differenced,
    World::Slow,
    World::Skewed,
    World::Paper,
];

/// One set of recordings.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    /// Effects of the catalogue that are in the truth and not in the model.
    pub(crate) hidden: Vec<&'static str>,
    /// Factor of their moderate sizes.
    pub(crate) size: f64,
    /// Something else that is in the truth.
    pub(crate) stranger: Option<Stranger>,
    /// How it is recorded.
    pub(crate) world: World,
    /// Noise level of the recordings, 1 to 3.
    pub(crate) level: usize,
    /// Seed of movements and noise.
    pub(crate) seed: u64,
}

impl Case {
    /// Nothing hidden.
    pub(crate) fn healthy(world: World, level: usize, seed: u64) -> Self {
        Self { hidden: vec![], size: 1.0, stranger: None, world, level, seed }
    }

    /// One effect.
    pub(crate) fn single(id: &'static str, size: f64, level: usize, seed: u64) -> Self {
        Self { hidden: vec![id], size, ..Self::healthy(World::Stated, level, seed) }
    }

    /// The k-th of a fixed walk through the pairs of moderate effects.
    pub(crate) fn pair(k: u64, level: usize) -> Self {
        let n = HIDDEN.len() as u64;
        let (a, round) = (k % n, k / n);
        let b = (a + 3 + 4 * round) % n;
        let hidden = vec![HIDDEN[a as usize].0, HIDDEN[b as usize].0];
        Self { hidden, ..Self::healthy(World::Stated, level, 500 + k) }
    }

    /// Something outside the catalogue.
    pub(crate) fn stranger(stranger: Stranger, level: usize, seed: u64) -> Self {
        Self { stranger: Some(stranger), ..Self::healthy(World::Stated, level, seed) }
    }

    /// Standard deviations of the white noise.
    pub(crate) fn noise(&self) -> NoiseLevel {
        match self.level {
            1 => NoiseLevel { alpha: 5e-4, dalpha: 0.02, moment: 0.002 },
            2 => NoiseLevel { alpha: 1e-3, dalpha: 0.05, moment: 0.005 },
            _ => NoiseLevel { alpha: 2e-3, dalpha: 0.15, moment: 0.015 },
        }
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let what = match (self.stranger, self.hidden.is_empty()) {
            (Some(stranger), _) => format!("{stranger:?}").to_lowercase(),
            (None, true) => "nothing".into(),
            (None, false) => self.hidden.join("+"),
        };
        let world = format!("{:?}", self.world).to_lowercase();
        write!(f, "{what},{},N{},{world},{}", self.size, self.level, self.seed)
    }
}

/// Whether two ids mean the same by the equations.
pub(crate) fn same(a: &str, b: &str) -> bool {
    let twins = || find(a).map(|e| e.description().equivalent).unwrap_or_default();
    a == b || twins().iter().any(|t| t == b)
}
