//! Exact first derivatives of a model, and the dynamics solved from it.

use super::{Model, ModelError, Variation, Variations};
use crate::effects::{DIFFERENTIATED, DIRECTIONS, Jet, Motion, Own, Terms};
use crate::math::{Dual, Real};

/// Partial derivatives of a [`Jet`] before those of an effect's own parameters.
const STATES: usize = 4;

/// The torque balance `mass a + torque + Σ d_j level_j s_j` and its derivatives at one instant.
#[derive(Clone, Debug)]
pub struct Linearisation {
    /// Values.
    pub terms: Terms<f64>,
    /// Derivatives of the two torques with respect to (alpha1, alpha2, omega1, omega2), at fixed
    /// acceleration and friction signs.
    pub by_state: [[f64; 4]; 2],
    /// Derivatives of the two torques with respect to each parameter of the model (those that act
    /// through the input have zero here).
    pub by_parameter: Vec<[f64; 2]>,
    /// What each effect adds, with its own derivatives.
    effects: Vec<Terms<Jet>>,
    /// The sum of the effects that are the same at every instant; the parameter values for which
    /// it and they stand here, and these with their derivatives.
    constant: Terms<f64>,
    given: Vec<f64>,
    own: Vec<Jet>,
}

impl Linearisation {
    /// Room for the derivatives of a model with `parameters` parameters.
    #[must_use]
    pub fn new(parameters: usize) -> Self {
        Self {
            terms: Terms::zero(),
            by_state: [[0.0; 4]; 2],
            by_parameter: vec![[0.0; 2]; parameters],
            effects: vec![],
            constant: Terms::zero(),
            given: vec![],
            own: vec![],
        }
    }
}

impl Model {
    /// Writes values and exact derivatives of the torque balance at acceleration `a` [rad/s^2]
    /// and friction signs `s` (one for each of [`crate::effects::DIRECTIONS`]) into `out`, which
    /// is made for this model: the inner loop of every estimator allocates nothing.
    ///
    /// # Panics
    /// If `p` or `out` do not have one entry a parameter.
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

    /// The first half of [`Model::linearise`]: every effect once, its values summed in `out.terms`.
    /// A caller that chooses signs and acceleration by the values goes on with
    /// [`Model::differentiate`], which may be repeated. Effects that are the same at every instant
    /// are evaluated anew only where `p` is another than before.
    pub fn evaluate(&self, x: &Motion<f64>, p: &[f64], out: &mut Linearisation) {
        let jet = Motion {
            t: Dual::constant(x.t),
            alpha: [Dual::variable(x.alpha[0], 0), Dual::variable(x.alpha[1], 1)],
            omega: [Dual::variable(x.omega[0], 2), Dual::variable(x.omega[1], 3)],
            variance: x.variance,
            robot: x.robot,
        };
        if out.given != p {
            self.prepare(&jet, p, out);
        }
        out.terms = out.constant;
        for (e, effect) in self.effects().iter().enumerate() {
            let variations = self.variations(e);
            if !variations.vary() {
                continue;
            }
            let (terms, own) = (&mut out.effects[e], &out.own[self.slots(e)]);
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

    /// What does not change with the motion: parameters with their derivatives, constant effects.
    fn prepare(&self, x: &Motion<Jet>, p: &[f64], out: &mut Linearisation) {
        out.given.clear();
        out.given.extend_from_slice(p);
        out.own.clear();
        out.effects.clear();
        out.constant = Terms::zero();
        for (e, effect) in self.effects().iter().enumerate() {
            let slots = self.slots(e);
            out.own.extend(p[slots.clone()].iter().enumerate().map(|(k, &value)| {
                if k < DIFFERENTIATED {
                    Dual::variable(value, STATES + k)
                } else {
                    Dual::constant(value)
                }
            }));
            let terms = effect.terms_jet(x, &out.own[slots]);
            if !self.variations(e).vary() {
                out.constant.add(&values(&terms));
            }
            out.effects.push(terms);
        }
    }

    /// The second half of [`Model::linearise`]: derivatives at acceleration `a` and signs `s` of
    /// what [`Model::evaluate`] left in `out`.
    pub fn differentiate(&self, a: &[f64; 2], s: &[f64; 4], out: &mut Linearisation) {
        self.differentiate_by_state(a, s, out);
        self.differentiate_by_parameter(a, s, out);
    }

    /// [`Model::differentiate`] by the motion alone.
    pub fn differentiate_by_state(&self, a: &[f64; 2], s: &[f64; 4], out: &mut Linearisation) {
        out.by_state = [[0.0; STATES]; 2];
        for (e, terms) in out.effects.iter().enumerate() {
            let variations = self.variations(e);
            if variations.vary() {
                for k in 0..STATES {
                    let slope = slope(terms, variations, k, a, s);
                    out.by_state[0][k] += slope[0];
                    out.by_state[1][k] += slope[1];
                }
            }
        }
    }

    /// [`Model::differentiate`] by the parameters alone.
    pub fn differentiate_by_parameter(&self, a: &[f64; 2], s: &[f64; 4], out: &mut Linearisation) {
        for (e, terms) in out.effects.iter().enumerate() {
            let variations = self.variations(e);
            for (k, j) in self.slots(e).enumerate().take(DIFFERENTIATED) {
                out.by_parameter[j] = slope(terms, variations, STATES + k, a, s);
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
        for seen in acting.chunks(DIFFERENTIATED) {
            let m = self.input_by(&effects, seen, t, recorded, p);
            for (slot, &j) in seen.iter().enumerate() {
                derivatives[j] = m.iter().map(|row| row.map(|v| v.partial[slot])).collect();
            }
            input.get_or_insert_with(|| m.iter().map(|row| row.map(|v| v.value)).collect());
        }
        (input.unwrap_or_else(|| recorded.to_vec()), derivatives)
    }

    /// The acting input with its derivatives by the parameters `seen`.
    fn input_by(
        &self,
        effects: &[usize],
        seen: &[usize],
        t: &[f64],
        recorded: &[[f64; 2]],
        p: &[f64],
    ) -> Vec<[Own; 2]> {
        let parameter = |j: usize| match seen.iter().position(|&k| k == j) {
            Some(slot) => Own::variable(p[j], slot),
            None => Own::constant(p[j]),
        };
        let constant = recorded.iter().map(|row| row.map(Own::constant)).collect();
        effects.iter().fold(constant, |m: Vec<[Own; 2]>, &e| {
            let own: Vec<Own> = self.slots(e).map(parameter).collect();
            self.effects()[e].input_own(t, &m, &own).unwrap_or(m)
        })
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
        for (j, d) in DIRECTIONS.iter().enumerate() {
            let friction = s[j] * terms.level[j].partial[k];
            out = [out[0] + d[0] * friction, out[1] + d[1] * friction];
        }
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

/// Inverse of a positive definite mass matrix as (i11, i12, i22): the accelerations that torques of one give.
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
