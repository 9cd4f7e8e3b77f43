//! Parameters that the model as given leaves open, estimated again once an effect has been added.

use super::Search;
use crate::diagnose::fit::{WindowFit, fit};
use crate::model::base::{A4, A5};

/// Friction from which a fit starts, as a share of the largest input.
const LEAST: f64 = 1e-3;

impl Search<'_> {
    /// The fit with the parameters estimated that were held because the fit of the model as given did not determine
    /// them ([`Settings::held`]), if the windows now do: their criterion is lower, no standard error is infinite, and
    /// the reported error does not rise. Where a dominant torque is missing, friction is uncertain by the error of the
    /// model; held at what that fit left of it, it would be missing beside the effect that is found.
    ///
    /// [`Settings::held`]: crate::diagnose::Settings::held
    pub(super) fn released(&self, held: WindowFit) -> WindowFit {
        let symbols = self.settings.held.iter();
        let fixed: Vec<usize> = symbols
            .filter_map(|symbol| held.model.index_of(symbol).ok())
            .filter(|&j| held.model.parameters()[j].fixed.is_some())
            .collect();
        if fixed.is_empty() {
            return held;
        }
        let model = fixed.iter().fold(held.model.clone(), |model, &j| model.estimating(j));
        // where there is no friction, nothing changes with its direction
        let least = LEAST * self.scale.torque_quantile(1.0);
        let mut start = held.p.clone();
        fixed
            .iter()
            .filter(|j| matches!(**j, A4 | A5))
            .for_each(|&j| start[j] = start[j].max(least));
        let Some(free) = fit(&self.windows, &model, &start, &self.scale) else { return held };
        let gain = self.ratio(&held, &free);
        let known = fixed.iter().all(|&j| free.covariance[(j, j)].is_finite());
        let supported = gain > fixed.len() as f64 * self.degrees.ln();
        match known && supported && self.shown(&free) <= self.shown(&held) {
            true => free,
            false => held,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::diagnose::search::recorded;
    use crate::diagnose::{Data, Settings, diagnose};
    use crate::model::Model;
    use crate::model::base::A4;
    use crate::robot::Robot;
    use crate::simulate::Hold;

    #[test]
    fn a_friction_that_was_held_is_estimated_once_the_missing_effect_is_found() {
        let base = Model::base(Robot::amigobot());
        let robot = base.add("viscous_friction").unwrap();
        let mut truth = robot.initial();
        truth[5] = 0.03;
        let [train, validation] = [3, 4].map(|seed| recorded(&robot, &truth, seed));
        let data =
            Data { train: &train, validation: &validation, hold: Hold::Linear, corrected_s: 0.0 };
        let held = base.fix("a4", 0.0).unwrap();
        let settings = Settings { held: vec!["a4".into()], ..Settings::default() };
        let found = diagnose(&held, &[held.initial()], &data, &settings).unwrap();
        assert_eq!(found.found(), ["viscous_friction"]);
        let last = found.last();
        let error = last.covariance[(A4, A4)].sqrt();
        assert!((last.p[A4] - truth[A4]).abs() < 4.0 * error, "{} {error}", last.p[A4]);
    }
}
