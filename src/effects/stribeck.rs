//! Stribeck effect: static friction above kinetic friction.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use super::{Description, Energy, Motion, ParameterSpec, Physics, Scale, Terms, geometric};
use crate::math::Real;
use crate::robot::Robot;

/// Exponents of the Stribeck curve.
const EXPONENTS: [f64; 2] = [1.0, 2.0];
/// Ratio of the standard deviation of the speed to the Stribeck speed above which the curve is a narrow peak
/// within the distribution: the approximation of the mean is then accurate to 3/WIDE^4, whereas the exact
/// form below loses exp(WIDE^2/2) units in the last place.
const WIDE: f64 = 6.0;

/// The mean of exp(-(w/ws)^2) over N(w, variance).
fn mean_of_bell<T: Real>(w: T, variance: f64, ws: T) -> T {
    if variance == 0.0 {
        return (-(w / ws).squared()).exp();
    }
    let q = ws.squared();
    let width = q + 2.0 * variance;
    (q / width).sqrt() * (-w.squared() / width).exp()
}

/// The mean of exp(-|w|/ws) over N(w, variance).
fn mean_of_exponential<T: Real>(w: T, variance: f64, ws: T) -> T {
    if variance == 0.0 {
        return (-w.abs() / ws).exp();
    }
    let s = variance.sqrt();
    if s > WIDE * ws.value() {
        // ∫ exp(-|x|/ws) (N + x^2 N''/2) dx, N the density and its second derivative at -w
        let density = (w.squared() * (-0.5 / variance)).exp() * (1.0 / (s * TAU.sqrt()));
        let bend = (w.squared() * (1.0 / variance) - 1.0) * ws.squared() * (1.0 / variance);
        return ws * 2.0 * density * (bend + 1.0);
    }
    let share = T::from(variance) / ws;
    let below = |z: T| ((z * (FRAC_1_SQRT_2 / s)).erf() + 1.0) * 0.5;
    let rise = (share / ws * 0.5).exp();
    let right = (-w / ws).exp() * below(w - share);
    rise * (right + (w / ws).exp() * below(-w - share))
}

/// Dry friction that is higher at rest and decreases with speed (Stribeck curve).
///
/// ```text
/// level of wheel i:  + (fs ± fsd) exp(-(|w_i|/ws)^fse),   + on wheel 1, - on wheel 2
/// ```
/// Source: Bo and Pavelescu (1982), as in Armstrong-Hélouvry, Dupont, Canudas de Wit, Automatica 30
/// (1994), eq. (4), with the exponents in use: fse = 1 (Tustin 1947) and fse = 2 (Gaussian). The static
/// level of wheel 1 is a4 + fs + fsd, the kinetic level a4.
///
/// For an estimated speed with variance P = s^2 the level is the mean over N(w, P), with
/// q = ws^2 and Φ the normal distribution:
///
/// ```text
/// fse = 2   sqrt(q/(q + 2 P)) exp(-w^2/(q + 2 P))
/// fse = 1   exp(P/(2 q)) (exp(-w/ws) Φ((w - P/ws)/s) + exp(w/ws) Φ(-(w + P/ws)/s))
/// ```
#[derive(Clone, Debug, Default)]
pub struct Stribeck;

impl Physics for Stribeck {
    fn description(&self) -> Description {
        Description {
            id: "stribeck".into(),
            title: "Stribeck friction".into(),
            equation: "level (fs +- fsd) exp(-(abs(w)/ws)^fse) on wheel 1, 2, fse 1 or 2".into(),
            cause: "boundary lubrication: contact breaks up as the lubricant film builds".into(),
            signature: "more friction near standstill than at speed; jerky starts".into(),
            excitation: "slow driving, many starts and reversals".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let (level, width) = ((0.0, 1e3), (1e-3, 1e3));
        vec![
            ParameterSpec::linear("fs", "static minus kinetic friction", "N m", level, 0.03),
            ParameterSpec::shape("ws", "Stribeck speed", "rad/s", width, 0.6),
            ParameterSpec::linear(
                "fsd",
                "half the difference of fs between wheels 1 and 2",
                "N m",
                (-1e3, 1e3),
                0.0,
            ),
            ParameterSpec::whole("fse", "exponent of the fall, 1 or 2", (0.75, 2.25), 2.0),
        ]
    }

    /// From a Stribeck speed far below the resolution to one that covers the whole range of speeds.
    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let speeds = geometric(0.03, 0.7, 6).into_iter().map(|share| share * scale.speed);
        speeds.flat_map(|speed| EXPONENTS.map(|exponent| vec![speed, exponent])).collect()
    }

    /// The Stribeck speed is limited to the range of speeds: a slower decrease is another dependence of the
    /// friction on speed.
    fn limits(&self, scale: &Scale) -> Vec<(f64, f64)> {
        let mut limits: Vec<(f64, f64)> = self.parameters().iter().map(|s| s.range).collect();
        limits[1].1 = scale.speed;
        limits
    }

    /// Static friction is above kinetic friction on both wheels.
    fn is_itself(&self, p: &[f64], _errors: &[f64], _robot: &Robot) -> bool {
        p[2].abs() <= p[0]
    }

    fn several_starts(&self) -> bool {
        true
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        let bell = p[3].round() - 1.0;
        let level = |i: usize| {
            let (w, variance) = (x.omega[i], x.variance[2 + i]);
            let fall = bell.choose(
                || mean_of_bell(w, variance, p[1]),
                || mean_of_exponential(w, variance, p[1]),
            );
            let own = if i == 0 { p[0] + p[2] } else { p[0] - p[2] };
            own * fall
        };
        let zero = T::from(0.0);
        Terms { level: [level(0), level(1), zero, zero], ..Terms::zero() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The level of wheel 1 with an exponent, at a speed with a variance.
    fn level(exponent: f64, w: f64, variance: f64) -> f64 {
        let robot = Robot::amigobot();
        let x = Motion {
            t: 0.0,
            alpha: [0.0; 2],
            omega: [w, 0.0],
            variance: [0.0, 0.0, variance, 0.0],
            robot: &robot,
        };
        Stribeck.terms(&x, &[0.03, 0.6, 0.0, exponent]).level[0]
    }

    #[test]
    fn the_level_under_uncertainty_is_the_mean_of_the_level_over_the_speed() {
        // trapezoidal sum over +-10 standard deviations: converges exponentially for a bell, and with the
        // square of the step where there is a kink
        for (exponent, tolerance) in [(2.0, 1e-14), (1.0, 1e-8)] {
            for (w, variance) in [(0.4, 0.09_f64), (-2.0, 0.01), (0.1, 4.0)] {
                let (mut mean, step) = (0.0, 1e-3);
                for k in -10_000..=10_000 {
                    let z = step * f64::from(k);
                    let density = (-0.5 * z * z).exp() / TAU.sqrt();
                    mean += step * density * level(exponent, w + z * variance.sqrt(), 0.0);
                }
                let found = level(exponent, w, variance);
                assert!((found - mean).abs() < tolerance, "{exponent} {w}: {found} {mean}");
            }
            assert_eq!(level(exponent, 0.0, 0.0), 0.03);
        }
    }

    #[test]
    fn the_mean_over_a_wide_speed_joins_the_one_beside_it() {
        let at = |ratio: f64| level(1.0, 0.3, (ratio * 0.6_f64).powi(2));
        // both sides of WIDE, where the peak is right to 3/WIDE^4
        let (below, above) = (at(WIDE * 0.9999), at(WIDE * 1.0001));
        assert!((below / above - 1.0).abs() < 3.0 / WIDE.powi(4) + 2e-4, "{below} {above}");
    }
}
