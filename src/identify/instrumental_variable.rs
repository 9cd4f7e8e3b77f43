//! Instrumental variables: noisy columns against the columns of a simulated motion.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::identifiability::inverse_where_known;
use super::inverse_dynamics::{Regression, Source};
use super::linear_fit::settle;
use super::{
    Fit, Identifier, IdentifyError, MethodDescription, Status, Task, fields_as_options, start,
};
use crate::math::{clustered_covariance, pseudo_inverse};
use crate::simulate::{Gain, PhysicalDynamics, Structure, emulate};

/// Instrumental variables for the inverse dynamics (IDIM-IV).
///
/// ```text
/// θ = (Z'W)⁻¹ Z'M,   Z: W of the motion that the model of the last θ makes
/// ```
/// The motion is that of the emulator of eq. (19) in the parallel structure, whose gain holds it
/// near the measured one: with little gain little of the sensors' noise comes into Z. Rows and
/// filter as in `torque_regression`. Deviation from the source: its instruments come from the
/// real controller following the real reference, which no recording here contains.
///
/// Source: Janot, Vandanjon and Gautier, "A generic instrumental variable approach for industrial
/// robot identification", IEEE Trans. Control Systems Technology 22 (2014).
#[derive(Clone, Debug, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct InstrumentalVariable {
    /// Cut-off of the filter \[Hz\]; chosen from noise and motion unless given.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub cutoff_hz: Option<f64>,
    /// Gain that corrects the simulated speeds towards the measured ones [1/s].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub gain: f64,
    /// Largest number of simulations.
    pub iterations: usize,
}

impl Default for InstrumentalVariable {
    fn default() -> Self {
        Self { cutoff_hz: None, gain: 2.0, iterations: 15 }
    }
}

const NAME: &str = "instrumental_variable";
/// Noise let into the acceleration, as a share of its rms: attenuation is accounted for, noise that reaches the
/// simulation is not.
const NOISE_SHARE: f64 = 0.06;
/// A change by this share of the standard errors is the last.
const SETTLED: f64 = 0.01;

impl Identifier for InstrumentalVariable {
    fn describe(&self) -> MethodDescription {
        MethodDescription {
            name: NAME.into(),
            title: "Instrumental variables for inverse dynamics (IDIM-IV)".into(),
            equation: "θ = (Z'W)⁻¹ Z'M with Z the columns of the simulated motion".into(),
            source: "Janot, Vandanjon and Gautier 2014".into(),
            use_when:
                "as torque_regression, with noisy speeds: the simulated columns carry little \
                       of their noise"
                    .into(),
            avoid_when:
                "the torques are noisy: the simulated instruments then contain the same noise; its \
                         intervals do not cover the bias of the filter"
                    .into(),
        }
    }

    fn intervals_cover(&self) -> bool {
        false
    }

    fields_as_options!(NAME);

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        let rows = Regression::new(task, self.cutoff_hz, NOISE_SHARE, NAME)?;
        let mut status = Status::IterationLimit;
        let mut values = inverse_where_known(&rows.x.tr_mul(&rows.x)) * rows.x.tr_mul(&rows.y);
        let mut p = movable(task, &rows, &values);
        let mut covariance = DMatrix::zeros(values.len(), values.len());
        let mut iterations = 0;
        while iterations < self.iterations.max(1) {
            let z = self.instruments(task, &rows, &p)?;
            let bread = inverse_of_product(&z, &rows.x);
            let next = &bread * z.tr_mul(&rows.y);
            let residuals = &rows.y - &rows.x * &next;
            covariance = clustered_covariance(&bread, &z, &residuals, &rows.block, z.nrows());
            let moved = (0..next.len()).any(|c| {
                let change = (next[c] - values[c]).abs();
                change > SETTLED * covariance[(c, c)].sqrt() && change > 1e-9 * next[c].abs()
            });
            values = next;
            iterations += 1;
            p = movable(task, &rows, &values);
            if !moved {
                status = Status::Converged;
                break;
            }
        }
        let mut fit = rows.fit(NAME, &values, &covariance)?;
        fit.status = status;
        fit.work.iterations = iterations;
        fit.work.evaluations = iterations;
        Ok(fit)
    }
}

impl InstrumentalVariable {
    /// The columns of the motion that the model makes with parameters `p`.
    fn instruments(
        &self,
        task: &Task,
        rows: &Regression,
        p: &[f64],
    ) -> Result<DMatrix<f64>, IdentifyError> {
        let dynamics = Arc::new(PhysicalDynamics { model: task.model.clone(), p: p.to_vec() });
        let mut sources = Vec::with_capacity(task.train.len());
        for recording in task.train {
            let gain = Gain::speed(self.gain);
            let motion = emulate(&*dynamics, recording, &gain, Structure::Parallel, task.hold)?;
            sources.push(Source {
                alpha: motion.iter().map(|s| s.alpha).collect(),
                omega: motion.iter().map(|s| s.omega).collect(),
                input: recording.torque().to_vec(),
            });
        }
        let (z, _) = rows.rows_of(&sources);
        Ok(match &rows.projection {
            Some(projection) => z * projection,
            None => z,
        })
    }
}

/// Parameters with which the model can move.
fn movable(task: &Task, rows: &Regression, values: &DVector<f64>) -> Vec<f64> {
    let mut p = task.model.initial();
    for (value, &j) in values.iter().zip(rows.linear()) {
        p[j] = *value;
    }
    settle(&mut p, task, true, &mut vec![]);
    start::sound(task.model, &mut p);
    p
}

/// `(z'x)⁻¹` over the directions that carry something, with rows and columns scaled: not symmetric, so no
/// [`crate::math::Information`].
fn inverse_of_product(z: &DMatrix<f64>, x: &DMatrix<f64>) -> DMatrix<f64> {
    let norms = |m: &DMatrix<f64>| -> Vec<f64> {
        m.column_iter().map(|c| if c.norm() > 0.0 { c.norm() } else { 1.0 }).collect()
    };
    let (of_z, of_x) = (norms(z), norms(x));
    let n = x.ncols();
    let product = z.tr_mul(x);
    let scaled = DMatrix::from_fn(n, n, |i, k| product[(i, k)] / (of_z[i] * of_x[k]));
    let inverse = pseudo_inverse(&scaled, 1e-8).unwrap_or_else(|| DMatrix::zeros(n, n));
    DMatrix::from_fn(n, n, |i, k| inverse[(i, k)] / (of_x[i] * of_z[k]))
}
