//! Which terms of an effect depend on the motion, determined from its recorded formula.

use crate::effects::{Effect, Motion};
use crate::math::{Formula, record};
use crate::robot::Robot;

/// How a group of terms depends on the instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Variation {
    /// Zero everywhere.
    Absent,
    /// The same at every time, angle and speed.
    Constant,
    /// A second-degree polynomial in the wheel speeds only.
    Quadratic,
    /// Anything else.
    Varying,
}

/// How the terms of an effect vary. Known before a simulation, so that constant terms are evaluated once per
/// parameter vector and absent terms never.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variations {
    /// The mass matrix.
    pub mass: Variation,
    /// The resisting torques.
    pub torque: Variation,
    /// The levels of dry friction.
    pub level: Variation,
}

/// Number of inputs of an instant: t, alpha1, alpha2, omega1, omega2.
const MOTION: usize = 5;
const SPEEDS: std::ops::Range<usize> = 3..5;
/// Instant at which formulas are recorded; formulas that are valid only there count as varying.
const PLACE: [f64; MOTION] = [0.7, 0.3, -0.4, 1.1, -0.6];

impl Variations {
    pub(crate) fn of(effect: &dyn Effect, robot: &Robot) -> Self {
        let typical = effect.parameters().iter().map(|spec| spec.typical).collect::<Vec<f64>>();
        let formula = record(&[&PLACE, &typical[..]].concat(), |inputs| {
            let (x, p) = inputs.split_at(MOTION);
            let (alpha, omega) = ([x[1], x[2]], [x[3], x[4]]);
            let motion = Motion::at(x[0], alpha, omega, robot);
            let terms = effect.terms_symbolic(&motion, p);
            [&terms.mass[..], &terms.torque, &terms.level].concat()
        });
        let variation = |outputs: std::ops::Range<usize>| {
            let part = Formula { outputs: formula.outputs[outputs].to_vec(), ..formula.clone() };
            if part.read || (0..SPEEDS.start).any(|input| part.depends_on(input)) {
                Variation::Varying
            } else if SPEEDS.into_iter().any(|input| part.depends_on(input)) {
                let quadratic = part.degree(SPEEDS).is_some_and(|degree| degree <= 2);
                if quadratic { Variation::Quadratic } else { Variation::Varying }
            } else if part.is_zero() {
                Variation::Absent
            } else {
                Variation::Constant
            }
        };
        Self { mass: variation(0..3), torque: variation(3..5), level: variation(5..9) }
    }

    /// Whether any term varies with the motion.
    #[must_use]
    pub fn vary(&self) -> bool {
        self.most() > Variation::Constant
    }

    /// Whether only the torques vary, as second-degree polynomials of the speeds.
    #[must_use]
    pub fn is_quadratic(&self) -> bool {
        self.torque == Variation::Quadratic && self.mass.max(self.level) <= Variation::Constant
    }

    /// Whether the effect has only torques.
    #[must_use]
    pub fn is_torque_alone(&self) -> bool {
        self.mass.max(self.level) == Variation::Absent
    }

    fn most(&self) -> Variation {
        self.mass.max(self.torque).max(self.level)
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
            let variations = Variations::of(&*effect, &robot);
            let p: Vec<f64> = effect.parameters().iter().map(|spec| spec.typical).collect();
            let at = |k: usize| {
                let x = |n: usize| 3.0 * ((7 * k + n) as f64).sin();
                let (alpha, omega) = ([x(1), x(2)], [x(3), x(4)]);
                let motion = Motion::at(x(0), alpha, omega, &robot);
                effect.terms(&motion, &p)
            };
            let same = |variation: Variation, part: &dyn Fn(&Terms<f64>) -> Vec<f64>| {
                let parts: Vec<Vec<f64>> = (0..40).map(|k| part(&at(k))).collect();
                match variation {
                    Variation::Absent => parts.iter().flatten().all(|v| *v == 0.0),
                    Variation::Constant => parts.iter().all(|v| *v == parts[0]),
                    Variation::Quadratic | Variation::Varying => true,
                }
            };
            let right = same(variations.mass, &|t| t.mass.to_vec())
                && same(variations.torque, &|t| t.torque.to_vec())
                && same(variations.level, &|t| t.level.to_vec());
            assert!(right, "{}: {variations:?}", effect.id());
        }
    }

    #[test]
    fn the_base_model_varies_in_its_centrifugal_torques_only() {
        let robot = Robot::amigobot();
        let of = |id: &str| Variations::of(&*crate::effects::find(id).unwrap(), &robot);
        let (absent, constant) = (Variation::Absent, Variation::Constant);
        let inertia = Variations { mass: constant, torque: absent, level: absent };
        assert_eq!(of("inertia"), inertia);
        let centrifugal = Variations { mass: absent, torque: Variation::Quadratic, level: absent };
        assert_eq!(of("centrifugal"), centrifugal);
        let coulomb = Variations { mass: absent, torque: absent, level: constant };
        assert_eq!(of("coulomb_friction"), coulomb);
    }
}
