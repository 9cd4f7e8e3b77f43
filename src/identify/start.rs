//! Where likelihood methods start: the weak form, which needs no acceleration and no start.

use nalgebra::{DMatrix, DVector};

use super::identifiability::among_all;
use super::regressor::{Regressor, drive_around};
use super::weak::{weak_rows, windows};
use super::{IdentifyError, Task};
use crate::math::Information;
use crate::model::Model;
use crate::model::base::{A1, A2};
use crate::recording::Recording;

/// Half width of a test function \[s\].
const HALF_WIDTH: f64 = 0.25;

/// A first guess of all parameters: weak-form least squares for the linear ones with the shape
/// parameters at their typical values, fixed ones as they are.
///
/// # Errors
/// If no usable window is left.
pub fn start(task: &Task, method: &str) -> Result<Vec<f64>, IdentifyError> {
    let mut p = task.model.initial();
    let regressor = Regressor::new(task.model, &p);
    let linear = &regressor.linear;
    if linear.is_empty() {
        return Ok(p);
    }
    let mut rows = Vec::new();
    for recording in task.train {
        let windows = windows(recording, HALF_WIDTH, 2);
        let drive = drive_around(task, recording, recording.moment());
        rows.push(weak_rows(task, &regressor, recording, &windows, recording.omega(), &drive));
    }
    let samples: usize = task.train.iter().map(Recording::len).sum();
    let usable = rows.iter().map(|(_, y)| y.len()).sum();
    if usable < linear.len() {
        return Err(IdentifyError::TooFewSamples { method: method.into(), usable, samples });
    }
    let mut x = DMatrix::zeros(usable, linear.len());
    let mut y = DVector::zeros(usable);
    let mut first = 0;
    for (part, right) in &rows {
        x.rows_mut(first, right.len()).copy_from(part);
        y.rows_mut(first, right.len()).copy_from(right);
        first += right.len();
    }
    let values = minimum_norm(&x, &y);
    for (value, &j) in values.iter().zip(linear) {
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
pub(super) fn sound(model: &Model, p: &mut [f64]) {
    let parameters = model.parameters();
    let free = |j: usize| parameters[j].fixed.is_none();
    if free(A1) && !(p[A1] > 1.05 * p[A2].abs()) {
        p[A1] = (1.1 * p[A2].abs()).max(1e-6);
    }
    for (j, parameter) in parameters.iter().enumerate().filter(|(j, _)| free(*j)) {
        if parameter.effect == "coulomb_friction" {
            p[j] = p[j].max(0.0);
        } else if parameter.spec.kind == crate::effects::ParameterKind::Shape {
            p[j] = p[j].clamp(parameter.spec.range.0, parameter.spec.range.1);
        }
    }
}

/// The covariance of all parameters from the information of all: fixed ones have none, and those
/// that take part in a direction which the data do not give have an infinite one.
#[must_use]
pub fn covariance_of_free(model: &Model, information: &DMatrix<f64>) -> DMatrix<f64> {
    let free = model.free();
    let of_free = information.select_rows(&free).select_columns(&free);
    among_all(model, &Information::new(&of_free).covariance())
}
