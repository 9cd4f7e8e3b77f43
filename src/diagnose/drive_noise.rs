//! What noise of the recorded drive does to the choice between a lag and a delay.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use super::refit::Refit;
use super::stepwise::Ranked;
use crate::identify::kalman::{Likelihood, Prepared};
use crate::recording::Recording;

/// Draws of the added noise: the mean of so many is within some nats where tens are at stake.
const DRAWS: u64 = 8;
/// Share of the larger evidence within which two refits are close enough to be looked at.
const CLOSE: f64 = 0.2;

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
    rivals.retain(|r| r.evidence > (1.0 - CLOSE) * best);
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
    }
}

/// Log-likelihood that each refit loses on average when as much noise again is added to the drive, all
/// at the process noise of the first.
fn losses(refits: &[&mut Refit], likelihood: &Likelihood) -> Vec<f64> {
    let noise = refits[0].maximum.noise;
    let value = |likelihood: &Likelihood, refit: &Refit| {
        likelihood.value(&refit.model, &refit.maximum.p, &noise).unwrap_or(f64::NAN)
    };
    let exact: Vec<f64> = refits.iter().map(|refit| value(likelihood, refit)).collect();
    let draws: Vec<Vec<f64>> = (0..DRAWS)
        .into_par_iter()
        .map(|draw| {
            let recordings = noisier(likelihood, draw);
            let prepared = recordings.iter().zip(&likelihood.prepared);
            let prepared = prepared.map(|(recording, p)| Prepared { recording, ..p.clone() });
            let noisy = Likelihood { prepared: prepared.collect(), ..likelihood.clone() };
            refits.iter().map(|refit| value(&noisy, refit)).collect()
        })
        .collect();
    let mean = |i: usize| draws.iter().map(|values| values[i]).sum::<f64>() / DRAWS as f64;
    exact.iter().enumerate().map(|(i, exact)| exact - mean(i)).collect()
}

/// The recordings with as much noise of the drive again.
fn noisier(likelihood: &Likelihood, draw: u64) -> Vec<Recording> {
    let mut rng = ChaCha8Rng::seed_from_u64(draw);
    let add = |p: &Prepared, rng: &mut ChaCha8Rng| {
        let mut more = || -> f64 { StandardNormal.sample(rng) };
        let moment = p.recording.moment().iter();
        p.recording.with_moment(moment.map(|m| m.map(|v| v + p.moment_noise * more())).collect())
    };
    likelihood.prepared.iter().map(|p| add(p, &mut rng)).collect()
}
