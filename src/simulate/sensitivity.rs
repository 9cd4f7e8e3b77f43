//! Simulation with exact sensitivities: how the motion changes with every parameter and with the
//! initial state, in the same pass.

use super::friction::Contact;
use super::stepper::{Drive, Passenger, Stepper, Vector, along_freedom, plus};
use super::{Hold, Input, SimulateError, simulate};
use crate::effects::along;
use crate::model::{Linearisation, Model, solve_mass};
use crate::robot::State;

/// Derivatives of a simulated motion.
#[derive(Clone, Debug)]
pub struct Sensitivities {
    /// Parameters of the model plus the four initial states (alpha1, alpha2, omega1, omega2).
    pub columns: usize,
    /// `[k][i][j]` flattened: state i (alpha1, alpha2, omega1, omega2) at sample k by column j.
    values: Vec<f64>,
}

impl Sensitivities {
    /// Derivative of state `i` (alpha1, alpha2, omega1, omega2) at sample `k` by column `j`.
    #[must_use]
    pub fn at(&self, k: usize, i: usize, j: usize) -> f64 {
        self.values[(k * 4 + i) * self.columns + j]
    }

    /// All columns of state `i` at sample `k`.
    #[must_use]
    pub fn row(&self, k: usize, i: usize) -> &[f64] {
        let start = (k * 4 + i) * self.columns;
        &self.values[start..start + self.columns]
    }
}

/// Simulates as [`simulate`] and returns the exact derivatives of the motion.
///
/// ```text
/// S' = f_x S + f_p           between events (Runge-Kutta 4 on the stages of the state)
/// S+ = S- + (f- - f+) dt/dp  where a speed d·ω reaches zero, dt/dp = -(d·S-)/(d·f-)
/// ```
/// Source: forward sensitivity analysis of hybrid systems (saltation matrix). The jump is what
/// makes the derivative right through reversals and stops.
/// Deviation: models with a body behind the wheels are differentiated by central differences.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_with_sensitivities(
    model: &Model,
    p: &[f64],
    input: &Input,
    start: State,
) -> Result<(Vec<State>, Sensitivities), SimulateError> {
    if model.is_coupled() {
        return by_differences(model, p, input, start);
    }
    let (drive, derivatives) = model.drive_derivatives(input.t, input.moment, p);
    let mut stepper = Stepper::new(model, p, input.t[0], start);
    let mut variation = Variation::new(p.len());
    let mut motion = Vec::with_capacity(input.t.len());
    let columns = p.len() + 4;
    let mut values = Vec::with_capacity(input.t.len() * 4 * columns);
    motion.push(start);
    values.extend_from_slice(&variation.s);
    for k in 1..input.t.len() {
        let last = match input.hold {
            Hold::Linear => k,
            Hold::Constant => k - 1,
        };
        for (j, d) in derivatives.iter().enumerate().filter(|(_, d)| !d.is_empty()) {
            variation.drive[j] = [d[k - 1], d[last]];
        }
        let (from, to) = (input.t[k - 1], input.t[k]);
        stepper.advance(from, to, &drive[k - 1], &drive[last], &mut variation)?;
        motion.push(stepper.state());
        values.extend_from_slice(&variation.s);
    }
    Ok((motion, Sensitivities { columns, values }))
}

/// The sensitivities on their way, with room for the Runge-Kutta stages.
struct Variation {
    parameters: usize,
    columns: usize,
    /// 4 x columns.
    s: Vec<f64>,
    /// Derivative of the drive by each parameter at both ends of the sample.
    drive: Vec<[[f64; 2]; 2]>,
    linear: Linearisation,
    stage: [Vec<f64>; 4],
    trial: Vec<f64>,
}

impl Variation {
    fn new(parameters: usize) -> Self {
        let columns = parameters + 4;
        let mut s = vec![0.0; 4 * columns];
        for i in 0..4 {
            s[i * columns + parameters + i] = 1.0;
        }
        Self {
            parameters,
            columns,
            drive: vec![[[0.0; 2]; 2]; parameters],
            linear: Linearisation::new(parameters),
            stage: std::array::from_fn(|_| vec![0.0; 4 * columns]),
            trial: s.clone(),
            s,
        }
    }

    /// Writes S' at one Runge-Kutta stage, where the state changes by `rate`, from `self.trial`.
    fn rates(
        &mut self,
        s: &Stepper,
        t: f64,
        (y, rate): (&Vector, &Vector),
        drive: &Drive,
        c: &Contact,
        stage: usize,
    ) {
        let a = [rate[2], rate[3]];
        s.model.linearise(&s.motion(t, y), s.p, &a, &c.sign, &mut self.linear);
        let (n, freedom) = (self.columns, c.freedom());
        let out = &mut self.stage[stage];
        let share = drive.share(t);
        for j in 0..n {
            let mut b = [0.0; 2];
            for i in 0..2 {
                for k in 0..4 {
                    b[i] -= self.linear.by_state[i][k] * self.trial[k * n + j];
                }
            }
            if j < self.parameters {
                for i in 0..2 {
                    let [start, end] = [self.drive[j][0][i], self.drive[j][1][i]];
                    b[i] += start + share * (end - start) - self.linear.by_parameter[j][i];
                }
            }
            let da = match freedom {
                None => solve_mass(&self.linear.terms.mass, &b).unwrap_or([0.0; 2]),
                Some(free) => along_freedom(&self.linear.terms.mass, &b, &free),
            };
            out[j] = self.trial[2 * n + j];
            out[n + j] = self.trial[3 * n + j];
            out[2 * n + j] = da[0];
            out[3 * n + j] = da[1];
        }
    }

    fn trial_from(&mut self, h: f64, stage: usize) {
        for (trial, (s, k)) in self.trial.iter_mut().zip(self.s.iter().zip(&self.stage[stage])) {
            *trial = s + h * k;
        }
    }
}

impl Passenger for Variation {
    fn smooth(&mut self, s: &Stepper, t: f64, h: f64, y: &Vector, drive: &Drive, c: &Contact) {
        let half = 0.5 * h;
        let rate = |t: f64, y: &Vector| s.stage_rates(t, y, drive, c);
        let k1 = rate(t, y);
        let y2 = plus(y, half, &k1);
        let k2 = rate(t + half, &y2);
        let y3 = plus(y, half, &k2);
        let k3 = rate(t + half, &y3);
        let y4 = plus(y, h, &k3);
        let k4 = rate(t + h, &y4);
        self.trial.copy_from_slice(&self.s);
        self.rates(s, t, (y, &k1), drive, c, 0);
        self.trial_from(half, 0);
        self.rates(s, t + half, (&y2, &k2), drive, c, 1);
        self.trial_from(half, 1);
        self.rates(s, t + half, (&y3, &k3), drive, c, 2);
        self.trial_from(h, 2);
        self.rates(s, t + h, (&y4, &k4), drive, c, 3);
        for (k, value) in self.s.iter_mut().enumerate() {
            let [k1, k2, k3, k4] = [0, 1, 2, 3].map(|stage| self.stage[stage][k]);
            *value += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        }
    }

    fn event(&mut self, j: usize, before: &[f64; 2], after: &Contact) {
        let n = self.columns;
        let rate = along(j, before);
        let freedom = after.freedom();
        for column in 0..n {
            let mut speed = [self.s[2 * n + column], self.s[3 * n + column]];
            let time = if rate == 0.0 { 0.0 } else { -along(j, &speed) / rate };
            for i in 0..2 {
                speed[i] += (before[i] - after.acceleration[i]) * time;
            }
            // where both wheels arrive together one jump does not account for the other
            if let Some(free) = freedom {
                speed = along_freedom(&[1.0, 0.0, 1.0], &speed, &free);
            }
            (self.s[2 * n + column], self.s[3 * n + column]) = (speed[0], speed[1]);
        }
    }
}

/// Central differences, for models whose internal states have no variational equation here.
fn by_differences(
    model: &Model,
    p: &[f64],
    input: &Input,
    start: State,
) -> Result<(Vec<State>, Sensitivities), SimulateError> {
    let motion = simulate(model, p, input, start)?;
    let columns = p.len() + 4;
    let mut values = vec![0.0; motion.len() * 4 * columns];
    for j in 0..columns {
        let at = |sign: f64| {
            let (mut p, mut start) = (p.to_vec(), start);
            let x = match j.checked_sub(p.len()) {
                None => &mut p[j],
                Some(i @ 0..2) => &mut start.alpha[i],
                Some(i) => &mut start.omega[i - 2],
            };
            let h = 1e-5 * x.abs().max(1e-4);
            *x += sign * h;
            simulate(model, &p, input, start).map(|motion| (motion, h))
        };
        let ((up, h), (down, _)) = (at(1.0)?, at(-1.0)?);
        for (k, (u, d)) in up.iter().zip(&down).enumerate() {
            for i in 0..2 {
                values[(k * 4 + i) * columns + j] = (u.alpha[i] - d.alpha[i]) / (2.0 * h);
                values[(k * 4 + 2 + i) * columns + j] = (u.omega[i] - d.omega[i]) / (2.0 * h);
            }
        }
    }
    Ok((motion, Sensitivities { columns, values }))
}
