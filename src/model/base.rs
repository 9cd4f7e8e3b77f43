//! Indices of the base parameters, which are the first parameters of every model.

use crate::robot::BaseParameters;

/// Inertia of a wheel, a1 [kg m^2].
pub const A1: usize = 0;
/// Coupling inertia, a2 [kg m^2].
pub const A2: usize = 1;
/// Constant of the centrifugal torque, a3 [kg m^2].
pub const A3: usize = 2;
/// Coulomb friction of wheel 1, a4 [N m].
pub const A4: usize = 3;
/// Coulomb friction of wheel 2, a5 [N m].
pub const A5: usize = 4;
/// Number of base parameters.
pub const COUNT: usize = 5;

/// The base parameters of a model by name, from its parameter vector.
///
/// # Panics
/// If `p` has fewer than [`COUNT`] values.
#[must_use]
pub fn of(p: &[f64]) -> BaseParameters {
    BaseParameters { a1: p[A1], a2: p[A2], a3: p[A3], a4: p[A4], a5: p[A5] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::robot::Robot;

    #[test]
    fn every_place_holds_the_parameter_of_that_name() {
        let model = Model::with_effects(Robot::amigobot(), &["viscous_friction"]).unwrap();
        let named = [("a1", A1), ("a2", A2), ("a3", A3), ("a4", A4), ("a5", A5)];
        for (symbol, place) in named {
            assert_eq!(model.index_of(symbol).unwrap(), place);
        }
        assert_eq!(of(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).to_array(), [1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(
            (named.len(), Model::base(Robot::amigobot()).parameters().len()),
            (COUNT, COUNT)
        );
    }
}
