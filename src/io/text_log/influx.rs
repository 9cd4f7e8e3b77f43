//! The line protocol of InfluxDB: `motor,side=left rpm=44.1,current=0.5 1718020983000000000`.
//!
//! Source: InfluxDB documentation, line protocol.

use super::lines::Columns;
use super::record::{Pairs, collected, joined};

/// Number of lines from which the format is detected.
const LOOKED_AT: usize = 40;

/// A point: its series, that is the measurement and the values of its tags, its fields, and its time.
struct Point<'a> {
    series: Vec<&'a str>,
    fields: Pairs,
    time: f64,
}

/// Whether the first lines are points, all of them with a time.
pub(super) fn is_one(lines: &[&str]) -> bool {
    let mut held = lines.iter().filter(|line| is_held(line)).take(LOOKED_AT).peekable();
    held.peek().is_some() && held.all(|line| point(line).is_some())
}

fn is_held(line: &str) -> bool {
    !line.trim().is_empty() && !line.starts_with('#')
}

/// A column for each field and series, and the time.
pub(super) fn columns(text: &str) -> Columns {
    let points: Vec<Point> = text.lines().filter(|line| is_held(line)).filter_map(point).collect();
    // what all series have in common distinguishes none
    let is_common = |k: usize| points.iter().all(|p| p.series.get(k) == points[0].series.get(k));
    let rows = points.iter().map(|p| {
        let own =
            p.series.iter().enumerate().filter(|(k, _)| !is_common(*k)).map(|(_, word)| *word);
        let own = own.collect::<Vec<_>>().join(".");
        let name =
            |field: &str| if own.is_empty() { field.into() } else { format!("{own}.{field}") };
        let fields = p.fields.iter().map(|(field, x)| (name(field), *x));
        std::iter::once(("time".to_string(), p.time)).chain(fields).collect()
    });
    collected(joined(rows))
}

fn point(line: &str) -> Option<Point<'_>> {
    let mut parts = line.trim().split(' ');
    let (series, fields, time) = (parts.next()?, parts.next()?, parts.next()?);
    if parts.next().is_some() || time.len() < 10 || !time.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let mut tags = series.split(',');
    let measurement = tags.next().filter(|name| !name.contains('='))?;
    let tags: Option<Vec<&str>> = tags.map(|tag| Some(tag.split_once('=')?.1)).collect();
    let series = std::iter::once(measurement).chain(tags?).collect();
    let mut numbers = vec![];
    for field in fields.split(',') {
        let (name, text) = field.split_once('=')?;
        // whole numbers end in i or u; words and truth values are left out
        let text = text.strip_suffix(['i', 'u']).unwrap_or(text);
        numbers.extend(text.parse().ok().map(|x| (name.to_string(), x)));
    }
    Some(Point { series, fields: numbers, time: time.parse().ok()? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_several_series_stand_in_one_row() {
        let line = |k: u32, side: &str| {
            format!(
                "motor,robot=a,side={side} rpm={k}.5,n={k}i,state=\"on\" 17180209830{k:02}000000\n"
            )
        };
        let text: String = (0..9).flat_map(|k| [line(k, "left"), line(k, "right")]).collect();
        assert!(is_one(&text.lines().collect::<Vec<_>>()));
        let found = columns(&text);
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["time", "left.rpm", "left.n", "right.rpm", "right.n"]);
        assert_eq!((found[3].1.len(), found[3].1[4]), (9, 4.5));
        for other in ["a b c", "l=1 r=2 3", "a,b 1 1718020983000", ""] {
            assert!(!is_one(&[other]), "{other}");
        }
    }
}
