//! A fuzzy state emulator as dynamics: acceleration = f̂(w1, w2) + G u.

use std::convert::Infallible;

use wide::f64x2;

use super::{Hold, Input, Rules, SimulateError, Structure, TakagiSugeno, WithRules};
use crate::math::runge_kutta_step;
use crate::robot::State;

/// A rule is trained if its firing strength reaches this value in some sample.
const EXCITED: f64 = 0.2;
/// Longest step of the integrator \[s\].
const LONGEST_STEP: f64 = 0.005;
/// Wheel speed above which the motion has diverged [rad/s].
const LIMIT: f64 = 1e4;

/// The two fuzzy systems that replace f3 and f4 of eq. (18).
///
/// ```text
/// w' = f̂(w) + G u,   f̂ = [f31, f41]      eq. (17), (19) with K = 0
/// ```
/// Without stick-slip: the friction at rest is approximated by the rules.
///
/// Source: the paper, section 3, eq. (17), (19).
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct FuzzyDynamics {
    /// Rules of f31 and f41, the accelerations without input [rad/s²].
    pub system: TakagiSugeno,
    /// G [[G31, G32], [G41, G42]] [1/(kg m²), or per unit of the input].
    pub input_gain: [[f64; 2]; 2],
    /// Rules that the training data excited: strength of at least 0.2 in some sample.
    pub trained: Vec<bool>,
    /// Gain K on the wheel speeds with which the rules were fitted [1/s].
    pub gain: f64,
    /// Structure in which they were fitted.
    pub structure: Structure,
}

impl FuzzyDynamics {
    /// Marks the rules that `speeds` [rad/s] excite as trained.
    #[must_use]
    pub fn new<'a>(
        system: TakagiSugeno,
        input_gain: [[f64; 2]; 2],
        gain: f64,
        structure: Structure,
        speeds: impl IntoIterator<Item = &'a [f64; 2]>,
    ) -> Self {
        let mut trained = vec![false; system.rules()];
        for omega in speeds {
            for (trained, strength) in trained.iter_mut().zip(system.firing(omega)) {
                *trained |= strength >= EXCITED;
            }
        }
        Self { system, input_gain, trained, gain, structure }
    }

    /// The acceleration f̂(w) + G u [rad/s²].
    pub(super) fn rate(&self, omega: &[f64; 2], u: &[f64; 2]) -> [f64; 2] {
        self.driven(self.system.output(omega), u)
    }

    /// The motion by Runge-Kutta 4 in steps of at most 5 ms.
    pub(super) fn simulate(
        &self,
        input: &Input,
        start: State,
    ) -> Result<Vec<State>, SimulateError> {
        self.system.with_rules(Simulation { dynamics: self, input, start })
    }

    fn driven(&self, f: [f64; 2], u: &[f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| f[i] + self.input_gain[i][0] * u[0] + self.input_gain[i][1] * u[1])
    }
}

/// A simulation with the rules laid out for it.
struct Simulation<'a, 'b> {
    dynamics: &'a FuzzyDynamics,
    input: &'a Input<'b>,
    start: State,
}

impl WithRules for Simulation<'_, '_> {
    type Output = Result<Vec<State>, SimulateError>;

    fn run<const N: usize>(self, rules: &Rules<N>) -> Self::Output {
        let Self { dynamics, input, start } = self;
        let mut motion = Vec::with_capacity(input.t.len());
        motion.push(start);
        let mut state = start;
        for k in 1..input.t.len() {
            let (t, dt) = (input.t[k], input.t[k] - input.t[k - 1]);
            let from = input.torque[k - 1];
            let to = if input.hold == Hold::Linear { input.torque[k] } else { from };
            let steps = ((dt / LONGEST_STEP - 1e-6).ceil() as usize).max(1);
            for step in 0..steps {
                let input = |c: f64| {
                    let c = (step as f64 + c) / steps as f64;
                    [0, 1].map(|i| from[i] + c * (to[i] - from[i]))
                };
                state = dynamics.step(rules, &state, dt / steps as f64, input);
            }
            if !state.omega.iter().all(|w| w.abs() < LIMIT) {
                return Err(SimulateError::Diverged { t, limit: LIMIT });
            }
            motion.push(state);
        }
        Ok(motion)
    }
}

impl FuzzyDynamics {
    #[inline]
    fn step<const N: usize>(
        &self,
        rules: &Rules<N>,
        state: &State,
        h: f64,
        input: impl Fn(f64) -> [f64; 2],
    ) -> State {
        let ([a1, a2], [w1, w2]) = (state.alpha, state.omega);
        let rate = |c: f64, x: &[f64; 4]| {
            let f = rules.output(f64x2::new([x[2], x[3]])).to_array();
            let [d1, d2] = self.driven(f, &input(c));
            Ok::<_, Infallible>([x[2], x[3], d1, d2])
        };
        let Ok([a1, a2, w1, w2]) = runge_kutta_step(&[a1, a2, w1, w2], h, rate);
        State { alpha: [a1, a2], omega: [w1, w2] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::{Consequents, Defuzzification};

    #[test]
    fn constant_rules_give_uniform_acceleration() {
        let range = [(0.0, 30.0); 2];
        let mut system = TakagiSugeno::uniform(
            6,
            range,
            Consequents::Constant,
            Defuzzification::WeightedAverage,
        );
        system.set_parameters(&[-4.0; 72]);
        let g = [[30.0, 2.0], [2.0, 30.0]];
        let fuzzy = FuzzyDynamics::new(system, g, 1.0, Structure::Parallel, &[]);
        let t: Vec<f64> = (0..101).map(|k| 0.01 * f64::from(k)).collect();
        let torque = vec![[0.2, 0.1]; 101];
        let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
        let end = fuzzy.simulate(&input, State::default()).unwrap()[100];
        // w = a t, alpha = a t²/2 with a1 = 30 0.2 + 2 0.1 - 4 = 2.2, a2 = 0.4 + 3 - 4 = -0.6
        for (i, a) in [2.2, -0.6].into_iter().enumerate() {
            assert!((end.omega[i] - a).abs() < 1e-12 && (end.alpha[i] - 0.5 * a).abs() < 1e-12);
        }
    }
}
