//! The prediction over a step: linearly implicit, with statistically linearised friction, for a rigid robot and for one
//! with a body behind its wheels.

use nalgebra::{Matrix2, SMatrix};

use super::ProcessNoise;
use super::correction::{Covariance, Mean, freeze};
use super::dynamics::Dynamics;
use super::friction::{Friction, in_directions, torque_noise};
use super::sample::{Predicted, Sample};
use crate::model::ModelError;

/// What dry friction brakes: its levels [N m], and the inverse mass (m11, m12, m22) of the wheels.
pub(super) struct Braked {
    pub(super) level: [f64; 4],
    pub(super) mobility: [f64; 3],
}

/// A robot that a [`Step`] moves: torques and masses at the start of a part of the step, and the linearly implicit
/// solution over that part.
pub(super) trait Body<const N: usize> {
    /// Fills the states beyond the first six at the start of a piece; `input` acts there [N m].
    fn start(&mut self, _input: &[f64; 2], _: &mut Mean<N>, _: &mut Covariance<N>) {}

    /// Evaluates torques and masses at the state.
    fn evaluate(
        &mut self,
        sample: &Sample,
        at: &Predicted,
        mean: &Mean<N>,
    ) -> Result<Braked, ModelError>;

    /// Begins a step of `h` \[s\] at the state that was evaluated; returns into how many equal parts it is cut.
    fn begin(&mut self, _h: f64) -> usize {
        1
    }

    /// Solves over a part of length `h` \[s\] over which the slow torques decay by `decay`: the mean acceleration of
    /// the wheels [rad/s^2].
    fn solve(
        &mut self,
        friction: &Friction,
        sample: &Sample,
        mean: &Mean<N>,
        h: f64,
        decay: f64,
    ) -> Result<[f64; 2], ModelError>;

    /// Computes the derivatives of the part by the parameters.
    fn differentiate(&mut self, friction: &Friction, acceleration: &[f64; 2], mean: &Mean<N>);

    /// Moves mean and covariance over the part that was solved, without noise.
    fn advance(
        &mut self,
        sample: &Sample,
        acceleration: &[f64; 2],
        mean: &mut Mean<N>,
        covariance: &mut Covariance<N>,
    );

    /// Adds a variance of the torque on the wheels that lasts over the step [N^2 m^2].
    fn add_noise(&self, torque: &Matrix2<f64>, covariance: &mut Covariance<N>);

    /// Transition matrix of the step.
    fn transition(&self) -> Covariance<N>;

    /// Effect of a torque on the wheels that lasts over the step.
    fn gain(&self) -> SMatrix<f64, N, 2>;

    /// A column of derivatives after the step under a further torque on the wheels [N m]; of parameter `j`, if it is
    /// that of one.
    fn carried(&self, column: &[f64; N], j: Option<usize>, torque: [f64; 2]) -> [f64; N];

    /// Number of parameters.
    fn parameters(&self) -> usize;

    /// `∂(mass matrix)/∂θ` of the parameters that have one; none where it is not computed.
    fn mass_slopes(&mut self, _: &Predicted) -> Vec<(usize, Matrix2<f64>)> {
        vec![]
    }
}

/// Decay of the slow torques over a step.
#[derive(Clone, Copy, Debug)]
struct Decay {
    /// The step over the time constant, as it was last, and its exponential.
    known: (f64, f64),
}

/// Steps over the time constant that differ by less have decays in proportion to 1 - difference, to rounding.
const ALIKE: f64 = 1e-8;

impl Decay {
    /// The remaining part of a slow torque after `h` \[s\]. Steps of even sampling differ by rounding.
    #[inline]
    fn over(&mut self, h: f64, noise: &ProcessNoise) -> f64 {
        if noise.sigma_d <= 0.0 {
            return 0.0;
        }
        let exponent = h / noise.tau_d;
        let more = exponent - self.known.0;
        if more.abs() < ALIKE {
            return self.known.1 * (1.0 - more);
        }
        self.known = (exponent, (-exponent).exp());
        self.known.1
    }
}

/// The prediction of a robot.
///
/// Every sgn is replaced by its mean over the filter's own spread, erf(v / sqrt(2 V)), and the
/// variance about that mean becomes process noise; if a wheel may pass through rest within the
/// step, the square of the friction level is added to the process noise, which reduces the weight
/// of the step. The step is implicit in the friction (its slope is stiff) and of second order
/// elsewhere.
pub(super) struct Step<B> {
    body: B,
    noise: ProcessNoise,
    decay: Decay,
}

impl<B> Step<B> {
    pub(super) fn new(body: B, noise: ProcessNoise) -> Self {
        Self { body, noise, decay: Decay { known: (0.0, 1.0) } }
    }
}

impl<B: Body<N>, const N: usize> Dynamics<N> for Step<B> {
    fn start(&mut self, input: &[f64; 2], mean: &mut Mean<N>, covariance: &mut Covariance<N>) {
        for i in 4..N.min(6) {
            covariance[(i, i)] = self.noise.sigma_d.powi(2);
        }
        self.body.start(input, mean, covariance);
    }

    #[inline]
    fn predict(
        &mut self,
        sample: &Sample,
        mean: &mut Mean<N>,
        covariance: &mut Covariance<N>,
        derivatives: bool,
    ) -> Result<Predicted, ModelError> {
        let mut at = start_of(sample, mean, covariance);
        let mut braked = self.body.evaluate(sample, &at, mean)?;
        let parts = self.body.begin(sample.step);
        let h = sample.step / parts as f64;
        let (mut decay, mut reversals) = (1.0, [0.0_f64; 4]);
        for part in 0..parts {
            if part > 0 {
                let middle = |i: usize| mean[i] + 0.5 * h * mean[2 + i];
                let alpha = [0, 1].map(middle);
                let here = Predicted { alpha, ..start_of(sample, mean, covariance) };
                braked = self.body.evaluate(sample, &here, mean)?;
            }
            let (omega, variances) = ([mean[2], mean[3]], speed_variances(covariance));
            let Braked { level, mobility } = &braked;
            let open = sample.speed_variance;
            let friction = Friction::over(h, level, &omega, &variances, *mobility, open);
            let left = self.decay.over(h, &self.noise);
            let acceleration = self.body.solve(&friction, sample, mean, h, left)?;
            if derivatives {
                self.body.differentiate(&friction, &acceleration, mean);
            }
            let rest = friction.with_reversals(&omega, &acceleration, &variances, h);
            self.body.advance(sample, &acceleration, mean, covariance);
            decay *= left;
            for j in 0..4 {
                reversals[j] = reversals[j].max(rest[j]);
            }
            for i in 0..2 {
                at.acceleration[i] += acceleration[i] / parts as f64;
            }
            if part == 0 {
                at.sign = friction.sign;
            }
        }
        tilt_angles(sample, &self.body.gain(), mean);
        let torque = torque_noise(self.noise.sigma_m, &sample.change, &reversals);
        self.body.add_noise(&torque, covariance);
        finish(&self.noise, decay, sample.still, mean, covariance);
        Ok(at)
    }

    fn transition(&self) -> Covariance<N> {
        self.body.transition()
    }

    fn gain(&self) -> SMatrix<f64, N, 2> {
        self.body.gain()
    }

    #[inline]
    fn carry(&self, sample: &Sample, extra: &[[f64; 2]], psi: &mut [[f64; N]]) {
        let parameters = self.body.parameters();
        for (j, column) in psi.iter_mut().enumerate() {
            let (parameter, torque) = match j.checked_sub(parameters) {
                None => (Some(j), sample.by_parameter.get(j).copied().unwrap_or([0.0; 2])),
                Some(c) => (None, extra[c]),
            };
            let old = *column;
            *column = self.body.carried(&old, parameter, torque);
            for i in 0..2 {
                if sample.still[i] {
                    (column[i], column[2 + i]) = (old[i], 0.0);
                }
            }
        }
    }

    fn mass_slopes(&mut self, predicted: &Predicted) -> Vec<(usize, Matrix2<f64>)> {
        self.body.mass_slopes(predicted)
    }
}

/// Whether slow torques are among `N` states.
#[inline]
pub(super) const fn has_slow<const N: usize>() -> bool {
    N > 4
}

/// The state at the start of a step, its angles in the middle.
#[inline]
fn start_of<const N: usize>(
    sample: &Sample,
    mean: &Mean<N>,
    covariance: &Covariance<N>,
) -> Predicted {
    let omega = [mean[2], mean[3]];
    let [.., turning, forward] = speed_variances(covariance);
    Predicted {
        acceleration: [0.0; 2],
        sign: [0.0; 4],
        alpha: [0, 1].map(|i| mean[i] + 0.5 * sample.step * omega[i]),
        omega,
        variance: [0, 1, 2, 3].map(|i| covariance[(i, i)]),
        spread: [turning, forward],
    }
}

/// Variances of the wheels' speeds along the directions [rad^2/s^2].
#[inline]
fn speed_variances<const N: usize>(covariance: &Covariance<N>) -> [f64; 4] {
    in_directions([covariance[(2, 2)], covariance[(2, 3)], covariance[(3, 3)]])
}

/// Corrects the angles after a step with the mean input for the first moment of the input; `gain` is the effect of a
/// torque on the wheels.
#[inline]
fn tilt_angles<const N: usize>(sample: &Sample, gain: &SMatrix<f64, N, 2>, mean: &mut Mean<N>) {
    for i in (0..2).filter(|&i| !sample.still[i]) {
        // the gain of the angle is h²/2 times the inverse inertia
        mean[i] -= 2.0 * (gain[(i, 0)] * sample.tilt[0] + gain[(i, 1)] * sample.tilt[1]);
    }
}

/// Completes a step over which the slow torques decay by `decay`: adds their process noise and keeps wheels at rest.
#[inline]
fn finish<const N: usize>(
    noise: &ProcessNoise,
    decay: f64,
    still: [bool; 2],
    mean: &mut Mean<N>,
    covariance: &mut Covariance<N>,
) {
    let slow = noise.sigma_d.powi(2) * (1.0 - decay.powi(2));
    for i in 0..2 {
        if has_slow::<N>() {
            covariance[(4 + i, 4 + i)] += slow;
        }
        if still[i] {
            freeze(covariance, mean, i);
        }
    }
}
