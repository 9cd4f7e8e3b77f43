//! How well recordings determine gains.

use nalgebra::{DMatrix, DVector};

use super::gains::{Feedforward, Gains, Operation};
use crate::math::distribution::NORMAL_95;
use crate::model::Model;
use crate::recording::DriveUnit;

/// Standard errors of the gains of driving straight and of turning; infinite where a gain depends on a parameter that
/// is not identifiable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainErrors {
    /// Of driving straight, per m/s.
    pub linear: Feedforward,
    /// Of turning on the spot, per rad/s of the robot.
    pub angular: Feedforward,
}

/// Step of the differences in standard errors, or in parts of the value where there is no finite one.
const STEP: f64 = 1e-3;

impl GainErrors {
    /// Standard errors of the gains of a model with parameter values `p`, by the delta method.
    ///
    /// ```text
    /// s_g² = sum_ij dg/dp_i C_ij dg/dp_j,   C: covariance of the parameters
    /// ```
    #[must_use]
    pub fn of(model: &Model, p: &[f64], covariance: &DMatrix<f64>, operation: &Operation) -> Self {
        let six = |p: &[f64]| -> [f64; 6] {
            let Gains { linear: l, angular: a, .. } = Gains::of(model, p, operation);
            [l.ks, l.kv, l.ka, a.ks, a.kv, a.ka]
        };
        let free: Vec<usize> = (0..p.len()).filter(|&j| covariance[(j, j)] != 0.0).collect();
        let slopes: Vec<[f64; 6]> = free
            .iter()
            .map(|&j| {
                let error = covariance[(j, j)].sqrt();
                let step = STEP * if error.is_finite() { error } else { p[j].abs().max(1e-6) };
                let moved = |by: f64| {
                    let mut p = p.to_vec();
                    p[j] += by;
                    six(&p)
                };
                let (up, down) = (moved(step), moved(-step));
                std::array::from_fn(|g| (up[g] - down[g]) / (2.0 * step))
            })
            .collect();
        let [ls, lv, la, as_, av, aa] = std::array::from_fn(|g| {
            let largest = slopes.iter().map(|s| s[g].abs()).fold(0.0, f64::max);
            // what rounding makes of a gain that does not depend on a parameter is no dependence
            let depends = |k: &usize| slopes[*k][g].abs() > 1e-9 * largest;
            let on: Vec<usize> = (0..free.len()).filter(depends).collect();
            if on.iter().any(|&k| !covariance[(free[k], free[k])].is_finite()) {
                return f64::INFINITY;
            }
            let slope = DVector::from_iterator(on.len(), on.iter().map(|&k| slopes[k][g]));
            let of = |i: usize, j: usize| covariance[(free[on[i]], free[on[j]])];
            let among = DMatrix::from_fn(on.len(), on.len(), of);
            (slope.transpose() * among * slope)[(0, 0)].max(0.0).sqrt()
        });
        Self {
            linear: Feedforward { ks: ls, kv: lv, ka: la },
            angular: Feedforward { ks: as_, kv: av, ka: aa },
        }
    }

    /// Whether the recordings show the inertia of driving straight, and that of turning: its 95 % interval excludes
    /// zero.
    #[must_use]
    pub fn shows_inertia(&self, gains: &Gains) -> [bool; 2] {
        let shows = |value: f64, error: f64| value > NORMAL_95 * error;
        [shows(gains.linear.ka, self.linear.ka), shows(gains.angular.ka, self.angular.ka)]
    }

    /// What of the gains the recordings do not determine, in sentences.
    #[must_use]
    pub fn not_identified(&self, gains: &Gains, unit: DriveUnit) -> Vec<String> {
        let unit = unit.symbol();
        let all = [
            ("linear", "driving straight", gains.linear.ka, self.linear.ka, "s^2/m"),
            ("angular", "turning on the spot", gains.angular.ka, self.angular.ka, "s^2/rad"),
        ];
        let not = all.into_iter().zip(self.shows_inertia(gains)).filter(|(_, shown)| !shown);
        not.map(|((key, motion, value, error, per), _)| {
            let error = match error < value {
                true => format!("standard error {error:.1e}"),
                false => "a parameter in it is not identifiable".to_owned(),
            };
            format!(
                "{key} kA = {value:.2e} {unit} {per} is not identified by these recordings ({error}), nor are the {key} \
                 controller gains; record hard starts of {motion}"
            )
        })
        .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;

    const OPERATION: Operation =
        Operation { top_speed: 12.0, largest_input: 1.0, time: 0.0, period: 0.02 };

    /// A model with viscous friction whose inertias have these errors and correlation.
    fn gains(errors: [f64; 2], correlation: f64) -> (Gains, GainErrors) {
        let model = Model::with_effects(Robot::amigobot(), &["viscous_friction"]).unwrap();
        let p = model.initial();
        let mut covariance = DMatrix::zeros(p.len(), p.len());
        let [one, two] = ["a1", "a2"].map(|s| model.index_of(s).unwrap());
        (covariance[(one, one)], covariance[(two, two)]) = (errors[0].powi(2), errors[1].powi(2));
        let both = errors[0] * errors[1] * correlation;
        (covariance[(one, two)], covariance[(two, one)]) = (both, both);
        let friction = model.index_of("b").unwrap();
        covariance[(friction, friction)] = 1e-6;
        let of = Gains::of(&model, &p, &OPERATION);
        (of, GainErrors::of(&model, &p, &covariance, &OPERATION))
    }

    #[test]
    fn errors_are_those_of_sum_and_difference_of_the_inertias() {
        let (s, rho, r, l1) = (4e-4_f64, -0.9_f64, 0.05, 0.12);
        let (_, errors) = gains([s, s], rho);
        let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
        near(errors.linear.ka, (2.0 * s * s * (1.0 + rho)).sqrt() / r);
        near(errors.angular.ka, (2.0 * s * s * (1.0 - rho)).sqrt() * l1 / r);
        near(errors.linear.kv, 1e-3 / r);
        assert!(errors.linear.ks < 1e-12);
    }

    #[test]
    fn inertias_that_straight_runs_do_not_separate_leave_turning_open() {
        // only their sum is known
        let (of, errors) = gains([0.05, 0.05], -0.999_999);
        assert_eq!(errors.shows_inertia(&of), [true, false]);
        let said = errors.not_identified(&of, DriveUnit::Volt);
        assert!(said.len() == 1 && said[0].starts_with("angular kA = "), "{said:?}");
        let (of, errors) = gains([f64::INFINITY, 1e-5], 0.0);
        assert_eq!(errors.shows_inertia(&of), [false, false]);
    }
}
