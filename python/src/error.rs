//! Errors of the library as Python exceptions, with the same words.

use amigo_ident::experiment::{ExperimentError, RunError};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyType;
use serde::Serialize;

/// The exception of the error: `ColumnError`, `InputError` or `RunError`.
pub(crate) fn raise(error: &ExperimentError) -> PyErr {
    let class = match error {
        _ if error.is_missing_column() => "ColumnError",
        _ if error.is_wrong_input() => "InputError",
        _ => "RunError",
    };
    exception(class, &error.to_string())
}

/// What went wrong in a run.
pub(crate) fn failed(error: &RunError) -> PyErr {
    exception("RunError", &error.to_string())
}

/// What is wrong with an argument.
pub(crate) fn wrong(message: &str) -> PyErr {
    exception("InputError", message)
}

/// What cannot happen with values that the library made itself.
pub(crate) fn internal(error: impl std::fmt::Display) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}

fn exception(name: &str, message: &str) -> PyErr {
    Python::with_gil(|py| {
        let class = || -> PyResult<Bound<'_, PyType>> {
            Ok(py.import("amigo_ident._errors")?.getattr(name)?.downcast_into::<PyType>()?)
        };
        class().map_or_else(|e| e, |class| PyErr::from_type(class, message.to_owned()))
    })
}

pub(crate) fn json(value: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(internal)
}

/// A table of settings that Python wrote as JSON.
pub(crate) fn table(json: &str) -> PyResult<toml::Table> {
    serde_json::from_str(json).map_err(|e| wrong(&e.to_string()))
}
