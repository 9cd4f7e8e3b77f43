//! Whether recordings of one robot have one set of parameters.

use rayon::prelude::*;

use super::fit::{WindowFit, fit};
use super::input_timing::SYMBOL;
use super::scale::scale_of;
use super::thresholds::THRESHOLDS;
use super::windows::Windows;
use crate::math::distribution::t_survival;
use crate::recording::Recording;
use crate::simulate::Hold;

/// A parameter of one recording that differs from that of the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Name of the recording that differs.
    pub recording: String,
    /// Symbol of the parameter by which it differs most surely.
    pub symbol: String,
    /// Its estimate from that recording over the one from the others, less one.
    pub share: f64,
    /// Standard error of that.
    pub std_error: f64,
}

/// The parameter that differs most significantly between one of the `recordings` and the others, each fitted
/// separately from `common` on. `None` if no difference is significant.
///
/// ```text
/// t = (p_r - p̄)/sqrt(var p_r + var p̄),   p̄: mean of the other recordings, weighted by their variances
/// ```
/// The degrees of freedom are the number of windows minus parameters of the shortest of them; the
/// significance level is 1e-6 for all parameters and recordings together.
#[must_use]
pub fn difference(common: &WindowFit, recordings: &[&Recording], hold: Hold) -> Option<Difference> {
    if recordings.len() < 2 {
        return None;
    }
    let own = |recording: &&Recording| {
        let windows = Windows::weighted(vec![*recording], hold, &common.model, &common.p);
        let scale = scale_of(&common.model, &common.p, &[*recording]);
        let found = fit(&windows, &common.model, &common.p, &scale)?;
        Some((found, windows.windows.len()))
    };
    let fits: Vec<(WindowFit, usize)> = recordings.par_iter().map(own).collect::<Option<_>>()?;
    let free = common.model.free();
    let fewest = fits.iter().map(|(_, windows)| *windows).min()?;
    let degrees = fewest.checked_sub(free.len()).filter(|left| *left > 0)? as f64;
    let symbols = common.model.symbols();
    let tried = (free.len() * recordings.len()) as f64;
    let mut surest: Option<(f64, Difference)> = None;
    for &j in free.iter().filter(|&&j| symbols[j] != SYMBOL) {
        let of =
            |(fit, _): &(WindowFit, usize)| (fit.p[j], fit.covariance[(j, j)], fit.at_bound[j]);
        let all: Vec<(f64, f64, bool)> = fits.iter().map(of).collect();
        let is_known = |(_, variance, bound): &(f64, f64, bool)| {
            variance.is_finite() && *variance > 0.0 && !bound
        };
        for (r, one) in all.iter().enumerate().filter(|(_, one)| is_known(one)) {
            let others = all.iter().enumerate().filter(|(n, other)| *n != r && is_known(other));
            let (weight, sum) =
                others.fold((0.0, 0.0), |(weight, sum), (_, (value, variance, _))| {
                    (weight + 1.0 / variance, sum + value / variance)
                });
            if weight == 0.0 {
                continue;
            }
            let (mean, std_error) = (sum / weight, (one.1 + 1.0 / weight).sqrt());
            let apart = one.0 - mean;
            let chance = 2.0 * tried * t_survival(apart.abs() / std_error, degrees);
            let least = surest.as_ref().map_or(THRESHOLDS.differs_by_chance, |(chance, _)| *chance);
            if chance < least && apart.abs() > THRESHOLDS.least_difference * mean.abs() {
                let (share, std_error) = (apart / mean, std_error / mean.abs());
                let (recording, symbol) = (recordings[r].name().to_owned(), symbols[j].clone());
                surest = Some((chance, Difference { recording, symbol, share, std_error }));
            }
        }
    }
    surest.map(|(_, difference)| difference)
}
