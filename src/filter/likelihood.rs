//! The likelihood of a set of recordings, and its maximum over parameters and noise.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::pass::{Columns, NoColumns, Pass, PassSettings, filter_pass};
use super::prepare::Prepared;
use super::run::Innovation;
use super::{FilterError, ProcessNoise};
use crate::effects::ParameterKind;
use crate::math::{Attempt, DampedSearch, Information, MinimumStatus, Proposal, take_steps};
use crate::model::{Model, ModelError};
use crate::simulate::Hold;

/// Recordings ready for the filter.
#[derive(Clone)]
pub struct Likelihood<'a> {
    /// One independent run of the filter each.
    pub prepared: Vec<Prepared<'a>>,
    /// The input between samples.
    pub hold: Hold,
    /// Whether the slow unknown torque is part of the noise model.
    pub slow_moment: bool,
    /// Whether [`ProcessNoise::later`] is estimated, for efficient estimates. It is fixed in
    /// searches for lags and delays, with which it is correlated by up to half a sample.
    pub timing: bool,
    /// Relative scatter of the times at which the input changes ([`PassSettings::step_scatter`]).
    pub step_scatter: f64,
}

/// Where a maximisation ended.
#[derive(Clone, Debug)]
pub struct Maximum {
    /// Parameters of the model.
    pub p: Vec<f64>,
    /// Noise of process and input that belongs to them.
    pub noise: ProcessNoise,
    /// Its maximum \[nats\].
    pub log_likelihood: f64,
    /// Information of all parameters.
    pub information: DMatrix<f64>,
    /// How it ended.
    pub status: MinimumStatus,
    /// Gauss-Newton steps.
    pub iterations: usize,
    /// Passes over all recordings.
    pub evaluations: usize,
}

/// Largest number of Gauss-Newton steps.
const STEPS: usize = 40;
/// Rounds of parameters and noise, at most.
const ROUNDS: usize = 8;
/// A round that gains less is the last [nats].
const SETTLED: f64 = 1.0;
/// A step that raises the log-likelihood by less is the last.
const GAIN: f64 = 2e-3;
/// Information of a parameter in units of its own size below which it is rounding.
const NOTHING: f64 = 1e-12;
/// Smallest share of a step that is tried.
const SHORTEST: f64 = 1e-4;
/// If no step raises it and the predicted increase is less than this, the maximum is reached: the
/// score neglects the dependence of the filter's gain on the parameters, so it need not vanish
/// there.
const SLACK: f64 = 0.1;

/// How a run of Gauss-Newton steps ended.
struct Climb {
    status: MinimumStatus,
    steps: usize,
    evaluations: usize,
    /// What it gained [nats].
    gain: f64,
}

impl Likelihood<'_> {
    pub(super) fn settings(&self, noise: &ProcessNoise, derivatives: bool) -> PassSettings {
        let (keep_innovations, input_noise) = (false, false);
        let step_scatter = self.step_scatter;
        PassSettings { noise: *noise, derivatives, keep_innovations, input_noise, step_scatter }
    }

    /// Bias of every parameter at a maximum by noise of the recorded input.
    ///
    /// ```text
    /// H⁻¹ E[Σ ψ e / S],   not zero for inertias: the acceleration they multiply contains that noise
    /// ```
    ///
    /// # Errors
    /// If the mass matrix is not positive definite.
    pub fn bias_by_input_noise(
        &self,
        model: &Model,
        maximum: &Maximum,
    ) -> Result<Vec<f64>, ModelError> {
        let settings = PassSettings { input_noise: true, ..self.settings(&maximum.noise, true) };
        let passes: Vec<Pass> = self
            .prepared
            .par_iter()
            .map(|prepared| filter_pass(model, &maximum.p, prepared, &settings, &NoColumns))
            .collect::<Result<_, _>>()?;
        let score: DVector<f64> = passes.iter().map(|pass| &pass.score_of_input_noise).sum();
        let mut bias = vec![0.0; maximum.p.len()];
        // not computed for a single axis
        if score.is_empty() {
            return Ok(bias);
        }
        let identified = identified(model, &maximum.p, &maximum.information);
        for (step, j) in
            newton_step(&maximum.information, &score, &identified).into_iter().zip(identified)
        {
            bias[j] = step;
        }
        Ok(bias)
    }

    /// One pass over every recording, in parallel.
    ///
    /// # Errors
    /// If the mass matrix is not positive definite.
    pub fn passes(
        &self,
        model: &Model,
        p: &[f64],
        noise: &ProcessNoise,
        derivatives: bool,
        columns: &[&dyn Columns],
    ) -> Result<Vec<Pass>, ModelError> {
        let settings = self.settings(noise, derivatives);
        (0..self.prepared.len())
            .into_par_iter()
            .map(|r| self.pass(r, model, p, &settings, columns))
            .collect()
    }

    /// The innovations of every recording with the given noise only.
    ///
    /// # Errors
    /// If the mass matrix is not positive definite.
    pub fn innovations(
        &self,
        model: &Model,
        p: &[f64],
        noise: &ProcessNoise,
    ) -> Result<Vec<Vec<Innovation>>, ModelError> {
        let settings = PassSettings { keep_innovations: true, ..self.settings(noise, false) };
        let pass = |r| Ok(self.pass(r, model, p, &settings, &[])?.innovations);
        (0..self.prepared.len()).into_par_iter().map(pass).collect()
    }

    /// Log-likelihood alone.
    #[must_use]
    pub fn value(&self, model: &Model, p: &[f64], noise: &ProcessNoise) -> Option<f64> {
        let passes = self.passes(model, p, noise, false, &[]).ok()?;
        let sum: f64 = passes.iter().map(|pass| pass.log_likelihood).sum();
        sum.is_finite().then_some(sum)
    }

    /// Noise to start with: that of differences, no slow torque.
    #[must_use]
    pub fn initial_noise(&self) -> ProcessNoise {
        let count = self.prepared.len().max(1) as f64;
        let rms = self.torque_rms();
        let seen = self.prepared.iter().map(|p| p.torque_noise).sum::<f64>() / count;
        let later = match self.hold {
            Hold::Linear => 0.5,
            Hold::Constant => 0.0,
        };
        ProcessNoise { sigma_m: seen.max(1e-4 * rms), sigma_d: 0.0, tau_d: 1.0, later }
    }

    /// Root mean square of the recorded input [N m].
    #[must_use]
    pub fn torque_rms(&self) -> f64 {
        let (mut sum, mut count) = (0.0, 0_usize);
        for prepared in &self.prepared {
            for m in prepared.recording.torque() {
                sum += m[0] * m[0] + m[1] * m[1];
                count += 2;
            }
        }
        (sum / count.max(1) as f64).sqrt().max(1e-12)
    }

    /// Maximises the likelihood over the free parameters by Gauss-Newton and over the noise.
    ///
    /// ```text
    /// δθ = H⁻¹ g   (H scaled to unit diagonal, damped where a step fails)
    /// ```
    ///
    /// # Errors
    /// If no likelihood can be computed at the start.
    pub fn maximise(
        &self,
        model: &Model,
        start: &[f64],
        noise: Option<ProcessNoise>,
    ) -> Result<Maximum, FilterError> {
        let mut p = start.to_vec();
        let refresh = noise.is_none();
        let mut noise = noise.unwrap_or_else(|| self.initial_noise());
        let mut evaluations = 0;
        if refresh {
            let (best, count) = self.noise(model, &p, &noise);
            noise = best;
            evaluations += count;
        }
        let mut iterations = 0;
        let mut status = MinimumStatus::MaxIterations;
        for round in 0..ROUNDS {
            let steps = if refresh && round < 2 { 4 } else { STEPS };
            let climb = self.climb(model, &mut p, &noise, steps)?;
            status = climb.status;
            iterations += climb.steps;
            evaluations += climb.evaluations;
            // the noise is estimated anew after a large change of the parameters
            if !refresh || (round >= 2 && climb.gain < SETTLED) || round + 1 == ROUNDS {
                break;
            }
            let (best, count) = self.noise(model, &p, &noise);
            noise = best;
            evaluations += count;
        }
        let passes = self.passes(model, &p, &noise, true, &[])?;
        let log_likelihood = passes.iter().map(|pass| pass.log_likelihood).sum();
        let information = passes.iter().map(|pass| &pass.information).sum();
        evaluations += 1;
        Ok(Maximum { p, noise, log_likelihood, information, status, iterations, evaluations })
    }

    /// Gauss-Newton steps at fixed noise; moves `p`.
    fn climb(
        &self,
        model: &Model,
        p: &mut Vec<f64>,
        noise: &ProcessNoise,
        limit: usize,
    ) -> Result<Climb, FilterError> {
        let (likelihood, slope) = (self, Slope::default());
        let (evaluations, gain, error) = (0, 0.0, None);
        let mut ascent =
            Ascent { likelihood, model, noise, limit, p, slope, evaluations, gain, error };
        let (status, steps) = take_steps(&mut ascent);
        let Ascent { evaluations, gain, error, .. } = ascent;
        error.map_or(Ok(Climb { status, steps, evaluations, gain }), Err)
    }
}

/// The likelihood at the present parameters, and the step from there.
#[derive(Default)]
struct Slope {
    value: f64,
    free: Vec<usize>,
    step: Vec<f64>,
    /// Increase that the step promises [nats].
    promised: f64,
}

/// Gauss-Newton steps at fixed noise, whole or halved. The score neglects the dependence of the gain on the parameters,
/// so the predicted increase need not be reached.
struct Ascent<'a> {
    likelihood: &'a Likelihood<'a>,
    model: &'a Model,
    noise: &'a ProcessNoise,
    /// Most steps.
    limit: usize,
    p: &'a mut Vec<f64>,
    slope: Slope,
    evaluations: usize,
    /// What the steps gained [nats].
    gain: f64,
    error: Option<FilterError>,
}

impl Ascent<'_> {
    fn slope(&mut self) -> Result<Slope, FilterError> {
        let passes = self.likelihood.passes(self.model, self.p, self.noise, true, &[])?;
        self.evaluations += 1;
        let value: f64 = passes.iter().map(|pass| pass.log_likelihood).sum();
        if !value.is_finite() {
            return Err(FilterError::NotFinite);
        }
        let h: DMatrix<f64> = passes.iter().map(|pass| &pass.information).sum();
        let g: DVector<f64> = passes.iter().map(|pass| &pass.score).sum();
        let free = identified(self.model, self.p, &h);
        let step = newton_step(&h, &g, &free);
        let promised = 0.5 * step.iter().zip(&free).map(|(s, &j)| s * g[j]).sum::<f64>();
        Ok(Slope { value, free, step, promised })
    }

    /// Parameters after a share of the step. A shape outside its range has no meaning; linear parameters may cross
    /// zero, so that estimates of an absent effect scatter around it.
    fn moved(&self, share: f64) -> Vec<f64> {
        let mut trial = self.p.clone();
        for (s, &j) in self.slope.step.iter().zip(&self.slope.free) {
            let spec = &self.model.parameters()[j].spec;
            trial[j] += share * s;
            if spec.kind == ParameterKind::Shape {
                trial[j] = trial[j].clamp(spec.range.0, spec.range.1);
            }
        }
        trial
    }
}

impl DampedSearch for Ascent<'_> {
    /// A share of the step.
    type Step = f64;

    fn propose(&mut self, accepted: usize, rejected: usize) -> Proposal<f64> {
        if rejected == 0 {
            if accepted == self.limit {
                return Proposal::End(MinimumStatus::MaxIterations);
            }
            match self.slope() {
                Ok(slope) => self.slope = slope,
                Err(error) => {
                    self.error = Some(error);
                    return Proposal::End(MinimumStatus::Stalled);
                }
            }
            if self.slope.promised < GAIN {
                return Proposal::End(MinimumStatus::Converged);
            }
        }
        let share = 0.5_f64.powi(rejected as i32);
        if share < SHORTEST {
            let reached = self.slope.promised < SLACK;
            let end = if reached { MinimumStatus::Converged } else { MinimumStatus::Stalled };
            return Proposal::End(end);
        }
        Proposal::Step(share)
    }

    fn attempt(&mut self, share: f64) -> Attempt {
        let (trial, value) = (self.moved(share), self.slope.value);
        self.evaluations += 1;
        let there = self.likelihood.value(self.model, &trial, self.noise);
        let Some(there) = there.filter(|there| *there > value - 1e-9 * value.abs().max(1.0)) else {
            return Attempt::Rejected;
        };
        *self.p = trial;
        self.gain += there - value;
        if there - value < GAIN { Attempt::Last } else { Attempt::Accepted }
    }
}

/// Free parameters with information above rounding level; the others are kept fixed.
fn identified(model: &Model, p: &[f64], information: &DMatrix<f64>) -> Vec<usize> {
    let size = |j: usize| p[j].abs().max(model.parameters()[j].spec.typical.abs());
    let mut out = model.free();
    out.retain(|&j| information[(j, j)] * size(j).powi(2) > NOTHING);
    out
}

/// `H⁻¹ g` over the free columns; zero in directions that the data do not determine.
fn newton_step(h: &DMatrix<f64>, g: &DVector<f64>, free: &[usize]) -> Vec<f64> {
    let of_free = h.select_rows(free).select_columns(free);
    Information::new(&of_free).solve(&g.select_rows(free)).iter().copied().collect()
}
