//! Where likelihood methods start: the weak form, which needs no acceleration and no start.

use nalgebra::{DMatrix, DVector};

use super::{IdentifyError, Task};
use crate::effects::Motion;
use crate::model::Model;
use crate::recording::Recording;

/// Half width of a test function [s].
const HALF_WIDTH: f64 = 0.25;
/// Windows that touch a wheel slower than this share of the top speed are dropped: what friction
/// does there is not sgn(w).
const REST: f64 = 0.025;

/// A first guess of all parameters: weak-form least squares for the linear ones with the shape
/// parameters at their typical values, fixed ones as they are.
///
/// # Errors
/// If no usable window is left.
pub fn start(task: &Task, method: &str) -> Result<Vec<f64>, IdentifyError> {
    let mut p = task.model.initial();
    let linear = task.model.linear();
    let mut rows = Vec::new();
    for recording in task.train {
        weak_rows(task.model, &p, &linear, recording, &mut rows);
    }
    let samples: usize = task.train.iter().map(Recording::len).sum();
    if rows.len() < linear.len() {
        let usable = rows.len();
        return Err(IdentifyError::TooFewSamples { method: method.into(), usable, samples });
    }
    let x = DMatrix::from_fn(rows.len(), linear.len(), |i, j| rows[i].0[j]);
    let y = DVector::from_fn(rows.len(), |i, _| rows[i].1);
    let values = minimum_norm(&x, &y);
    for (value, &j) in values.iter().zip(&linear) {
        if value.abs() > 0.0 {
            p[j] = *value;
        }
    }
    sound(task.model, &mut p);
    Ok(p)
}

/// Least squares with columns scaled to unit norm and weak directions left out.
fn minimum_norm(x: &DMatrix<f64>, y: &DVector<f64>) -> DVector<f64> {
    // a column of zeros (no turning, no a3) keeps a coefficient of zero
    let scale: Vec<f64> =
        x.column_iter().map(|c| if c.norm() > 0.0 { c.norm() } else { 1.0 }).collect();
    let scaled = DMatrix::from_fn(x.nrows(), x.ncols(), |i, j| x[(i, j)] / scale[j]);
    let solution = scaled.svd(true, true).solve(y, 1e-6).expect("both factors were asked for");
    DVector::from_fn(x.ncols(), |j, _| solution[j] / scale[j])
}

/// Makes a start from which the model can move: a1 above |a2|, frictions not negative.
fn sound(model: &Model, p: &mut [f64]) {
    let parameters = model.parameters();
    let free = |j: usize| parameters[j].fixed.is_none();
    if free(0) && !(p[0] > 1.05 * p[1].abs()) {
        p[0] = (1.1 * p[1].abs()).max(1e-6);
    }
    for (j, parameter) in parameters.iter().enumerate().filter(|(j, _)| free(*j)) {
        if parameter.effect == "coulomb_friction" {
            p[j] = p[j].max(0.0);
        } else if parameter.spec.kind == crate::effects::ParameterKind::Shape {
            p[j] = p[j].clamp(parameter.spec.range.0, parameter.spec.range.1);
        }
    }
}

/// Rows of the weak form, `(columns, right-hand side)`:
/// `-∫ψ' A ω + ∫ψ (torque + friction) = ∫ψ M` with ψ = (1 - x²)⁴ over a window.
fn weak_rows(
    model: &Model,
    p: &[f64],
    linear: &[usize],
    recording: &Recording,
    rows: &mut Vec<(Vec<f64>, f64)>,
) {
    let t = recording.t();
    let drive = model.drive(t, recording.moment(), p);
    let half = ((HALF_WIDTH / recording.step()).round() as usize).max(4);
    let stride = (half / 2).max(1);
    let rest = REST * recording.top_speed();
    for piece in recording.pieces() {
        let mut centre = piece.start + half;
        while centre + half < piece.end {
            let window = centre - half..centre + half + 1;
            for wheel in 0..2 {
                if let Some(row) =
                    weak_row(model, p, linear, recording, &drive, &window, wheel, rest)
                {
                    rows.push(row);
                }
            }
            centre += stride;
        }
    }
}

fn weak_row(
    model: &Model,
    p: &[f64],
    linear: &[usize],
    recording: &Recording,
    drive: &[[f64; 2]],
    window: &std::ops::Range<usize>,
    wheel: usize,
    rest: f64,
) -> Option<(Vec<f64>, f64)> {
    let t = recording.t();
    let omega = recording.omega();
    let sign = omega[window.start].map(f64::signum);
    if window.clone().any(|k| (0..2).any(|i| omega[k][i] * sign[i] < rest)) {
        return None;
    }
    let (middle, reach) =
        (0.5 * (t[window.start] + t[window.end - 1]), 0.5 * (t[window.end - 1] - t[window.start]));
    let mut row = vec![0.0; linear.len()];
    let mut right = 0.0;
    let mut unit = p.to_vec();
    for k in window.clone() {
        let x = (t[k] - middle) / reach;
        let (weight, slope) = ((1.0 - x * x).powi(4), -8.0 * x * (1.0 - x * x).powi(3) / reach);
        let before = if k > window.start { t[k] - t[k - 1] } else { 0.0 };
        let after = if k + 1 < window.end { t[k + 1] - t[k] } else { 0.0 };
        let dt = 0.5 * (before + after);
        let motion = Motion {
            t: t[k] - t[0],
            alpha: recording.alpha()[k],
            omega: omega[k],
            variance: [0.0; 4],
            robot: model.robot(),
        };
        let signs = [0, 1, 2, 3].map(|j| crate::math::sgn(crate::effects::along(j, &omega[k])));
        // column j: what the balance gains from parameter j being one and not zero; what all
        // linear parameters at zero leave goes to the right
        for &j in linear {
            unit[j] = 0.0;
        }
        let balance = |q: &[f64]| {
            let terms = model.terms(&motion, q);
            let [m11, m12, m22] = terms.mass;
            let momentum = if wheel == 0 {
                m11 * omega[k][0] + m12 * omega[k][1]
            } else {
                m12 * omega[k][0] + m22 * omega[k][1]
            };
            let torque = terms.moment(&[0.0; 2], &signs)[wheel];
            dt * (weight * torque - slope * momentum)
        };
        let given = balance(&unit);
        for (column, &j) in linear.iter().enumerate() {
            unit[j] = 1.0;
            row[column] += balance(&unit) - given;
            unit[j] = 0.0;
        }
        right += dt * weight * drive[k][wheel] - given;
    }
    Some((row, right))
}

/// The covariance of all parameters from the information of all: fixed ones have none, and those
/// that take part in a direction which the data do not give have an infinite one.
#[must_use]
pub fn covariance_of_free(model: &Model, information: &DMatrix<f64>) -> DMatrix<f64> {
    let free = model.free();
    let n = free.len();
    let scale: Vec<f64> = free.iter().map(|&j| information[(j, j)].max(1e-300).sqrt()).collect();
    let scaled =
        DMatrix::from_fn(n, n, |i, k| information[(free[i], free[k])] / (scale[i] * scale[k]));
    let eigen = scaled.symmetric_eigen();
    let mut covariance = DMatrix::zeros(model.parameters().len(), model.parameters().len());
    for (value, v) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        for i in 0..n {
            for k in 0..n {
                let entry = &mut covariance[(free[i], free[k])];
                if *value > 1e-10 {
                    *entry += v[i] * v[k] / (value * scale[i] * scale[k]);
                } else if i == k && v[i].abs() > 1e-3 {
                    *entry = f64::INFINITY;
                }
            }
        }
    }
    covariance
}
