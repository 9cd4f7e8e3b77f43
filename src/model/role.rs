//! Which terms of an effect change with the motion, read off its formula.

use crate::effects::{Effect, Motion};
use crate::math::{Formula, record};
use crate::robot::Robot;

/// How a group of terms depends on the instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Zero everywhere.
    Absent,
    /// The same at every time, angle and speed.
    Constant,
    /// Anything else.
    Varying,
}

/// The roles of an effect's terms. Known before any simulation, so that what is constant is
/// evaluated once a parameter vector and what is absent never.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Roles {
    /// The mass matrix.
    pub mass: Role,
    /// The resisting moments.
    pub torque: Role,
    /// The levels of dry friction.
    pub level: Role,
}

/// Inputs that make up an instant: t, alpha1, alpha2, omega1, omega2.
const MOTION: usize = 5;
/// A place to record at; formulas that hold there only count as varying.
const PLACE: [f64; MOTION] = [0.7, 0.3, -0.4, 1.1, -0.6];

impl Roles {
    pub(super) fn of(effect: &dyn Effect, robot: &Robot) -> Self {
        let typical = effect.parameters().iter().map(|spec| spec.typical).collect::<Vec<f64>>();
        let formula = record(&[&PLACE, &typical[..]].concat(), |inputs| {
            let (x, p) = inputs.split_at(MOTION);
            let (alpha, omega) = ([x[1], x[2]], [x[3], x[4]]);
            let motion = Motion { t: x[0], alpha, omega, variance: [0.0; 4], robot };
            let terms = effect.terms_symbolic(&motion, p);
            [&terms.mass[..], &terms.torque, &terms.level].concat()
        });
        let role = |outputs: std::ops::Range<usize>| {
            let part = Formula { outputs: formula.outputs[outputs].to_vec(), ..formula.clone() };
            if part.read || (0..MOTION).any(|input| part.depends_on(input)) {
                Role::Varying
            } else if part.is_zero() {
                Role::Absent
            } else {
                Role::Constant
            }
        };
        Self { mass: role(0..3), torque: role(3..5), level: role(5..9) }
    }

    /// Whether any term varies.
    #[must_use]
    pub fn vary(&self) -> bool {
        self.mass.max(self.torque).max(self.level) == Role::Varying
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Terms, all};

    #[test]
    fn what_is_called_constant_or_absent_is_so_at_every_instant() {
        let robot = Robot::amigobot();
        for effect in all() {
            let roles = Roles::of(&*effect, &robot);
            let p: Vec<f64> = effect.parameters().iter().map(|spec| spec.typical).collect();
            let at = |k: usize| {
                let x = |n: usize| 3.0 * ((7 * k + n) as f64).sin();
                let (alpha, omega) = ([x(1), x(2)], [x(3), x(4)]);
                let motion = Motion { t: x(0), alpha, omega, variance: [0.0; 4], robot: &robot };
                effect.terms(&motion, &p)
            };
            let same = |role: Role, part: &dyn Fn(&Terms<f64>) -> Vec<f64>| {
                let parts: Vec<Vec<f64>> = (0..40).map(|k| part(&at(k))).collect();
                match role {
                    Role::Absent => parts.iter().flatten().all(|v| *v == 0.0),
                    Role::Constant => parts.iter().all(|v| *v == parts[0]),
                    Role::Varying => true,
                }
            };
            let right = same(roles.mass, &|t| t.mass.to_vec())
                && same(roles.torque, &|t| t.torque.to_vec())
                && same(roles.level, &|t| t.level.to_vec());
            assert!(right, "{}: {roles:?}", effect.id());
        }
    }

    #[test]
    fn the_base_model_varies_in_its_centrifugal_moments_only() {
        let robot = Robot::amigobot();
        let of = |id: &str| Roles::of(&*crate::effects::find(id).unwrap(), &robot);
        let (absent, constant) = (Role::Absent, Role::Constant);
        let inertia = Roles { mass: constant, torque: absent, level: absent };
        assert_eq!(of("inertia"), inertia);
        let centrifugal = Roles { mass: absent, torque: Role::Varying, level: absent };
        assert_eq!(of("centrifugal"), centrifugal);
        let coulomb = Roles { mass: absent, torque: absent, level: constant };
        assert_eq!(of("coulomb_friction"), coulomb);
    }
}
