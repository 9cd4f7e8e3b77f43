//! Where likelihood methods start: the weak form, which needs no acceleration and no start.

use nalgebra::{DMatrix, DVector};

use super::regressor::{Regressor, input_around};
use super::weak::{Window, longest_motion, weak_rows, windows, windows_across_reversals};
use super::{IdentifyError, Task};
use crate::math::least_squares::fit_above;
use crate::model::Model;
use crate::recording::Recording;

/// Half widths of a test function \[s\]: the widest with which enough windows fit between rests and gaps.
const HALF_WIDTHS: [f64; 4] = [0.25, 0.12, 0.06, 0.03];
/// A choice of windows of a half width \[s\], so many on each half width.
type Select = fn(&Recording, f64, usize) -> Vec<Window>;
/// Directions of the regressor below this share of the largest stay out of a start: they would begin it far away.
const WEAK: f64 = 1e-6;

/// Initial values of all parameters: weak-form least squares for the linear ones with the shape parameters at their
/// typical values, fixed ones unchanged. If the input reverses so often that no window without a reversal is left,
/// windows with reversals are used.
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
    let rows_of = |(half_width, select): (f64, Select)| {
        let of = |recording: &Recording| {
            let windows = select(recording, half_width, 2);
            let input = input_around(task, recording, recording.torque());
            let omega = recording.on_lines(recording.omega());
            weak_rows(task, &regressor, recording, &windows, &omega, &input)
        };
        task.train.iter().map(of).collect::<Vec<_>>()
    };
    let count = |rows: &[(DMatrix<f64>, DVector<f64>)]| rows.iter().map(|(_, y)| y.len()).sum();
    let one_way = HALF_WIDTHS.map(|width| (width, windows as Select));
    let across = HALF_WIDTHS.map(|width| (width, windows_across_reversals as Select));
    let mut rows = vec![];
    let mut usable: usize = 0;
    for choice in one_way.into_iter().chain(across) {
        if usable > linear.len() {
            break;
        }
        rows = rows_of(choice);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::find;
    use crate::model::base::{A1, A2, A4};
    use crate::recording::{Channels, DriveUnit};
    use crate::robot::{Robot, State};
    use crate::simulate::{Hold, Input, simulate};

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

    /// Torques that reverse every five rows, out of phase, so that no movement lasts as long as a window.
    fn reversing() -> Recording {
        let model = Model::base(Robot::amigobot());
        let t: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
        let wave = |t: f64, phase: f64| 0.6 * (20.0 * std::f64::consts::PI * t + phase).sin();
        let torque: Vec<[f64; 2]> = t.iter().map(|t| [wave(*t, 0.0), wave(*t, 0.7)]).collect();
        let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
        let rest = State { alpha: [0.0; 2], omega: [0.0; 2] };
        let states = simulate(&model, &model.initial(), &input, rest).unwrap();
        let channels = Channels {
            t: t.clone(),
            alpha: Some(states.iter().map(|s| s.alpha).collect()),
            omega: Some(states.iter().map(|s| s.omega).collect()),
            torque,
        };
        Recording::new("reversing", channels, DriveUnit::NewtonMetre).unwrap()
    }

    #[test]
    fn an_input_that_reverses_every_few_rows_has_a_start() {
        let (model, train) = (Model::base(Robot::amigobot()), [reversing()]);
        assert!(windows(&train[0], HALF_WIDTHS[3], 2).is_empty());
        let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 0 };
        let (p, truth) = (start(&task, "test").unwrap(), model.initial());
        // ten rows per period: the sum over rows misses the reversals within them, which a simulation does not
        let fit = find("output_error").unwrap().identify(&task).unwrap();
        for j in [A1, A4] {
            assert!((0.4..2.0).contains(&(p[j] / truth[j])), "{j}: {p:?}");
            let estimate = fit.estimates[j].value;
            assert!((estimate / truth[j] - 1.0).abs() < 1e-3, "{j}: {estimate}");
        }
    }
}
