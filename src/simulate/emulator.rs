//! The state emulator of eq. (19), in parallel and serial-parallel structure.

use super::dynamics::Dynamics;
use super::{Hold, SimulateError, Structure};
use crate::math::runge_kutta_step;
use crate::recording::Recording;
use crate::robot::State;

/// The gain matrix K of eq. (19), rows and columns in the order alpha1, alpha2, omega1, omega2.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Gain(pub [[f64; 4]; 4]);

/// Why a gain matrix is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GainError {
    /// A - K has a pole with a real part that is not negative.
    #[error(
        "A - K is not strictly stable: a pole has real part {real:.4} 1/s; eq. (20) needs all below zero (K = 0 alone is allowed, as pure simulation)"
    )]
    Unstable {
        /// Largest real part [1/s].
        real: f64,
    },
    /// An entry that is not finite, or too large for a step of 5 ms.
    #[error("an entry of K is {entry:e}; expected sizes up to {most:e}")]
    TooLarge {
        /// Found.
        entry: f64,
        /// Largest size.
        most: f64,
    },
}

impl Gain {
    /// K = 0: pure simulation.
    pub const ZERO: Self = Self([[0.0; 4]; 4]);

    /// The same gain `k` [1/s] on the two wheel speeds, none on the angles: the speed errors decay
    /// as e^(-k t), and the angles follow by integration.
    #[must_use]
    pub fn speed(k: f64) -> Self {
        let mut gain = Self::ZERO;
        gain.0[2][2] = k;
        gain.0[3][3] = k;
        gain
    }

    /// The gain for which the two error poles of each wheel (angle, speed) are `poles` [1/s] (negative):
    /// `[[-(s1+s2), 0], [s1 s2, 0]]` on the angle error of each wheel.
    #[must_use]
    pub fn from_poles(s1: f64, s2: f64) -> Self {
        let mut gain = Self::ZERO;
        for i in 0..2 {
            gain.0[i][i] = -(s1 + s2);
            gain.0[2 + i][i] = s1 * s2;
        }
        gain
    }

    /// The poles of A_H = A - K, eq. (20), as (real, imaginary) [1/s].
    #[must_use]
    pub fn poles(&self) -> Vec<(f64, f64)> {
        let mut a = nalgebra::Matrix4::<f64>::zeros();
        a[(0, 2)] = 1.0;
        a[(1, 3)] = 1.0;
        let k = nalgebra::Matrix4::from_fn(|i, j| self.0[i][j]);
        let poles = (a - k).complex_eigenvalues();
        poles.iter().map(|z| (z.re, z.im)).collect()
    }

    /// Checks that A - K is strictly stable; zero poles of angles without gain are accepted, because their
    /// error is the integral of a decaying one.
    ///
    /// # Errors
    /// [`GainError::Unstable`].
    pub fn check(&self) -> Result<(), GainError> {
        if *self == Self::ZERO {
            return Ok(());
        }
        if let Some(entry) = self.0.iter().flatten().find(|k| !(k.abs() <= MOST_GAIN)) {
            return Err(GainError::TooLarge { entry: *entry, most: MOST_GAIN });
        }
        let poles = self.poles();
        let untouched = (0..2).filter(|&i| self.0.iter().all(|row| row[i] == 0.0)).count();
        let mut zeros = poles.iter().filter(|p| p.0.abs() < 1e-9 && p.1.abs() < 1e-9).count();
        zeros = zeros.min(untouched);
        let mut real: Vec<f64> = poles.iter().map(|p| p.0).collect();
        real.sort_by(f64::total_cmp);
        let worst = real[3 - zeros];
        if worst < 0.0 { Ok(()) } else { Err(GainError::Unstable { real: worst }) }
    }
}

/// Largest absolute value of the entries of K.
const MOST_GAIN: f64 = 1e9;

/// Runs the emulator over a recording: one state per sample, from the first measured one.
///
/// ```text
/// xhat' = A xhat + B [fhat + G u] + K (x - xhat)      eq. (19)
/// ```
/// fhat + G u is `dynamics.acceleration` at xhat (parallel) or at the measured x
/// (serial-parallel). x and u are interpolated linearly between samples; Runge-Kutta 4 with steps of at most
/// 5 ms; the state is reset after a gap in time.
///
/// # Errors
/// The motion diverges.
pub fn emulate(
    dynamics: &dyn Dynamics,
    recording: &Recording,
    gain: &Gain,
    structure: Structure,
    hold: Hold,
) -> Result<Vec<State>, SimulateError> {
    let (t, input) = (recording.t(), dynamics.input(recording.t(), recording.torque()));
    let measured = |k: usize| {
        let (a, w) = (recording.alpha()[k], recording.omega()[k]);
        [a[0], a[1], w[0], w[1]]
    };
    let mut out = Vec::with_capacity(t.len());
    for piece in recording.pieces() {
        let mut x = measured(piece.start);
        out.push(state(&x));
        for k in piece.start + 1..piece.end {
            let (m, n) = (measured(k - 1), measured(k));
            let end = if hold == Hold::Linear { input[k] } else { input[k - 1] };
            let steps = (((t[k] - t[k - 1]) / 0.005).ceil() as usize).clamp(1, 1000);
            let h = (t[k] - t[k - 1]) / steps as f64;
            let rate = |c: f64, x: &[f64; 4]| -> Result<[f64; 4], SimulateError> {
                let time = t[k - 1] + c * (t[k] - t[k - 1]);
                let y: [f64; 4] = std::array::from_fn(|i| m[i] + c * (n[i] - m[i]));
                let u = [0, 1].map(|i| input[k - 1][i] + c * (end[i] - input[k - 1][i]));
                let at = if structure == Structure::Parallel { x } else { &y };
                let a = dynamics.acceleration(time - t[0], &state(at), &u)?;
                let mut rate = [x[2], x[3], a[0], a[1]];
                for (row, gain) in rate.iter_mut().zip(&gain.0) {
                    *row += (0..4).map(|i| gain[i] * (y[i] - x[i])).sum::<f64>();
                }
                Ok(rate)
            };
            for step in 0..steps {
                let share = |c: f64| (step as f64 + c) / steps as f64;
                x = runge_kutta_step(&x, h, |c, x| rate(share(c), x))?;
            }
            if !x.iter().all(|v| v.abs() < 1e9) {
                return Err(SimulateError::Diverged { t: t[k], limit: 1e9 });
            }
            out.push(state(&x));
        }
    }
    Ok(out)
}

fn state(x: &[f64; 4]) -> State {
    State { alpha: [x[0], x[1]], omega: [x[2], x[3]] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poles_are_where_they_were_put() {
        let mut poles = Gain::from_poles(-2.0, -5.0).poles();
        poles.sort_by(|a, b| a.0.total_cmp(&b.0));
        // double poles of the two wheels split by rounding: sqrt(eps) at worst
        for (pole, expected) in poles.iter().zip([-5.0, -5.0, -2.0, -2.0]) {
            assert!((pole.0 - expected).abs() < 1e-6 && pole.1.abs() < 1e-6, "{poles:?}");
        }
    }

    #[test]
    fn a_gain_that_drives_the_error_away_is_refused() {
        assert!(Gain::speed(2.0).check().is_ok());
        assert!(Gain::from_poles(-1.0, -2.0).check().is_ok());
        assert!(matches!(Gain::speed(-1.0).check(), Err(GainError::Unstable { .. })));
    }
}
