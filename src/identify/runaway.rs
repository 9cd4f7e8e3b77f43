//! Fits whose inertias have grown without limit.

use super::{Fit, IdentifyError, Task};
use crate::model::base::{A1, A2};
use crate::recording::Recording;

/// Smallest ratio of the change of speed that the largest input could cause during the recordings to the change that is
/// recorded. The input of a robot causes all of that change, so that it is about one or more; a hundredth leaves two
/// orders of magnitude to gains of the input and to currents whose scale is wrong.
const ANSWERS: f64 = 0.01;

/// The fit, unless its input moves nothing: speeds that do not answer to the input are explained best by a robot that
/// keeps its speed for ever.
///
/// ```text
/// max |M| T / min(a1 + a2, a1 - a2) < max (ω_max - ω_min)/100
/// ```
pub(super) fn bounded(fit: Fit, task: &Task) -> Result<Fit, IdentifyError> {
    let (Some(a1), Some(a2)) = (fit.estimates.get(A1), fit.estimates.get(A2)) else {
        return Ok(fit);
    };
    let inertia = (a1.value + a2.value).min(a1.value - a2.value);
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let train = || task.train.iter();
    let input = largest(&mut train().flat_map(|r| r.torque().iter().flatten()).map(|m| m.abs()));
    let duration: f64 = train().map(Recording::duration).sum();
    let recorded = largest(&mut train().flat_map(|r| [0, 1].map(|i| range(r, i))));
    if inertia <= 0.0 || input * duration / inertia >= ANSWERS * recorded {
        return Ok(fit);
    }
    Err(IdentifyError::Unbounded {
        method: fit.method.clone(),
        inertia,
        unit: a1.unit.clone(),
        change: input * duration / inertia,
        recorded,
    })
}

/// Range of the speed of wheel `i`.
fn range(r: &Recording, i: usize) -> f64 {
    let speeds = || r.omega().iter().map(|w| w[i]);
    speeds().fold(f64::NEG_INFINITY, f64::max) - speeds().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::model::Model;
    use crate::recording::{Channels, DriveUnit};
    use crate::robot::Robot;
    use crate::simulate::Hold;

    #[test]
    fn a_fit_that_ran_to_infinity_is_a_failure() {
        let t: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
        let omega = Some(t.iter().map(|t| [5.0 * t.sin(); 2]).collect());
        let torque = t.iter().map(|t| [0.2 * t.cos(); 2]).collect();
        let channels = Channels { t, alpha: None, omega, torque };
        let train = [Recording::new("run.csv", channels, DriveUnit::Ampere).unwrap()];
        let model = Model::base(Robot::amigobot());
        let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 0 };
        let fit = |a1: f64| {
            let p = vec![a1, 0.0, 0.0, 0.1, 0.1];
            let covariance = DMatrix::zeros(5, 5);
            bounded(Fit::physical("any", &model, p, covariance, DriveUnit::Ampere), &task)
        };
        // 0.2 A for 10 s: a hundredth of the range of 10 rad/s by 20 A s^2/rad
        assert!(fit(0.04).is_ok() && fit(15.0).is_ok() && fit(-0.04).is_ok());
        let reason = fit(1.3e24).err().unwrap().to_string();
        assert!(
            reason.starts_with("any: the fit ran to an inertia of 1.3e24 A s^2/rad"),
            "{reason}"
        );
    }
}
