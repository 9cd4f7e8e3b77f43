//! Derivatives of the accelerations with respect to the parameters, compiled for sliding wheels: with a
//! constant mass matrix and torques that are polynomials of the speeds, they are linear combinations of a few
//! quantities with constant coefficients.

use pulp::Simd;

use super::forces::Forces;
use crate::effects::{DIFFERENTIATED, DIRECTIONS, Jet, Motion};
use crate::math::{Dual, Lanes};
use crate::model::{SpeedPolynomial, times};

/// Number of quantities beside the constant: w1, w2, w1 (w1 - w2), w2 (w1 - w2), w1 w2, and the two
/// accelerations; padded to a power of two, so that indexing needs neither a branch nor a division.
const QUANTITIES: usize = 8;
/// Number of partial derivatives of a [`Jet`] by the state; those by the parameters of an effect follow.
const STATES: usize = 4;

/// Number of columns in a group: the lanes of the widest register.
pub(crate) const LANES: usize = 8;
/// The derivatives of both accelerations with respect to this many parameters.
pub(super) type Pair = [[f64; LANES]; 2];

/// The compiled derivatives.
#[derive(Clone)]
pub(super) struct Forcing {
    groups: Vec<Group>,
    /// The friction signs for which the constants are valid.
    sign: [f64; 4],
}

/// Those of [`LANES`] parameters.
#[derive(Clone, Default)]
struct Group {
    constant: Pair,
    without_friction: Pair,
    by_sign: [Pair; 4],
    /// Coefficients of the quantities that are not zero.
    factors: Vec<(usize, Pair)>,
}

/// The quantities of one instant.
pub(super) type Quantities = [f64; QUANTITIES];

/// The quantities at one instant: speeds, their products, accelerations.
pub(super) fn quantities([w1, w2]: [f64; 2], a: [f64; 2]) -> [f64; QUANTITIES] {
    let turn = w1 - w2;
    [w1, w2, w1 * turn, w2 * turn, w1 * w2, a[0], a[1], 0.0]
}

impl Forcing {
    /// `None` if an effect has other terms, or the mass matrix is singular.
    pub(super) fn new(f: &Forces) -> Option<Self> {
        let inverse = f.inverse.filter(|_| f.wheel.is_polynomial() && !f.rough)?;
        let mut groups = vec![Group::default(); (f.p.len() + 4).div_ceil(LANES)];
        for (e, effect) in f.model.effects().iter().enumerate() {
            let slots = f.model.slots(e);
            let value = |(k, &p): (usize, &f64)| {
                if k < DIFFERENTIATED { Dual::variable(p, STATES + k) } else { p.into() }
            };
            let own: Vec<Jet> = f.p[slots.clone()].iter().enumerate().map(value).collect();
            let at = |omega: [f64; 2]| {
                let zero = Jet::from(0.0);
                let (t, alpha, omega) = (zero, [zero; 2], omega.map(Jet::from));
                let robot = f.model.robot();
                effect.terms_jet(&Motion::at(t, alpha, omega, robot), &own)
            };
            for (k, j) in slots.enumerate().take(DIFFERENTIATED) {
                let part = |value: Jet| value.partial[STATES + k];
                let terms = at([0.0; 2]);
                let mut set = |quantity: Option<usize>, torque: [f64; 2]| {
                    groups[j / LANES].set(j % LANES, quantity, times(&inverse, &torque));
                };
                let torque = SpeedPolynomial::through(|omega| at(omega).torque.map(part));
                for (n, factors) in torque.factors.into_iter().enumerate() {
                    set(n.checked_sub(1), factors);
                }
                let [m11, m12, m22] = terms.mass.map(part);
                set(Some(5), [m11, m12]);
                set(Some(6), [m12, m22]);
                for (d, level) in terms.level.map(part).into_iter().enumerate() {
                    let friction = times(&inverse, &DIRECTIONS[d].map(|share| share * level));
                    groups[j / LANES].set_friction(j % LANES, d, friction);
                }
            }
        }
        Some(Self { groups, sign: [0.0; 4] }.with_signs([1.0; 4]))
    }

    fn with_signs(mut self, sign: [f64; 4]) -> Self {
        self.turn(&sign);
        self
    }

    /// Updates the constants for these friction signs.
    #[inline]
    pub(super) fn turn(&mut self, sign: &[f64; 4]) {
        if *sign == self.sign {
            return;
        }
        self.sign = *sign;
        for group in &mut self.groups {
            group.constant = group.without_friction;
            for (friction, sign) in group.by_sign.iter().zip(sign) {
                for (constant, friction) in group.constant.iter_mut().zip(friction) {
                    constant.iter_mut().zip(friction).for_each(|(c, f)| *c += f * sign);
                }
            }
        }
    }

    /// Writes the derivatives with respect to the first `columns` parameters at several instants, padded to whole
    /// registers.
    #[inline(always)]
    pub(super) fn write<S: Simd, const N: usize>(
        &self,
        simd: S,
        quantities: [&Quantities; N],
        columns: usize,
        out: [&mut [Pair]; N],
    ) {
        for (g, group) in self.groups.iter().enumerate() {
            let asked = columns.saturating_sub(g * LANES).min(LANES);
            for r in (0..asked).step_by(Lanes::<S>::COUNT) {
                let mut first = [Lanes::load(simd, &group.constant[0][r..]); N];
                let mut second = [Lanes::load(simd, &group.constant[1][r..]); N];
                for (n, factor) in &group.factors {
                    let by_first = Lanes::load(simd, &factor[0][r..]);
                    let by_second = Lanes::load(simd, &factor[1][r..]);
                    for k in 0..N {
                        let quantity = quantities[k][*n % QUANTITIES];
                        first[k] = first[k] + by_first * quantity;
                        second[k] = second[k] + by_second * quantity;
                    }
                }
                for k in 0..N {
                    first[k].store(&mut out[k][g][0][r..]);
                    second[k].store(&mut out[k][g][1][r..]);
                }
            }
        }
    }
}

impl Group {
    /// Sets the coefficients of a torque per unit of a quantity.
    fn set(&mut self, lane: usize, quantity: Option<usize>, taken: [f64; 2]) {
        if taken == [0.0; 2] {
            return;
        }
        let pair = match quantity {
            None => &mut self.without_friction,
            Some(n) => {
                let known = self.factors.iter().position(|(place, _)| *place == n);
                let place = known.unwrap_or(self.factors.len());
                if known.is_none() {
                    self.factors.push((n, Pair::default()));
                }
                &mut self.factors[place].1
            }
        };
        subtract(pair, lane, taken);
    }

    fn set_friction(&mut self, lane: usize, direction: usize, taken: [f64; 2]) {
        subtract(&mut self.by_sign[direction], lane, taken);
    }
}

fn subtract(pair: &mut Pair, lane: usize, taken: [f64; 2]) {
    for (value, taken) in pair.iter_mut().zip(taken) {
        value[lane] -= taken;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::in_lanes;
    use crate::model::{Linearisation, Model};
    use crate::robot::Robot;

    struct Write<'a>(&'a Forcing, [f64; QUANTITIES], usize, &'a mut [Pair]);
    impl pulp::WithSimd for Write<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            self.0.write(simd, [&self.1], self.2, [self.3]);
        }
    }

    #[test]
    fn compiled_derivatives_are_those_of_the_effects() {
        let ids = [
            "viscous_friction",
            "torque_offset",
            "turning_scrub",
            "yaw_viscous",
            "caster_drag",
            "lateral_com",
        ];
        let model = Model::with_effects(Robot::amigobot(), &ids).unwrap();
        let p = model.initial();
        let f = Forces::new(&model, &p, 0.0);
        let (omega, a, sign) = ([1.3, -0.8], [2.0, -0.7], [1.0, -1.0, 1.0, 1.0]);
        let mut forcing = Forcing::new(&f).unwrap();
        forcing.turn(&sign);
        let mut out = vec![Pair::default(); (p.len() + 4).div_ceil(LANES)];
        in_lanes(Write(&forcing, quantities(omega, a), p.len(), &mut out));
        let x = f.motion(0.0, &[0.0, 0.0, omega[0], omega[1], omega[0], omega[1], 0.0, 0.0]);
        let mut linear = Linearisation::new(p.len());
        model.linearise(&x, &p, &a, &sign, &mut linear);
        let inverse = f.inverse.unwrap();
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-11 * (1.0 + b.abs()), "{a} {b}");
        for (j, torque) in linear.by_parameter.iter().enumerate() {
            let expected = times(&inverse, torque);
            for i in 0..2 {
                close(out[j / LANES][i][j % LANES], -expected[i]);
            }
        }
        let slope = f.by_speed.slope(omega);
        for k in 0..2 {
            let [first, second] = linear.by_state;
            let expected = times(&inverse, &[first[2 + k], second[2 + k]]);
            (0..2).for_each(|i| close(slope[i][k], -expected[i]));
        }
    }

    #[test]
    fn what_is_no_polynomial_of_the_speeds_is_not_compiled() {
        for id in ["quadratic_drag", "stribeck", "torque_ripple", "compliance"] {
            let model = Model::with_effects(Robot::amigobot(), &[id]).unwrap();
            let p = model.initial();
            assert!(Forcing::new(&Forces::new(&model, &p, 0.0)).is_none(), "{id}");
        }
    }
}
