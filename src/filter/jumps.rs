//! Whether the changes of an input from row to row are noise, determined from the motion.

use super::{Likelihood, ProcessNoise, prepare};
use crate::model::Model;
use crate::recording::{DriveUnit, Recording};
use crate::simulate::Hold;

/// Increase of the log-likelihood for which another level of noise, or another account of the input, is accepted
/// \[nats\]: four standard errors.
pub const SURE: f64 = 8.0;
/// Noise of the input, as a share of its root mean square, that stands for none.
const NEGLIGIBLE: f64 = 1e-4;
/// Standard errors by which the innovations ask for more noise than the input shows, from which on the model is
/// incomplete.
const INCOMPLETE: f64 = 4.0;

/// Ratio (0 to 1) of the maximum-likelihood noise of the input for a model at `p` to the noise estimated
/// from the input's differences, [`Recording::input_jumps`]; 1 unless the innovations reject the latter, and where these
/// differences show no noise.
///
/// A held command, and a controller that responds to the counts of an encoder, change from row to row like
/// noise, but the robot follows them. Where the innovations show more than this noise, a slow torque beside it stands for
/// what the model lacks.
///
/// A voltage that is held is a command and known exactly: the ratio is zero unless the innovations reject that. Where a
/// controller feeds back the noise of the speeds, to count its answer as noise of the input biases the inertias and the
/// time of the input.
#[must_use]
pub fn noise_of_jumps(model: &Model, p: &[f64], recordings: &[&Recording], hold: Hold) -> f64 {
    let prepared = recordings.iter().map(|r| prepare(r)).collect();
    let likelihood =
        Likelihood { prepared, hold, slow_moment: false, timing: false, step_scatter: 1.0 };
    // a share of nothing: the search would cost more than the fit
    let negligible = NEGLIGIBLE * likelihood.torque_rms();
    if likelihood.prepared.iter().all(|p| p.torque_noise <= negligible) {
        return 1.0;
    }
    let seen = likelihood.initial_noise();
    let is_command = |r: &&Recording| r.drive_unit() == DriveUnit::Volt;
    if hold == Hold::Constant && recordings.iter().all(is_command) {
        return noise_of_command(&likelihood, model, p, &seen).unwrap_or(1.0);
    }
    let Some(asked) = likelihood.asked_noise(model, p, &seen) else { return 1.0 };
    // the usual case, for which the search is not needed
    if (0.0..INCOMPLETE).contains(&asked) {
        return 1.0;
    }
    let likelihood = Likelihood { slow_moment: asked >= INCOMPLETE, ..likelihood };
    let (likely, _) = likelihood.noise(model, p, &seen);
    if likely.sigma_m >= seen.sigma_m {
        return 1.0;
    }
    let (no_less, _) = likelihood.noise_from(model, p, &seen, seen.sigma_m);
    let value = |noise: &ProcessNoise| likelihood.value(model, p, noise);
    let gain = value(&likely).zip(value(&no_less)).map(|(likely, no_less)| likely - no_less);
    if gain.is_some_and(|gain| gain > SURE) { likely.sigma_m / seen.sigma_m } else { 1.0 }
}

/// The ratio of [`noise_of_jumps`] for a command, from the parameters that are the most likely without noise on.
fn noise_of_command(
    likelihood: &Likelihood,
    model: &Model,
    p: &[f64],
    seen: &ProcessNoise,
) -> Option<f64> {
    let none = ProcessNoise { sigma_m: NEGLIGIBLE * likelihood.torque_rms(), ..*seen };
    let exact = likelihood.maximise(model, p, Some(none)).ok()?;
    let (likely, _) = likelihood.noise(model, &exact.p, seen);
    let gain = likelihood.value(model, &exact.p, &likely)? - exact.log_likelihood;
    Some(if gain > SURE { (likely.sigma_m / seen.sigma_m).min(1.0) } else { 0.0 })
}

/// Log-likelihood of recordings under a model at `p`, at its most likely white noise of the input, if its changes
/// happen at times in their rows that scatter by [`step_scatter`](super::PassSettings::step_scatter). `None` where it
/// is not finite.
#[must_use]
pub fn likelihood_of_steps(
    model: &Model,
    p: &[f64],
    recordings: &[&Recording],
    hold: Hold,
    step_scatter: f64,
) -> Option<f64> {
    let prepared = recordings.iter().map(|r| prepare(r)).collect();
    let likelihood = Likelihood { prepared, hold, slow_moment: false, timing: false, step_scatter };
    let (noise, _) = likelihood.noise(model, p, &likelihood.initial_noise());
    likelihood.value(model, p, &noise)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Channels;
    use crate::robot::{Robot, State};
    use crate::simulate::{Input, simulate};
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    /// Share of jumps of 0.03 N m of a held input over 25 s at 100 Hz that is noise, where the robot follows them and
    /// where they are on the recorded input alone.
    fn found(real: bool) -> f64 {
        let model = Model::base(Robot::amigobot());
        let p = model.initial();
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let mut normal = |sigma: f64| -> f64 {
            let draw: f64 = StandardNormal.sample(&mut rng);
            sigma * draw
        };
        let t: Vec<f64> = (0..2500).map(|k| 0.01 * f64::from(k)).collect();
        let smooth = |t: f64| [0.35 + 0.2 * (1.1 * t).sin(), 0.3 + 0.2 * (0.7 * t).cos()];
        let jumping: Vec<[f64; 2]> =
            t.iter().map(|&t| smooth(t).map(|m| m + normal(0.03))).collect();
        let acting = if real { jumping.clone() } else { t.iter().map(|&t| smooth(t)).collect() };
        let input = Input { t: &t, torque: &acting, hold: Hold::Constant };
        let states = simulate(&model, &p, &input, State::default()).unwrap();
        let omega = states.iter().map(|s| s.omega.map(|w| w + normal(0.005))).collect();
        let channels = Channels { t, alpha: None, omega: Some(omega), torque: jumping };
        let recording = Recording::new("jumps", channels, DriveUnit::NewtonMetre).unwrap();
        noise_of_jumps(&model, &p, &[&recording], Hold::Constant)
    }

    #[test]
    fn jumps_that_the_robot_follows_are_no_noise() {
        assert!(found(true) < 0.1, "{}", found(true));
        // the level of the differences is known to 2 %, and four standard errors are asked for
        assert!(found(false) > 0.9, "{}", found(false));
    }
}
