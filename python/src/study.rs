//! A finished study: `results.json`, the report, and curves.

use std::sync::Arc;

use amigo_ident::experiment::{self, FittedModels, Overlay};
use amigo_ident::report::results;
use amigo_ident::report::{figure_to_svg, render};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::array::bytes;
use crate::error::{failed, internal, json, wrong};

/// What an experiment found.
#[pyclass(frozen)]
pub(crate) struct Study {
    pub(crate) plan: Arc<experiment::Plan>,
    pub(crate) study: amigo_ident::study::Study,
}

type Columns<'py> = Vec<(String, Bound<'py, PyBytes>)>;

impl Study {
    fn of_recording(&self, k: usize) -> PyResult<Overlay> {
        let models = FittedModels::of(&self.plan, &self.study).map_err(|e| failed(&e.into()))?;
        let models = models.ok_or_else(|| wrong("no method identified a physical model"))?;
        let recordings = &self.plan.recordings;
        let Some(measured) = recordings.get(k) else {
            return Err(wrong(&format!("recording {k}: there are {}", recordings.len())));
        };
        experiment::overlay(&measured.recording, self.plan.hold, &models)
            .map_err(|e| failed(&e.into()))
    }
}

#[pymethods]
impl Study {
    /// The content of `results.json`.
    fn results(&self) -> PyResult<String> {
        json(&results(&self.study))
    }

    /// The method that is shown in detail, by its place.
    #[getter]
    fn reference(&self) -> Option<usize> {
        self.study.reference
    }

    /// Numbers of the recordings on which errors are judged.
    #[getter]
    fn judged(&self) -> Vec<usize> {
        self.study.judged()
    }

    /// RMSE of 2 s simulations of the reference method and noise floor on the judged recordings [rad/s].
    #[getter]
    fn error_and_floor(&self) -> (Option<f64>, f64) {
        let method = self.study.reference_method();
        (method.map(|m| self.study.judged_window_rms(m)), self.study.judged_floor())
    }

    /// The page.
    fn report(&self, py: Python<'_>) -> PyResult<String> {
        py.allow_threads(|| render(&self.study)).map(|r| r.html).map_err(internal)
    }

    /// Measured and simulated motion of a recording.
    fn overlay<'py>(&self, py: Python<'py>, recording: usize) -> PyResult<Columns<'py>> {
        let overlay = py.allow_threads(|| self.of_recording(recording))?;
        let column =
            |(name, values): (String, Vec<f64>)| Ok((name, bytes(py, values.into_iter())?));
        overlay.columns.into_iter().map(column).collect()
    }

    /// The same as a picture.
    fn svg(&self, py: Python<'_>, recording: usize) -> PyResult<String> {
        py.allow_threads(|| {
            let overlay = self.of_recording(recording)?;
            figure_to_svg(&crate::figure::figure(&overlay)).map_err(internal)
        })
    }
}
