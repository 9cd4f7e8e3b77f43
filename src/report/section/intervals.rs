//! When the residual torque is far above its usual size: a wheel that was held, a push, a floor bump, a motor that was
//! switched off.

use crate::compare::Interval;
use crate::report::block::{Cell, Column, Table};
use crate::report::format;
use crate::report::section::words;
use crate::study::{Events, Study};

/// Largest number of intervals that are listed.
const MOST: usize = 5;

/// The [`Events`] of the verdict with the largest residual torque, in the order of their recordings. `None` where there
/// are none, and unless the verdict states a dependence.
pub(super) fn intervals(study: &Study) -> Option<Table> {
    let Events { intervals, names } =
        study.diagnosis.as_ref()?.dependence.as_ref()?.events.as_ref()?;
    let mut found = intervals.clone();
    found.sort_by(|a, b| b.torque.abs().total_cmp(&a.torque.abs()));
    found.truncate(MOST);
    found.sort_by(|a, b| a.recording.cmp(&b.recording).then(a.from.total_cmp(&b.from)));
    Some(table(&found, names, study.drive_unit.symbol()))
}

fn table(found: &[Interval], names: &[String], unit: &'static str) -> Table {
    let columns = vec![
        Column::text("Recording"),
        Column::text("Wheel"),
        Column::number("From", "s"),
        Column::number("To", "s"),
        Column::number("Residual torque, mean", unit),
    ];
    let caption = "When the residual torque is largest: seconds whose mean is larger than any stationary noise explains. \
                   Something acted on the robot then (a push, a wheel that was held, a bump, another load), or the recorded \
                   input did not reach the motors.";
    let mut table = Table::new(caption.to_owned(), columns);
    for Interval { recording, wheel, from, to, torque, .. } in found {
        let time = |v: f64| Cell::formatted(format!("{v:.1}"), v);
        table.push(vec![
            Cell::text(names[*recording].clone()),
            Cell::text(words::WHEELS[*wheel].to_owned()),
            time(*from),
            time(*to),
            Cell::formatted(format::significant(*torque, 2), *torque),
        ]);
    }
    table
}
