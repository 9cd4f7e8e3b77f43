//! One prediction and one correction of the filter.

use nalgebra::{Matrix2, SMatrix, SVector};

use super::ProcessNoise;
use super::correction::{Covariance, Mean};
use super::friction::{Friction, finish, in_directions, torque_noise};
use super::push::Push;
use crate::effects::Motion;
use crate::model::{Linearisation, Model, ModelError, inverse_mass};
use crate::simulate::Ends;

/// The input over one sample.
pub(super) struct Sample<'a> {
    /// Time at the start, since the start of the recording \[s\].
    pub(super) t: f64,
    /// Length \[s\].
    pub(super) step: f64,
    /// Acting input that the step uses [N m].
    pub(super) input: [f64; 2],
    /// The acting input at both ends of the sample [N m].
    pub(super) ends: Ends,
    /// Correction of the mean input for its effect on the angle (first moment over the step), see
    /// [`lag_of_angle`] [N m].
    pub(super) tilt: [f64; 2],
    /// Change of the recorded input over the sample [N m].
    pub(super) change: [f64; 2],
    /// Smoothed less recorded input, mean over the row [N m]; derivatives by inertias are taken with
    /// the smoothed one.
    pub(super) smoother: [f64; 2],
    /// Variance of a friction along each direction that may reverse within the sample [N^2 m^2],
    /// for steps that do not add it themselves.
    pub(super) crossing: [f64; 4],
    /// Derivative of `input` by each parameter; empty where no effect acts on the input.
    pub(super) by_parameter: &'a [[f64; 2]],
    /// Derivative of `ends` by each parameter that acts through them.
    pub(super) ends_by_parameter: &'a [Option<Ends>],
    /// Variance of the speed of the body due to sensor noise alone, for any process noise
    /// [rad^2/s^2].
    pub(super) speed_variance: f64,
    /// Wheels at rest during the sample.
    pub(super) still: [bool; 2],
}

/// Result of a prediction, for the columns that are propagated with it.
pub(super) struct Predicted<const N: usize> {
    /// Linear map of a torque on the wheels to the state after the step.
    pub(super) gain: SMatrix<f64, N, 2>,
    /// Mean acceleration over the step [rad/s^2].
    pub(super) acceleration: [f64; 2],
    /// Friction signs, statistically linearised.
    pub(super) sign: [f64; 4],
    /// Where the step was linearised.
    pub(super) alpha: [f64; 2],
    /// Where the step was linearised.
    pub(super) omega: [f64; 2],
    /// Spread there.
    pub(super) variance: [f64; 4],
    /// Variance of w1 - w2 and of w1 + w2.
    pub(super) spread: [f64; 2],
}

/// What moves a state: the model with the values of its parameters, and its process noise.
#[derive(Clone, Copy)]
pub(super) struct Law<'a> {
    pub(super) model: &'a Model,
    pub(super) p: &'a [f64],
    pub(super) noise: ProcessNoise,
}

/// Difference between the change of the angle by the mean of an input and that by the input, from
/// its first moment.
///
/// ```text
/// ∫ (h - s) M ds = h² (mean/2 - tilt),   tilt = c (1 - c)/3 (M1 - M0)
/// ```
/// with the weight c of the later row in the mean: exact for a linear input (c = 1/2, M0/3 + M1/6),
/// a held one (c = 0), and one held over each of m parts of the row, c = (m - 1)/(2 m). Derived
/// here.
pub(super) fn lag_of_angle(later: f64, start: &[f64; 2], end: &[f64; 2]) -> [f64; 2] {
    [0, 1].map(|i| later * (1.0 - later) / 3.0 * (end[i] - start[i]))
}

/// Corrects the angles after a step with the mean input for the first moment of the input.
pub(super) fn tilt_angles<const N: usize>(
    mean: &mut Mean<N>,
    gain: &SMatrix<f64, N, 2>,
    sample: &Sample,
) {
    for i in (0..2).filter(|&i| !sample.still[i]) {
        // the gain of the angle is h²/2 times the inverse inertia
        mean[i] -= 2.0 * (gain[(i, 0)] * sample.tilt[0] + gain[(i, 1)] * sample.tilt[1]);
    }
}

/// Moves mean and covariance over one sample.
///
/// Every sgn is replaced by its mean over the filter's own spread, erf(v / sqrt(2 V)), and the
/// variance about that mean becomes process noise; if a wheel may pass through rest within the
/// step, the square of the friction level is added to the process noise, which reduces the weight
/// of the step. The step is implicit in the friction (its slope is stiff) and of second order
/// elsewhere.
#[inline]
pub(super) fn predict(
    law: &Law,
    sample: &Sample,
    mean: &mut Mean<6>,
    covariance: &mut Covariance<6>,
    work: &mut Linearisation,
    push: &mut Push,
) -> Result<Predicted<6>, ModelError> {
    let Law { model, p, noise } = law;
    let h = sample.step;
    let omega = [mean[2], mean[3]];
    let x = Motion {
        t: sample.t + 0.5 * h,
        alpha: [mean[0] + 0.5 * h * omega[0], mean[1] + 0.5 * h * omega[1]],
        omega,
        variance: [covariance[(0, 0)], covariance[(1, 1)], covariance[(2, 2)], covariance[(3, 3)]],
        robot: model.robot(),
    };
    model.evaluate(&x, p, work);
    let terms = work.terms;
    let mobility = mobility(&terms.mass, sample.still)?;
    let variances = in_directions([covariance[(2, 2)], covariance[(2, 3)], covariance[(3, 3)]]);
    let inverse = [mobility[(0, 0)], mobility[(0, 1)], mobility[(1, 1)]];
    let friction =
        Friction::over(h, &terms.level, &omega, &variances, inverse, sample.speed_variance);
    model.differentiate_by_state(&[0.0; 2], &friction.sign, work);
    let resisting = terms.total_torque(&[0.0; 2], &friction.sign);
    let block = |k: usize| {
        let [first, second] = &work.by_state;
        Matrix2::new(first[k], first[k + 1], second[k], second[k + 1])
    };
    let (by_angle, smooth) = (block(0), block(2));
    let stiff = friction.stiffness();
    let implicit = Matrix2::identity() + mobility * (smooth * (0.5 * h) + stiff * h);
    let Some(phi) = implicit.try_inverse() else {
        let [m11, m12, m22] = terms.mass;
        return Err(ModelError::MassNotPositive { m11, m12, m22 });
    };
    let force = SVector::<f64, 2>::new(
        sample.input[0] + mean[4] - resisting[0],
        sample.input[1] + mean[5] - resisting[1],
    );
    let reach = phi * mobility;
    let acceleration = reach * force;
    let acceleration = [acceleration[0], acceleration[1]];
    let rest = friction.with_reversals(&omega, &acceleration, &variances, h);
    // F = I - h reach (C + K) with reach = Phi A^-1, C the smooth slope and K that of friction
    push.by_torque = reach * h;
    push.by_speed = push.by_torque * -(smooth + by_angle * (0.5 * h) + stiff);
    push.by_angle = (by_angle != Matrix2::zeros()).then(|| push.by_torque * -by_angle);
    push.last(h, noise);
    let mut gain = SMatrix::<f64, 6, 2>::zeros();
    gain.fixed_view_mut::<2, 2>(0, 0).copy_from(&(push.by_torque * (0.5 * h)));
    gain.fixed_view_mut::<2, 2>(2, 0).copy_from(&push.by_torque);
    let after = omega_after(&omega, &acceleration, h, sample.still);
    for i in 0..2 {
        mean[i] += 0.5 * h * (omega[i] + after[i]);
        mean[2 + i] = after[i];
        mean[4 + i] *= push.decay;
    }
    tilt_angles(mean, &gain, sample);
    *covariance = push.spread(covariance, &torque_noise(noise.sigma_m, &sample.change, &rest));
    finish(noise, push.decay, sample.still, mean, covariance);
    Ok(Predicted {
        gain,
        acceleration,
        sign: friction.sign,
        alpha: x.alpha,
        omega,
        variance: x.variance,
        spread: [variances[2], variances[3]],
    })
}

/// Moves the derivatives over the step: `psi <- F psi + G f`, `f` the derivative of the torque
/// balance by each parameter (column).
pub(super) fn move_parameters(
    push: &Push,
    work: &Linearisation,
    sample: &Sample,
    extra: &[[f64; 2]],
    psi: &mut [[f64; 6]],
) {
    let (by_parameter, by_column) = psi.split_at_mut(work.by_parameter.len());
    let carry = |column: &mut [f64; 6], torque: [f64; 2]| {
        let old = *column;
        *column = push.moved(&old, torque);
        for i in (0..2).filter(|&i| sample.still[i]) {
            (column[i], column[2 + i]) = (old[i], 0.0);
        }
    };
    for (j, (column, needed)) in by_parameter.iter_mut().zip(&work.by_parameter).enumerate() {
        let input = sample.by_parameter.get(j).copied().unwrap_or([0.0; 2]);
        carry(column, [input[0] - needed[0], input[1] - needed[1]]);
    }
    by_column.iter_mut().zip(extra).for_each(|(column, torque)| carry(column, *torque));
}

/// The inverse mass matrix; if one wheel is at rest, only the other one moves.
fn mobility(mass: &[f64; 3], still: [bool; 2]) -> Result<Matrix2<f64>, ModelError> {
    let [i11, i12, i22] = inverse_mass(mass)?;
    Ok(match still {
        [false, false] => Matrix2::new(i11, i12, i12, i22),
        [false, true] => Matrix2::new(1.0 / mass[0], 0.0, 0.0, 0.0),
        [true, false] => Matrix2::new(0.0, 0.0, 0.0, 1.0 / mass[2]),
        [true, true] => Matrix2::zeros(),
    })
}

fn omega_after(omega: &[f64; 2], acceleration: &[f64; 2], h: f64, still: [bool; 2]) -> [f64; 2] {
    [0, 1].map(|i| if still[i] { 0.0 } else { omega[i] + h * acceleration[i] })
}
