//! How every parameter pushes the wheels, compiled for wheels that slide: with a mass matrix that never
//! changes and torques that are polynomials of the speeds, the derivatives of the accelerations by the
//! parameters are sums of a few quantities with constant factors.

use pulp::Simd;

use super::forces::Forces;
use crate::effects::{DIFFERENTIATED, DIRECTIONS, Jet, Motion};
use crate::math::{Dual, Lanes};
use crate::model::{SpeedPolynomial, times};

/// Quantities beside the constant: w1, w2, w1 (w1 - w2), w2 (w1 - w2), w1 w2, and the two accelerations; filled up to a
/// power of two, so that a place among them needs neither a branch nor a division.
const QUANTITIES: usize = 8;
/// Partial derivatives of a [`Jet`] before those of an effect's own parameters.
const STATES: usize = 4;

/// Columns that stand together: the numbers of the widest register.
pub(crate) const LANES: usize = 8;
/// The derivatives of both accelerations by as many parameters.
pub(super) type Pair = [[f64; LANES]; 2];

/// The compiled derivatives.
pub(super) struct Forcing {
    groups: Vec<Group>,
    /// The friction signs for which the constants stand.
    sign: [f64; 4],
}

/// Those of [`LANES`] parameters.
#[derive(Clone, Default)]
struct Group {
    constant: Pair,
    without_friction: Pair,
    by_sign: [Pair; 4],
    /// Factors of the quantities that have any.
    factors: Vec<(usize, Pair)>,
}

/// The quantities of one instant.
pub(super) type Quantities = [f64; QUANTITIES];

/// What acts at one instant: speeds, their products, accelerations.
pub(super) fn quantities([w1, w2]: [f64; 2], a: [f64; 2]) -> [f64; QUANTITIES] {
    let turn = w1 - w2;
    [w1, w2, w1 * turn, w2 * turn, w1 * w2, a[0], a[1], 0.0]
}

impl Forcing {
    /// `None` where an effect is anything else, or the mass matrix has no inverse.
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

    /// Makes the constants those for these friction signs.
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

    /// Writes the derivatives by the first `columns` parameters, and what fills their registers up.
    #[inline(always)]
    pub(super) fn write<S: Simd>(
        &self,
        simd: S,
        quantities: &[f64; QUANTITIES],
        columns: usize,
        out: &mut [Pair],
    ) {
        for (g, (group, out)) in self.groups.iter().zip(out).enumerate() {
            let asked = columns.saturating_sub(g * LANES).min(LANES);
            for r in (0..asked).step_by(Lanes::<S>::COUNT) {
                let mut first = Lanes::load(simd, &group.constant[0][r..]);
                let mut second = Lanes::load(simd, &group.constant[1][r..]);
                for (n, factor) in &group.factors {
                    let quantity = quantities[*n % QUANTITIES];
                    first = first + Lanes::load(simd, &factor[0][r..]) * quantity;
                    second = second + Lanes::load(simd, &factor[1][r..]) * quantity;
                }
                first.store(&mut out[0][r..]);
                second.store(&mut out[1][r..]);
            }
        }
    }
}

impl Group {
    /// What a torque per unit of a quantity takes from the accelerations.
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
            self.0.write(simd, &self.1, self.2, self.3);
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
