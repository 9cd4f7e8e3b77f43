//! Where likelihood methods start: the weak form, which needs no acceleration and no start.

use nalgebra::{DMatrix, DVector};

use super::identifiability::among_all;
use super::regressor::{Regressor, input_around};
use super::weak::{longest_motion, weak_rows, windows};
use super::{IdentifyError, Task};
use crate::math::Information;
use crate::math::least_squares::fit_above;
use crate::model::Model;
use crate::recording::Recording;

/// Half widths of a test function \[s\]: the widest with which enough windows fit between rests and gaps.
const HALF_WIDTHS: [f64; 4] = [0.25, 0.12, 0.06, 0.03];
/// Directions of the regressor below this share of the largest stay out of a start: they would begin it far away.
const WEAK: f64 = 1e-6;

/// Initial values of all parameters: weak-form least squares for the linear ones with the shape parameters at
/// their typical values, fixed ones unchanged.
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
    let rows_of = |half_width: f64| {
        let of = |recording: &Recording| {
            let windows = windows(recording, half_width, 2);
            let input = input_around(task, recording, recording.torque());
            let omega = recording.on_lines(recording.omega());
            weak_rows(task, &regressor, recording, &windows, &omega, &input)
        };
        task.train.iter().map(of).collect::<Vec<_>>()
    };
    let count = |rows: &[(DMatrix<f64>, DVector<f64>)]| rows.iter().map(|(_, y)| y.len()).sum();
    let mut widths = HALF_WIDTHS.into_iter();
    let mut rows = widths.next().map(rows_of).unwrap_or_default();
    let mut usable: usize = count(&rows);
    for half_width in widths {
        if usable > linear.len() {
            break;
        }
        rows = rows_of(half_width);
        usable = count(&rows);
    }
    if usable <= linear.len() {
        let samples = task.train.iter().map(Recording::len).sum();
        let moving_s = longest_motion(task.train);
        return Err(IdentifyError::TooFewSamples {
            method: method.into(),
            usable,
            samples,
            moving_s,
        });
    }
    let mut x = DMatrix::zeros(usable, linear.len());
    let mut y = DVector::zeros(usable);
    let mut first = 0;
    for (part, right) in &rows {
        x.rows_mut(first, right.len()).copy_from(part);
        y.rows_mut(first, right.len()).copy_from(right);
        first += right.len();
    }
    let fit = fit_above(WEAK, &x, &y, None);
    let fit =
        fit.map_err(|e| IdentifyError::Unsupported { method: method.into(), reason: e.into() })?;
    for (value, &j) in fit.coefficients.iter().zip(linear) {
        if value.abs() > 0.0 {
            p[j] = *value;
        }
    }
    sound(task.model, &mut p);
    Ok(p)
}

/// Makes a start from which the model can move, as its effects state it ([`crate::effects::Physics::start`]); fixed
/// values stay.
pub(super) fn sound(model: &Model, p: &mut [f64]) {
    (0..model.effects().len()).for_each(|e| sound_effect(model, e, p));
}

/// The same for the inertias alone, which are those of the first effect: a1 above |a2|.
pub(super) fn with_positive_mass(model: &Model, p: &mut [f64]) {
    sound_effect(model, 0, p);
}

fn sound_effect(model: &Model, e: usize, p: &mut [f64]) {
    let slots = model.slots(e);
    let free: Vec<bool> =
        model.parameters()[slots.clone()].iter().map(|q| q.fixed.is_none()).collect();
    let mut moved = p[slots.clone()].to_vec();
    model.effects()[e].start(&mut moved, &free);
    let values = p[slots].iter_mut().zip(moved).zip(free);
    values.filter(|(_, free)| *free).for_each(|((value, moved), _)| *value = moved);
}

/// The covariance of all parameters from the information of all: fixed ones have none, and those
/// that take part in a direction which the data do not give have an infinite one.
#[must_use]
pub fn covariance_of_free(model: &Model, information: &DMatrix<f64>) -> DMatrix<f64> {
    let free = model.free();
    let of_free = information.select_rows(&free).select_columns(&free);
    among_all(model, &Information::new(&of_free).covariance())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::base::{A1, A2, A4};
    use crate::robot::Robot;

    #[test]
    fn a_start_keeps_the_inertia_that_the_data_show() {
        let model = Model::base(Robot::amigobot());
        // straight driving gives a1 + a2, pivots give a1 - a2; the shortest solution has a1 = |a2|
        for a2 in [0.0147, -0.0147] {
            let mut p = vec![0.0147, a2, 0.0, -0.1, 0.1];
            sound(&model, &mut p);
            assert!((p[A1] - 1.1 * p[A2].abs()).abs() < 1e-15 && p[A2] * a2 > 0.0, "{p:?}");
            assert!((p[A1] + p[A2].abs() - 0.0294).abs() < 1e-15, "{p:?}");
            assert_eq!(p[A4], 0.0);
        }
        let fixed = model.fix("a2", 0.02).unwrap();
        let mut p = vec![0.0147, 0.02, 0.0, 0.1, 0.1];
        sound(&fixed, &mut p);
        assert_eq!((p[A1], p[A2]), (1.1 * 0.02, 0.02));
    }
}
