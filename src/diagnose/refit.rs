//! Refit: the likelihood of the model with a candidate in it, and its evidence.

use nalgebra::DMatrix;

use super::candidate::{Candidate, Form};
use super::scan::{PRIOR_SHARE, Score, left_out_gain};
use crate::compare::project;
use crate::effects::ParameterKind;
use crate::identify::IdentifyError;
use crate::identify::kalman::{Likelihood, Maximum, ProcessNoise};
use crate::model::Model;

/// A model with one candidate added, fitted.
#[derive(Clone)]
pub struct Refit {
    /// The model with the effect.
    pub model: Model,
    /// Its maximum.
    pub maximum: Maximum,
    /// Log-evidence over the model without it, less what noise of the drive gives a lag.
    pub evidence: f64,
    /// Gain in log-likelihood, less the same.
    pub gain: f64,
    /// Gain on recordings left out; zero for a single recording.
    pub cross_gain: f64,
    /// Wald statistic of its linear parameters (chi-square).
    pub wald: f64,
    /// Whether its parameters are within their ranges.
    pub in_range: bool,
}

/// Adds the candidate to the model and maximises the likelihood over all parameters and the noise.
///
/// ```text
/// E* = Δll - ½ ln|1 + Π½ I Π½| - ½ θ'Π⁻¹θ - ln(grid)
/// ```
///
/// # Errors
/// If the likelihood has no value at the start.
pub fn refit(
    model: &Model,
    base: &Maximum,
    candidate: &Candidate,
    score: &Score,
    likelihood: &Likelihood,
) -> Result<Refit, IdentifyError> {
    let mut extended = model.add_effect(candidate.effect.clone())?;
    let mut start = start(candidate, score);
    let mut p = base.p.clone();
    p.extend(&start);
    if let Some(shift) = best_shift(&extended, &p, base, candidate, likelihood) {
        start[0] = shift;
        let last = p.len() - start.len();
        p[last] = shift;
    }
    // an order of ripple is a whole number: it stays where the grid found it
    if candidate.id == "torque_ripple" {
        for (value, spec) in start.iter().zip(candidate.effect.parameters()) {
            if spec.kind == ParameterKind::Shape {
                extended = extended.fix(&spec.symbol, *value)?;
            }
        }
    }
    let maximum = maximise(&extended, &p, base.noise, likelihood)?;
    Ok(judge(extended, maximum, base, candidate, score, likelihood))
}

/// Gain in log-likelihood on each recording in turn when the parameters come from the others, by
/// one Gauss-Newton step, against the same for the model without the effect.
fn cross_gain(extended: &Model, maximum: &Maximum, base: &Maximum) -> f64 {
    if maximum.passes.len() < 2 {
        return 0.0;
    }
    let free = extended.free();
    let given: Vec<usize> = free.iter().copied().filter(|&j| j < base.p.len()).collect();
    let left_out = |m: &Maximum, columns: &[usize]| -> f64 {
        let g = m.passes.iter().map(|pass| &pass.score).sum();
        let one = |pass| left_out_gain(pass, &m.information, &g, columns);
        m.passes.iter().map(one).sum()
    };
    maximum.log_likelihood - base.log_likelihood + left_out(maximum, &free) - left_out(base, &given)
}

/// Shifts in time that are tried, in samples: a long delay is out of reach of a linear step.
const SHIFTS: [f64; 7] = [0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];

/// Least share of samples that a saturation must clip to be one.
const CLIPPED: f64 = 0.01;

/// A limit that next to no sample reaches explains outliers, not a drive.
fn clips_enough(candidate: &Candidate, own: &[f64], likelihood: &Likelihood) -> bool {
    if candidate.id != "torque_saturation" {
        return true;
    }
    let rows = || likelihood.prepared.iter().flat_map(|p| p.recording.moment()).flatten();
    let clipped = rows().filter(|m| m.abs() > own[0]).count();
    clipped as f64 > CLIPPED * rows().count() as f64
}

/// A shift in time below half a sample is the logger's business, not the robot's.
fn late_enough(candidate: &Candidate, own: &[f64], likelihood: &Likelihood) -> bool {
    let step = likelihood.prepared.iter().map(|p| p.recording.step()).fold(0.0, f64::max);
    !candidate.is_shift() || own[0] > 0.5 * step
}

/// For a lag or delay: the best of the scan's estimate and a grid of shifts, by likelihood.
fn best_shift(
    model: &Model,
    p: &[f64],
    base: &Maximum,
    candidate: &Candidate,
    likelihood: &Likelihood,
) -> Option<f64> {
    if !candidate.is_shift() {
        return None;
    }
    let spec = &candidate.effect.parameters()[0];
    let first = p.len() - candidate.p.len();
    let step = likelihood.prepared.iter().map(|r| r.recording.step()).fold(f64::MAX, f64::min);
    let mut shifts = vec![p[first]];
    shifts.extend(SHIFTS.map(|s| s * step).iter().filter(|s| **s < spec.range.1.min(0.3)));
    let value = |shift: f64| {
        let mut trial = p.to_vec();
        trial[first] = shift;
        likelihood.value(model, &trial, &base.noise).unwrap_or(f64::NEG_INFINITY)
    };
    let scored = shifts.into_iter().map(|shift| (value(shift), shift));
    scored.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, shift)| shift)
}

/// Parameters, noise, parameters.
fn maximise(
    model: &Model,
    p: &[f64],
    noise: ProcessNoise,
    likelihood: &Likelihood,
) -> Result<Maximum, IdentifyError> {
    let first = likelihood.maximise(model, p, Some(noise), "diagnosis")?;
    let (noise, _) = likelihood.noise(model, &first.p, &noise);
    likelihood.maximise(model, &first.p, Some(noise), "diagnosis")
}

/// Where the search for the candidate's parameters starts.
fn start(candidate: &Candidate, score: &Score) -> Vec<f64> {
    let specs = candidate.effect.parameters();
    let mut p = candidate.p.clone();
    match &candidate.form {
        Form::Instant => {
            for (value, &j) in score.estimate.iter().zip(&candidate.linear) {
                p[j] = *value;
            }
        }
        Form::Signal(_) => match candidate.linear.first() {
            Some(&j) => p[j] = score.estimate[0],
            // a time shift: its column was per second, so the estimate is the time itself
            None if candidate.is_shift() => p[0] = score.estimate[0],
            None => {}
        },
    }
    for (value, spec) in p.iter_mut().zip(&specs) {
        if spec.kind == ParameterKind::Shape {
            *value = value.clamp(spec.range.0, spec.range.1);
        }
    }
    p
}

fn judge(
    model: Model,
    maximum: Maximum,
    base: &Maximum,
    candidate: &Candidate,
    score: &Score,
    likelihood: &Likelihood,
) -> Refit {
    let gain = maximum.log_likelihood - base.log_likelihood;
    let cross_gain = cross_gain(&model, &maximum, base);
    let first = model.parameters().len() - candidate.p.len();
    let own: Vec<usize> = if candidate.linear.is_empty() {
        (first..first + candidate.p.len()).collect()
    } else {
        candidate.linear.iter().map(|j| first + j).collect()
    };
    let others: Vec<usize> = model.free().into_iter().filter(|j| !own.contains(j)).collect();
    let g = nalgebra::DVector::zeros(maximum.information.nrows());
    let (information, _) = project(&maximum.information, &g, &others, &own);
    let rms = likelihood.moment_rms();
    let n = own.len();
    let theta = nalgebra::DVector::from_fn(n, |j, _| maximum.p[own[j]]);
    let prior = nalgebra::DVector::from_fn(n, |j, _| {
        let size = score.size[j.min(score.size.len() - 1)];
        // a threshold is no coefficient: its prior is as wide as itself
        let threshold = candidate.linear.is_empty() && !candidate.is_shift();
        if threshold { theta[j].abs().max(1e-12) } else { PRIOR_SHARE * rms / size }
    });
    let whitened = DMatrix::from_fn(n, n, |i, k| prior[i] * information[(i, k)] * prior[k]);
    let occam = (DMatrix::identity(n, n) + whitened).determinant().max(1.0).ln();
    let misfit: f64 = (0..n).map(|j| (theta[j] / prior[j]).powi(2)).sum();
    let evidence = gain - 0.5 * occam - 0.5 * misfit - (candidate.grid as f64).ln();
    let wald = theta.dot(&(&information * &theta));
    let specs = candidate.effect.parameters();
    let in_range = specs.iter().zip(&maximum.p[first..]).all(|(s, v)| {
        // at the edge of a shape's range the effect is another one in disguise
        let inside = *v > s.range.0 && *v < s.range.1;
        if s.kind == ParameterKind::Shape && candidate.id != "torque_ripple" {
            inside
        } else {
            *v >= s.range.0 && *v <= s.range.1
        }
    });
    let own = &maximum.p[first..];
    let in_range = in_range
        && clips_enough(candidate, own, likelihood)
        && late_enough(candidate, own, likelihood);
    Refit { model, maximum, evidence, gain, cross_gain, wald, in_range }
}
