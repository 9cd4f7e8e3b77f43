//! Recursive least squares: the estimates as they come in, sample by sample.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::identifiability::inverse_where_known;
use super::inverse_dynamics::{NOISE_SHARE, Regression};
use super::{
    Fit, Identifier, IdentifyError, MethodDescription, Task, Trace, TraceAxis, TraceKind,
    fields_as_options,
};
use crate::math::clustered_covariance;

/// Recursive least squares of the inverse dynamics with exponential forgetting.
///
/// ```text
/// R_k = λ R_{k-1} + w_k w_k',   b_k = λ b_{k-1} + w_k M_k,   θ_k = R_k⁻¹ b_k
/// ```
/// One step an instant (both wheels), in the order of time; with λ = 1 the last estimate is that
/// of `torque_regression`. The information form needs no guess of a start: parameters appear when
/// the data have excited them. A trace that drifts shows a robot that changes (warm-up, a load).
///
/// Source: Ljung, System Identification (1999), sec. 11.2.
#[derive(Clone, Debug, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RecursiveLeastSquares {
    /// Cut-off of the filter \[Hz\]; chosen from noise and motion unless given.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub cutoff_hz: Option<f64>,
    /// Forgetting factor λ of a sample.
    #[schemars(range(max = 1.0), extend("exclusiveMinimum" = 0))]
    pub forgetting: f64,
}

impl Default for RecursiveLeastSquares {
    fn default() -> Self {
        Self { cutoff_hz: None, forgetting: 1.0 }
    }
}

const NAME: &str = "recursive_least_squares";
/// Points of a trace.
const POINTS: usize = 400;

impl Identifier for RecursiveLeastSquares {
    fn describe(&self) -> MethodDescription {
        MethodDescription {
            name: NAME.into(),
            title: "Recursive least squares".into(),
            equation: "R = λR + ww', b = λb + wM, θ = R⁻¹b, instant by instant".into(),
            source: "Ljung, System Identification, 1999, sec. 11.2".into(),
            use_when: "to detect parameters that vary with time: warm-up, a changed load".into(),
            avoid_when: "speeds are noisy (as torque_regression: inertias are underestimated, \
                         which its intervals do not cover)"
                .into(),
        }
    }

    fn intervals_cover(&self) -> bool {
        false
    }

    fields_as_options!(NAME);

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        let rows = Regression::new(task, self.cutoff_hz, NOISE_SHARE, NAME)?;
        let width = rows.x.ncols();
        let instants = rows.y.len() / 2;
        let every = instants.div_ceil(POINTS).max(1);
        let (mut r, mut b) = (DMatrix::zeros(width, width), DVector::zeros(width));
        let symbols = rows.linear().iter().map(|&j| task.model.symbols()[j].clone());
        let mut trace = Trace {
            kind: TraceKind::Estimates(symbols.collect()),
            axis: TraceAxis::Time,
            at: vec![],
            values: vec![],
        };
        for k in 0..instants {
            r *= self.forgetting;
            b *= self.forgetting;
            for i in [2 * k, 2 * k + 1] {
                let w = rows.x.row(i).transpose();
                r.ger(1.0, &w, &w, 1.0);
                b.axpy(rows.y[i], &w, 1.0);
            }
            if k >= width && k % every == 0 {
                trace.at.push(rows.time[2 * k]);
                trace.values.push((inverse_where_known(&r) * &b).iter().copied().collect());
            }
        }
        let bread = inverse_where_known(&r);
        let values = &bread * b;
        let residuals = &rows.y - &rows.x * &values;
        let weighted = DVector::from_fn(residuals.len(), |i, _| {
            self.forgetting.powi((instants - 1 - i / 2) as i32) * residuals[i]
        });
        let covariance =
            clustered_covariance(&bread, &rows.x, &weighted, &rows.block, rows.x.nrows());
        let mut fit = rows.fit(NAME, &values, &covariance)?;
        rows.note_of_bias(
            &mut fit,
            &rows.bias(&values, &inverse_where_known(&rows.x.tr_mul(&rows.x))),
        );
        fit.traces.push(trace);
        fit.work.iterations = instants;
        Ok(fit)
    }
}
