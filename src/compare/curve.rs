//! How the residual torque depends on a variable.

use super::acting::Acting;
use super::mean::Mean;
use super::unexplained_torque::Variable;
use crate::math::distribution::chi2_log_survival;

/// The residual torque in one bin of a variable.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct CurveBin {
    /// Mean of the variable.
    pub at: f64,
    /// Whether there is no gap between this bin and the previous one.
    pub joined: bool,
    /// Residual torque of the model as given, by wheel [N m; a share of the input if it acts as a gain].
    pub before: [Mean; 2],
    /// Residual torque of the model with the effects found, by wheel, in the same unit.
    pub after: Option<[Mean; 2]>,
}

/// How the residual torque depends on a variable.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Curve {
    /// Variable of the abscissa.
    pub variable: Variable,
    /// How the torque of the bins acts.
    pub acting: Acting,
    /// Bins in order.
    pub bins: Vec<CurveBin>,
    /// Share of the mean square of the residual torque that the bins explain, of the model as given.
    pub share_before: f64,
    /// The same for the model with the effects found, as a share of the mean square of the model as given.
    pub share_after: Option<f64>,
    /// -ln of the p-value of the dependence of the model as given.
    pub log_significance: f64,
}

impl Curve {
    /// The remaining share: of the model with the effects found if there are any, otherwise of the model as
    /// given.
    #[must_use]
    pub fn left(&self) -> f64 {
        self.share_after.unwrap_or(self.share_before)
    }

    /// The largest absolute mean of the remaining residual torque \[N m; a share of the input if it acts as a
    /// gain\].
    #[must_use]
    pub fn largest_left(&self) -> f64 {
        let means = self.bins.iter().flat_map(|b| b.after.unwrap_or(b.before));
        means.map(|m| m.value.abs()).filter(|v| v.is_finite()).fold(0.0, f64::max)
    }

    /// -ln of the p-value of the remaining dependence if only the blocks of 1 s are independent, as under coloured
    /// noise of the input. Bins of one or two blocks are left out.
    ///
    /// ```text
    /// T = Σ z² ~ χ²,   z: normal quantile of the p-value of t = (mean - c)/se, of B - 1 degrees of freedom in B blocks
    /// ```
    /// c is zero for a torque; for a resistance or a gain it is the mean of all bins, weighted by 1/se², which does not
    /// depend on the variable.
    ///
    /// Source of z: Wallace, Ann. Math. Stat. 30 (1959).
    #[must_use]
    pub fn clustered_significance(&self) -> f64 {
        let (mut statistic, mut count) = (0.0, 0.0);
        for i in 0..2 {
            let means = self.bins.iter().map(|b| b.after.unwrap_or(b.before)[i]);
            let known: Vec<Mean> = means.filter(|m| m.blocks > 2 && m.std_error > 0.0).collect();
            if known.is_empty() {
                continue;
            }
            let weight = |m: &Mean| m.std_error.powi(-2);
            let common = match self.acting {
                Acting::Torque => 0.0,
                _ => {
                    known.iter().map(|m| weight(m) * m.value).sum::<f64>()
                        / known.iter().map(weight).sum::<f64>()
                }
            };
            let degrees = |m: &Mean| (m.blocks - 1) as f64;
            let square = |m: &Mean| {
                let t = (m.value - common) / m.std_error;
                let n = degrees(m);
                ((8.0 * n + 1.0) / (8.0 * n + 3.0)).powi(2) * n * (t * t / n).ln_1p()
            };
            statistic += known.iter().map(square).sum::<f64>();
            count += known.len() as f64 - f64::from(u8::from(self.acting != Acting::Torque));
        }
        if count > 0.0 { -chi2_log_survival(statistic, count) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dependence_counts_blocks_and_not_rows() {
        // two bins of three blocks: means 1 and -1 with standard errors of 0.5, t = ±2 of two degrees of freedom, whose
        // p-value of 0.18350 (scipy.stats.t.sf(2, 2) * 2) is that of z² = 1.7691; Wallace's z² is 1.7590
        let mean = |value| Mean { value, std_error: 0.5, blocks: 3 };
        let bin = |value| CurveBin { at: 0.0, joined: true, before: [mean(value); 2], after: None };
        let of = |acting, bins| Curve {
            variable: Variable::Omega1,
            acting,
            bins,
            share_before: 0.0,
            share_after: None,
            log_significance: 0.0,
        };
        let torque = of(Acting::Torque, vec![bin(1.0), bin(-1.0)]).clustered_significance();
        let expected = -chi2_log_survival(4.0 * 1.7691, 4.0);
        assert!((torque - expected).abs() < 0.02, "{torque} {expected}");
        // what all bins of a gain have in common does not depend on the variable
        let gain = of(Acting::Gain, vec![bin(1.0), bin(1.0)]).clustered_significance();
        assert!(gain.abs() < 1e-12, "{gain}");
    }
}
