//! Frictions that would drive the robot.

use super::{Fit, Note};
use crate::effects::Energy;
use crate::model::Model;

impl Fit {
    /// The same with a note on friction parameters of `model` whose whole interval is negative: such an effect would
    /// not dissipate energy, so something else is wrong.
    pub(super) fn driving_frictions(mut self, model: &Model) -> Self {
        let dissipates = |id: &str| {
            model.effects().iter().any(|e| e.id() == id && e.energy() == Energy::Dissipates)
        };
        let negative: Vec<(String, f64)> = model
            .parameters()
            .iter()
            .zip(&self.estimates)
            .filter(|(p, e)| {
                p.spec.range.0 == 0.0 && !e.fixed && e.interval.1 < 0.0 && dissipates(&p.effect)
            })
            .map(|(_, e)| (e.symbol.clone(), e.value))
            .collect();
        if !negative.is_empty() {
            self.notes.push(Note::DrivingFriction(negative));
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::DriveUnit;
    use crate::robot::Robot;
    use nalgebra::DMatrix;

    #[test]
    fn a_friction_below_zero_is_reported_where_its_interval_is_below_zero_too() {
        let model = Model::base(Robot::amigobot());
        let of = |a4: f64| {
            let p = vec![0.03, -0.002, -1e-3, a4, 0.1];
            let covariance = DMatrix::identity(5, 5) * 1e-4;
            let fit = Fit::physical("output_error", &model, p, covariance, DriveUnit::NewtonMetre);
            fit.driving_frictions(&model).notes
        };
        assert!(
            matches!(&of(-0.1)[..], [Note::DrivingFriction(n)] if n.len() == 1 && n[0].0 == "a4")
        );
        assert!(of(-0.01).is_empty() && of(0.1).is_empty());
    }
}
