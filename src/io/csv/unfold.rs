//! Tables with a row for each joint, side by side.

use std::path::Path;

use super::{Layout, by_place, value};
use crate::io::IoError;

/// Columns with their names.
type Columns = Vec<(String, Vec<f64>)>;

/// Rows that say whether a table has a row for each joint.
const LOOKED_AT: usize = 64;
/// The most joints of a robot that a log tells apart.
const JOINTS: usize = 16;

/// The columns of a table that has a row for each joint, with the name of the joint in a column of text, one
/// for each quantity and joint: `velocity` of `left` becomes `velocity.left`. Rows of one time become one row;
/// what a joint does not have at that time is NaN. A quantity that one joint alone has keeps its name, and one
/// that none has is left out: so are messages of several kinds in one table. `None` for any other table.
///
/// # Errors
/// A file that cannot be read.
pub(in crate::io) fn unfold(path: &Path, layout: &Layout) -> Result<Option<Columns>, IoError> {
    let Some((label, time)) = label_and_time(path, layout)? else { return Ok(None) };
    let texts = by_place(path, layout)?;
    let joints = distinct(texts[label].iter().map(String::as_str));
    if joints.len() > JOINTS {
        return Ok(None);
    }
    let comma = layout.separator != b',';
    let number = |text: &String| value(text, comma).unwrap_or(f64::NAN);
    let mut names = vec![layout.names[time].clone()];
    let quantities: Vec<usize> =
        (0..layout.names.len()).filter(|k| *k != label && *k != time).collect();
    for joint in &joints {
        names.extend(quantities.iter().map(|k| format!("{}.{joint}", layout.names[*k])));
    }
    let mut columns: Vec<Vec<f64>> = vec![vec![]; names.len()];
    for row in 0..texts[time].len() {
        let t = number(&texts[time][row]);
        let joint = joints.iter().position(|j| *j == texts[label][row]).unwrap_or_default();
        let first = 1 + joint * quantities.len();
        // a joint that comes again begins a row of its own, as a log does that has no time between
        let again = columns[first..first + quantities.len()]
            .iter()
            .any(|c| c.last().is_some_and(|x| !x.is_nan()));
        if columns[0].last() != Some(&t) || again {
            columns.iter_mut().for_each(|c| c.push(f64::NAN));
            if let Some(last) = columns[0].last_mut() {
                *last = t;
            }
        }
        for (column, k) in columns[first..].iter_mut().zip(&quantities) {
            if let Some(last) = column.last_mut() {
                *last = number(&texts[*k][row]);
            }
        }
    }
    let columns: Columns = names.into_iter().zip(columns).collect();
    let quantities: Vec<&String> = quantities.iter().map(|k| &layout.names[*k]).collect();
    Ok(Some(with_numbers(columns, &quantities)))
}

/// The columns that hold numbers, behind the first, which is the time. One joint is behind the other, and each has
/// these quantities in order.
fn with_numbers(columns: Columns, quantities: &[&String]) -> Columns {
    if quantities.is_empty() {
        return columns;
    }
    let is_filled = |(_, values): &(String, Vec<f64>)| values.iter().any(|x| !x.is_nan());
    let filled: Vec<bool> = columns.iter().map(is_filled).collect();
    let joints_with = |quantity: usize| {
        filled.iter().skip(1 + quantity).step_by(quantities.len()).filter(|f| **f).count()
    };
    let numbered = columns.into_iter().enumerate().filter(|(k, _)| *k == 0 || filled[*k]);
    numbered
        .map(|(k, (name, values))| {
            let quantity = k.saturating_sub(1) % quantities.len();
            let alone = k > 0 && joints_with(quantity) == 1;
            (if alone { quantities[quantity].clone() } else { name }, values)
        })
        .collect()
}

/// Places of the names of joints and of the time: the one column of text, of two to [`JOINTS`] words that
/// come again, and the first that never falls and changes. Joints differ from the row before in
/// at least half of the rows; the state of a robot stays for many.
fn label_and_time(path: &Path, layout: &Layout) -> Result<Option<(usize, usize)>, IoError> {
    let comma = layout.separator != b',';
    let head: Vec<Vec<String>> = super::rows(path)?
        .take(LOOKED_AT)
        .map(|(_, _, line)| {
            super::split(&String::from_utf8_lossy(&line), char::from(layout.separator))
        })
        .collect();
    let cells = |k: usize| head.iter().map(move |row| row.get(k).map_or("", |cell| cell.trim()));
    let text = |k: &usize| cells(*k).all(|c| !c.is_empty() && value(c, comma).is_none());
    let comes_again = |k: &usize| {
        let words = distinct(cells(*k)).len();
        (2..=JOINTS).contains(&words) && 2 * words <= head.len()
    };
    let mut labels = (0..layout.names.len()).filter(|k| text(k) && comes_again(k));
    let (Some(label), None) = (labels.next(), labels.next()) else { return Ok(None) };
    let rises = |k: &usize| {
        let values: Option<Vec<f64>> = cells(*k).map(|c| value(c, comma)).collect();
        values.is_some_and(|v| v.windows(2).all(|w| w[1] >= w[0]) && v[0] < v[v.len() - 1])
    };
    let Some(time) = (0..layout.names.len()).find(rises) else { return Ok(None) };
    let labels: Vec<&str> = cells(label).collect();
    let changes = labels.windows(2).filter(|w| w[0] != w[1]).count();
    let alternates = 2 * changes >= labels.len().saturating_sub(1);
    Ok(alternates.then_some((label, time)))
}

fn distinct<'a>(texts: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut out: Vec<String> = vec![];
    for text in texts {
        if out.len() <= JOINTS && !out.iter().any(|o| o == text) {
            out.push(text.into());
        }
    }
    out
}
