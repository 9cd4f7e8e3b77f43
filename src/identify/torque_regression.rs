//! Inverse-dynamic least squares: the method of the textbooks.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::identifiability::inverse_where_known;
use super::inverse_dynamics::{NOISE_SHARE, Regression};
use super::sampling::at_least;
use super::{Fit, Identifier, IdentifyError, MethodDescription, Task, fields_as_options, start};
use crate::math::{MathError, least_squares, robust};
use crate::recording::LongRecording;

/// Inverse-dynamic identification by least squares (IDIM-LS).
///
/// ```text
/// W θ = M,   W = [dw1, dw2, w2(w2-w1), sgn(w1), …] per effect, θ = (W'W)⁻¹ W'M
/// ```
/// Speeds pass a zero-phase Butterworth filter of order 4, are differentiated, and the columns
/// and the torques pass the same filter again, so that the relation stays linear; then every row
/// that the filter makes redundant is left out. Each movement between two stops or reversals is
/// filtered on its own, so that friction at rest, which is not sgn(w), does not come in.
///
/// Source: Gautier, "Dynamic identification of robots with power model", ICRA 1997; Janot,
/// Vandanjon, Gautier, Control Engineering Practice 2014.
#[derive(Clone, Debug, Default, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct TorqueRegression {
    /// Cut-off of the filter \[Hz\]; chosen from noise and motion unless given.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub cutoff_hz: Option<f64>,
    /// Speed below which a wheel counts as near rest [rad/s]: from noise and top speed unless given; 0 keeps
    /// all samples, which suits sharp reversals with little noise.
    #[schemars(range(min = 0.0))]
    pub rest_rad_s: Option<f64>,
    /// How rows are weighted.
    pub weighting: Weighting,
}

/// How rows are weighted.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Weighting {
    /// Equal weights.
    #[default]
    Ordinary,
    /// By the residual variance of their wheel.
    Weighted,
    /// Huber's loss: large residuals have less weight.
    Huber,
}

const NAME: &str = "torque_regression";

impl Identifier for TorqueRegression {
    fn describe(&self) -> MethodDescription {
        MethodDescription {
            name: NAME.into(),
            title: "Inverse-dynamic least squares (IDIM-LS)".into(),
            equation: "W θ = M by least squares, W of filtered speeds and accelerations".into(),
            source: "Gautier 1997; Janot, Vandanjon and Gautier 2014".into(),
            use_when: "a quick look, clean data, very long recordings; the literature's reference"
                .into(),
            avoid_when: "speeds are noisy: accelerations are attenuated, inertias are underestimated, the best cut-off depends on the noise, and its intervals do not \
                         cover that"
                .into(),
        }
    }

    fn intervals_cover(&self) -> bool {
        false
    }

    fn rank(&self) -> Option<usize> {
        Some(3)
    }

    fn is_default(&self) -> bool {
        true
    }

    fields_as_options!(NAME);

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        self.fit(&self.rows(task)?, false)
    }

    fn identify_long(
        &self,
        task: &Task,
        long: &[Option<&LongRecording>],
    ) -> Option<Result<Fit, IdentifyError>> {
        if self.weighting == Weighting::Huber {
            return None;
        }
        let settings = (self.cutoff_hz, self.rest_rad_s);
        let rows = super::streamed::regression(task, long, settings, NOISE_SHARE, NAME);
        Some(rows.and_then(|rows| self.fit(&rows, false)))
    }
}

/// Each row times its factor.
fn scaled_rows(x: &DMatrix<f64>, factor: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(x.nrows(), x.ncols(), |i, j| x[(i, j)] * factor[i])
}

/// Values, weights of the rows, influence of their residuals and the slope of that.
type Solved = (DVector<f64>, DVector<f64>, DVector<f64>, DVector<f64>);

impl TorqueRegression {
    /// The rows of the regression.
    ///
    /// # Errors
    /// If too few are left.
    pub(super) fn rows<'t>(&self, task: &'t Task<'t>) -> Result<Regression<'t>, IdentifyError> {
        Regression::with_rest(task, self.cutoff_hz, self.rest_rad_s, NOISE_SHARE, NAME)
    }

    /// The fit, its standard errors no smaller than what noise of the columns and the sampling of the input do, and
    /// the parameters without each of some pieces (recording and rows) in turn.
    ///
    /// # Errors
    /// As [`Identifier::identify`].
    pub(super) fn left_out(
        &self,
        rows: &Regression,
        pieces: &[(usize, std::ops::Range<usize>)],
    ) -> Result<(Fit, Vec<Vec<f64>>), IdentifyError> {
        let fit = self.fit(rows, true)?;
        let p: Vec<f64> = fit.estimates.iter().map(|e| e.value).collect();
        let left_out = rows.left_out(pieces);
        let of = |values: DVector<f64>| {
            let mut p = p.clone();
            rows.linear().iter().zip(values.iter()).for_each(|(&j, value)| p[j] = *value);
            // what the other pieces do not give must not keep the robot from moving
            start::sound(rows.task.model, &mut p);
            p
        };
        Ok((fit, left_out.into_iter().map(of).collect()))
    }

    /// The fit; if `widened`, with standard errors no smaller than what noise of the columns and the sampling of
    /// the input do to the values.
    ///
    /// # Errors
    /// If the rows do not give the values.
    pub(super) fn fit(&self, rows: &Regression, widened: bool) -> Result<Fit, IdentifyError> {
        let (values, weights, psi, slope) = self
            .solve(rows)
            .map_err(|e| IdentifyError::Unsupported { method: NAME.into(), reason: e.into() })?;
        let weighted = scaled_rows(&rows.x, &weights);
        let bread = inverse_where_known(&rows.x.tr_mul(&scaled_rows(&rows.x, &slope)));
        let inverse = inverse_where_known(&rows.x.tr_mul(&weighted));
        let mean = weights.sum() / weights.len() as f64;
        let bias = rows.bias(&values, &(inverse * mean));
        let mut covariance = rows.covariance(&bread, &psi);
        if widened {
            at_least(&mut covariance, &bias);
            let halved = rows.halved().component_mul(&slope);
            at_least(&mut covariance, &(&bread * rows.x.tr_mul(&halved)));
        }
        let mut fit = rows.fit(NAME, &values, &covariance)?;
        rows.note_of_bias(&mut fit, &bias);
        Ok(fit)
    }

    fn solve(&self, rows: &Regression) -> Result<Solved, MathError> {
        let first = least_squares::fit(&rows.x, &rows.y, None)?;
        let ones = DVector::repeat(rows.y.len(), 1.0);
        Ok(match self.weighting {
            Weighting::Ordinary => (first.coefficients, ones.clone(), first.residuals, ones),
            Weighting::Weighted => {
                let weights = wheel_weights(&first.residuals, &rows.wheel);
                let fit = least_squares::fit(&rows.x, &rows.y, Some(&weights))?;
                let psi = fit.residuals.component_mul(&weights);
                (fit.coefficients, weights.clone(), psi, weights)
            }
            Weighting::Huber => {
                let robust = robust::fit_huber(&rows.x, &rows.y, None)?;
                let psi = robust.fit.residuals.component_mul(&robust.row_weights);
                let slope = robust.row_weights.map(|w| if w < 1.0 { 0.0 } else { 1.0 });
                (robust.fit.coefficients, robust.row_weights, psi, slope)
            }
        })
    }
}

/// One over the residual variance of the row's wheel.
fn wheel_weights(residuals: &DVector<f64>, wheel: &[usize]) -> DVector<f64> {
    let (mut sum, mut count) = ([0.0; 2], [0.0; 2]);
    for (r, &w) in residuals.iter().zip(wheel) {
        sum[w] += r * r;
        count[w] += 1.0;
    }
    let variance = [0, 1].map(|w| f64::max(sum[w] / f64::max(count[w], 1.0), 1e-300));
    DVector::from_fn(wheel.len(), |i, _| 1.0 / variance[wheel[i]])
}
