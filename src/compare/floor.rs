//! The noise floor: the error that the right model would still have.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::error::{Acting, WINDOW, start_of, windows_of};
use crate::recording::{LocalMotion, Recording};
use crate::robot::State;
use crate::simulate::{BETWEEN_ROWS, Dynamics, Hold, SimulateError, every_other};

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

/// The error that remains for a perfect model: the noise of the measured speeds, what noise of the recorded
/// torques (from differences) and of the starting state does to a simulation, and what the input does
/// between its rows, which nobody recorded.
///
/// ```text
/// floor = ∫ σ_w² dt + mean over 8 draws of ∫ (w(M + noise, x0 + noise) - w(M, x0))² dt
///         + mean over both phases of ∫ (w(every other row of M) - w(M))² dt
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
    let acting = Acting::new(dynamics, recording, recording.moment());
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let t = recording.t();
    let (mut free, mut windows) = ([0.0; 2], 0.0);
    let whole: Vec<_> = recording.pieces().to_vec();
    let short: Vec<_> = whole.iter().flat_map(|p| windows_of(recording, p, WINDOW)).collect();
    let mean_free = all(&acting, motion, &whole, hold, None)?;
    let mean_windows = all(&acting, motion, &short, hold, None)?;
    for _ in 0..DRAWS {
        let moment = noisier_drive(recording, noise.moment, &mut rng);
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
    let sampled = sampling(dynamics, recording, motion, hold, (&mean_free, &mean_windows))?;
    let draws = DRAWS as f64;
    let covered: f64 = whole.iter().map(|p| t[p.end - 1] - t[p.start]).sum();
    let speed = noise.omega.map(|s| s * s);
    let ise = [0, 1].map(|i| speed[i] * covered + free[i] / draws + sampled.ise[i]);
    let variance = 0.5 * (speed[0] + speed[1])
        + windows / draws / (2.0 * t.len() as f64)
        + sampled.window_rms.powi(2);
    Ok(Floor { ise, window_rms: variance.sqrt() })
}

/// Root mean square error over windows of 2 s [rad/s] that a right model has on recordings because the input
/// between their rows is not known: a third of the difference that every other row makes, since a straight
/// line errs as the square of the interval. A smaller change of the error says nothing of the robot.
///
/// # Errors
/// A model that cannot move.
pub fn unresolved(
    dynamics: &dyn Dynamics,
    recordings: &[Recording],
    motions: &[Vec<LocalMotion>],
    hold: Hold,
) -> Result<f64, SimulateError> {
    let square = |recording: &Recording, motion: &Vec<LocalMotion>| {
        Ok(halved(dynamics, recording, motion, hold)?.window_rms.powi(2))
    };
    Ok(pooled(recordings, motions, square)? * BETWEEN_ROWS)
}

/// Root of the mean over all rows of a mean square of each recording.
fn pooled(
    recordings: &[Recording],
    motions: &[Vec<LocalMotion>],
    mut square: impl FnMut(&Recording, &Vec<LocalMotion>) -> Result<f64, SimulateError>,
) -> Result<f64, SimulateError> {
    let (mut sum, mut rows) = (0.0, 0.0);
    for (recording, motion) in recordings.iter().zip(motions) {
        sum += recording.len() as f64 * square(recording, motion)?;
        rows += recording.len() as f64;
    }
    Ok((sum / f64::max(rows, 1.0)).sqrt())
}

/// The floor of [`noise_floor`] over windows of all recordings [rad/s].
///
/// # Errors
/// A model that cannot move.
pub fn pooled_floor(
    dynamics: &dyn Dynamics,
    recordings: &[Recording],
    motions: &[Vec<LocalMotion>],
    hold: Hold,
    seed: u64,
) -> Result<f64, SimulateError> {
    let square = |recording: &Recording, motion: &Vec<LocalMotion>| {
        Ok(noise_floor(dynamics, recording, motion, hold, seed)?.window_rms.powi(2))
    };
    pooled(recordings, motions, square)
}

/// Root mean square difference over windows of 2 s [rad/s] that every other row of the input makes, less what
/// noise of the recorded input has in it: rows left out move a sum of independent errors as much as the errors
/// themselves do.
///
/// # Errors
/// A model that cannot move.
pub fn between_rows(
    dynamics: &dyn Dynamics,
    recordings: &[Recording],
    motions: &[Vec<LocalMotion>],
    hold: Hold,
) -> Result<f64, SimulateError> {
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let square = |recording: &Recording, motion: &Vec<LocalMotion>| {
        let Halved { short, windows, window_rms } = halved(dynamics, recording, motion, hold)?;
        let mut noise = 0.0;
        for _ in 0..DRAWS {
            let moment = noisier_drive(recording, recording.noise().moment, &mut rng);
            let noisy = Acting::new(dynamics, recording, &moment);
            let drawn = all(&noisy, motion, &short, hold, None)?;
            let pairs = drawn.iter().zip(&windows);
            noise += pairs.map(|(d, w)| spread(d, w, 0) + spread(d, w, 1)).sum::<f64>();
        }
        let noise = 0.5 * noise / DRAWS as f64 / recording.len() as f64;
        Ok((window_rms.powi(2) - noise).max(0.0))
    };
    pooled(recordings, motions, square)
}

/// The windows of a recording under its input, and the root mean square difference that every other row of
/// the input makes there.
struct Halved {
    short: Vec<std::ops::Range<usize>>,
    windows: Vec<State>,
    window_rms: f64,
}

fn halved(
    dynamics: &dyn Dynamics,
    recording: &Recording,
    motion: &[LocalMotion],
    hold: Hold,
) -> Result<Halved, SimulateError> {
    let acting = Acting::new(dynamics, recording, recording.moment());
    let whole = recording.pieces();
    let short: Vec<_> = whole.iter().flat_map(|p| windows_of(recording, p, WINDOW)).collect();
    let free = all(&acting, motion, whole, hold, None)?;
    let windows = all(&acting, motion, &short, hold, None)?;
    let Floor { window_rms, .. } = sampling(dynamics, recording, motion, hold, (&free, &windows))?;
    Ok(Halved { short, windows, window_rms })
}

/// What is not known of the input between its rows: the difference that every other row makes, the mean
/// over both ways of leaving rows out.
fn sampling(
    dynamics: &dyn Dynamics,
    recording: &Recording,
    motion: &[LocalMotion],
    hold: Hold,
    whole_rate: (&[State], &[State]),
) -> Result<Floor, SimulateError> {
    let (t, whole) = (recording.t(), recording.pieces().to_vec());
    let short: Vec<_> = whole.iter().flat_map(|p| windows_of(recording, p, WINDOW)).collect();
    let (mut ise, mut windows) = ([0.0; 2], 0.0);
    for phase in 0..2 {
        let moment = every_other(recording, recording.moment(), phase, hold);
        let acting = Acting::new(dynamics, recording, &moment);
        let free = all(&acting, motion, &whole, hold, None)?;
        for i in 0..2 {
            let square = |k: usize| spread(&free[k], &whole_rate.0[k], i);
            for piece in &whole {
                let rows = piece.start + 1..piece.end;
                ise[i] += rows
                    .map(|k| 0.25 * (t[k] - t[k - 1]) * (square(k - 1) + square(k)))
                    .sum::<f64>();
            }
        }
        let half = all(&acting, motion, &short, hold, None)?;
        for (h, w) in half.iter().zip(whole_rate.1) {
            windows += spread(h, w, 0) + spread(h, w, 1);
        }
    }
    Ok(Floor { ise, window_rms: (windows / (4.0 * t.len() as f64)).sqrt() })
}

fn spread(a: &State, b: &State, i: usize) -> f64 {
    let d = (a.omega[i] - b.omega[i]).powi(2);
    if d.is_finite() { d } else { 0.0 }
}

/// The recorded drive with noise of the deviations `sigma` [N m] added, one draw a row and wheel.
pub fn noisier_drive(
    recording: &Recording,
    sigma: [f64; 2],
    rng: &mut ChaCha8Rng,
) -> Vec<[f64; 2]> {
    let single = recording.is_single_axis();
    let rows = recording.moment().iter().map(|m| {
        // one axis written down twice has one noise
        let first = normal(rng);
        let second = if single { first } else { normal(rng) };
        [m[0] + sigma[0] * first, m[1] + sigma[1] * second]
    });
    rows.collect()
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
        let mut first = start_of(&local);
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
