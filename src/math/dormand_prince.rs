//! An adaptive integrator for smooth differential equations: the reference that tests compare with.

/// The method of Dormand and Prince: order 5 with an error estimate of order 4.
///
/// Source: E. Hairer, S. P. Norsett, G. Wanner, *Solving Ordinary Differential Equations I*,
/// 2nd ed., II.4 to II.6 (DOPRI5, with its continuous extension of order 4).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DormandPrince {
    /// Relative error allowed per step.
    pub(crate) relative: f64,
    /// Absolute error allowed per step, in the unit of the state.
    pub(crate) absolute: f64,
    /// Maximum number of steps, including rejected ones.
    pub(crate) max_steps: usize,
}

/// Why an integration ended early.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stopped {
    /// The right-hand side is not smooth, or the solution grows without bound.
    StepTooSmall { time: f64, step: f64 },
    /// It needed more steps than allowed.
    TooManySteps { time: f64, steps: usize },
}

impl Default for DormandPrince {
    fn default() -> Self {
        Self { relative: 1e-10, absolute: 1e-12, max_steps: 1_000_000 }
    }
}

/// A solution that can be evaluated at every time of its interval.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trajectory<const N: usize> {
    steps: Vec<Step<N>>,
    start: f64,
    end: f64,
    final_state: [f64; N],
}

#[derive(Debug, Clone, PartialEq)]
struct Step<const N: usize> {
    start: f64,
    length: f64,
    /// Coefficients of the continuous extension.
    dense: [[f64; N]; 5],
}

/// Nodes, stages and the two sets of weights of DOPRI5.
const C: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const A: [[f64; 6]; 6] = [
    [0.2, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
const ERROR: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339_200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];
const DENSE: [f64; 7] = [
    -12_715_105_075.0 / 11_282_082_432.0,
    0.0,
    87_487_479_700.0 / 32_700_410_799.0,
    -10_690_763_975.0 / 1_880_347_072.0,
    701_980_252_875.0 / 199_316_789_632.0,
    -1_453_857_185.0 / 822_651_844.0,
    69_997_945.0 / 29_380_423.0,
];

impl DormandPrince {
    /// Solves `x' = f(t, x)` from `x` at `start` to `end` > `start` \[s\].
    ///
    /// # Errors
    /// If the step becomes too small or there are too many; a right-hand side that is not finite
    /// ends in the former.
    pub(crate) fn solve<const N: usize>(
        &self,
        f: impl Fn(f64, &[f64; N]) -> [f64; N],
        start: f64,
        end: f64,
        x: [f64; N],
    ) -> Result<Trajectory<N>, Stopped> {
        let (mut t, mut x, mut slope) = (start, x, f(start, &x));
        let mut h = 1e-3 * (end - start);
        let mut steps = Vec::new();
        for _ in 0..self.max_steps {
            if t >= end {
                return Ok(Trajectory { steps, start, end, final_state: x });
            }
            // lengthen a step that would leave a tiny remainder before the end
            let last = t + 1.01 * h >= end;
            let length = if last { end - t } else { h };
            if t + length <= t || !length.is_finite() {
                return Err(Stopped::StepTooSmall { time: t, step: length });
            }
            let (next, k) = stages(&f, t, &x, slope, length);
            let error = self.error_norm(&x, &next, &k, length);
            if error <= 1.0 {
                steps.push(Step { start: t, length, dense: dense(&x, &next, &k, length) });
                (t, x, slope) = (if last { end } else { t + length }, next, k[6]);
            }
            // f64::clamp keeps NaN; a step with a NaN in it is to shrink
            let growth = 0.9 * error.powf(-0.2);
            h = length * if growth.is_nan() { 0.2 } else { growth.clamp(0.2, 5.0) };
        }
        if t >= end {
            return Ok(Trajectory { steps, start, end, final_state: x });
        }
        Err(Stopped::TooManySteps { time: t, steps: steps.len() })
    }

    fn error_norm<const N: usize>(
        &self,
        x: &[f64; N],
        next: &[f64; N],
        k: &[[f64; N]; 7],
        h: f64,
    ) -> f64 {
        let relative = |i: usize| {
            let error: f64 = (0..7).map(|s| ERROR[s] * k[s][i]).sum();
            let allowed = self.absolute + self.relative * x[i].abs().max(next[i].abs());
            (h * error / allowed).powi(2)
        };
        ((0..N).map(relative).sum::<f64>() / N.max(1) as f64).sqrt()
    }
}

impl<const N: usize> Trajectory<N> {
    /// The state at `t`, to fourth order; outside the interval the state at its nearer end.
    #[must_use]
    pub(crate) fn at(&self, t: f64) -> [f64; N] {
        let after = self.steps.partition_point(|s| s.start <= t).saturating_sub(1);
        match self.steps.get(after) {
            Some(step) if t < self.end => step.at(t.max(self.start)),
            _ => self.final_state,
        }
    }

    /// The state at the end of the interval.
    #[must_use]
    pub(crate) fn final_state(&self) -> [f64; N] {
        self.final_state
    }

    /// First time after the start at which `event(t, x)` changes its sign, by bisection.
    ///
    /// Two sign changes within one step are not detected.
    #[must_use]
    pub(crate) fn first_crossing(&self, event: impl Fn(f64, &[f64; N]) -> f64) -> Option<f64> {
        let value = |t: f64| event(t, &self.at(t));
        for step in &self.steps {
            let (mut low, mut high) = (step.start, (step.start + step.length).min(self.end));
            let before = value(low);
            if before == 0.0 || before * value(high) > 0.0 {
                continue;
            }
            while low < 0.5 * (low + high) && 0.5 * (low + high) < high {
                let middle = 0.5 * (low + high);
                if before * value(middle) > 0.0 { low = middle } else { high = middle }
            }
            return Some(high);
        }
        None
    }
}

impl<const N: usize> Step<N> {
    fn at(&self, t: f64) -> [f64; N] {
        let s = ((t - self.start) / self.length).min(1.0);
        let r = 1.0 - s;
        let d = &self.dense;
        std::array::from_fn(|i| {
            d[0][i] + s * (d[1][i] + r * (d[2][i] + s * (d[3][i] + r * d[4][i])))
        })
    }
}

fn stages<const N: usize>(
    f: &impl Fn(f64, &[f64; N]) -> [f64; N],
    t: f64,
    x: &[f64; N],
    slope: [f64; N],
    h: f64,
) -> ([f64; N], [[f64; N]; 7]) {
    let mut k = [slope; 7];
    let mut next = *x;
    for s in 1..7 {
        next =
            std::array::from_fn(|i| x[i] + h * (0..s).map(|j| A[s - 1][j] * k[j][i]).sum::<f64>());
        k[s] = f(t + C[s] * h, &next);
    }
    (next, k)
}

fn dense<const N: usize>(
    x: &[f64; N],
    next: &[f64; N],
    k: &[[f64; N]; 7],
    h: f64,
) -> [[f64; N]; 5] {
    let rise: [f64; N] = std::array::from_fn(|i| next[i] - x[i]);
    let bend: [f64; N] = std::array::from_fn(|i| h * k[0][i] - rise[i]);
    let twist = std::array::from_fn(|i| rise[i] - h * k[6][i] - bend[i]);
    let fourth = std::array::from_fn(|i| h * (0..7).map(|s| DENSE[s] * k[s][i]).sum::<f64>());
    [*x, rise, bend, twist, fourth]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn van_der_pol(_t: f64, x: &[f64; 2]) -> [f64; 2] {
        [x[1], (1.0 - x[0] * x[0]) * x[1] - x[0]]
    }

    #[test]
    fn van_der_pol_its_inside_and_its_zero_crossing_equal_dop853() {
        let solver = DormandPrince { relative: 1e-12, absolute: 1e-13, max_steps: 100_000 };
        let found = solver.solve(van_der_pol, 0.0, 5.0, [2.0, 0.0]).unwrap();
        // scipy DOP853 at rtol 2.3e-14; errors grow about tenfold along the way
        for (f, e) in found.final_state().iter().zip([-0.8370774502947605, 1.307088937799669]) {
            assert!((f - e).abs() < 1e-10, "{f} {e}");
        }
        // scipy's dense output is itself of order 7; ours of order 4 on short steps
        for (f, e) in found.at(1.7).iter().zip([0.7950349208071162, -1.3460973687882232]) {
            assert!((f - e).abs() < 1e-9, "{f} {e}");
        }
        let crossing = found.first_crossing(|_, x| x[0]).unwrap();
        assert!((crossing - 2.1616949938686765).abs() < 1e-9, "{crossing}");
    }

    #[test]
    fn the_error_of_the_adaptive_method_follows_its_tolerance() {
        let error = |relative: f64| {
            let solver = DormandPrince { relative, absolute: 0.0, max_steps: 100_000 };
            let decay = solver.solve(|_, x: &[f64; 1]| [-x[0]], 0.0, 3.0, [1.0]).unwrap();
            (decay.final_state()[0] / (-3.0_f64).exp() - 1.0).abs()
        };
        assert!(error(1e-6) < 1e-5 && error(1e-12) < 1e-11 && error(1e-12) < 1e-3 * error(1e-6));
    }

    #[test]
    fn a_pole_and_a_right_hand_side_that_is_not_finite_end_with_words() {
        let solver = DormandPrince { max_steps: 20_000, ..DormandPrince::default() };
        let pole = solver.solve(|_, x: &[f64; 1]| [x[0] * x[0]], 0.0, 2.0, [1.0]);
        assert!(pole.is_err());
        let nan = solver.solve(|_, _: &[f64; 1]| [f64::NAN], 0.0, 1.0, [1.0]);
        assert!(matches!(nan, Err(Stopped::StepTooSmall { .. })));
        let nothing = solver.solve(van_der_pol, 1.0, 1.0, [2.0, 0.0]).unwrap();
        assert_eq!((nothing.final_state(), nothing.at(1.0)), ([2.0, 0.0], [2.0, 0.0]));
    }
}
