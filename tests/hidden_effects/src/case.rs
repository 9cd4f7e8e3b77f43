//! One case of the benchmark: robot, simulator, logger and hidden effects.

use std::fmt;
use std::str::FromStr;

use super::hidden::{EFFECTS, OUTSIDE};
use super::logger::Log;
use super::robots::Machine;

/// Simulator of the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Simulator {
    /// The program's: event-driven stick and slip under a controller at 1 kHz.
    Own,
    /// The benchmark's: other equations, integrator, friction law, controller and set-points.
    Second,
}

/// Size of a hidden effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// 3 % of the input.
    Weak,
    /// 8 %.
    Moderate,
    /// 20 %.
    Strong,
}

/// All sizes.
pub const SIZES: [Size; 3] = [Size::Strong, Size::Moderate, Size::Weak];

impl Size {
    /// Root mean square torque of the effect over that of the input [1].
    pub fn share(self) -> f64 {
        match self {
            Self::Weak => 0.03,
            Self::Moderate => 0.08,
            Self::Strong => 0.2,
        }
    }

    /// Name in the id of a case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Weak => "weak",
            Self::Moderate => "moderate",
            Self::Strong => "strong",
        }
    }
}

/// A case. It is determined by its id.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Name of the robot.
    pub robot: String,
    /// Simulator.
    pub simulator: Simulator,
    /// Logger.
    pub log: Log,
    /// Ids of the hidden effects: none, one or two of the catalogue, or one outside it.
    pub hidden: Vec<String>,
    /// Size of the hidden effects.
    pub size: Size,
    /// Seed of movements and noise; the seed modulo 3 is the noise level.
    pub seed: u64,
}

impl Case {
    /// Whether a hidden effect is outside the catalogue.
    pub fn outside(&self) -> bool {
        self.hidden.iter().any(|h| OUTSIDE.contains(&h.as_str()))
    }

    /// Kind of case: healthy, single, two, or outside.
    pub fn kind(&self) -> &'static str {
        match self.hidden.len() {
            0 => "healthy",
            1 if self.outside() => "outside",
            1 => "single",
            _ => "two",
        }
    }

    /// Noise level: 0 low, 1 medium, 2 high.
    pub fn level(&self) -> usize {
        (self.seed % 3) as usize
    }

    /// A seed for random draws, different for every case.
    pub fn stream(&self) -> u64 {
        // FNV-1a of the id
        let id = self.to_string();
        id.bytes()
            .fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let simulator = if self.simulator == Simulator::Own { "own" } else { "second" };
        let (hidden, size) = match self.hidden.is_empty() {
            true => ("healthy".to_string(), "-"),
            false => (self.hidden.join("+"), self.size.name()),
        };
        write!(f, "{}/{simulator}/{}/{hidden}/{size}/{}", self.robot, self.log.name(), self.seed)
    }
}

impl FromStr for Case {
    type Err = String;

    fn from_str(id: &str) -> Result<Self, String> {
        let parts: Vec<&str> = id.split('/').collect();
        let [robot, simulator, log, hidden, size, seed] = parts[..] else {
            return Err(format!("{id}: expected robot/simulator/log/effect/size/seed"));
        };
        Machine::of(robot).ok_or_else(|| format!("{id}: no robot is called {robot}"))?;
        let simulator = match simulator {
            "own" => Simulator::Own,
            "second" => Simulator::Second,
            other => return Err(format!("{id}: {other} is neither own nor second")),
        };
        let hidden: Vec<String> = match hidden {
            "healthy" => vec![],
            all => all.split('+').map(str::to_string).collect(),
        };
        let known = |h: &String| EFFECTS.contains(&h.as_str()) || OUTSIDE.contains(&h.as_str());
        if let Some(unknown) = hidden.iter().find(|h| !known(h)) {
            return Err(format!("{id}: no effect is called {unknown}"));
        }
        let size = SIZES.into_iter().find(|s| s.name() == size);
        let size = match (size, hidden.is_empty()) {
            (Some(size), _) => size,
            (None, true) => Size::Moderate,
            (None, false) => return Err(format!("{id}: size is weak, moderate or strong")),
        };
        let log = Log::of(log).ok_or_else(|| format!("{id}: no log is called {log}"))?;
        let seed = seed.parse().map_err(|_| format!("{id}: {seed} is no seed"))?;
        Ok(Self { robot: robot.into(), simulator, log, hidden, size, seed })
    }
}
