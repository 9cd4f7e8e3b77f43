//! Recordings from files and from tables in memory.

use std::path::PathBuf;

use amigo_ident::experiment::{MeasuredRecording, Reading, Unread, robot_of};
use amigo_ident::recording::DriveUnit;
use amigo_ident::study::Role;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::array;
use crate::error::{internal, raise, table, wrong};

/// A checked recording, and where it comes from: beside others of its logger it is read again where they show more.
#[pyclass(frozen)]
pub(crate) struct Recording {
    pub(crate) measured: MeasuredRecording,
    pub(crate) unread: Unread,
}

impl Recording {
    fn of(py: Python<'_>, unread: Unread) -> PyResult<Self> {
        let measured = py.allow_threads(|| unread.read(Role::Train)).map_err(|e| raise(&e))?;
        Ok(Self { measured, unread })
    }
}

fn unit(text: &str) -> PyResult<DriveUnit> {
    let all = [DriveUnit::NewtonMetre, DriveUnit::Volt, DriveUnit::Ampere];
    all.into_iter()
        .find(|unit| unit.symbol() == text)
        .ok_or_else(|| wrong(&format!("drive_unit = {text:?}; expected \"N m\", \"V\" or \"A\"")))
}

fn reading(columns: &str, drive_unit: &str, robot: &str, conditioning: &str) -> PyResult<Reading> {
    let robot = robot_of(&table(robot)?).map_err(|e| raise(&e))?;
    let reading = Reading::new(robot, unit(drive_unit)?);
    let reading = reading.with_columns(&table(columns)?).map_err(|e| raise(&e))?;
    reading.with_conditioning(&table(conditioning)?).map_err(|e| raise(&e))
}

#[pymethods]
impl Recording {
    /// Reads a file.
    #[staticmethod]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        columns: &str,
        unit: &str,
        robot: &str,
        conditioning: &str,
    ) -> PyResult<Self> {
        Self::of(py, Unread::file(reading(columns, unit, robot, conditioning)?, &path))
    }

    /// Takes the columns that are needed of a table: `fetch(name)` gives one as the bytes of an array of float64.
    #[staticmethod]
    #[expect(clippy::too_many_arguments, reason = "the keywords of Python")]
    fn of_table(
        py: Python<'_>,
        name: &str,
        names: Vec<String>,
        fetch: &Bound<'_, PyAny>,
        columns: &str,
        unit: &str,
        robot: &str,
        conditioning: &str,
    ) -> PyResult<Self> {
        let reading = reading(columns, unit, robot, conditioning)?;
        let needed = reading.needed(name, &names).map_err(|e| raise(&e))?;
        let mut values = Vec::with_capacity(needed.len());
        for column in needed {
            let bytes = fetch.call1((&column,))?.downcast_into::<PyBytes>()?;
            values.push((column, array::values(bytes.as_bytes())?));
        }
        Self::of(py, Unread::table(reading, name, values))
    }

    #[getter]
    fn name(&self) -> &str {
        self.measured.recording.name()
    }

    #[getter]
    fn drive_unit(&self) -> &'static str {
        self.measured.recording.drive_unit().symbol()
    }

    #[getter]
    fn duration(&self) -> f64 {
        self.measured.duration()
    }

    #[getter]
    fn samples(&self) -> usize {
        self.measured.samples()
    }

    #[getter]
    fn sha256(&self) -> Option<&str> {
        self.measured.sha256.as_deref()
    }

    #[getter]
    fn findings(&self) -> Vec<String> {
        let corrected = self.measured.conditioning.iter().map(ToString::to_string);
        corrected.chain(self.measured.findings.iter().map(ToString::to_string)).collect()
    }

    fn t<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        array::bytes(py, self.measured.recording.t().iter().copied())
    }

    fn alpha<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        array::pairs(py, self.measured.recording.alpha())
    }

    fn dalpha<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        array::pairs(py, self.measured.recording.omega())
    }

    fn input<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        array::pairs(py, self.measured.recording.torque())
    }

    /// Standard deviations of the measurement noise as JSON.
    fn noise(&self) -> PyResult<String> {
        serde_json::to_string(&self.measured.recording.noise()).map_err(internal)
    }
}
