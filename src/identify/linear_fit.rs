//! From the values of the linear parameters and their covariance to a fit.

use nalgebra::{DMatrix, DVector};

use super::identifiability::identified;
use super::{Fit, IdentifyError, Task};

/// A fit of the linear parameters alone: shapes and drives are held where the model starts.
///
/// `information` of the columns tells which directions the data give, up to a factor; `covariance`
/// is that of the columns.
pub(super) fn linear_fit(
    method: &str,
    task: &Task,
    linear: &[usize],
    values: &DVector<f64>,
    information: &DMatrix<f64>,
    covariance: &DMatrix<f64>,
) -> Result<Fit, IdentifyError> {
    let total = task.model.parameters().len();
    let mut p = task.model.initial();
    for (value, &j) in values.iter().zip(linear) {
        p[j] = *value;
    }
    let mut held = task.model.clone();
    for j in task.model.free().into_iter().filter(|j| !linear.contains(j)) {
        held = held.fix(&task.model.parameters()[j].spec.symbol, p[j])?;
    }
    let spread = |small: &DMatrix<f64>| {
        let mut out = DMatrix::zeros(total, total);
        for (i, &a) in linear.iter().enumerate() {
            for (k, &b) in linear.iter().enumerate() {
                out[(a, b)] = small[(i, k)];
            }
        }
        out
    };
    let known = identified(&held, &p, &spread(information), Some(&spread(covariance)), task.train);
    let mut notes = known.notes;
    let blind = |j: usize| known.covariance[(j, j)].is_infinite();
    settle(&mut p, task, blind(0) || blind(1), &mut notes);
    let unit = task.train[0].drive_unit();
    let mut out = Fit::physical(method, task.model, p, known.covariance, unit);
    for (j, estimate) in out.estimates.iter_mut().enumerate() {
        estimate.fixed |= !linear.contains(&j);
    }
    out.notes = notes;
    Ok(out)
}

/// Where the data give a1 + a2 or a1 - a2 alone, takes of all that fit one that can move (a1 above
/// |a2|); where they contradict it, says so.
pub(super) fn settle(p: &mut [f64], task: &Task, blind: bool, notes: &mut Vec<String>) {
    let free = |j: usize| task.model.parameters()[j].fixed.is_none();
    if p[0] > 1.05 * p[1].abs() {
        return;
    }
    if blind && free(0) && free(1) {
        let side = if p[1] < 0.0 { -1.0 } else { 1.0 };
        let sum = p[0] + side * p[1];
        (p[0], p[1]) = (0.525 * sum, 0.475 * side * sum);
    } else if !(p[0] > p[1].abs()) {
        notes.push(
            "a1 does not exceed |a2|: no mass matrix has these values, and they cannot be \
             simulated; use constrained_regression, or prediction_error."
                .into(),
        );
    }
}

/// Covariance that holds when errors within a block are correlated and of unequal size.
///
/// ```text
/// C = c B [ Σ_b s_b s_b' ] B',   s_b = Σ_{i in b} z_i ψ_i,   c = G/(G-1) n/(n - width)
/// ```
/// `bread` B is the inverse of `Σ z x' ψ'`, `z` the instruments (the columns themselves for least
/// squares), `psi` the influence of each residual. With fewer than two blocks rows count as
/// independent.
///
/// Source: Liang and Zeger, Biometrika 73 (1986).
pub(super) fn block_covariance(
    bread: &DMatrix<f64>,
    z: &DMatrix<f64>,
    psi: &DVector<f64>,
    block: &[usize],
) -> DMatrix<f64> {
    clustered_covariance(bread, z, psi, block, z.nrows())
}

/// [`block_covariance`] of so many `rows` of data, which those of `z` may stand for.
pub(super) fn clustered_covariance(
    bread: &DMatrix<f64>,
    z: &DMatrix<f64>,
    psi: &DVector<f64>,
    block: &[usize],
    rows: usize,
) -> DMatrix<f64> {
    let blocks = block.iter().max().map_or(0, |b| b + 1);
    let one = |i: usize| if blocks < 2 { i } else { block[i] };
    let mut scores = std::collections::BTreeMap::<usize, DVector<f64>>::new();
    for i in 0..z.nrows() {
        let sum = scores.entry(one(i)).or_insert_with(|| DVector::zeros(z.ncols()));
        sum.axpy(psi[i], &z.row(i).transpose(), 1.0);
    }
    let (g, n) = (scores.len() as f64, rows as f64);
    let mut middle = DMatrix::zeros(z.ncols(), z.ncols());
    for s in scores.values() {
        middle += s * s.transpose();
    }
    let factor = g / (g - 1.0) * n / (n - z.ncols() as f64).max(1.0);
    bread * middle * bread.transpose() * factor
}

/// Information of `own` after `nuisance` took up what it can.
pub(super) fn schur(h: &DMatrix<f64>, nuisance: &[usize], own: &[usize]) -> DMatrix<f64> {
    let (n, m) = (nuisance.len(), own.len());
    let scale: Vec<f64> = nuisance.iter().map(|&j| 1.0 / h[(j, j)].max(1e-300).sqrt()).collect();
    let nn = DMatrix::from_fn(n, n, |i, k| h[(nuisance[i], nuisance[k])] * scale[i] * scale[k]);
    let no = DMatrix::from_fn(n, m, |i, k| h[(nuisance[i], own[k])] * scale[i]);
    let oo = DMatrix::from_fn(m, m, |i, k| h[(own[i], own[k])]);
    if n == 0 {
        return oo;
    }
    let inverse = nn.pseudo_inverse(1e-12).unwrap_or_else(|_| DMatrix::zeros(n, n));
    oo - no.transpose() * inverse * no
}
