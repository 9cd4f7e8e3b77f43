//! Static friction above kinetic friction.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Scale, Terms, geometric};
use crate::math::Real;

/// Dry friction that is higher at rest and falls with speed (Stribeck curve).
///
/// ```text
/// level of wheel i:  + (fs ± fsd) exp(-(w_i/ws)^2),   + on wheel 1, - on wheel 2
/// ```
/// Source: Bo and Pavelescu (1982) with exponent 2, as in Armstrong-Hélouvry, Dupont, Canudas de
/// Wit, Automatica 30 (1994), eq. (4). The static level of wheel 1 is a4 + fs + fsd, the
/// kinetic one a4.
///
/// Where the speed is an estimate with variance P the level is the mean of the bell over
/// N(w, P), with q = ws^2:
///
/// ```text
/// sqrt(q/(q + 2 P)) exp(-w^2/(q + 2 P))
/// ```
#[derive(Clone, Debug, Default)]
pub struct Stribeck;

impl Physics for Stribeck {
    fn description(&self) -> Description {
        Description {
            id: "stribeck".into(),
            title: "Stribeck friction".into(),
            equation: "level (fs +- fsd) exp(-(w/ws)^2) on wheel 1, 2".into(),
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
                "half of what wheel 1 has more of fs",
                "N m",
                (-1e3, 1e3),
                0.0,
            ),
        ]
    }

    /// From where friction is far from resolved to where it falls over the whole range of speeds.
    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        geometric(0.03, 0.7, 6).into_iter().map(|share| vec![share * scale.speed]).collect()
    }

    fn several_starts(&self) -> bool {
        true
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        let q = p[1].squared();
        let level = |i: usize| {
            let width = q + 2.0 * x.variance[2 + i];
            let own = if i == 0 { p[0] + p[2] } else { p[0] - p[2] };
            own * (q / width).sqrt() * (-x.omega[i].squared() / width).exp()
        };
        let zero = T::from(0.0);
        Terms { level: [level(0), level(1), zero, zero], ..Terms::zero() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;

    #[test]
    fn the_level_under_uncertainty_is_the_mean_of_the_level_over_the_speed() {
        let robot = Robot::amigobot();
        let (w, variance, p) = (0.4, 0.09_f64, [0.03, 0.6, 0.0]);
        let at = |w: f64, v: f64| {
            let x = Motion {
                t: 0.0,
                alpha: [0.0; 2],
                omega: [w, 0.0],
                variance: [0.0, 0.0, v, 0.0],
                robot: &robot,
            };
            Stribeck.terms(&x, &p).level[0]
        };
        // trapezoidal sum over +-10 standard deviations: converges exponentially for a bell
        let (mut mean, step) = (0.0, 0.01);
        for k in -1000..=1000 {
            let z = step * f64::from(k);
            let density = (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
            mean += step * density * at(w + z * variance.sqrt(), 0.0);
        }
        assert!((at(w, variance) - mean).abs() < 1e-14, "{} {mean}", at(w, variance));
        assert_eq!(at(0.0, 0.0), 0.03);
    }
}
