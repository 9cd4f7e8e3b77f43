//! The most likely noise of the process at fixed parameters.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use rayon::prelude::*;

use super::pass::{NoColumns, PassSettings, filter_pass};
use super::run::Innovation;
use super::{Likelihood, ProcessNoise};
use crate::math::{Attempt, DampedSearch, Information, MinimumStatus, Proposal, take_steps};
use crate::model::Model;
use crate::simulate::Hold;

/// Longest time constant of the slow torque \[s\].
const SLOWEST: f64 = 1.0;
/// Step in the weight of the later input for differences of the likelihood.
const LATER: f64 = 0.1;
/// Step in the logarithms for differences of the innovations.
const DIFFERENCE: f64 = 0.02;
/// Longest step of a logarithm.
const LONGEST: f64 = 2.0;
/// Smallest damping, for directions that the data hardly determine.
const RIDGE: f64 = 1e-6;
/// Smallest factor of a variance in one step.
const LEAST: f64 = 0.1;
/// A step with a smaller gain, actual or predicted, is the last [nats].
const GAIN: f64 = 0.05;
/// Steps, at most.
const STEPS: usize = 15;
/// Initial slow torque if none is given, as a share of the RMS input.
const FIRST_SLOW: f64 = 0.01;
/// Information of a logarithm below which a step of it changes nothing.
const LEAST_INFORMATION: f64 = 1e-3;
/// Share of the other's strength below which one of white noise and slow torque is negligible.
const NEGLIGIBLE: f64 = 0.1;
/// Time constants at which a slow torque is tried again \[s\].
const TIME_CONSTANTS: [f64; 2] = [1.0, 0.1];
/// Largest damping; the search ends beyond it.
const DAMPED: f64 = 1e4;

impl Likelihood<'_> {
    /// The most likely noise at fixed parameters, from `start`, and how many passes it took.
    ///
    /// Fisher scoring on (`sigma_m²`, `sigma_d²`, `ln tau_d`), in which the variances of the
    /// innovations are nearly linear:
    ///
    /// ```text
    /// g_a = -½ Σ (∂ₐS/S)(1 - e²/S) - Σ e ∂ₐe/S,    I_ab = ½ Σ ∂ₐS ∂ᵦS/S² + Σ ∂ₐe ∂ᵦe/S
    /// ```
    ///
    /// with the derivatives of innovations e and their variances S from passes side by side.
    #[must_use]
    pub fn noise(&self, model: &Model, p: &[f64], start: &ProcessNoise) -> (ProcessNoise, usize) {
        self.noise_from(model, p, start, 0.0)
    }

    /// [`Likelihood::noise`] with noise of the input of `least` or more.
    pub(super) fn noise_from(
        &self,
        model: &Model,
        p: &[f64],
        start: &ProcessNoise,
        least: f64,
    ) -> (ProcessNoise, usize) {
        let mut search = NoiseSearch::new(self, model, p, start.later);
        search.low[0] = search.low[0].max(least.ln());
        let (mut x, mut count) = search.climb(search.to_logs(start));
        if search.dimensions > 1 {
            let (better, passes) = search.climb_again(x);
            (x, count) = (better, count + passes);
        }
        let mut best = search.noise_at(&x);
        if self.timing && self.hold == Hold::Linear {
            best.later = self.later(model, p, &best);
            count += 3;
        }
        (best, count)
    }

    /// By how many standard errors the innovations ask for more noise of the input than `noise` (negative: for less), by
    /// the score of its variance. `None` where the likelihood is not known.
    pub(super) fn asked_noise(
        &self,
        model: &Model,
        p: &[f64],
        noise: &ProcessNoise,
    ) -> Option<f64> {
        let search = NoiseSearch::new(self, model, p, noise.later);
        let Slopes { gradient, information } = search.slopes(&search.to_logs(noise))?;
        let asked = gradient[0] / information[(0, 0)].sqrt();
        asked.is_finite().then_some(asked)
    }

    /// The most likely weight of the later input: the top of the parabola through three weights,
    /// between 0 and 1 (rows stamped half a sample early or late). A hold that the user states is
    /// used without an estimate.
    fn later(&self, model: &Model, p: &[f64], noise: &ProcessNoise) -> f64 {
        let at = |later: f64| self.value(model, p, &ProcessNoise { later, ..*noise });
        let c = noise.later;
        let three = (at(c - LATER), at(c), at(c + LATER));
        let (Some(a), Some(b), Some(d)) = three else { return c };
        let bend = a - 2.0 * b + d;
        if bend < 0.0 { (c + 0.5 * LATER * (a - d) / bend).clamp(0.0, 1.0) } else { c }
    }
}

struct NoiseSearch<'a> {
    likelihood: &'a Likelihood<'a>,
    model: &'a Model,
    p: &'a [f64],
    later: f64,
    /// Bounds of the logarithms of `sigma_m`, `sigma_d` and `tau_d`.
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// Root mean square of the input [N m].
    rms: f64,
    /// Shortest step of the recordings \[s\].
    step: f64,
    /// How many of the three are searched.
    dimensions: usize,
}

/// Gradient and Fisher information by the logarithms.
struct Slopes {
    gradient: Vector3<f64>,
    information: Matrix3<f64>,
}

impl Slopes {
    fn none() -> Self {
        Self { gradient: Vector3::zeros(), information: Matrix3::zeros() }
    }
}

impl<'a> NoiseSearch<'a> {
    fn new(likelihood: &'a Likelihood<'a>, model: &'a Model, p: &'a [f64], later: f64) -> Self {
        let rms = likelihood.torque_rms();
        let steps = likelihood.prepared.iter().map(|p| p.recording.step());
        // faster than a few samples it is equivalent to white noise of the input; slower than a
        // second it would absorb a constant offset or a sloping floor
        let step = steps.fold(f64::MAX, f64::min);
        let fastest = 5.0 * step;
        let low = Vector3::new(1e-6 * rms, 1e-5 * rms, fastest).map(f64::ln);
        let high = Vector3::new(1e2 * rms, 10.0 * rms, SLOWEST.max(fastest)).map(f64::ln);
        let dimensions = if likelihood.slow_moment { 3 } else { 1 };
        Self { likelihood, model, p, later, low, high, rms, step, dimensions }
    }

    fn to_logs(&self, noise: &ProcessNoise) -> Vector3<f64> {
        let slow = if noise.sigma_d > 0.0 { noise.sigma_d } else { FIRST_SLOW * self.rms };
        self.bounded(Vector3::new(noise.sigma_m, slow, noise.tau_d).map(f64::ln))
    }

    fn bounded(&self, x: Vector3<f64>) -> Vector3<f64> {
        x.sup(&self.low).inf(&self.high)
    }

    fn noise_at(&self, x: &Vector3<f64>) -> ProcessNoise {
        let flat =
            ProcessNoise { sigma_m: x[0].exp(), sigma_d: 0.0, tau_d: 1.0, later: self.later };
        match self.dimensions {
            3 => ProcessNoise { sigma_d: x[1].exp(), tau_d: x[2].exp(), ..flat },
            _ => flat,
        }
    }

    fn climb(&self, start: Vector3<f64>) -> (Vector3<f64>, usize) {
        let Some(here) = self.value(&start) else { return (start, 1) };
        let (x, slopes, damping, count) = (start, Slopes::none(), 0.0, 1);
        let mut climb = Climb { search: self, x, here, slopes, damping, count };
        take_steps(&mut climb);
        (climb.x, climb.count)
    }

    /// Restarts the search if one of white noise and slow torque is negligible at `x` and equal levels
    /// are more likely: the derivative by a level of noise vanishes at zero.
    fn climb_again(&self, x: Vector3<f64>) -> (Vector3<f64>, usize) {
        let share = x[1] - self.as_strong_as(x[0], x[2]);
        let half = 0.5 * 2.0_f64.ln();
        let offers: Vec<Vector3<f64>> = if share < NEGLIGIBLE.ln() {
            let slow = |tau: f64| self.as_strong_as(x[0], tau) - half;
            TIME_CONSTANTS.map(|tau| Vector3::new(x[0] - half, slow(tau.ln()), tau.ln())).to_vec()
        } else if share > -NEGLIGIBLE.ln() {
            vec![Vector3::new(x[0] + share - half, x[1] - half, x[2])]
        } else {
            return (x, 0);
        };
        let Some(here) = self.value(&x) else { return (x, 1) };
        let mut count = 1;
        for offer in offers.iter().map(|offer| self.bounded(*offer)) {
            count += 1;
            if self.value(&offer).is_some_and(|there| there > here) {
                let (better, passes) = self.climb(offer);
                return (better, count + passes);
            }
        }
        (x, count)
    }

    /// Logarithm of the slow torque that is at low frequencies as strong as white noise:
    /// `2 sigma_d² tau_d = sigma_m² h`.
    fn as_strong_as(&self, log_sigma_m: f64, log_tau_d: f64) -> f64 {
        log_sigma_m + 0.5 * ((0.5 * self.step).ln() - log_tau_d)
    }

    fn value(&self, x: &Vector3<f64>) -> Option<f64> {
        self.likelihood.value(self.model, self.p, &self.noise_at(x))
    }

    /// The next logarithms and the gain predicted by the quadratic model.
    fn next(&self, x: &Vector3<f64>, slopes: &Slopes, damping: f64) -> (Vector3<f64>, f64) {
        let (g, information) = (&slopes.gradient, &slopes.information);
        let at_edge = |i: usize| {
            (x[i] <= self.low[i] && g[i] <= 0.0) || (x[i] >= self.high[i] && g[i] >= 0.0)
        };
        let free: Vec<usize> = (0..self.dimensions)
            .filter(|&i| !at_edge(i) && information[(i, i)] > LEAST_INFORMATION)
            .collect();
        let of_free: DMatrix<f64> = information.select_rows(&free).select_columns(&free);
        let right: DVector<f64> = g.select_rows(&free);
        let steps = Information::new(&of_free).solve_damped(&right, damping + RIDGE);
        let (mut trial, mut promised) = (*x, 0.0);
        for (&j, &by_log) in free.iter().zip(&steps) {
            // the step is linear in the variance: from v to v (1 + 2 by_log)
            let step = if j < 2 { 0.5 * (1.0 + 2.0 * by_log).max(LEAST).ln() } else { by_log };
            trial[j] = (x[j] + step.clamp(-LONGEST, LONGEST)).clamp(self.low[j], self.high[j]);
            promised += 0.5 * g[j] * by_log;
        }
        (trial, promised)
    }

    fn slopes(&self, x: &Vector3<f64>) -> Option<Slopes> {
        let recordings = 0..self.likelihood.prepared.len();
        let parts: Option<Vec<Slopes>> =
            recordings.into_par_iter().map(|r| self.slopes_of(r, x)).collect();
        parts?.into_iter().reduce(|a, b| Slopes {
            gradient: a.gradient + b.gradient,
            information: a.information + b.information,
        })
    }

    /// For one recording at a time, to limit the memory for innovations.
    fn slopes_of(&self, r: usize, x: &Vector3<f64>) -> Option<Slopes> {
        // away from the bound, if there is one
        let difference = Vector3::from_fn(|i, _| {
            if x[i] + DIFFERENCE > self.high[i] { -DIFFERENCE } else { DIFFERENCE }
        });
        let beside = |k: usize| {
            let mut there = *x;
            if k > 0 {
                there[k - 1] += difference[k - 1];
            }
            self.innovations(r, &there)
        };
        // side by side only where the recordings leave threads idle
        let all: Option<Vec<_>> = if self.likelihood.prepared.len() < rayon::current_num_threads() {
            (0..=self.dimensions).into_par_iter().map(beside).collect()
        } else {
            (0..=self.dimensions).map(beside).collect()
        };
        let all = all?;
        let mut out = Slopes::none();
        for (k, innovation) in all[0].iter().enumerate() {
            let (e, s) = (innovation.value, innovation.variance);
            let (mut by_e, mut by_s) = (Vector3::zeros(), Vector3::zeros());
            for (i, there) in all[1..].iter().enumerate() {
                by_e[i] = (there[k].value - e) / difference[i];
                by_s[i] = (there[k].variance - s) / (difference[i] * s);
            }
            out.gradient -= by_s * (0.5 * (1.0 - e * e / s)) + by_e * (e / s);
            out.information += by_s * by_s.transpose() * 0.5 + by_e * by_e.transpose() / s;
        }
        Some(out)
    }

    fn innovations(&self, r: usize, x: &Vector3<f64>) -> Option<Vec<Innovation>> {
        let flat = self.likelihood.settings(&self.noise_at(x), false);
        let settings = PassSettings { keep_innovations: true, ..flat };
        let prepared = &self.likelihood.prepared[r];
        let pass = filter_pass(self.model, self.p, prepared, &settings, &NoColumns).ok()?;
        pass.log_likelihood.is_finite().then_some(pass.innovations)
    }
}

/// Fisher scoring under way.
struct Climb<'a> {
    search: &'a NoiseSearch<'a>,
    x: Vector3<f64>,
    /// Log-likelihood there.
    here: f64,
    slopes: Slopes,
    damping: f64,
    /// Passes.
    count: usize,
}

impl DampedSearch for Climb<'_> {
    /// The next logarithms.
    type Step = Vector3<f64>;

    fn propose(&mut self, accepted: usize, rejected: usize) -> Proposal<Self::Step> {
        if rejected == 0 {
            if accepted == STEPS {
                return Proposal::End(MinimumStatus::MaxIterations);
            }
            let Some(slopes) = self.search.slopes(&self.x) else {
                return Proposal::End(MinimumStatus::Stalled);
            };
            self.slopes = slopes;
            self.count += 1 + self.search.dimensions;
        }
        if self.damping >= DAMPED {
            return Proposal::End(MinimumStatus::Stalled);
        }
        match self.search.next(&self.x, &self.slopes, self.damping) {
            (_, promised) if promised < GAIN => Proposal::End(MinimumStatus::Converged),
            (trial, _) => Proposal::Step(trial),
        }
    }

    /// A rejected step is repeated with more damping.
    fn attempt(&mut self, trial: Self::Step) -> Attempt {
        self.count += 1;
        let there = self.search.value(&trial).filter(|there| *there > self.here);
        let Some(there) = there else {
            self.damping = 10.0 * self.damping.max(0.1);
            return Attempt::Rejected;
        };
        let gain = there - self.here;
        (self.x, self.here) = (trial, there);
        self.damping *= 0.1;
        if gain < GAIN { Attempt::Last } else { Attempt::Accepted }
    }
}

#[cfg(test)]
mod tests;
