//! The sum of the effects of a model, with constant parts computed before the simulation.

use crate::effects::{Effect, Motion, Terms};
use crate::model::{Model, SpeedPolynomial, Variation};

/// An effect with the values of its parameters.
type Placed<'m> = (&'m dyn Effect, &'m [f64]);

/// The sum of effects: constant terms are already added, polynomials of the speeds are combined into one, and
/// only terms that vary in another way are evaluated at every instant.
#[derive(Clone)]
pub(super) struct Sum<'m> {
    pub(super) constant: Terms<f64>,
    /// Without its constant, which is included in the terms above.
    pub(super) by_speed: SpeedPolynomial,
    masses: Vec<Placed<'m>>,
    torques: Vec<Placed<'m>>,
    levels: Vec<Placed<'m>>,
}

impl<'m> Sum<'m> {
    /// The sum of the effects selected by `part`; constant terms are evaluated at rest, `x`.
    pub(super) fn new(
        model: &'m Model,
        p: &'m [f64],
        x: &Motion<f64>,
        part: impl Fn(&dyn Effect) -> bool,
    ) -> Self {
        let (constant, by_speed) = (Terms::zero(), SpeedPolynomial::default());
        let mut sum = Self { constant, by_speed, masses: vec![], torques: vec![], levels: vec![] };
        for (e, effect) in model.effects().iter().enumerate().filter(|(_, e)| part(&***e)) {
            let (p, variations) = (&p[model.slots(e)], model.variations(e));
            let mut here = effect.terms(x, p);
            if variations.torque == Variation::Quadratic {
                let torque = |omega| effect.torque(&Motion { omega, ..*x }, p);
                sum.by_speed.add(&SpeedPolynomial::through(torque));
            } else if variations.torque == Variation::Varying {
                sum.torques.push((&**effect, p));
                here.torque = [0.0; 2];
            }
            if variations.mass > Variation::Constant {
                sum.masses.push((&**effect, p));
                here.mass = [0.0; 3];
            }
            if variations.level > Variation::Constant {
                sum.levels.push((&**effect, p));
                here.level = [0.0; 4];
            }
            sum.constant.add(&here);
        }
        sum.by_speed.take_constant();
        sum
    }

    /// Whether the mass matrix is constant.
    pub(super) fn has_constant_mass(&self) -> bool {
        self.masses.is_empty()
    }

    /// Whether the levels of dry friction are constant.
    pub(super) fn has_constant_levels(&self) -> bool {
        self.levels.is_empty()
    }

    /// Whether every varying torque is in the polynomial of the speeds.
    pub(super) fn is_polynomial(&self) -> bool {
        self.torques.is_empty()
    }

    #[inline]
    pub(super) fn at(&self, x: &Motion<f64>) -> Terms<f64> {
        let mut mass = self.constant.mass;
        for (effect, p) in &self.masses {
            add(&mut mass, &effect.mass(x, p));
        }
        let (mut torque, by_speed) = (self.constant.torque, self.by_speed.rest(x.omega));
        add(&mut torque, &by_speed);
        add(&mut torque, &self.varying_torque(x));
        Terms { mass, torque, level: self.level(x) }
    }

    /// The torques that are not polynomials of the speeds [N m].
    #[inline]
    pub(super) fn varying_torque(&self, x: &Motion<f64>) -> [f64; 2] {
        let mut torque = [0.0; 2];
        for (effect, p) in &self.torques {
            add(&mut torque, &effect.torque(x, p));
        }
        torque
    }

    /// The levels of dry friction [N m].
    #[inline]
    pub(super) fn level(&self, x: &Motion<f64>) -> [f64; 4] {
        let mut level = self.constant.level;
        for (effect, p) in &self.levels {
            add(&mut level, &effect.level(x, p));
        }
        level
    }
}

#[inline]
fn add<const N: usize>(sum: &mut [f64; N], more: &[f64; N]) {
    sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
}
