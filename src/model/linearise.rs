//! Exact first derivatives of a model, and the solution of the torque balance for the accelerations.

use super::{Model, ModelError, SpeedPolynomial, Variation, Variations};
use crate::effects::{DIFFERENTIATED, Effect, Jet, Motion, Own, Tangent, Terms, with_friction};
use crate::math::{Dual, Real};

/// Number of partial derivatives of a [`Jet`] by the state; those by the parameters of an effect follow.
const STATES: usize = 4;

/// The torque balance `mass a + torque + Σ d_j level_j s_j` and its derivatives at one instant.
#[derive(Clone, Debug)]
pub struct Linearisation {
    /// Values.
    pub terms: Terms<f64>,
    /// Derivatives of the two torques with respect to (alpha1, alpha2, omega1, omega2), at fixed
    /// acceleration and friction signs.
    pub by_state: [[f64; 4]; 2],
    /// Derivatives of the two torques with respect to each parameter of the model (zero for those that act
    /// through the input).
    pub by_parameter: Vec<[f64; 2]>,
    /// Terms of each effect that is not a polynomial of the speeds, with their derivatives.
    varying: Vec<(usize, Terms<Jet>)>,
    /// Derivatives with respect to the parameters of all other effects.
    compiled: Vec<(usize, Compiled)>,
    /// Sum of the constant terms and of the polynomials of the speeds, with the parameter values for which
    /// they were computed and the derivatives with respect to these.
    constant: Terms<f64>,
    by_speed: SpeedPolynomial,
    given: Vec<f64>,
    own: Vec<Jet>,
    /// Speeds of the instant that was evaluated last [rad/s].
    omega: [f64; 2],
}

/// The derivative of the torque balance with respect to a parameter of an effect with constant masses and
/// levels and torques that are polynomials of the speeds.
#[derive(Clone, Copy, Debug)]
struct Compiled {
    mass: Option<[f64; 3]>,
    torque: Option<SpeedPolynomial>,
    level: Option<[f64; 4]>,
}

impl Compiled {
    /// Of partial derivative number `k` of an effect's terms at given speeds.
    fn new(terms: impl Fn([f64; 2]) -> Terms<Jet>, variations: Variations, k: usize) -> Self {
        let part = |value: Jet| value.partial[k];
        let here = terms([0.0; 2]);
        let present = |variation: Variation| variation != Variation::Absent;
        Self {
            mass: present(variations.mass).then(|| here.mass.map(part)),
            torque: present(variations.torque)
                .then(|| SpeedPolynomial::through(|omega| terms(omega).torque.map(part))),
            level: present(variations.level).then(|| here.level.map(part)),
        }
    }

    #[inline]
    fn at(&self, omega: [f64; 2], a: &[f64; 2], s: &[f64; 4]) -> [f64; 2] {
        let mut out = self.mass.as_ref().map_or([0.0; 2], |mass| times(mass, a));
        if let Some(torque) = &self.torque {
            let rest = torque.rest(omega);
            out = [0, 1].map(|i| out[i] + (torque.factors[0][i] + rest[i]));
        }
        if let Some(level) = &self.level {
            out = with_friction(out, level, s);
        }
        out
    }
}

impl Linearisation {
    /// Allocates the derivatives of a model with `parameters` parameters.
    #[must_use]
    pub fn new(parameters: usize) -> Self {
        Self {
            terms: Terms::zero(),
            by_state: [[0.0; 4]; 2],
            by_parameter: vec![[0.0; 2]; parameters],
            varying: vec![],
            compiled: vec![],
            constant: Terms::zero(),
            by_speed: SpeedPolynomial::default(),
            given: vec![],
            own: vec![],
            omega: [0.0; 2],
        }
    }
}

impl Model {
    /// Writes values and exact derivatives of the torque balance at acceleration `a` [rad/s^2] and friction
    /// signs `s` (one for each of [`crate::effects::DIRECTIONS`]) into `out`, which must have been allocated
    /// for this model: inner loops do not allocate.
    ///
    /// # Panics
    /// If `p` or `out` do not have one entry per parameter.
    pub fn linearise(
        &self,
        x: &Motion<f64>,
        p: &[f64],
        a: &[f64; 2],
        s: &[f64; 4],
        out: &mut Linearisation,
    ) {
        self.evaluate(x, p, out);
        self.differentiate(a, s, out);
    }

    /// The first half of [`Model::linearise`]: evaluates every effect once and sums the values in
    /// `out.terms`. A caller that chooses signs and acceleration from the values continues with
    /// [`Model::differentiate`], which may be called repeatedly. Constant effects and polynomials of the
    /// speeds are evaluated again only if `p` has changed.
    pub fn evaluate(&self, x: &Motion<f64>, p: &[f64], out: &mut Linearisation) {
        if out.given != p {
            self.prepare(x, p, out);
        }
        out.omega = x.omega;
        out.terms = out.constant;
        let by_speed = out.by_speed.rest(x.omega);
        for (sum, torque) in out.terms.torque.iter_mut().zip(by_speed) {
            *sum += torque;
        }
        if out.varying.is_empty() {
            return;
        }
        let jet = jet(x);
        for (e, terms) in &mut out.varying {
            let (effect, variations) = (&self.effects()[*e], self.variations(*e));
            let own = &out.own[self.slots(*e)];
            if (variations.mass, variations.level) == (Variation::Absent, Variation::Absent) {
                terms.torque = effect.torque_jet(&jet, own);
                for (sum, torque) in out.terms.torque.iter_mut().zip(&terms.torque) {
                    *sum += torque.value;
                }
            } else {
                *terms = effect.terms_jet(&jet, own);
                out.terms.add(&values(terms));
            }
        }
    }

    /// Terms that do not change with the motion: parameters with their derivatives, constant effects and
    /// polynomials of the speeds.
    fn prepare(&self, x: &Motion<f64>, p: &[f64], out: &mut Linearisation) {
        out.given.clear();
        out.given.extend_from_slice(p);
        out.own.clear();
        out.varying.clear();
        out.compiled.clear();
        (out.constant, out.by_speed) = (Terms::zero(), SpeedPolynomial::default());
        for (e, effect) in self.effects().iter().enumerate() {
            let (slots, variations) = (self.slots(e), self.variations(e));
            out.own.extend(p[slots.clone()].iter().enumerate().map(|(k, &value)| {
                if k < DIFFERENTIATED {
                    Dual::variable(value, STATES + k)
                } else {
                    Dual::constant(value)
                }
            }));
            let own = &out.own[slots.clone()];
            let at = |omega| effect.terms_jet(&jet(&Motion { omega, ..*x }), own);
            if variations.vary() && !variations.is_quadratic() {
                out.varying.push((e, at(x.omega)));
                continue;
            }
            let torque = |omega| at(omega).torque.map(|v| v.value);
            if variations.is_quadratic() {
                out.by_speed.add(&SpeedPolynomial::through(torque));
            }
            out.constant.add(&Terms { torque: torque([0.0; 2]), ..values(&at([0.0; 2])) });
            let places = slots.enumerate().take(DIFFERENTIATED);
            let by = places.map(|(k, j)| (j, Compiled::new(at, variations, STATES + k)));
            out.compiled.extend(by);
        }
        out.by_speed.take_constant();
    }

    /// The second half of [`Model::linearise`]: derivatives at acceleration `a` and signs `s` of the terms
    /// that [`Model::evaluate`] wrote to `out`.
    pub fn differentiate(&self, a: &[f64; 2], s: &[f64; 4], out: &mut Linearisation) {
        self.differentiate_by_state(a, s, out);
        self.differentiate_by_parameter(a, s, out);
    }

    /// [`Model::differentiate`] with respect to the motion only.
    pub fn differentiate_by_state(&self, a: &[f64; 2], s: &[f64; 4], out: &mut Linearisation) {
        let [first, second] = out.by_speed.slope(out.omega);
        out.by_state = [[0.0, 0.0, first[0], first[1]], [0.0, 0.0, second[0], second[1]]];
        for (e, terms) in &out.varying {
            for k in 0..STATES {
                let slope = slope(terms, self.variations(*e), k, a, s);
                out.by_state[0][k] += slope[0];
                out.by_state[1][k] += slope[1];
            }
        }
    }

    /// [`Model::differentiate`] with respect to the parameters only.
    pub fn differentiate_by_parameter(&self, a: &[f64; 2], s: &[f64; 4], out: &mut Linearisation) {
        for (j, compiled) in &out.compiled {
            out.by_parameter[*j] = compiled.at(out.omega, a, s);
        }
        for (e, terms) in &out.varying {
            for (k, j) in self.slots(*e).enumerate().take(DIFFERENTIATED) {
                out.by_parameter[j] = slope(terms, self.variations(*e), STATES + k, a, s);
            }
        }
    }

    /// Derivatives of the acting input with respect to every parameter: `[j][k]` is that of
    /// sample k by parameter j; empty for parameters that do not act through the input.
    #[must_use]
    pub fn input_derivatives(
        &self,
        t: &[f64],
        recorded: &[[f64; 2]],
        p: &[f64],
    ) -> (Vec<[f64; 2]>, Vec<Vec<[f64; 2]>>) {
        let mut derivatives = vec![Vec::new(); p.len()];
        let of_input = |e: &usize| self.effects()[*e].acts_on_input();
        let effects: Vec<usize> = (0..self.effects().len()).filter(of_input).collect();
        let acting: Vec<usize> = effects.iter().flat_map(|&e| self.slots(e)).collect();
        let mut input = None;
        // for one or two parameters, separate passes are faster than one pass with room for all
        if acting.len() <= 2 {
            for &j in &acting {
                let m =
                    self.input_by(&effects, &[j], recorded, p, |e, m, p| e.input_tangent(t, m, p));
                derivatives[j] = m.iter().map(|row| row.map(|v: Tangent| v.partial[0])).collect();
                input.get_or_insert_with(|| m.iter().map(|row| row.map(|v| v.value)).collect());
            }
        } else {
            for seen in acting.chunks(DIFFERENTIATED) {
                let m = self.input_by(&effects, seen, recorded, p, |e, m, p| e.input_own(t, m, p));
                for (slot, &j) in seen.iter().enumerate() {
                    let of_one = |row: &[Own; 2]| row.map(|v| v.partial[slot]);
                    derivatives[j] = m.iter().map(of_one).collect();
                }
                input.get_or_insert_with(|| m.iter().map(|row| row.map(|v| v.value)).collect());
            }
        }
        (input.unwrap_or_else(|| recorded.to_vec()), derivatives)
    }

    /// The acting input with its derivatives with respect to the parameters `seen`, applying the input
    /// effects in turn by `act`.
    fn input_by<const N: usize>(
        &self,
        effects: &[usize],
        seen: &[usize],
        recorded: &[[f64; 2]],
        p: &[f64],
        act: impl Fn(&dyn Effect, &[[Dual<N>; 2]], &[Dual<N>]) -> Option<Vec<[Dual<N>; 2]>>,
    ) -> Vec<[Dual<N>; 2]> {
        let parameter = |j: usize| match seen.iter().position(|&k| k == j) {
            Some(slot) => Dual::variable(p[j], slot),
            None => Dual::constant(p[j]),
        };
        let constant = recorded.iter().map(|row| row.map(Dual::constant)).collect();
        effects.iter().fold(constant, |m: Vec<[Dual<N>; 2]>, &e| {
            let own: Vec<Dual<N>> = self.slots(e).map(parameter).collect();
            act(&*self.effects()[e], &m, &own).unwrap_or(m)
        })
    }
}

/// An instant with its derivatives by the motion.
fn jet<'a>(x: &Motion<'a, f64>) -> Motion<'a, Jet> {
    Motion {
        t: Dual::constant(x.t),
        alpha: [Dual::variable(x.alpha[0], 0), Dual::variable(x.alpha[1], 1)],
        omega: [Dual::variable(x.omega[0], 2), Dual::variable(x.omega[1], 3)],
        variance: x.variance,
        robot: x.robot,
    }
}

fn values(terms: &Terms<Jet>) -> Terms<f64> {
    Terms {
        mass: terms.mass.map(|v| v.value),
        torque: terms.torque.map(|v| v.value),
        level: terms.level.map(|v| v.value),
    }
}

/// Partial derivative number `k` of [`Terms::torque`].
#[inline]
fn slope(
    terms: &Terms<Jet>,
    variations: Variations,
    k: usize,
    a: &[f64; 2],
    s: &[f64; 4],
) -> [f64; 2] {
    let mut out = [0.0; 2];
    if variations.mass != Variation::Absent {
        let [m11, m12, m22] = [0, 1, 2].map(|i| terms.mass[i].partial[k]);
        out = [m11 * a[0] + m12 * a[1], m12 * a[0] + m22 * a[1]];
    }
    if variations.torque != Variation::Absent {
        out = [out[0] + terms.torque[0].partial[k], out[1] + terms.torque[1].partial[k]];
    }
    if variations.level != Variation::Absent {
        out = with_friction(out, &terms.level.map(|level| level.partial[k]), s);
    }
    out
}

/// Solves `mass x = b` for a symmetric 2x2 mass matrix.
///
/// # Errors
/// If the matrix is not positive definite.
pub fn solve_mass(mass: &[f64; 3], b: &[f64; 2]) -> Result<[f64; 2], ModelError> {
    let [m11, m12, m22] = *mass;
    let determinant = m11 * m22 - m12 * m12;
    if !(m11 > 0.0 && determinant > 0.0) {
        return Err(ModelError::MassNotPositive { m11, m12, m22 });
    }
    Ok(cramer(mass, b))
}

/// Inverse of a positive definite mass matrix as (i11, i12, i22): the accelerations due to unit torques.
///
/// # Errors
/// [`ModelError::MassNotPositive`].
#[inline]
pub fn inverse_mass(mass: &[f64; 3]) -> Result<[f64; 3], ModelError> {
    let [first, second] = [solve_mass(mass, &[1.0, 0.0])?, solve_mass(mass, &[0.0, 1.0])?];
    Ok([first[0], first[1], second[1]])
}

/// Symmetric matrix (m11, m12, m22) times a vector.
#[inline]
pub fn times([m11, m12, m22]: &[f64; 3], b: &[f64; 2]) -> [f64; 2] {
    [m11 * b[0] + m12 * b[1], m12 * b[0] + m22 * b[1]]
}

/// The solution of `mass x = b` for a symmetric regular 2x2 matrix, by Cramer's rule.
pub(crate) fn cramer<T: Real>(mass: &[T; 3], b: &[T; 2]) -> [T; 2] {
    let [m11, m12, m22] = *mass;
    let determinant = m11 * m22 - m12 * m12;
    [(m22 * b[0] - m12 * b[1]) / determinant, (m11 * b[1] - m12 * b[0]) / determinant]
}
