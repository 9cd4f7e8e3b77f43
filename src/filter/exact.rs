//! The step of the simulation inside the filter: stops, reversals and releases where they happen.

use nalgebra::{Matrix2, SMatrix, SVector};

use super::correction::{Covariance, Mean, add_torque_noise, carried_over};
use super::dynamics::{Dynamics, slopes_of_mass};
use super::friction::torque_noise;
use super::sample::{Predicted, Sample};
use crate::effects::Motion;
use crate::model::{Linearisation, Model, ModelError, inverse_mass};
use crate::robot::State;
use crate::simulate::{Ends, Walk};

/// Product of damping rate and row time above which the decay of a torque within the row is taken into account: below,
/// it changes the input matrix by less than 5 %.
const DAMPED: f64 = 0.1;

/// The rigid robot with the integrator of the simulation: Runge-Kutta 4 with an input linear over
/// the row, contact events located inside the row, exact derivatives through them.
///
/// Derivatives by inertias are those along the smoothed input. With the recorded one they would
/// share its noise with the innovations, and inertias would come out too large (errors in
/// variables) where friction is most of the input; as instruments they need not be exact.
///
/// States (alpha1, alpha2, omega1, omega2). Deviations from the recorded input enter as torque
/// noise:
///
/// ```text
/// Q = diag(s_M² + max(0, ΔM² - 6 s_M²)/12) + Σ_j d_j d_j' crossing_j,   P <- F P F' + G Q G'
/// ```
pub(super) struct Exact<'a> {
    model: &'a Model,
    p: &'a [f64],
    /// Standard deviation of the noise of the input [N m].
    sigma: f64,
    walk: Walk<'a>,
    acting: Vec<(usize, Ends)>,
    /// Of the last step.
    transition: Covariance<4>,
    /// Effect of a torque over the last step without contact.
    gain: SMatrix<f64, 4, 2>,
    /// Wheels at rest after the step.
    rest: [bool; 2],
    /// `∂(mass matrix)/∂θ` of the parameters that have one, at rest: enough for an instrument.
    slopes: Vec<(usize, Matrix2<f64>)>,
}

impl<'a> Exact<'a> {
    pub(super) fn new(model: &'a Model, p: &'a [f64], sigma: f64) -> Self {
        let walk = Walk::new(model, p);
        let slopes = mass_slopes(model, p);
        Self {
            model,
            p,
            sigma,
            walk,
            acting: vec![],
            transition: Covariance::<4>::identity(),
            gain: SMatrix::zeros(),
            rest: [false; 2],
            slopes,
        }
    }

    /// Input matrix G of a step without contact: change of the state per unit torque.
    fn gain_of(&self, sample: &Sample, mean: &Mean<4>) -> Result<SMatrix<f64, 4, 2>, ModelError> {
        let [i11, i12, i22] = match self.walk.mobility() {
            Some(constant) => constant,
            None => self.mobility(sample, mean)?,
        };
        let mobility = Matrix2::new(i11, i12, i12, i22);
        let h = sample.step;
        let mut gain = SMatrix::<f64, 4, 2>::zeros();
        gain.fixed_view_mut::<2, 2>(0, 0).copy_from(&(mobility * (0.5 * h * h)));
        gain.fixed_view_mut::<2, 2>(2, 0).copy_from(&(mobility * h));
        Ok(gain)
    }

    /// The input matrix where torques that depend on the speeds change them within the row: a torque early in the row
    /// has decayed at its end.
    ///
    /// ```text
    /// G_ω = L h A⁻¹,  G_α = (1 + 2 L)/3 h²/2 A⁻¹,   L = mean of Φ_ω over the row ≈ (2 √Φ_ω + (1 + Φ_ω)/2)/3
    /// ```
    /// The scalar form of L is within 4 % of `(1 - φ)/(-ln φ)` for φ above 0.03.
    fn dampen(&mut self, step: f64) {
        if self.walk.damping_rate() * step < DAMPED {
            return;
        }
        let of_speeds: Matrix2<f64> = self.transition.fixed_view::<2, 2>(2, 2).into();
        let Some(mean) = mean_transition(&of_speeds) else { return };
        let one = Matrix2::identity();
        let [angles, speeds] = [0, 2].map(|i| self.gain.fixed_view::<2, 2>(i, 0).into_owned());
        self.gain.fixed_view_mut::<2, 2>(0, 0).copy_from(&((one + mean * 2.0) / 3.0 * angles));
        self.gain.fixed_view_mut::<2, 2>(2, 0).copy_from(&(mean * speeds));
    }

    /// Inverse of a mass matrix that varies.
    fn mobility(&self, sample: &Sample, mean: &Mean<4>) -> Result<[f64; 3], ModelError> {
        let x = Motion::at(sample.t, [mean[0], mean[1]], [mean[2], mean[3]], self.model.robot());
        inverse_mass(&self.model.terms(&x, self.p).mass)
    }
}

impl Dynamics<4> for Exact<'_> {
    fn start(&mut self, _: &[f64; 2], _: &mut Mean<4>, _: &mut Covariance<4>) {}

    fn predict(
        &mut self,
        sample: &Sample,
        mean: &mut Mean<4>,
        covariance: &mut Covariance<4>,
        _: bool,
    ) -> Result<Predicted, ModelError> {
        self.gain = self.gain_of(sample, mean)?;
        let before = State { alpha: [mean[0], mean[1]], omega: [mean[2], mean[3]] };
        self.acting.clear();
        let ends = sample.ends_by_parameter.iter().enumerate();
        self.acting.extend(ends.filter_map(|(j, ends)| ends.map(|ends| (j, ends))));
        let time = (sample.t, sample.t + sample.step);
        let after = self.walk.step(&before, time, &sample.ends, &self.acting);
        // a diverging simulation has a likelihood of NaN
        let after = after.unwrap_or(State { alpha: [f64::NAN; 2], omega: [f64::NAN; 2] });
        self.rest = after.omega.map(|w| w == 0.0);
        let columns = [0, 1, 2, 3].map(|k| Mean::<4>::from(self.walk.by_state(k)));
        let mut transition = Covariance::<4>::from_columns(&columns);
        for i in (0..2).filter(|&i| self.rest[i]) {
            // the speed of a wheel at rest does not depend on the previous state
            transition.row_mut(2 + i).fill(0.0);
        }
        self.transition = transition;
        self.dampen(sample.step);
        *mean = Mean::<4>::new(after.alpha[0], after.alpha[1], after.omega[0], after.omega[1]);
        let torque = torque_noise(self.sigma, &sample.change, &sample.crossing);
        *covariance = carried_over(&transition, covariance);
        add_torque_noise(covariance, &self.gain, &torque);
        let acceleration = [0, 1].map(|i| (after.omega[i] - before.omega[i]) / sample.step);
        Ok(Predicted {
            acceleration,
            sign: [0.0; 4],
            alpha: before.alpha,
            omega: before.omega,
            variance: [0.0; 4],
            spread: [0.0; 2],
        })
    }

    fn transition(&self) -> Covariance<4> {
        self.transition
    }

    fn gain(&self) -> SMatrix<f64, 4, 2> {
        self.gain
    }

    fn carry(&self, sample: &Sample, extra: &[[f64; 2]], psi: &mut [[f64; 4]]) {
        let (f, g) = (&self.transition, &self.gain);
        let carried = |column: &mut [f64; 4], forced: [f64; 4]| {
            // in loops of known length, as in `carried_over`
            let mut moved = [0.0; 4];
            for k in 0..4 {
                for i in 0..4 {
                    moved[i] += f[(i, k)] * column[k];
                }
            }
            for i in 0..4 {
                column[i] = moved[i] + forced[i];
            }
        };
        let (by_parameter, by_column) = psi.split_at_mut(self.p.len());
        for (j, column) in by_parameter.iter_mut().enumerate() {
            carried(column, self.walk.by_parameter(j));
        }
        for (column, torque) in by_column.iter_mut().zip(extra) {
            carried(column, (g * SVector::<f64, 2>::from(*torque)).into());
        }
        // acceleration by the difference of smoothed and recorded input, times ∂A/∂θ; A⁻¹ is the
        // lower block of G over h
        let smoother = SVector::<f64, 2>::from(sample.smoother);
        let acceleration = g.fixed_view::<2, 2>(2, 0) * smoother / sample.step;
        for (j, slope) in &self.slopes {
            let torque = g * (slope * acceleration);
            (0..4).for_each(|i| psi[*j][i] -= torque[i]);
        }
        for column in psi.iter_mut() {
            for i in (0..2).filter(|&i| self.rest[i]) {
                column[2 + i] = 0.0;
            }
        }
    }
}

/// The mean of the transition of the speeds over a row, from that of the whole row; `None` if a wheel stops in the row.
fn mean_transition(whole: &Matrix2<f64>) -> Option<Matrix2<f64>> {
    let root = whole.determinant().sqrt();
    let scale = (whole.trace() + 2.0 * root).sqrt();
    let one = Matrix2::identity();
    // the transition of half a row is the square root of the whole
    let half = || (whole + one * root) / scale;
    (root > 0.0 && scale > 0.0).then(|| (half() * 2.0 + (one + whole) * 0.5) / 3.0)
}

fn mass_slopes(model: &Model, p: &[f64]) -> Vec<(usize, Matrix2<f64>)> {
    let mut work = Linearisation::new(p.len());
    let (still, robot) = ([0.0; 2], model.robot());
    let x = Motion::at(0.0, still, still, robot);
    slopes_of_mass(|a| {
        model.linearise(&x, p, a, &[0.0; 4], &mut work);
        work.by_parameter.clone()
    })
}

#[cfg(test)]
mod tests;
