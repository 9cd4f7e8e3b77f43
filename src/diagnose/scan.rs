//! The score scan: one filter pass tells of every candidate how much it would gain.

use nalgebra::{DMatrix, DVector};

use super::candidate::{Candidate, column_size};
use super::signals::smoothed_drive;
use crate::compare::{log_significance, project, score_statistic};
use crate::identify::kalman::{Columns, Instant, Likelihood, Pass, ProcessNoise};
use crate::model::{Model, ModelError};
use crate::recording::{LocalMotion, Recording};

/// Prior size of an effect as a share of the root mean square drive: 0.02 N m on the AmigoBot.
pub(super) const PRIOR_SHARE: f64 = 0.1;
/// Prior of a timing error between drive and speeds, in sample steps.
const TIMING: f64 = 0.3;
/// Columns that the base explains to better than this share are not looked at.
const COLLINEAR: f64 = 1e-7;

/// What the scan says of one candidate.
#[derive(Clone, Debug)]
pub struct Score {
    /// Test statistic after sign constraints.
    pub statistic: f64,
    /// Degrees of freedom.
    pub rank: usize,
    /// -ln of the p-value.
    pub log_significance: f64,
    /// Log-evidence over the base.
    pub evidence: f64,
    /// Gain on recordings left out.
    pub cross_gain: f64,
    /// Estimates of the columns' coefficients.
    pub estimate: Vec<f64>,
    /// Root mean square of the columns [N m per unit].
    pub size: Vec<f64>,
}

struct Scan<'a> {
    candidates: &'a [Candidate],
    recording: usize,
    rate: Vec<[f64; 2]>,
    columns: usize,
}

impl Columns for Scan<'_> {
    fn count(&self) -> usize {
        self.columns
    }
    fn torque(&self, at: &Instant, out: &mut [[f64; 2]]) {
        out[0] = self.rate[at.sample].map(|rate| -rate);
        let mut next = 1;
        let sign = self.candidates.first().map_or([0.0; 4], |first| first.signs(at));
        for candidate in self.candidates {
            let width = candidate.columns();
            candidate.torque_with(self.recording, at, &sign, &mut out[next..next + width]);
            next += width;
        }
    }
}

/// Scores every candidate at the maximum `p` of `model`.
///
/// The base of each test is the free parameters of the model and a timing error between drive and
/// speeds with a prior of 0.3 sample steps, so that half a sample of skew is not an effect.
///
/// ```text
/// T_J = s' I⁻¹ s,  E_J = ½ s'(I+Π⁻¹)⁻¹ s - ½ ln|1 + Π½ I Π½| - ln(grid),  Π = (0.1 rms M / rms φ)²
/// ```
///
/// # Errors
/// If the model has no acceleration.
pub fn scan(
    model: &Model,
    p: &[f64],
    noise: &ProcessNoise,
    likelihood: &Likelihood,
    candidates: &[Candidate],
) -> Result<Vec<Score>, ModelError> {
    let recordings: Vec<&Recording> = likelihood.prepared.iter().map(|p| p.recording).collect();
    let columns = 1 + candidates.iter().map(Candidate::columns).sum::<usize>();
    let scans: Vec<Scan> = recordings
        .iter()
        .enumerate()
        .map(|(recording, r)| Scan { candidates, recording, rate: drive_rate(r), columns })
        .collect();
    let sources: Vec<&dyn Columns> = scans.iter().map(|s| s as &dyn Columns).collect();
    let mut passes = likelihood.passes(model, p, noise, true, &sources)?;
    let step = recordings.iter().map(|r| r.step()).fold(f64::MAX, f64::min);
    let prior = 1.0 / (TIMING * step).powi(2);
    let count = passes.len() as f64;
    for pass in &mut passes {
        pass.information[(p.len(), p.len())] += prior / count;
    }
    let mut base = model.free();
    base.push(p.len());
    let rms = likelihood.moment_rms();
    let motions: Vec<Vec<LocalMotion>> = recordings.iter().map(|r| r.local_motion()).collect();
    let mut next = p.len() + 1;
    Ok(candidates
        .iter()
        .map(|candidate| {
            let own: Vec<usize> = (next..next + candidate.columns()).collect();
            next += candidate.columns();
            let size = column_size(candidate, model, &recordings, &motions);
            score(candidate, &passes, &base, &own, rms, size)
        })
        .collect())
}

/// Rate of the smoothed drive [N m/s], one value a sample step.
fn drive_rate(recording: &Recording) -> Vec<[f64; 2]> {
    let (t, m) = (recording.t(), smoothed_drive(recording));
    let mut rate = vec![[0.0; 2]; t.len()];
    for piece in recording.pieces() {
        for k in piece.start..piece.end - 1 {
            rate[k] = [0, 1].map(|i| (m[k + 1][i] - m[k][i]) / (t[k + 1] - t[k]));
        }
    }
    rate
}

fn score(
    candidate: &Candidate,
    passes: &[Pass],
    base: &[usize],
    own: &[usize],
    rms: f64,
    size: Vec<f64>,
) -> Score {
    let h: DMatrix<f64> = passes.iter().map(|pass| &pass.information).sum();
    let g: DVector<f64> = passes.iter().map(|pass| &pass.score).sum();
    let (information, right) = project(&h, &g, base, own);
    let n = own.len();
    let none = |size: Vec<f64>| Score {
        statistic: 0.0,
        rank: 0,
        log_significance: 0.0,
        evidence: f64::NEG_INFINITY,
        cross_gain: 0.0,
        estimate: vec![0.0; n],
        size,
    };
    if n == 0 {
        return none(size);
    }
    if (0..n).any(|j| {
        let own_part = h[(own[j], own[j])];
        own_part.is_nan() || information[(j, j)] <= COLLINEAR * own_part
    }) {
        return none(size);
    }
    let Some(estimate) = information.clone().pseudo_inverse(1e-12).ok().map(|i| i * &right) else {
        return none(size);
    };
    let violates = (0..n).any(|j| n == 1 && candidate.not_negative(j) && estimate[j] <= 0.0);
    if violates {
        return none(size);
    }
    let (statistic, rank) = score_statistic(&information, &right);
    let prior = DVector::from_fn(n, |j, _| PRIOR_SHARE * rms / size[j]);
    let whitened = DMatrix::from_fn(n, n, |i, k| prior[i] * information[(i, k)] * prior[k]);
    let tempered = DMatrix::identity(n, n) + &whitened;
    let scaled = DVector::from_fn(n, |j, _| prior[j] * right[j]);
    let solved = tempered.clone().lu().solve(&scaled).unwrap_or_else(|| DVector::zeros(n));
    let evidence = 0.5 * scaled.dot(&solved)
        - 0.5 * tempered.determinant().max(1.0).ln()
        - (candidate.grid as f64).ln();
    Score {
        statistic,
        rank,
        log_significance: log_significance(statistic, rank),
        evidence,
        cross_gain: cross_gain(passes, &h, &g, base, own),
        estimate: estimate.iter().copied().collect(),
        size,
    }
}

/// Gain in log-likelihood on each recording in turn when base and columns take one Gauss-Newton
/// step from the others, minus the same for the base alone. Zero for a single recording.
fn cross_gain(
    passes: &[Pass],
    h: &DMatrix<f64>,
    g: &DVector<f64>,
    base: &[usize],
    own: &[usize],
) -> f64 {
    if passes.len() < 2 {
        return 0.0;
    }
    let both: Vec<usize> = base.iter().chain(own).copied().collect();
    passes
        .iter()
        .map(|pass| {
            let gain = |columns: &[usize]| left_out_gain(pass, h, g, columns);
            gain(&both) - gain(base)
        })
        .sum()
}

/// Change of the log-likelihood of one recording when `columns` take one Gauss-Newton step from the
/// others alone.
pub(super) fn left_out_gain(
    pass: &Pass,
    h: &DMatrix<f64>,
    g: &DVector<f64>,
    columns: &[usize],
) -> f64 {
    let n = columns.len();
    let at = |m: &DMatrix<f64>, i: usize, k: usize| m[(columns[i], columns[k])];
    let scale: Vec<f64> = (0..n).map(|j| 1.0 / at(h, j, j).max(1e-300).sqrt()).collect();
    let rest = DMatrix::from_fn(n, n, |i, k| {
        (at(h, i, k) - at(&pass.information, i, k)) * scale[i] * scale[k]
    });
    let right = DVector::from_fn(n, |j, _| (g[columns[j]] - pass.score[columns[j]]) * scale[j]);
    let Ok(inverse) = rest.pseudo_inverse(1e-10) else { return 0.0 };
    let step = inverse * right;
    let own = DMatrix::from_fn(n, n, |i, k| at(&pass.information, i, k) * scale[i] * scale[k]);
    let linear: f64 = (0..n).map(|j| pass.score[columns[j]] * scale[j] * step[j]).sum();
    linear - 0.5 * step.dot(&(own * &step))
}
