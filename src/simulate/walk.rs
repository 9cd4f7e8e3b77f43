//! Single steps from given states, with their derivatives, as required by a filter.

use super::SimulateError;
use super::stepper::Stepper;
use super::variation::{Variation, column_of_start};
use crate::model::Model;
use crate::robot::State;

/// A model that is advanced sample by sample from states that are corrected in between.
///
/// The derivatives are those of one sample: with respect to the state at its start, and with respect to the
/// parameters at this state. Models with a two-mass drivetrain have further states and are not supported.
pub(crate) struct Walk<'m> {
    stepper: Stepper<'m>,
    variation: Variation,
    parameters: usize,
}

/// Input over a sample: at its start and at its end, linear in between [N m].
pub(crate) type Ends = [[f64; 2]; 2];

impl<'m> Walk<'m> {
    /// Time-dependent effects are relative to time zero.
    pub(crate) fn new(model: &'m Model, p: &'m [f64]) -> Self {
        let stepper = Stepper::new(model, p, 0.0, State::default());
        let variation = Variation::new(stepper.forces());
        Self { stepper, variation, parameters: p.len() }
    }

    /// The state at `to` \[s\] from the state at `from`; `acting` are the derivatives of the input at both
    /// ends with respect to parameters that act on it.
    ///
    /// # Errors
    /// As [`super::simulate`].
    pub(crate) fn step(
        &mut self,
        state: &State,
        (from, to): (f64, f64),
        ends: &Ends,
        acting: &[(usize, Ends)],
    ) -> Result<State, SimulateError> {
        self.variation.restart(acting);
        self.stepper.place(*state);
        self.stepper.advance(from, to, &ends[0], &ends[1], &mut self.variation)?;
        Ok(self.stepper.state())
    }

    /// Inverse of the mass matrix as (i11, i12, i22), if it is constant.
    pub(crate) fn mobility(&self) -> Option<[f64; 3]> {
        self.stepper.forces().inverse
    }

    /// The fastest rate of torques that depend on the speeds, so far [1/s].
    pub(crate) fn damping_rate(&self) -> f64 {
        self.stepper.damping_rate()
    }

    /// Derivatives of (alpha1, alpha2, omega1, omega2) after the sample with respect to parameter `j`.
    #[inline]
    pub(crate) fn by_parameter(&self, j: usize) -> [f64; 4] {
        self.variation.by(j)
    }

    /// The same with respect to state `k` at the start of the sample.
    #[inline]
    pub(crate) fn by_state(&self, k: usize) -> [f64; 4] {
        self.variation.by(column_of_start(self.parameters, k))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;
    use crate::simulate::{Hold, Input, simulate_with_sensitivities};

    #[test]
    fn samples_chained_give_the_derivatives_of_the_whole_simulation() {
        let model = Model::base(Robot::amigobot()).add("viscous_friction").unwrap();
        let p = model.initial();
        let t: Vec<f64> = (0..60).map(|k| 0.01 * f64::from(k)).collect();
        // through a reversal of one wheel and a stop of the other
        let torque: Vec<[f64; 2]> =
            t.iter().map(|t| [0.3 - 1.5 * t, 0.25 - 0.9 * t.min(0.3)]).collect();
        let start = State { alpha: [0.0; 2], omega: [1.0, 1.5] };
        let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
        let (motion, whole) = simulate_with_sensitivities(&model, &p, &input, start).unwrap();
        assert!(motion.windows(2).any(|w| w[0].omega[0] * w[1].omega[0] < 0.0));
        let mut walk = Walk::new(&model, &p);
        let mut state = start;
        let mut psi = vec![[0.0; 4]; p.len()];
        for k in 1..t.len() {
            let ends = [torque[k - 1], torque[k]];
            state = walk.step(&state, (t[k - 1], t[k]), &ends, &[]).unwrap();
            for (j, column) in psi.iter_mut().enumerate() {
                let old = *column;
                *column = std::array::from_fn(|i| {
                    let carried: f64 = (0..4).map(|n| walk.by_state(n)[i] * old[n]).sum();
                    carried + walk.by_parameter(j)[i]
                });
            }
            for i in 0..2 {
                assert!((state.omega[i] - motion[k].omega[i]).abs() < 1e-9);
                for (j, column) in psi.iter().enumerate() {
                    // the same chain rule, in another order
                    let (a, b) = (column[2 + i], whole.at(k, 2 + i, j));
                    assert!((a - b).abs() < 1e-6 * (1.0 + b.abs()), "{k} {i} {j}: {a} {b}");
                }
            }
        }
    }
}
