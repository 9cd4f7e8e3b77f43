//! Total least squares: noise in the columns as well as in the torques.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::inverse_dynamics::Regression;
use super::{
    Fit, Identifier, IdentifyError, MethodDescription, Task, Unsupported, fields_as_options,
};
use crate::math::Information;

/// Total least squares of the inverse dynamics, with columns scaled by their noise.
///
/// ```text
/// minimise  v' A v / v' C v,   v = (θ, -1),   A = [W M]'[W M],   C: the part of A that is noise
/// ```
/// C is what the same amount of sensor noise, added once more, changes in the filtered columns:
/// it holds for every effect of the catalogue, and columns without noise (sgn) are exact. Rows as
/// in `torque_regression`; errors by leaving out one block of rows after the other.
///
/// Source: Van Huffel and Vandewalle, The Total Least Squares Problem (1991); Fuller, Measurement
/// Error Models (1987), sec. 2.3.
#[derive(Clone, Debug, Default, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct TotalLeastSquares {
    /// Cut-off of the filter \[Hz\]; chosen from noise and motion unless given.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub cutoff_hz: Option<f64>,
}

const NAME: &str = "total_least_squares";
/// Noise let into the acceleration, as a share of its rms: attenuation is accounted for, so the filter may be wide.
const NOISE_SHARE: f64 = 0.1;
/// Noise that every column has at least, as a share of its square: keeps C invertible where
/// columns are exact.
const FLOOR: f64 = 1e-10;

impl Identifier for TotalLeastSquares {
    fn describe(&self) -> MethodDescription {
        MethodDescription {
            name: NAME.into(),
            title: "Total least squares".into(),
            equation: "minimise v'Av / v'Cv over v = (θ, -1), A = [W M]'[W M], C its noise part"
                .into(),
            source: "Van Huffel and Vandewalle 1991; Fuller, Measurement Error Models, 1987".into(),
            use_when: "as torque_regression, with noisy speeds: the inertias are not attenuated"
                .into(),
            avoid_when:
                "an effect is missing: the error of the model is treated as noise; the intervals do not \
                         cover the bias of the filter"
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
        let mut columns = rows.x.clone().insert_column(width, 0.0);
        columns.set_column(width, &rows.y);
        let gram = columns.tr_mul(&columns);
        let failed = || IdentifyError::Unsupported {
            method: NAME.into(),
            reason: Unsupported::NoSmallestDirection,
        };
        let values = smallest(&gram, &rows.noise).ok_or_else(failed)?;
        let covariance = jackknife(&columns, &gram, &rows, &values).ok_or_else(failed)?;
        rows.fit(NAME, &values, &covariance)
    }
}

/// The coefficients of the direction in which `gram` is smallest against `noise`.
fn smallest(gram: &DMatrix<f64>, noise: &DMatrix<f64>) -> Option<DVector<f64>> {
    let width = gram.nrows() - 1;
    let of_columns = Information::new(&gram.view((0, 0), (width, width)).into_owned()).whitening();
    let known = of_columns.ncols();
    let mut basis = DMatrix::zeros(width + 1, known + 1);
    basis.view_mut((0, 0), (width, known)).copy_from(&of_columns);
    basis[(width, known)] = 1.0 / gram[(width, width)].max(f64::MIN_POSITIVE).sqrt();
    let a = basis.transpose() * gram * &basis;
    let c = basis.transpose() * noise * &basis;
    let c = 0.5 * (&c + c.transpose()) + DMatrix::identity(known + 1, known + 1) * FLOOR;
    let lower = c.cholesky()?.l();
    let half = lower.solve_lower_triangular(&a)?;
    let whitened = lower.solve_lower_triangular(&half.transpose())?;
    let eigen = (0.5 * (&whitened + whitened.transpose())).symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    let v = lower.transpose().solve_upper_triangular(&eigen.eigenvectors.column(least))?;
    let v = basis * v;
    let last = v[width];
    (last != 0.0).then(|| v.rows(0, width) / -last)
}

/// Covariance from leaving out one block after the other.
fn jackknife(
    columns: &DMatrix<f64>,
    gram: &DMatrix<f64>,
    rows: &Regression,
    values: &DVector<f64>,
) -> Option<DMatrix<f64>> {
    let blocks = rows.block.iter().max().map_or(0, |b| b + 1);
    let mut part = vec![DMatrix::zeros(gram.nrows(), gram.ncols()); blocks];
    let mut count = vec![0_usize; blocks];
    for (i, &b) in rows.block.iter().enumerate() {
        let row = columns.row(i);
        part[b] += row.transpose() * row;
        count[b] += 1;
    }
    let used = count.iter().filter(|c| **c > 0).count() as f64;
    let mut covariance = DMatrix::zeros(values.len(), values.len());
    for (part, &n) in part.iter().zip(&count).filter(|(_, n)| **n > 0) {
        let share = 1.0 - n as f64 / columns.nrows() as f64;
        let without = smallest(&(gram - part), &(&rows.noise * share))?;
        let change = without - values;
        covariance += &change * change.transpose();
    }
    Some(covariance * ((used - 1.0) / used))
}
