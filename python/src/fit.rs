//! A fit: estimates, and a model that moves.

use amigo_ident::robot::State;
use amigo_ident::simulate::{Hold, Input};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::array::{pairs, values};
use crate::error::{json, wrong};

/// What a method identified.
#[pyclass(frozen)]
pub(crate) struct Fit {
    pub(crate) fit: amigo_ident::identify::Fit,
    pub(crate) seconds: f64,
    pub(crate) hold: Hold,
}

type Motion<'py> = (Bound<'py, PyBytes>, Bound<'py, PyBytes>);

#[pymethods]
impl Fit {
    #[getter]
    fn method(&self) -> &str {
        &self.fit.method
    }

    #[getter]
    fn status(&self) -> &'static str {
        self.fit.status.name()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.fit.notes.iter().map(ToString::to_string).collect()
    }

    #[getter]
    fn seconds(&self) -> f64 {
        self.seconds
    }

    /// The input between two rows, as it was fitted.
    #[getter]
    fn hold(&self) -> &'static str {
        match self.hold {
            Hold::Linear => "linear",
            Hold::Constant => "constant",
        }
    }

    /// The parameters as JSON.
    fn estimates(&self) -> PyResult<String> {
        json(&self.fit.estimates)
    }

    /// Covariance of all parameters, row by row; `None` without one.
    fn covariance(&self) -> Option<Vec<Vec<f64>>> {
        let matrix = self.fit.covariance.as_ref()?;
        Some(matrix.row_iter().map(|row| row.iter().copied().collect()).collect())
    }

    /// Angles and speeds from the input alone.
    fn simulate<'py>(
        &self,
        py: Python<'py>,
        t: &[u8],
        input: &[u8],
        alpha: [f64; 2],
        dalpha: [f64; 2],
    ) -> PyResult<Motion<'py>> {
        let (t, input) = (values(t)?, values(input)?);
        if t.len() < 2 || input.len() != 2 * t.len() {
            let rows = t.len();
            return Err(wrong(&format!(
                "t has {rows} values and inputs {} in all; expected at least 2, and an array of shape \
                 ({rows}, 2)",
                input.len()
            )));
        }
        if let Some(k) = (1..t.len()).find(|&k| !(t[k] > t[k - 1])) {
            return Err(wrong(&format!("t[{k}] = {} s does not exceed {} s", t[k], t[k - 1])));
        }
        let rows: Vec<[f64; 2]> = input.chunks_exact(2).map(|row| [row[0], row[1]]).collect();
        if let Some(k) = rows.iter().position(|row| !row.iter().all(|m| m.is_finite())) {
            return Err(wrong(&format!("inputs[{k}] = {:?}; expected finite numbers", rows[k])));
        }
        let start = State { alpha, omega: dalpha };
        let motion = py.allow_threads(|| {
            self.fit.dynamics.simulate(&Input { t: &t, torque: &rows, hold: self.hold }, start)
        });
        let motion = motion.map_err(|e| crate::error::failed(&e.into()))?;
        let alpha: Vec<[f64; 2]> = motion.iter().map(|s| s.alpha).collect();
        let dalpha: Vec<[f64; 2]> = motion.iter().map(|s| s.omega).collect();
        Ok((pairs(py, &alpha)?, pairs(py, &dalpha)?))
    }
}
