//! Columns of a block of rows as channels, in the units of the contract.

use std::borrow::Cow;
use std::path::Path;

use polars::prelude::{DataFrame, DataType, PolarsError};

use super::super::csv;
use super::super::error::format_error;
use super::super::{ColumnMap, IoError};
use super::direction::{SIGNS, give_sign};
use super::fraction::in_seconds;
use super::header::conversion;
use super::sum;
use crate::recording::{Channels, Factor};

/// The part of a time that is written as seconds and nanoseconds.
pub(super) const NANOSECONDS: &str = "t.nanoseconds";
/// The columns that multiply the inputs, with their inputs.
pub(super) const FACTORS: [(&str, &str); 2] = [("M1.times", "M1"), ("M2.times", "M2")];

/// A time beyond this is that of a calendar and not of the recording \[s\].
const CALENDAR: f64 = 1e6;

/// Where a block of rows stands in its file.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::io) struct Place {
    /// Rows before it.
    pub(in crate::io) first: usize,
    /// Time of the first row of all, where that is the start of a calendar.
    start: f64,
    /// Time of the last row before it, where the file has steps in place of times.
    passed: f64,
}

impl Place {
    /// Times of a calendar, `factor` seconds each, from the first row of all on.
    fn count_from_start(&mut self, times: &mut [f64], factor: f64) {
        // a row without a time may come first
        let start = times.iter().copied().find(|t| t.is_finite()).unwrap_or_default();
        if self.first == 0 && (factor * start).abs() > CALENDAR {
            self.start = start;
        }
        if self.start != 0.0 {
            times.iter_mut().for_each(|t| *t -= self.start);
        }
    }

    /// Times from steps \[s\]; a row without a step is one without a time.
    fn add_steps(&mut self, steps: &mut [f64]) {
        for t in steps {
            self.passed += if t.is_finite() { *t } else { 0.0 };
            *t = if t.is_finite() { self.passed } else { f64::NAN };
        }
    }
}

/// The columns of a block of rows, in the units of the contract, and the factors of the inputs.
pub(in crate::io) fn channels(
    path: &Path,
    columns: &ColumnMap,
    wanted: &[(&'static str, String)],
    frame: &DataFrame,
    place: &mut Place,
) -> Result<(Channels, [Option<Factor>; 2]), IoError> {
    let mut factors = [None, None];
    let rows = place.first..place.first + frame.height();
    let part = wanted.iter().find(|(k, _)| *k == NANOSECONDS);
    let part = part
        .map(|(_, name)| {
            let part = numbers(path, frame, name, place.first)?;
            Ok(in_seconds(name, part.into_owned()))
        })
        .transpose()?;
    let mut one = |key: &str| -> Result<Option<Cow<[f64]>>, IoError> {
        let Some((_, name)) = wanted.iter().find(|(k, _)| *k == key) else { return Ok(None) };
        let (factor, offset) = conversion(path, columns, key, name)?;
        let mut values = numbers(path, frame, name, place.first)?;
        for other in sum::columns_of(key, wanted) {
            // another controller may write in rows of its own
            let others = held(numbers(path, frame, other, place.first)?);
            values.to_mut().iter_mut().zip(others).for_each(|(x, other)| *x += other);
        }
        if key == "t" && !columns.get("t").sum {
            place.count_from_start(values.to_mut(), factor);
        }
        if (factor, offset) != (1.0, 0.0) {
            values.to_mut().iter_mut().for_each(|x| *x = factor * *x + offset);
        }
        if key == "t" && columns.get("t").sum {
            place.add_steps(values.to_mut());
        }
        if let (Some(part), "t") = (&part, key) {
            values.to_mut().iter_mut().zip(part).for_each(|(t, part)| *t += part);
        }
        let sign = SIGNS.iter().find(|(_, of)| *of == key).map(|(sign, _)| sign);
        if let Some((_, name)) = wanted.iter().find(|(k, _)| Some(k) == sign) {
            let directions = numbers(path, frame, name, place.first)?;
            let signed = (key, columns.get(key));
            give_sign(path, signed, values.to_mut(), &directions, place.first)?;
        }
        let wheel = FACTORS.iter().position(|(_, input)| *input == key);
        let factor = wheel.map(|wheel| FACTORS[wheel].0);
        if let (Some(wheel), Some((_, name))) =
            (wheel, wanted.iter().find(|(k, _)| Some(*k) == factor))
        {
            let by = held(numbers(path, frame, name, place.first)?);
            let input = values.to_vec();
            values.to_mut().iter_mut().zip(&by).for_each(|(x, by)| *x *= by);
            factors[wheel] = Some(Factor { values: by, input });
        }
        Ok(Some(values))
    };
    let pair = |a: Option<Cow<[f64]>>, b: Option<Cow<[f64]>>| {
        a.zip(b).map(|(a, b)| a.iter().zip(b.iter()).map(|(a, b)| [*a, *b]).collect::<Vec<_>>())
    };
    let channels = Channels {
        t: match columns.get("t").period {
            Some(period) => rows.map(|row| period * row as f64).collect(),
            None => one("t")?.unwrap_or_default().into_owned(),
        },
        alpha: pair(one("alpha1")?, one("alpha2")?),
        omega: pair(one("dalpha1")?, one("dalpha2")?),
        torque: pair(one("M1")?, one("M2")?).unwrap_or_default(),
    };
    Ok((channels, factors))
}

/// The values with the last one in place of those that are missing: the battery is measured more slowly than
/// the wheels. Before the first there is the first.
fn held(values: Cow<[f64]>) -> Vec<f64> {
    let mut values = values.into_owned();
    let mut last = values.iter().copied().find(|x| x.is_finite()).unwrap_or(f64::NAN);
    for x in &mut values {
        last = if x.is_finite() { *x } else { last };
        *x = last;
    }
    values
}

/// A column of a frame, after so many rows, as numbers; a file of Parquet may hold whole numbers or text. Plain numbers
/// are not copied.
fn numbers<'f>(
    path: &Path,
    frame: &'f DataFrame,
    name: &str,
    before: usize,
) -> Result<Cow<'f, [f64]>, IoError> {
    let wrong = |e: PolarsError| format_error(path, "table", &e);
    let broken =
        |k: usize, text: &str| IoError::not_a_number(path, before + k + 1, None, name, text);
    let column = frame.column(name).map_err(wrong)?;
    if matches!(column.dtype(), DataType::String) {
        let cells = column.str().map_err(wrong)?.iter().map(Option::unwrap_or_default);
        let cells = cells.enumerate();
        return cells
            .map(|(k, c)| csv::value(c, csv::Style::Either).ok_or_else(|| broken(k, c)))
            .collect();
    }
    if let Ok(Ok(plain)) = column.f64().map(|values| values.cont_slice()) {
        return Ok(plain.into());
    }
    let column = column.cast(&DataType::Float64).map_err(wrong)?.rechunk();
    let values = column.f64().map_err(wrong)?;
    let all = values.cont_slice().map(<[f64]>::to_vec);
    Ok(all.unwrap_or_else(|_| values.iter().map(|v| v.unwrap_or(f64::NAN)).collect()).into())
}
