//! Experiments: settings and recordings, ready to run.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use amigo_ident::experiment::{self, MethodFit, Unread};
use amigo_ident::simulate::Hold;
use amigo_ident::study::Role;
use pyo3::prelude::*;

use crate::error::{failed, raise, table, wrong};
use crate::fit::Fit;
use crate::recording::Recording;
use crate::study::Study;

/// An experiment ready to run.
#[pyclass(frozen)]
pub(crate) struct Plan {
    pub(crate) plan: Arc<experiment::Plan>,
}

fn hold(text: &str) -> PyResult<Hold> {
    match text {
        "linear" => Ok(Hold::Linear),
        "constant" => Ok(Hold::Constant),
        _ => Err(wrong(&format!(
            "hold = {text:?}; expected \"linear\" or \"constant\", or None to leave it to the data"
        ))),
    }
}

#[pymethods]
impl Plan {
    /// Settings as JSON, with the keys of an experiment file, on recordings.
    #[new]
    fn new(
        py: Python<'_>,
        name: &str,
        keys: &str,
        train: Vec<Py<Recording>>,
        validation: Vec<Py<Recording>>,
        hold: Option<&str>,
    ) -> PyResult<Self> {
        let measured = |(role, r): (Role, &Py<Recording>)| experiment::MeasuredRecording {
            role,
            ..r.get().measured.clone()
        };
        let train = train.iter().map(|r| (Role::Train, r));
        let all: Vec<_> = train.chain(validation.iter().map(|r| (Role::Validation, r))).collect();
        let unread: Vec<&Unread> = all.iter().map(|(_, r)| &r.get().unread).collect();
        let measured: Vec<_> = all.iter().copied().map(measured).collect();
        let (keys, hold) = (table(keys)?, hold.map(self::hold).transpose()?);
        let plan = py.allow_threads(|| {
            experiment::plan_of(name, &keys, experiment::together(&unread, measured)?, hold)
        });
        Ok(Self { plan: Arc::new(plan.map_err(|e| raise(&e))?) })
    }

    /// Recordings whose columns are found out by names and values.
    #[staticmethod]
    fn of_recordings(py: Python<'_>, paths: Vec<PathBuf>, set: Vec<String>) -> PyResult<Self> {
        let plan = py.allow_threads(|| experiment::load_recordings(&paths, &set));
        Ok(Self { plan: Arc::new(plan.map_err(|e| raise(&e))?) })
    }

    /// An experiment file with overrides.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf, set: Vec<String>) -> PyResult<Self> {
        let plan = py.allow_threads(|| experiment::load(&path, &set)).map_err(|e| raise(&e))?;
        if plan.grid.is_some() {
            let message =
                "has a [grid]: run it with the command `experiment`, whose parts can be resumed";
            return Err(wrong(&format!("{}: {message}", path.display())));
        }
        Ok(Self { plan: Arc::new(plan) })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.plan.name
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.plan.warnings()
    }

    #[getter]
    fn has_diagnosis(&self) -> bool {
        self.plan.diagnosis.is_some()
    }

    /// The fit of its first method.
    fn fit(&self, py: Python<'_>) -> PyResult<Fit> {
        let made = py.allow_threads(|| experiment::fits(&self.plan));
        match made.into_iter().next() {
            Some(MethodFit { fit: Ok(fit), seconds }) => {
                Ok(Fit { fit, seconds, hold: self.plan.hold })
            }
            Some(MethodFit { fit: Err(reason), .. }) => {
                Err(failed(&experiment::RunError::NoFit(vec![reason])))
            }
            None => Err(wrong("no method is given")),
        }
    }

    /// The fit of its first method set against its recordings.
    fn compare(&self, py: Python<'_>, fit: &Fit) -> PyResult<Study> {
        let fits = [MethodFit { fit: Ok(fit.fit.clone()), seconds: fit.seconds }];
        let study = py.allow_threads(|| {
            experiment::study(&self.plan, experiment::compare(&self.plan, &fits)?.into())
        });
        Ok(Study { plan: self.plan.clone(), study: study.map_err(|e| failed(&e))? })
    }

    /// Fits, compares and diagnoses.
    fn run(&self, py: Python<'_>) -> PyResult<Study> {
        let study = py.allow_threads(|| experiment::run(&self.plan)).map_err(|e| failed(&e))?;
        Ok(Study { plan: self.plan.clone(), study })
    }

    /// Writes the result folder of a study; returns the path of its report.
    fn write(&self, py: Python<'_>, study: &Study, out: PathBuf) -> PyResult<PathBuf> {
        let out: &Path = &out;
        let done = py.allow_threads(|| experiment::write(&self.plan, study.study.clone(), out));
        Ok(done.map_err(|e| raise(&e))?.report)
    }
}
