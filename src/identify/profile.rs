//! Profile likelihood: how far a parameter can go if all others follow it.

use rayon::prelude::*;

use super::{IdentifyError, Trace, TraceAxis, TraceKind};
use crate::model::Model;

/// Where the profile is taken, in standard errors from the maximum.
const PLACES: [f64; 11] = [-4.0, -3.0, -2.4, -1.8, -0.9, 0.0, 0.9, 1.8, 2.4, 3.0, 4.0];
/// Half of the chi-square quantile at 95 %, one degree of freedom.
pub const DROP: f64 = 1.920_729;

/// A profile and its 95 % interval.
pub(super) struct Profile {
    /// The curve.
    pub(super) trace: Trace,
    /// Where the log-likelihood has fallen by 1.92; infinite where it does not within four
    /// standard errors.
    pub(super) interval: (f64, f64),
}

/// The parameter that is profiled; the profile reaches four of its standard errors to either side.
pub(super) struct Place {
    /// Number of the parameter in the model.
    pub(super) j: usize,
    /// Standard error of its estimate, in `unit`.
    pub(super) std_error: f64,
    /// For the unit of the input.
    pub(super) unit: String,
}

/// The profile of a parameter around the maximum `p`.
///
/// ```text
/// l(θ_j) = max over the other parameters of the log-likelihood;   interval: l > max l - 1.92
/// ```
/// Unlike the interval of the standard error it need not be symmetric, and it holds where the
/// likelihood is no parabola. `log_likelihood` is the largest one of a model
/// with the parameter held, from a start.
///
/// Source: Venzon and Moolgavkar, Applied Statistics 37 (1988); Raue et al., Bioinformatics 25
/// (2009).
///
/// # Errors
/// If the likelihood cannot be computed at one of the places.
pub(super) fn profile(
    model: &Model,
    p: &[f64],
    Place { j, std_error, unit }: &Place,
    log_likelihood: impl Fn(&Model, &[f64]) -> Result<f64, IdentifyError> + Sync,
) -> Result<Profile, IdentifyError> {
    let symbol = model.parameters()[*j].spec.symbol.clone();
    let at = PLACES.map(|z| p[*j] + z * std_error);
    let values = at
        .par_iter()
        .map(|value| {
            let held = model.clone().fix(&symbol, *value)?;
            let mut start = p.to_vec();
            start[*j] = *value;
            log_likelihood(&held, &start)
        })
        .collect::<Result<Vec<f64>, IdentifyError>>()?;
    let best = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let drops: Vec<f64> = values.iter().map(|l| l - best).collect();
    let interval = ends(&at, &drops);
    let trace = Trace {
        kind: TraceKind::Profile,
        axis: TraceAxis::Parameter { symbol, unit: unit.clone() },
        at: at.to_vec(),
        values: drops.into_iter().map(|d| vec![d]).collect(),
    };
    Ok(Profile { trace, interval })
}

/// Where the curve crosses -1.92 on either side of its top. Between two places the root of the
/// drop is a straight line, as that of a parabola is.
fn ends(at: &[f64], drops: &[f64]) -> (f64, f64) {
    let top = (0..drops.len()).fold(0, |b, k| if drops[k] > drops[b] { k } else { b });
    let root = |k: usize| (-drops[k]).max(0.0).sqrt();
    let limit = DROP.sqrt();
    let crossing = |inner: usize, outer: usize| {
        let share = (limit - root(inner)) / (root(outer) - root(inner));
        at[inner] + share * (at[outer] - at[inner])
    };
    let low = (0..top).rev().find(|&k| -drops[k] > DROP);
    let high = (top + 1..at.len()).find(|&k| -drops[k] > DROP);
    (
        low.map_or(f64::NEG_INFINITY, |k| crossing(k + 1, k)),
        high.map_or(f64::INFINITY, |k| crossing(k - 1, k)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_gives_the_normal_interval() {
        let at: Vec<f64> = PLACES.iter().map(|z| 5.0 + 0.1 * z).collect();
        let drops: Vec<f64> = PLACES.iter().map(|z| -0.5 * z * z).collect();
        let (low, high) = ends(&at, &drops);
        // 1.959964 standard errors of 0.1; the constant 1.920729 has seven digits
        assert!((low - (5.0 - 0.195_996_4)).abs() < 1e-6, "{low}");
        assert!((high - (5.0 + 0.195_996_4)).abs() < 1e-6, "{high}");
    }

    #[test]
    fn a_side_that_never_falls_is_open() {
        let at: Vec<f64> = PLACES.to_vec();
        let drops: Vec<f64> =
            PLACES.iter().map(|z| if *z > 0.0 { -0.1 * z } else { -z * z }).collect();
        let (low, high) = ends(&at, &drops);
        assert!(low > -2.4 && low < -0.9 && high.is_infinite(), "{low} {high}");
    }
}
