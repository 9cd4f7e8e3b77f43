//! A regression with the shape parameters held at another fit's values.

use crate::effects::ParameterKind;
use crate::identify::torque_regression::TorqueRegression;
use crate::identify::{Estimate, Fit, Identifier, Task};
use crate::model::Model;

/// Relative change of a shape by which derivatives are computed.
const STEP: f64 = 0.01;

/// Indices of the estimated shape parameters, which a regression holds.
fn shapes(model: &Model) -> impl Iterator<Item = usize> {
    let is_shape = |j: &usize| model.parameters()[*j].spec.kind == ParameterKind::Shape;
    model.free().into_iter().filter(is_shape)
}

/// The model with the shapes of a fit; `None` if it has none.
pub(super) fn shaped(model: &Model, fit: &Fit) -> Option<Model> {
    shapes(model).next()?;
    Some(shapes(model).fold(model.clone(), |out, j| out.starting_at(j, fit.estimates[j].value)))
}

/// Sets the standard errors of the shapes that the `regression` of `task` fixed at the values of `fit`, and adds the
/// errors that these cause to those of the other parameters.
///
/// ```text
/// s_k² → s_k² + Σ_j (∂θ_k/∂θ_j)² s_j²,   j: shapes that were held, ∂ by a regression with shape j moved
/// ```
/// A parameter that changes by more than its standard error when an unidentifiable shape is changed by its own value is
/// not identifiable either.
///
/// Source: propagation of errors of a two-step estimate, without the covariance of the steps (Murphy and Topel, J. Bus.
/// Econ. Stat. 3, 1985).
pub(super) fn with_shapes_of(fit: &Fit, regression: &mut Fit, task: &Task) {
    let before: Vec<f64> = regression.estimates.iter().map(|e| e.value).collect();
    for j in shapes(task.model) {
        let shape = fit.estimates[j].clone();
        let step = STEP * shape.value.abs().max(task.model.parameters()[j].spec.typical.abs());
        let model = task.model.starting_at(j, shape.value + step);
        let moved = TorqueRegression::default().identify(&Task { model: &model, ..*task });
        for (k, from) in before.iter().enumerate() {
            let Some(to) = moved.as_ref().ok().map(|m| m.estimates[k].value) else { continue };
            let slope = (to - from) / step;
            if !regression.estimates[k].fixed && slope.is_finite() {
                widen(&mut regression.estimates[k], slope, &shape);
            }
        }
        regression.estimates[j] = shape;
    }
    let variances: Vec<f64> = regression.estimates.iter().map(|e| e.std_error.powi(2)).collect();
    if let Some(covariance) = &mut regression.covariance {
        variances.into_iter().enumerate().for_each(|(k, v)| covariance[(k, k)] = v);
    }
}

/// Adds the contribution of a shape's error to the error of an estimate.
fn widen(estimate: &mut Estimate, slope: f64, shape: &Estimate) {
    let by = match shape.std_error.is_finite() {
        true => slope * shape.std_error,
        false if (slope * shape.value).abs() > estimate.std_error => f64::INFINITY,
        false => 0.0,
    };
    let (error, degrees) = (estimate.std_error.hypot(by), estimate.degrees);
    let wider = Estimate { std_error: error, ..estimate.clone() };
    *estimate = wider.with_degrees(degrees);
    estimate.identifiable &= error.is_finite();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::base::A1;
    use crate::robot::Robot;
    use crate::simulate::{Hold, Movement, NoiseLevel, Recorder, record};

    #[test]
    fn friction_beside_a_dead_zone_has_the_error_of_the_dead_zone() {
        let model = Model::with_effects(Robot::amigobot(), &["backlash_deadzone"]).unwrap();
        let mut truth = model.initial();
        truth[5] = 0.02;
        let movement = Movement::rich(model.robot(), 3, 20.0, 12.0);
        let noise = NoiseLevel { alpha: 5e-4, dalpha: 0.02, torque: 0.002 };
        let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed: 3 };
        let train = [record("dead zone", &model, &truth, &movement, &recorder).unwrap()];
        let model = model.starting_at(5, 0.02);
        let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 0 };
        let alone = TorqueRegression::default().identify(&task).unwrap();
        let with = |std_error: f64| {
            let (mut fit, mut regression) = (alone.clone(), alone.clone());
            fit.estimates[5] = Estimate::new("d", "N m".into(), 0.02, std_error);
            with_shapes_of(&fit, &mut regression, &task);
            regression
        };
        // on a robot that always drives, friction and dead zone are equivalent: only a4 + d is identifiable
        let found = with(0.01);
        for k in [3, 4] {
            let error = found.estimates[k].std_error;
            assert!((0.005..0.0105).contains(&error), "{k}: {error}");
            assert!(!with(f64::INFINITY).estimates[k].identifiable, "{k}");
        }
        assert_eq!(found.estimates[5].std_error, 0.01);
        // the inertia hardly depends on it
        assert!(found.estimates[A1].std_error < 0.1 * found.estimates[A1].value);
        assert_eq!(with(0.0).estimates[A1], alone.estimates[A1]);
    }
}
