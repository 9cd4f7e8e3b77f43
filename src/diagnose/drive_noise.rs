//! What noise of the recorded drive does to the choice between a lag and a delay.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use super::outcome::Ranked;
use super::refit::Refit;
use crate::identify::kalman::{Likelihood, Prepared};
use crate::recording::Recording;

/// Draws of the added noise: the mean of so many is within some nats where tens are at stake.
const DRAWS: u64 = 8;
/// Share of the larger evidence within which two refits are close enough to be looked at.
const CLOSE: f64 = 0.2;
/// Or difference of them [nats].
const CLOSE_NATS: f64 = 100.0;

/// Puts a lag and a delay that compete on the same terms.
///
/// A lag smooths the noise of the recorded drive and a delay does not, so where moments are noisy the
/// likelihood prefers the lag by tens of nats. As much noise again is added, and the change is
/// extrapolated back to none (SIMEX: Cook and Stefanski 1994):
///
/// ```text
/// ln L(no noise) ≈ ln L + (ln L - mean of ln L with noise added),   parameters and noise held
/// ```
pub(super) fn compare_fairly(ranked: &mut [Ranked], likelihood: &Likelihood) {
    let mut rivals: Vec<&mut Refit> = ranked
        .iter_mut()
        .filter(|r| r.candidate.is_shift())
        .filter_map(|r| r.refit.as_mut())
        .filter(|refit| refit.in_range)
        .collect();
    rivals.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    let best = rivals.first().map_or(0.0, |r| r.evidence);
    rivals.retain(|r| r.evidence > best - CLOSE_NATS.max(CLOSE * best));
    if rivals.len() < 2 {
        return;
    }
    let lost = losses(&rivals, likelihood);
    if lost.iter().any(|lost| !lost.is_finite()) {
        return;
    }
    // only differences count: the one that noise costs most keeps its evidence
    let most = lost.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    for (refit, lost) in rivals.into_iter().zip(lost) {
        refit.evidence -= most - lost;
        refit.gain -= most - lost;
        // of a single recording it is zero
        if refit.cross_gain != 0.0 {
            refit.cross_gain -= most - lost;
        }
    }
}

/// Log-likelihood that each refit loses on average when as much noise again is added to the drive, all
/// at the largest process noise among them.
fn losses(refits: &[&mut Refit], likelihood: &Likelihood) -> Vec<f64> {
    let noises = refits.iter().map(|refit| refit.maximum.noise);
    let Some(noise) = noises.max_by(|a, b| a.sigma_m.total_cmp(&b.sigma_m)) else { return vec![] };
    let recordings = 0..likelihood.prepared.len();
    let tasks: Vec<(u64, usize)> =
        (0..DRAWS).flat_map(|draw| recordings.clone().map(move |r| (draw, r))).collect();
    let lost: Vec<Vec<f64>> = tasks
        .into_par_iter()
        .map(|(draw, r)| {
            let prepared = &likelihood.prepared[r];
            // a drive that acts as roughly as it was recorded has no noise to take out
            let sigma = prepared.moment_noise.min(noise.sigma_m);
            let recording = noisier(prepared.recording, sigma, draw << 32 | r as u64);
            let noisy = Prepared { recording: &recording, ..prepared.clone() };
            let value = |prepared: &Prepared, refit: &Refit| {
                let one = Likelihood { prepared: vec![prepared.clone()], ..*likelihood };
                let value = one.value(&refit.model, &refit.maximum.p, &noise);
                value.unwrap_or(f64::NAN)
            };
            refits.iter().map(|refit| value(prepared, refit) - value(&noisy, refit)).collect()
        })
        .collect();
    let mean = |i: usize| lost.iter().map(|values| values[i]).sum::<f64>() / DRAWS as f64;
    (0..refits.len()).map(mean).collect()
}

/// The recording with noise of deviation `sigma` added to its drive; one axis has one noise.
fn noisier(recording: &Recording, sigma: f64, seed: u64) -> Recording {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let single = recording.is_single_axis();
    let rows = recording.moment().iter().map(|m| {
        let first = normal();
        let second = if single { first } else { normal() };
        [m[0] + sigma * first, m[1] + sigma * second]
    });
    recording.with_moment(rows.collect())
}
