//! Numbers to and from numpy: the bytes of float64 arrays, since the stable interface of Python 3.10 has
//! no buffers.

use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::wrong;

const SIZE: usize = size_of::<f64>();

/// The bytes of an array; `numpy.frombuffer` makes the array without a copy.
pub(crate) fn bytes<'py>(
    py: Python<'py>,
    values: impl ExactSizeIterator<Item = f64>,
) -> PyResult<Bound<'py, PyBytes>> {
    PyBytes::new_with(py, SIZE * values.len(), |out| {
        let places = out.chunks_exact_mut(SIZE).zip(values);
        places.for_each(|(place, value)| place.copy_from_slice(&value.to_ne_bytes()));
        Ok(())
    })
}

/// The same of rows of two values, one row after the other.
pub(crate) fn pairs<'py>(py: Python<'py>, rows: &[[f64; 2]]) -> PyResult<Bound<'py, PyBytes>> {
    bytes(py, rows.as_flattened().iter().copied())
}

/// The values of an array's bytes.
pub(crate) fn values(bytes: &[u8]) -> PyResult<Vec<f64>> {
    let chunks = bytes.chunks_exact(SIZE);
    if !chunks.remainder().is_empty() {
        return Err(wrong("expected the bytes of an array of float64"));
    }
    let value = |chunk: &[u8]| chunk.try_into().map_or(f64::NAN, f64::from_ne_bytes);
    Ok(chunks.map(value).collect())
}
