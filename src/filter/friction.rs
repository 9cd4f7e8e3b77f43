//! Dry friction over a step of the filter, and the noise that a step adds: the same for the rigid robot and for one
//! with a body behind its wheels.

use nalgebra::Matrix2;

use super::correction::STILL;
use crate::effects::along;
use crate::math::Real;

/// exp(-x) underflows to zero for x above this value.
const UNDERFLOW: f64 = 746.0;

/// The first of the [`DIRECTIONS`] are those of the wheels.
const WHEELS: usize = 2;
/// Standard deviations from rest between which the direction of a motion becomes clear.
const CLEAR: (f64, f64) = (2.0, 4.0);
/// Variance of a friction of unknown direction in units of its level squared: uniform between plus
/// and minus the level.
const UNCLEAR: f64 = 1.0 / 3.0;
/// Ratios of the speed to its possible change in a step (two standard deviations included) between
/// which the weight of a reversal decreases from one to zero.
const PASS: (f64, f64) = (0.75, 1.25);

/// Dry friction over a step, statistically linearised along each direction.
#[derive(Clone, Copy)]
pub(super) struct Friction {
    /// Not below zero [N m].
    pub(super) level: [f64; 4],
    /// Certainty of each direction, see [`clarity`].
    clear: [f64; 4],
    /// Means of the signs.
    pub(super) sign: [f64; 4],
    /// Slopes of the means by the speed \[s/rad\].
    slope: [f64; 4],
    /// Variance of the torque that the means leave out [N^2 m^2].
    rest: [f64; 4],
}

impl Friction {
    /// Friction of these levels [N m] over a step of `h` \[s\] that begins at speeds `omega` [rad/s] of these
    /// `variances` along the directions; `mobility` is the inverse mass (m11, m12, m22) of the braked body.
    #[inline]
    pub(super) fn over(
        h: f64,
        level: &[f64; 4],
        omega: &[f64; 2],
        variances: &[f64; 4],
        mobility: [f64; 3],
        speed_variance: f64,
    ) -> Self {
        let level = level.map(|level| level.max(0.0));
        let none = [0.0; 4];
        let mut out = Self { level, clear: none, sign: none, slope: none, rest: none };
        let yields = in_directions(mobility);
        for j in 0..4 {
            if level[j] == 0.0 {
                continue;
            }
            let kick = level[j] * h * yields[j];
            let variance = (variances[j] + 0.25 * kick * kick).max(STILL);
            let v = along(j, omega);
            out.clear[j] = clarity(j, v, speed_variance);
            (out.sign[j], out.slope[j], out.rest[j]) =
                linearised(level[j], v, variance, out.clear[j]);
        }
        out
    }

    /// Slope of the torque by the speeds [N m s/rad].
    #[inline]
    pub(super) fn stiffness(&self) -> Matrix2<f64> {
        along_directions(&[0, 1, 2, 3].map(|j| self.level[j] * self.slope[j]))
    }

    /// Variance of the friction about its mean [N^2 m^2], including that of a direction in which the speed may pass
    /// through rest within a step of `h`.
    #[inline]
    pub(super) fn with_reversals(
        &self,
        omega: &[f64; 2],
        acceleration: &[f64; 2],
        variances: &[f64; 4],
        h: f64,
    ) -> [f64; 4] {
        let mut rest = self.rest;
        for j in 0..4 {
            let (level, clear) = (self.level[j], self.clear[j]);
            if level == 0.0 || clear == 0.0 {
                continue;
            }
            let pass = along(j, acceleration).abs() * h + 2.0 * variances[j].max(0.0).sqrt();
            let near = 1.0 - between(PASS, along(j, omega).abs() / pass.max(f64::MIN_POSITIVE));
            rest[j] += near * clear * level * level;
        }
        rest
    }
}

/// `d' S d` of a symmetric matrix (s11, s12, s22) along each of the directions.
#[inline]
pub(super) fn in_directions([first, beside, second]: [f64; 3]) -> [f64; 4] {
    let (sum, cross) = (first + second, 2.0 * beside);
    [first, second, sum - cross, sum + cross]
}

/// `Σ_j d_j d_j' weight_j` over the directions.
#[inline]
fn along_directions([first, second, turning, forward]: &[f64; 4]) -> Matrix2<f64> {
    let (both, beside) = (turning + forward, forward - turning);
    Matrix2::new(first + both, beside, beside, second + both)
}

/// Mean of the sign of a friction of this `level` over a speed of mean `v` and this `variance`, the
/// slope of that mean, and the variance of the torque about it. The share 1 - `clear` of the friction is
/// uniform between minus and plus its level instead.
fn linearised(level: f64, v: f64, variance: f64, clear: f64) -> (f64, f64, f64) {
    if v * v > 2.0 * UNDERFLOW * variance {
        // far from rest, as in most steps: erf is one and its slope zero
        return (clear * v.signum(), 0.0, (1.0 - clear) * UNCLEAR * level * level);
    }
    let sign = Real::erf(v / (2.0 * variance).sqrt());
    let slope = 2.0 * density(v, variance);
    let left = (1.0 - sign * sign - slope * slope * variance).max(0.0);
    let rest = (clear * left + (1.0 - clear) * UNCLEAR) * level * level;
    (clear * sign, clear * slope, rest)
}

/// Certainty (0 to 1) of the direction of a friction of the body (turning, forward) at speed `v`
/// along it, with sensor variance `variance`: 0 within two standard deviations of rest, 1 beyond
/// four, smooth between. That of a wheel is always 1.
///
/// A friction of uncertain direction is treated as process noise. In straight driving the
/// controller keeps w1 - w2 near zero; a model with friction in this direction would predict that
/// better than the noisy torques do, and friction would be detected on robots without it.
#[must_use]
pub fn clarity(direction: usize, v: f64, variance: f64) -> f64 {
    if direction < WHEELS || v * v >= CLEAR.1 * CLEAR.1 * variance {
        return 1.0;
    }
    between(CLEAR, v.abs() / variance.sqrt())
}

/// 0 below the first limit, 1 above the second, smooth between, so that the likelihood is
/// differentiable.
pub(super) fn between(limits: (f64, f64), x: f64) -> f64 {
    let share = ((x - limits.0) / (limits.1 - limits.0)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// Density of a normal variable of this variance at `v`.
fn density(v: f64, variance: f64) -> f64 {
    let exponent = 0.5 * v * v / variance;
    // most steps are far from rest, and an exponential that underflows is slow
    if exponent > UNDERFLOW {
        return 0.0;
    }
    (-exponent).exp() / (2.0 * std::f64::consts::PI * variance).sqrt()
}

/// Variance of the torque over a step [N^2 m^2]: that of the input, and friction of variances `friction` along the
/// directions.
#[inline]
pub(super) fn torque_noise(sigma: f64, change: &[f64; 2], friction: &[f64; 4]) -> Matrix2<f64> {
    let mut out = along_directions(friction);
    for i in 0..2 {
        out[(i, i)] += input_variance(sigma, change[i]);
    }
    out
}

/// Variance of the input over a row in which it changes by `change` [N m], with white noise of standard deviation
/// `sigma`: a step at an unknown time in the row, recorded as a straight line.
#[inline]
pub(super) fn input_variance(sigma: f64, change: f64) -> f64 {
    let white = sigma * sigma;
    white + (change * change - 6.0 * white).max(0.0) / 12.0
}
