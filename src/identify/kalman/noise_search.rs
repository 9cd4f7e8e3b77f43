//! The most likely noise of the process at fixed parameters.

use argmin::core::{CostFunction, Executor, State as _};
use argmin::solver::neldermead::NelderMead;

use super::{Likelihood, ProcessNoise};
use crate::model::Model;
use crate::simulate::Hold;

/// Longest time constant of the slow moment [s].
const SLOWEST: f64 = 1.0;
/// Difference of the weights of the later drive at which the likelihood is looked at.
const LATER: f64 = 0.1;

impl Likelihood<'_> {
    /// The most likely noise at fixed parameters, from `start`, by Nelder-Mead on the logarithms.
    #[must_use]
    pub fn noise(
        &self,
        model: &Model,
        p: &[f64],
        start: &ProcessNoise,
        evaluations: usize,
    ) -> (ProcessNoise, usize) {
        let rms = self.moment_rms();
        let step = self.prepared.iter().map(|p| p.recording.step()).fold(f64::MAX, f64::min);
        let slow = self.slow_moment;
        let search = NoiseSearch { likelihood: self, model, p, rms, step, later: start.later };
        let first = search.to_logs(start);
        let dimensions = if slow { 3 } else { 1 };
        let origin: Vec<f64> = first[..dimensions].to_vec();
        let mut simplex = vec![origin.clone()];
        for i in 0..dimensions {
            let mut corner = origin.clone();
            corner[i] += if i == 1 && start.sigma_d == 0.0 { 2.0 } else { 0.5 };
            simplex.push(corner);
        }
        let solver = NelderMead::new(simplex).with_sd_tolerance(0.1);
        let Ok(solver) = solver else { return (*start, 0) };
        let run = Executor::new(search, solver)
            .configure(|state| state.max_iters(evaluations as u64))
            .run();
        let Ok(run) = run else { return (*start, 0) };
        let count = run.state().get_func_counts().values().sum::<u64>() as usize;
        let search = NoiseSearch { likelihood: self, model, p, rms, step, later: start.later };
        let mut best = run.state().get_best_param().map_or(*start, |x| search.noise_at(x));
        if self.timing && self.hold == Hold::Linear {
            best.later = self.later(model, p, &best);
        }
        (best, count + 3)
    }

    /// The most likely weight of the later drive: the top of the parabola through three weights,
    /// between 0 and 1 (rows stamped half a sample early or late). A hold that the user states is
    /// believed.
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
    rms: f64,
    step: f64,
    later: f64,
}

impl NoiseSearch<'_> {
    fn to_logs(&self, noise: &ProcessNoise) -> [f64; 3] {
        [
            noise.sigma_m.max(1e-6 * self.rms).ln(),
            noise.sigma_d.max(1e-3 * self.rms).ln(),
            noise.tau_d.ln(),
        ]
    }

    fn noise_at(&self, x: &[f64]) -> ProcessNoise {
        let bounded = |x: f64, low: f64, high: f64| x.exp().clamp(low, high);
        let mut noise = ProcessNoise {
            sigma_m: bounded(x[0], 1e-6 * self.rms, 1e2 * self.rms),
            sigma_d: 0.0,
            tau_d: 1.0,
            later: self.later,
        };
        if let [_, d, tau] = x {
            noise.sigma_d = bounded(*d, 1e-5 * self.rms, 10.0 * self.rms);
            // faster than a few samples it is white noise of the drive under another name; slower
            // than a second it would take a constant offset, or a floor that slopes, for noise
            noise.tau_d = bounded(*tau, 5.0 * self.step, SLOWEST.max(5.0 * self.step));
        }
        noise
    }
}

impl CostFunction for NoiseSearch<'_> {
    type Param = Vec<f64>;
    type Output = f64;
    fn cost(&self, x: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        let noise = self.noise_at(x);
        // the search must see a finite number everywhere
        Ok(self.likelihood.value(self.model, self.p, &noise).map_or(1e300, |v| -v))
    }
}
