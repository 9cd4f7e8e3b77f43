//! Loggers: sampling rates, noise, lags and channels that do not agree in time.

use amigo_ident::recording::Channels;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::robots::Machine;

/// Sampling rate of exact motions [Hz].
pub const EXACT: f64 = 1000.0;

/// Exact motion at [`EXACT`] rows per second.
#[derive(Clone, Debug, Default)]
pub struct Exact {
    /// Wheel angles [rad].
    pub alpha: Vec<[f64; 2]>,
    /// Wheel speeds [rad/s].
    pub omega: Vec<[f64; 2]>,
    /// Torques of the motors [N m].
    pub torque: Vec<[f64; 2]>,
}

/// How a motion is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Log {
    /// White noise on all channels, with the rate [Hz].
    White(u32),
    /// 100 Hz; the noise of the torques is an AR(1) process with 0.95 from row to row.
    Autocorrelated,
    /// 100 Hz; torques half a row late relative to angles and speeds.
    Skewed,
    /// 100 Hz; torques are means over the row before.
    Averaged,
    /// 100 Hz; angles from an encoder, speeds are its backward differences.
    Differenced,
    /// 100 Hz; speeds are means over the last 50 ms; angles have no delay.
    Lagging,
}

/// All loggers, the plain one first.
pub const LOGS: [Log; 11] = [
    Log::White(100),
    Log::White(20),
    Log::White(50),
    Log::White(200),
    Log::White(500),
    Log::White(1000),
    Log::Autocorrelated,
    Log::Skewed,
    Log::Averaged,
    Log::Differenced,
    Log::Lagging,
];

/// Counts of the encoder in a row of [`Log::Differenced`] at half the top speed.
const COUNTS: f64 = 20.0;
/// Window of the mean of [`Log::Lagging`] [s].
const LAG: f64 = 0.05;

impl Log {
    /// Name in the id of a case.
    pub fn name(self) -> String {
        match self {
            Self::White(rate) => format!("{rate}hz"),
            other => format!("{other:?}").to_lowercase(),
        }
    }

    /// The logger of a name.
    pub fn of(name: &str) -> Option<Self> {
        LOGS.into_iter().find(|log| log.name() == name)
    }

    /// Sampling rate [Hz].
    fn rate(self) -> f64 {
        if let Self::White(rate) = self { f64::from(rate) } else { 100.0 }
    }
}

/// Standard deviations of the noise of a level, 0 to 2: angles [rad], speeds over the top speed, torques over
/// their root mean square.
const NOISE: [(f64, f64, f64); 3] =
    [(5e-4, 0.0015, 0.005), (1e-3, 0.004, 0.02), (2e-3, 0.012, 0.05)];

/// Records `exact` of `machine` at a noise level.
pub fn record(
    exact: &Exact,
    log: Log,
    machine: &Machine,
    level: usize,
    rng: &mut ChaCha8Rng,
) -> Channels {
    let mut normal = || -> f64 { StandardNormal.sample(rng) };
    let (angle, speed, torque) = NOISE[level];
    let square: f64 = exact.torque.iter().flatten().map(|m| m * m).sum();
    let torque = torque * (square / (2 * exact.torque.len()) as f64).sqrt();
    let every = (EXACT / log.rate()).round() as usize;
    let tick = 0.5 * machine.speed / (COUNTS * log.rate());
    let counted = |k: usize| exact.alpha[k].map(|a| (a / tick).round() * tick);
    let mut drift = [0.0; 2];
    let mut channels = Channels::default();
    let (mut alpha, mut omega) = (Vec::new(), Vec::new());
    for k in (every..exact.alpha.len()).step_by(every) {
        channels.t.push((k - every) as f64 / EXACT);
        alpha.push(match log {
            Log::Differenced => counted(k),
            _ => exact.alpha[k].map(|a| a + angle * normal()),
        });
        omega.push(match log {
            Log::Differenced => {
                let (now, before) = (counted(k), counted(k - every));
                [0, 1].map(|i| (now[i] - before[i]) * log.rate())
            }
            Log::Lagging => mean(&exact.omega, k, (LAG * EXACT) as usize),
            _ => exact.omega[k],
        });
        if log != Log::Differenced {
            let last = omega.last_mut().expect("just pushed");
            *last = last.map(|w| w + speed * machine.speed * normal());
        }
        drift = drift.map(|d| match log {
            Log::Autocorrelated => 0.95 * d + (1.0 - 0.95_f64.powi(2)).sqrt() * normal(),
            _ => normal(),
        });
        let m = match log {
            Log::Skewed => exact.torque[k - every / 2],
            Log::Averaged => mean(&exact.torque, k, every),
            _ => exact.torque[k],
        };
        channels.torque.push([0, 1].map(|i| m[i] + torque * drift[i]));
    }
    (channels.alpha, channels.omega) = (Some(alpha), Some(omega));
    channels
}

/// Mean of the last `count` rows up to `k`.
fn mean(rows: &[[f64; 2]], k: usize, count: usize) -> [f64; 2] {
    let from = (k + 1).saturating_sub(count);
    [0, 1].map(|i| rows[from..=k].iter().map(|r| r[i]).sum::<f64>() / (k + 1 - from) as f64)
}
