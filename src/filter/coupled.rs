//! The filter's step where a body runs behind the wheels: slip, or a spring between them.

mod part;
mod robot;

use nalgebra::{Matrix2, SVector};

use part::{Part, Sides};
pub(super) use robot::Coupled;
use robot::{BODY, STATES, TWIST};

use super::ProcessNoise;
use super::correction::{Covariance, Mean, STILL, make_symmetric};
use super::dynamics::Dynamics;
use super::friction::{Friction, finish, in_directions, torque_noise};
use super::step::{Predicted, Sample, tilt_angles};
use crate::effects::{Coupling, DIFFERENTIATED, Jet, MOST_PARAMETERS, Motion, Terms};
use crate::math::Dual;
use crate::model::{Model, ModelError, inverse_mass};

/// Parts of a step for each radian by which the coupling turns in it: the frequency of a part is low by a share of
/// (1/8)²/12, a stiffness high by 0.3 %.
const PARTS: f64 = 8.0;
/// Most parts of a step. A coupling that is faster still is all but rigid at this rate of sampling.
const MOST_PARTS: f64 = 8.0;

impl<'a> Coupled<'a> {
    pub(super) fn new(model: &'a Model, p: &'a [f64], noise: ProcessNoise) -> Self {
        let energy = model.effects().iter().map(|e| e.energy());
        let on_body = energy.map(|e| e.of_the_body()).collect();
        let forced = vec![SVector::zeros(); p.len()];
        Self {
            model,
            p,
            noise,
            on_body,
            terms: vec![],
            joint: vec![],
            forced,
            transition: Covariance::<STATES>::identity(),
        }
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
                self.forced[j] += gain * SVector::<f64, 2>::from(by);
            }
        }
        for (j, [by_stiffness, by_damping, by_rotor]) in &self.joint {
            let passed =
                [0, 1].map(|i| by_stiffness * x[TWIST + i] + by_damping * (x[2 + i] - x[BODY + i]));
            self.forced[*j] += (part.body_gain - part.gain) * SVector::<f64, 2>::from(passed);
            // the inertia that is added to the wheel is subtracted from the body
            let wheel = part.wheel_acceleration.map(|a| -by_rotor * a);
            let body = part.body_acceleration.map(|a| by_rotor * a);
            self.forced[*j] += part.gain * SVector::<f64, 2>::from(wheel)
                + part.body_gain * SVector::<f64, 2>::from(body);
        }
    }

    /// Into how many parts a step is cut.
    fn parts(sides: &Sides, h: f64) -> usize {
        let Coupling { stiffness, damping, .. } = sides.coupling;
        let mobility = 1.0 / sides.rotor + sides.mobility[(0, 0)] + sides.mobility[(0, 1)].abs();
        let rate = (damping * mobility).max((stiffness * mobility).sqrt());
        (PARTS * rate * h).ceil().clamp(1.0, MOST_PARTS) as usize
    }
}

impl Dynamics<STATES> for Coupled<'_> {
    /// The body starts with the speeds of the wheels, with a variance of slip and twist that the input can
    /// cause.
    fn start(
        &mut self,
        input: &[f64; 2],
        mean: &mut Mean<STATES>,
        covariance: &mut Covariance<STATES>,
    ) {
        let joint = self.sides(0.0, mean).map(|sides| sides.coupling);
        let part = |value: f64, by: f64| if by > 0.0 { (value / by).powi(2) } else { 0.0 };
        for i in 0..2 {
            mean[BODY + i] = mean[2 + i];
            let Ok(joint) = &joint else { continue };
            let spread = covariance[(2 + i, 2 + i)];
            covariance[(BODY + i, 2 + i)] = spread;
            covariance[(2 + i, BODY + i)] = spread;
            let soft = if joint.stiffness > 0.0 { 0.0 } else { part(input[i], joint.damping) };
            covariance[(BODY + i, BODY + i)] = spread + soft + STILL;
            covariance[(TWIST + i, TWIST + i)] = part(input[i], joint.stiffness) + STILL;
        }
    }

    fn predict(
        &mut self,
        sample: &Sample,
        mean: &mut Mean<STATES>,
        covariance: &mut Covariance<STATES>,
        derivatives: bool,
    ) -> Result<Predicted<STATES>, ModelError> {
        let before = *mean;
        let middle = sample.t + 0.5 * sample.step;
        let mut sides = self.sides(middle, mean)?;
        let count = Self::parts(&sides, sample.step);
        let h = sample.step / count as f64;
        let decay = if self.noise.sigma_d > 0.0 { (-h / self.noise.tau_d).exp() } else { 0.0 };
        let mut out: Option<Predicted<STATES>> = None;
        let mut left = [0.0_f64; 4];
        self.forced.iter_mut().for_each(|column| *column = SVector::zeros());
        for part in 0..count {
            if part > 0 {
                sides = self.sides(middle, mean)?;
            }
            let (omega, variances) = ([mean[2], mean[3]], variances(covariance));
            let wheel = [1.0 / sides.rotor, 0.0, 1.0 / sides.rotor];
            let open = sample.speed_variance;
            let friction = Friction::over(h, &sides.level, &omega, &variances, wheel, open);
            let moved = self.part(&sides, &friction, mean, &sample.input, sample.still, h);
            let Some(mut moved) = moved else {
                return Err(ModelError::MassNotPositive { m11: sides.rotor, m12: 0.0, m22: 0.0 });
            };
            for i in 4..6 {
                moved.transition.row_mut(i).fill(0.0);
                moved.transition[(i, i)] = decay;
            }
            if derivatives {
                self.force(&friction, mean, &moved);
            }
            *mean += moved.shift;
            (mean[4], mean[5]) = (mean[4] * decay, mean[5] * decay);
            *covariance = moved.transition * *covariance * moved.transition.transpose();
            self.transition =
                if part == 0 { moved.transition } else { moved.transition * self.transition };
            let acceleration = moved.wheel_acceleration;
            let rest = friction.with_reversals(&omega, &acceleration, &variances, h);
            left = [0, 1, 2, 3].map(|j| left[j].max(rest[j]));
            out = Some(match out {
                None => {
                    let variance = std::array::from_fn(|i| covariance[(i, i)]);
                    Predicted {
                        gain: moved.gain,
                        acceleration,
                        sign: friction.sign,
                        alpha: [before[0], before[1]],
                        omega: [before[2], before[3]],
                        variance,
                        spread: [0.0; 2],
                    }
                }
                Some(so_far) => {
                    Predicted { gain: moved.transition * so_far.gain + moved.gain, ..so_far }
                }
            });
        }
        let Some(mut out) = out else {
            return Err(ModelError::MassNotPositive { m11: 0.0, m12: 0.0, m22: 0.0 });
        };
        let [.., turning, forward] = variances(covariance);
        out.spread = [turning, forward];
        out.acceleration = [0, 1].map(|i| (mean[2 + i] - before[2 + i]) / sample.step);
        tilt_angles(mean, &out.gain, sample);
        let noise = torque_noise(self.noise.sigma_m, &sample.change, &left);
        *covariance += out.gain * noise * out.gain.transpose();
        make_symmetric(covariance);
        finish(&self.noise, self.transition[(4, 4)], sample.still, mean, covariance);
        Ok(out)
    }

    fn transition(&self) -> Covariance<STATES> {
        self.transition
    }

    fn carry(
        &self,
        predicted: &Predicted<STATES>,
        sample: &Sample,
        extra: &[[f64; 2]],
        psi: &mut [[f64; STATES]],
    ) {
        let parameters = self.forced.len();
        for (j, column) in psi.iter_mut().enumerate() {
            let mut moved = self.transition * SVector::from(*column);
            let torque = if j < parameters {
                moved += self.forced[j];
                sample.by_parameter.get(j).copied().unwrap_or([0.0; 2])
            } else {
                extra[j - parameters]
            };
            moved += predicted.gain * SVector::<f64, 2>::from(torque);
            for i in (0..2).filter(|&i| sample.still[i]) {
                moved[i] = column[i];
                moved[2 + i] = 0.0;
            }
            *column = moved.into();
        }
    }

    /// The bias by noise of the input is worked out for rigid robots only.
    fn mass_slopes(&mut self, _: &Predicted<STATES>) -> Vec<(usize, Matrix2<f64>)> {
        vec![]
    }
}

/// Variances of the wheels' speeds along the directions [rad^2/s^2].
fn variances(covariance: &Covariance<STATES>) -> [f64; 4] {
    in_directions([covariance[(2, 2)], covariance[(2, 3)], covariance[(3, 3)]])
}

#[cfg(test)]
mod tests;
