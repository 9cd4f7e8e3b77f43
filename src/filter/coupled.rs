//! The filter's step where a body runs behind the wheels: slip, or a spring between them.

mod part;
mod robot;

use nalgebra::{Matrix2, SMatrix, Vector2};

pub(super) use robot::Coupled;
use robot::{BODY, Part, STATES, Sides, TWIST};

use super::ProcessNoise;
use super::correction::{Covariance, Mean, STILL, add_torque_noise};
use super::friction::Friction;
use super::sample::{Predicted, Sample};
use super::step::{Body, Braked, Step};
use crate::effects::{Coupling, DIFFERENTIATED, Jet, MOST_PARAMETERS, Motion, Terms};
use crate::math::Dual;
use crate::model::{Model, ModelError, inverse_mass};

/// Parts of a step for each radian by which the coupling turns in it: the frequency of a part is low by a share of
/// (1/8)²/12, a stiffness high by 0.3 %.
const PARTS: f64 = 8.0;
/// Most parts of a step. A coupling that is faster still is all but rigid at this rate of sampling.
const MOST_PARTS: f64 = 8.0;

impl<'a> Coupled<'a> {
    pub(super) fn step(model: &'a Model, p: &'a [f64], noise: ProcessNoise) -> Step<Self> {
        let energy = model.effects().iter().map(|e| e.energy());
        let body = Self {
            model,
            p,
            on_body: energy.map(|e| e.of_the_body()).collect(),
            terms: vec![],
            joint: vec![],
            forced: vec![Mean::<STATES>::zeros(); p.len()],
            sides: None,
            part: None,
            transition: Covariance::<STATES>::identity(),
            gain: SMatrix::zeros(),
        };
        Step::new(body, noise)
    }

    /// Evaluates all effects at time `t` and state `x`.
    fn sides(&mut self, t: f64, x: &Mean<STATES>) -> Result<Sides, ModelError> {
        let robot = self.model.robot();
        let motion = |alpha: [f64; 2], omega: [f64; 2]| Motion {
            t: Dual::constant(t),
            alpha: [Dual::variable(alpha[0], 0), Dual::variable(alpha[1], 1)],
            omega: [Dual::variable(omega[0], 2), Dual::variable(omega[1], 3)],
            variance: [0.0; 4],
            robot,
        };
        let front = motion([x[0], x[1]], [x[2], x[3]]);
        let behind = motion([x[0] - x[TWIST], x[1] - x[TWIST + 1]], [x[BODY], x[BODY + 1]]);
        let mut coupling = Coupling { rotor: 0.0, stiffness: 0.0, damping: 0.0 };
        let (mut body, mut wheel) = (Terms::zero(), Terms::zero());
        self.terms.clear();
        for (e, effect) in self.model.effects().iter().enumerate() {
            let slots = self.model.slots(e);
            let mut own = [Jet::constant(0.0); MOST_PARAMETERS];
            for (k, j) in slots.clone().enumerate() {
                own[k] = self.jet(k, j);
            }
            let own = &own[..slots.len()];
            if let Some(Coupling { rotor, stiffness, damping }) = effect.coupling_jet(&front, own) {
                let partial = |k: usize| [stiffness, damping, rotor].map(|v| v.partial[4 + k]);
                self.joint.clear();
                self.joint.extend(slots.enumerate().map(|(k, j)| (j, partial(k))));
                coupling = Coupling {
                    rotor: rotor.value,
                    stiffness: stiffness.value,
                    damping: damping.value,
                };
            }
            let terms = effect.terms_jet(if self.on_body[e] { &behind } else { &front }, own);
            let side = if self.on_body[e] { &mut body } else { &mut wheel };
            side.add(&Terms {
                mass: terms.mass.map(|v| v.value),
                torque: terms.torque.map(|v| v.value),
                level: terms.level.map(|v| v.value),
            });
            self.terms.push(terms);
        }
        let rotor = coupling.rotor_within(&body.mass);
        let [m11, m12, m22] = body.mass;
        let not_positive = ModelError::MassNotPositive { m11, m12, m22 };
        if !(rotor > 0.0) {
            return Err(not_positive);
        }
        let [i11, i12, i22] =
            inverse_mass(&[m11 - rotor, m12, m22 - rotor]).map_err(|_| not_positive)?;
        Ok(Sides {
            coupling,
            rotor,
            mobility: Matrix2::new(i11, i12, i12, i22),
            body_torque: body.torque,
            wheel_torque: wheel.torque,
            level: wheel.level,
        })
    }

    /// Calls `add(wheel, k, slope)` with the derivatives of the torques of one side by
    /// (alpha1, alpha2, omega1, omega2).
    fn add_slopes(
        &self,
        on_body: bool,
        a: &[f64; 2],
        s: &[f64; 4],
        mut add: impl FnMut(usize, usize, f64),
    ) {
        for (terms, _) in self.terms.iter().zip(&self.on_body).filter(|(_, b)| **b == on_body) {
            for (i, torque) in terms.total_torque(a, s).iter().enumerate() {
                (0..4).for_each(|k| add(i, k, torque.partial[k]));
            }
        }
    }

    /// Parameter `j`, number `k` of its effect.
    fn jet(&self, k: usize, j: usize) -> Jet {
        if k < DIFFERENTIATED {
            Dual::variable(self.p[j], 4 + k)
        } else {
            Dual::constant(self.p[j])
        }
    }

    /// Carries the derivatives by the parameters over a part.
    fn force(&mut self, friction: &Friction, x: &Mean<STATES>, part: &Part) {
        for column in &mut self.forced {
            *column = part.transition * *column;
        }
        for (e, terms) in self.terms.iter().enumerate() {
            let (torque, gain) = if self.on_body[e] {
                (terms.total_torque(&part.body_acceleration, &[0.0; 4]), &part.body_gain)
            } else {
                (terms.total_torque(&part.wheel_acceleration, &friction.sign), &part.gain)
            };
            for (k, j) in self.model.slots(e).enumerate().take(DIFFERENTIATED) {
                let by = [0, 1].map(|i| -torque[i].partial[4 + k]);
                self.forced[j] += gain * Vector2::from(by);
            }
        }
        for (j, [by_stiffness, by_damping, by_rotor]) in &self.joint {
            let passed =
                [0, 1].map(|i| by_stiffness * x[TWIST + i] + by_damping * (x[2 + i] - x[BODY + i]));
            self.forced[*j] += (part.body_gain - part.gain) * Vector2::from(passed);
            // the inertia that is added to the wheel is subtracted from the body
            let wheel = part.wheel_acceleration.map(|a| -by_rotor * a);
            let body = part.body_acceleration.map(|a| by_rotor * a);
            self.forced[*j] +=
                part.gain * Vector2::from(wheel) + part.body_gain * Vector2::from(body);
        }
    }

    /// Into how many parts a step of `h` \[s\] is cut.
    fn parts(sides: &Sides, h: f64) -> usize {
        let Coupling { stiffness, damping, .. } = sides.coupling;
        let mobility = 1.0 / sides.rotor + sides.mobility[(0, 0)] + sides.mobility[(0, 1)].abs();
        let rate = (damping * mobility).max((stiffness * mobility).sqrt());
        (PARTS * rate * h).ceil().clamp(1.0, MOST_PARTS) as usize
    }
}

impl Body<STATES> for Coupled<'_> {
    /// The body starts with the speeds of the wheels, with a variance of slip and twist that input and friction, M, can
    /// cause:
    ///
    /// ```text
    /// spring k:    φ = M/k,   w - u = φ sqrt(k (1/J_r + 1/(A - J_r)))   (free oscillation)
    /// slip:        w - u = M/c
    /// ```
    fn start(
        &mut self,
        input: &[f64; 2],
        mean: &mut Mean<STATES>,
        covariance: &mut Covariance<STATES>,
    ) {
        let sides = self.sides(0.0, mean);
        let square = |value: f64, by: f64| if by > 0.0 { (value / by).powi(2) } else { 0.0 };
        for i in 0..2 {
            mean[BODY + i] = mean[2 + i];
            let Ok(sides) = &sides else { continue };
            let Coupling { stiffness, damping, .. } = sides.coupling;
            let torque = input[i].abs() + sides.level[i].max(0.0);
            let twist = square(torque, stiffness);
            let slip = if stiffness > 0.0 {
                twist * stiffness * (1.0 / sides.rotor + sides.mobility[(i, i)])
            } else {
                square(torque, damping)
            };
            let spread = covariance[(2 + i, 2 + i)];
            covariance[(BODY + i, 2 + i)] = spread;
            covariance[(2 + i, BODY + i)] = spread;
            covariance[(BODY + i, BODY + i)] = spread + slip + STILL;
            covariance[(TWIST + i, TWIST + i)] = twist + STILL;
        }
    }

    fn evaluate(
        &mut self,
        sample: &Sample,
        _: &Predicted,
        mean: &Mean<STATES>,
    ) -> Result<Braked, ModelError> {
        let sides = self.sides(sample.t + 0.5 * sample.step, mean)?;
        self.sides = Some(sides);
        Ok(Braked { level: sides.level, mobility: [1.0 / sides.rotor, 0.0, 1.0 / sides.rotor] })
    }

    fn begin(&mut self, h: f64) -> usize {
        self.forced.iter_mut().for_each(|column| column.fill(0.0));
        self.part = None;
        self.sides.as_ref().map_or(1, |sides| Self::parts(sides, h))
    }

    fn solve(
        &mut self,
        friction: &Friction,
        sample: &Sample,
        mean: &Mean<STATES>,
        h: f64,
        decay: f64,
    ) -> Result<[f64; 2], ModelError> {
        let first = self.part.is_none();
        let mass = self.sides.map_or(0.0, |sides| sides.rotor);
        let part = self.sides.and_then(|s| self.part(&s, friction, mean, sample, (h, decay)));
        let not_positive = ModelError::MassNotPositive { m11: mass, m12: 0.0, m22: 0.0 };
        let part = part.ok_or(not_positive)?;
        (self.transition, self.gain) = if first {
            (part.transition, part.gain)
        } else {
            (part.transition * self.transition, part.transition * self.gain + part.gain)
        };
        let acceleration = [0, 1].map(|i| part.shift[2 + i] / h);
        self.part = Some(part);
        Ok(acceleration)
    }

    /// Carries the derivatives over the part.
    fn differentiate(&mut self, friction: &Friction, _: &[f64; 2], mean: &Mean<STATES>) {
        if let Some(part) = self.part.take() {
            self.force(friction, mean, &part);
            self.part = Some(part);
        }
    }

    fn advance(
        &mut self,
        _: &Sample,
        _: &[f64; 2],
        mean: &mut Mean<STATES>,
        covariance: &mut Covariance<STATES>,
    ) {
        if let Some(part) = &self.part {
            *mean += part.shift;
            *covariance = part.transition * *covariance * part.transition.transpose();
        }
    }

    fn add_noise(&self, torque: &Matrix2<f64>, covariance: &mut Covariance<STATES>) {
        add_torque_noise(covariance, &self.gain, torque);
    }

    fn transition(&self) -> Covariance<STATES> {
        self.transition
    }

    fn gain(&self) -> SMatrix<f64, STATES, 2> {
        self.gain
    }

    fn carried(&self, column: &[f64; STATES], j: Option<usize>, torque: [f64; 2]) -> [f64; STATES] {
        let mut moved = self.transition * Mean::<STATES>::from(*column);
        if let Some(j) = j {
            moved += self.forced[j];
        }
        moved += self.gain * Vector2::from(torque);
        moved.into()
    }

    fn parameters(&self) -> usize {
        self.forced.len()
    }
}

#[cfg(test)]
mod tests;
