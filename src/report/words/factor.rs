//! Factors of units and gears, as an experiment file can contain them.

use crate::math::Span;

/// Possible gear ratio for a ratio of speed to derivative of the angle, and the columns that it converts to
/// those of the wheel, i.e. the columns of the faster shaft.
pub(super) fn gear_scale(ratio: Span<f64>) -> String {
    let (key, scale) = if ratio.low() > 1.0 {
        ("dalpha", ratio.map(|ratio| 1.0 / ratio))
    } else {
        ("alpha", ratio)
    };
    format!("scale = {} in {key}1 and {key}2", scale.written(plain))
}

/// Five digits of a factor, as a file can contain it.
pub(super) fn plain(factor: f64) -> String {
    let decimals = (4.0 - factor.abs().log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{factor:.decimals$}")
}

/// Smallest and largest radius \[m\] of wheels that a speed in m/s may be told by (taste: wheels of toys and of vehicles).
const WHEELS_M: [f64; 2] = [0.005, 0.5];

/// The radius that would also explain the ratio of a speed to the slope of its angle.
pub(super) fn or_metres(ratio: Span<f64>) -> String {
    if ratio.low() < WHEELS_M[0] || ratio.high() > WHEELS_M[1] {
        return String::new();
    }
    let radius = ratio.written(plain);
    format!(
        "; for speeds in m/s of wheels of radius {radius} m write unit = \"m/s\" in dalpha1 and dalpha2 and r_m"
    )
}

/// The gear that would also explain the factor of a unit: a length, like a gear, may have any value.
pub(super) fn or_gear(factor: Span<f64>, unit: &str) -> String {
    if !matches!(unit, "m" | "m/s") {
        return String::new();
    }
    format!(
        " (or a gear of {:.4} lies between motor and wheel: write {})",
        factor.map(|factor| factor.max(1.0 / factor)),
        gear_scale(factor)
    )
}
