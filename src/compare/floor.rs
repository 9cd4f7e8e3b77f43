//! The noise floor: the error that the right model would still have.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::error::{Acting, start, windows_of};
use crate::recording::{LocalMotion, Recording};
use crate::robot::State;
use crate::simulate::{Dynamics, Hold, SimulateError};

/// Draws of the noise.
const DRAWS: usize = 8;

/// The error of the right model on one recording.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Floor {
    /// Of the free simulation, per wheel [rad^2/s].
    pub ise: [f64; 2],
    /// Of the windows, root mean square over both wheels [rad/s].
    pub window_rms: f64,
}

/// The error that remains for a perfect model: the noise of the measured speeds, and what noise of
/// the recorded moments (from differences) and of the starting state does to a simulation.
///
/// ```text
/// floor = ∫ σ_w² dt + mean over 8 draws of ∫ (w(M + noise, x0 + noise) - w(M, x0))² dt
/// ```
/// `dynamics` stands for the right model; any model near it serves, since only the spread counts.
///
/// # Errors
/// A model that cannot move.
pub fn noise_floor(
    dynamics: &dyn Dynamics,
    recording: &Recording,
    motion: &[LocalMotion],
    hold: Hold,
    seed: u64,
) -> Result<Floor, SimulateError> {
    let noise = recording.noise();
    let single = recording.is_single_axis();
    let acting = Acting::new(dynamics, recording, recording.moment());
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let t = recording.t();
    let (mut free, mut windows) = ([0.0; 2], 0.0);
    let whole: Vec<_> = recording.pieces().to_vec();
    let short: Vec<_> = whole.iter().flat_map(|p| windows_of(recording, p)).collect();
    let mean_free = all(&acting, motion, &whole, hold, None)?;
    let mean_windows = all(&acting, motion, &short, hold, None)?;
    for _ in 0..DRAWS {
        let moment: Vec<[f64; 2]> = recording
            .moment()
            .iter()
            .map(|m| {
                // one axis written down twice has one noise
                let first = normal(&mut rng);
                let second = if single { first } else { normal(&mut rng) };
                [m[0] + noise.moment[0] * first, m[1] + noise.moment[1] * second]
            })
            .collect();
        let acting = Acting::new(dynamics, recording, &moment);
        let drawn = all(&acting, motion, &whole, hold, Some(&mut rng))?;
        for i in 0..2 {
            let square = |k: usize| spread(&drawn[k], &mean_free[k], i);
            for piece in &whole {
                for k in piece.start + 1..piece.end {
                    free[i] += 0.5 * (t[k] - t[k - 1]) * (square(k - 1) + square(k));
                }
            }
        }
        let drawn = all(&acting, motion, &short, hold, Some(&mut rng))?;
        for (d, m) in drawn.iter().zip(&mean_windows) {
            windows += spread(d, m, 0) + spread(d, m, 1);
        }
    }
    let draws = DRAWS as f64;
    let covered: f64 = whole.iter().map(|p| t[p.end - 1] - t[p.start]).sum();
    let speed = noise.omega.map(|s| s * s);
    let ise = [0, 1].map(|i| speed[i] * covered + free[i] / draws);
    let variance = 0.5 * (speed[0] + speed[1]) + windows / draws / (2.0 * t.len() as f64);
    Ok(Floor { ise, window_rms: variance.sqrt() })
}

fn spread(a: &State, b: &State, i: usize) -> f64 {
    let d = (a.omega[i] - b.omega[i]).powi(2);
    if d.is_finite() { d } else { 0.0 }
}

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

fn all(
    acting: &Acting,
    motion: &[LocalMotion],
    ranges: &[std::ops::Range<usize>],
    hold: Hold,
    mut rng: Option<&mut ChaCha8Rng>,
) -> Result<Vec<State>, SimulateError> {
    let mut out = Vec::with_capacity(motion.len());
    for range in ranges {
        let mut local = motion[range.start];
        let mut first = start(&local);
        if let Some(rng) = rng.as_deref_mut() {
            let draws = [normal(rng), normal(rng)];
            let single = local.omega[0] == local.omega[1];
            for i in 0..2 {
                let draw = if single { draws[0] } else { draws[i] };
                local.omega[i] += local.omega_variance[i].sqrt() * draw;
            }
            // a wheel that counted as resting stays so: the draw is about the noise of its speed
            for i in 0..2 {
                if first.omega[i] != 0.0 {
                    first.omega[i] = local.omega[i];
                }
            }
        }
        out.extend(acting.simulate(motion, range.clone(), first, hold)?);
    }
    Ok(out)
}
