//! What the Python package `amigo_ident` calls: recordings, plans, fits and studies as opaque objects,
//! settings and tables as JSON, numbers as numpy arrays. Names, units and docstrings are those of the
//! Python files beside it; nothing is computed here.

mod array;
mod error;
mod figure;
mod fit;
mod plan;
mod recording;
mod study;

use pyo3::prelude::*;

use crate::error::json;

/// The catalogue of physical effects as JSON.
#[pyfunction]
fn effects() -> PyResult<String> {
    let one = |effect: Box<dyn amigo_ident::effects::Effect>| {
        let mut entry = serde_json::to_value(effect.description())?;
        entry["parameters"] = serde_json::to_value(effect.parameters())?;
        Ok(entry)
    };
    let all = amigo_ident::effects::all().into_iter().map(one);
    json(&all.collect::<Result<Vec<_>, serde_json::Error>>().map_err(error::internal)?)
}

/// The identification methods as JSON.
#[pyfunction]
fn methods() -> PyResult<String> {
    let one = |method: Box<dyn amigo_ident::identify::Identifier>| {
        let mut entry = serde_json::to_value(method.describe())?;
        entry["options"] = serde_json::to_value(method.options())?;
        Ok(entry)
    };
    let all = amigo_ident::identify::all().into_iter().map(one);
    json(&all.collect::<Result<Vec<_>, serde_json::Error>>().map_err(error::internal)?)
}

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_function(wrap_pyfunction!(effects, module)?)?;
    module.add_function(wrap_pyfunction!(methods, module)?)?;
    module.add_class::<recording::Recording>()?;
    module.add_class::<plan::Plan>()?;
    module.add_class::<fit::Fit>()?;
    module.add_class::<study::Study>()
}
