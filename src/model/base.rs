//! Places of the base parameters, which come first in the parameters of every model.

/// Own inertia of a wheel, a1 [kg m^2].
pub const A1: usize = 0;
/// Inertia that couples the wheels, a2 [kg m^2].
pub const A2: usize = 1;
/// Constant of the centrifugal torque, a3 [kg m^2].
pub const A3: usize = 2;
/// Coulomb friction of wheel 1, a4 [N m].
pub const A4: usize = 3;
/// Coulomb friction of wheel 2, a5 [N m].
pub const A5: usize = 4;
/// Number of base parameters.
pub const COUNT: usize = 5;

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
        assert_eq!(
            (named.len(), Model::base(Robot::amigobot()).parameters().len()),
            (COUNT, COUNT)
        );
    }
}
