//! `estimates.parquet`: one row per combination, method and parameter.

use crate::io::{IoError, TableColumn, write_parquet_table};
use crate::study::Study;

/// The estimates of a study as a table.
///
/// # Errors
/// If the table cannot be written.
pub(super) fn parquet(study: &Study) -> Result<Vec<u8>, IoError> {
    let (mut method, mut parameter, mut unit, mut status) = (vec![], vec![], vec![], vec![]);
    let (mut value, mut std_error, mut low, mut high) = (vec![], vec![], vec![], vec![]);
    let (mut truth, mut seconds) = (vec![], vec![]);
    for m in &study.methods {
        for e in &m.estimates {
            method.push(m.name.clone());
            parameter.push(e.symbol.clone());
            unit.push(e.unit.clone());
            status.push(m.status.map_or(String::new(), |s| format!("{s:?}")));
            value.push(e.value);
            std_error.push(e.std_error);
            low.push(e.interval.0);
            high.push(e.interval.1);
            let known = study.truth.iter().find(|(s, _)| *s == e.symbol);
            truth.push(known.map_or(f64::NAN, |(_, v)| *v));
            seconds.push(m.seconds);
        }
    }
    let rows = value.len();
    let columns = [
        TableColumn::Text("experiment".into(), vec![study.experiment.clone(); rows]),
        TableColumn::Text("method".into(), method),
        TableColumn::Text("parameter".into(), parameter),
        TableColumn::Text("unit".into(), unit),
        TableColumn::Text("status".into(), status),
        TableColumn::Number("value".into(), value),
        TableColumn::Number("std_error".into(), std_error),
        TableColumn::Number("ci95_low".into(), low),
        TableColumn::Number("ci95_high".into(), high),
        TableColumn::Number("truth".into(), truth),
        TableColumn::Number("seconds".into(), seconds),
    ];
    write_parquet_table(std::path::Path::new("estimates.parquet"), &columns)
}
