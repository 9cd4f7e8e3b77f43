//! Bars over categories.

use crate::report::ReportError;
use crate::report::figure::{Bars, Direction};
use crate::report::palette::{INK, Role};
use crate::report::polyline::{Rect, clip_line};

use super::canvas::Canvas;
use super::pen::{Anchor, LEGEND};
use super::plan::Frame;

/// Share of a category that its bars fill.
const FILLED: f64 = 0.68;

/// One bar: across its length from `low` to `high` [px], along it by the frame.
struct Place {
    low: f64,
    high: f64,
}

pub(super) fn draw(canvas: &Canvas<'_>, bars: &Bars, frame: &Frame) -> Result<(), ReportError> {
    let count = bars.series.len().max(1) as f64;
    for (s, series) in bars.series.iter().enumerate() {
        for (i, value) in series.values.iter().enumerate().take(bars.categories.len()) {
            let across = |share: f64| {
                let at = i as f64 + 0.5 + FILLED * (share / count - 0.5);
                if bars.direction == Direction::Horizontal { frame.y(at) } else { frame.x(at) }
            };
            let (a, b) = (across(s as f64), across(s as f64 + 1.0));
            // a sliver of paper between bars of one category
            let sliver = if count > 1.0 { 0.5 } else { 0.0 };
            let place = Place { low: a.min(b) + sliver, high: a.max(b) - sliver };
            let role = if bars.highlight == Some(i) { Role::Highlight } else { series.role };
            let interval = series.intervals.get(i).copied();
            let text = series.text.get(i).map_or("", String::as_str);
            bar(canvas, bars.direction, frame, &place, *value, role)?;
            let end = whisker(canvas, bars.direction, frame, &place, interval)?;
            value_text(canvas, bars.direction, frame, &place, (*value, end), text)?;
        }
    }
    Ok(())
}

/// Place of a value along the bars, within the plot; values a log axis cannot show stand at its start.
fn along(direction: Direction, frame: &Frame, value: f64) -> f64 {
    let rect = frame.rect;
    match direction {
        Direction::Horizontal => {
            let x = frame.x(value);
            if x.is_nan() { rect.left } else { x.clamp(rect.left, rect.right) }
        }
        Direction::Vertical => {
            let y = frame.y(value);
            if y.is_nan() { rect.bottom } else { y.clamp(rect.top, rect.bottom) }
        }
    }
}

fn bar(
    canvas: &Canvas<'_>,
    direction: Direction,
    frame: &Frame,
    place: &Place,
    value: f64,
    role: Role,
) -> Result<(), ReportError> {
    if value.is_nan() {
        return Ok(());
    }
    let (from, to) = (along(direction, frame, 0.0), along(direction, frame, value));
    let (near, far) = (from.min(to), from.max(to));
    let rect = match direction {
        Direction::Horizontal => {
            Rect { left: near, right: far, top: place.low, bottom: place.high }
        }
        Direction::Vertical => Rect { left: place.low, right: place.high, top: near, bottom: far },
    };
    canvas.rectangle(rect, role.color(), 0.88)
}

/// Draws the whisker; returns the place of its outer end.
fn whisker(
    canvas: &Canvas<'_>,
    direction: Direction,
    frame: &Frame,
    place: &Place,
    interval: Option<(f64, f64)>,
) -> Result<Option<f64>, ReportError> {
    let Some((lower, upper)) = interval.filter(|(l, u)| !l.is_nan() && !u.is_nan()) else {
        return Ok(None);
    };
    let middle = (place.low + place.high) / 2.0;
    let cap = (0.3 * (place.high - place.low)).min(4.0);
    let (from, to) = (along(direction, frame, lower), along(direction, frame, upper));
    let turned = |along: f64, across: f64| match direction {
        Direction::Horizontal => (along, across),
        Direction::Vertical => (across, along),
    };
    for part in clip_line(&[turned(from, middle), turned(to, middle)], frame.rect) {
        canvas.line(&part, INK, 1.3, 1.0)?;
    }
    for (end, value) in [(from, lower), (to, upper)] {
        if value.is_finite() {
            canvas.line(&[turned(end, middle - cap), turned(end, middle + cap)], INK, 1.3, 1.0)?;
        }
    }
    Ok(Some(if direction == Direction::Horizontal { from.max(to) } else { from.min(to) }))
}

/// Text behind the end of the bar and its whisker; in front of it where there is no room.
fn value_text(
    canvas: &Canvas<'_>,
    direction: Direction,
    frame: &Frame,
    place: &Place,
    (value, whisker): (f64, Option<f64>),
    text: &str,
) -> Result<(), ReportError> {
    if text.is_empty() {
        return Ok(());
    }
    let middle = (place.low + place.high) / 2.0;
    let zero = along(direction, frame, 0.0);
    let end = if value.is_nan() { zero } else { along(direction, frame, value) };
    match direction {
        Direction::Horizontal => {
            let end = end.max(zero).max(whisker.unwrap_or(end));
            let x = (end + 6.0).min(frame.cell.right - LEGEND.width(text));
            canvas.text(text, (x, middle + LEGEND.half_capital()), Anchor::Start, LEGEND)
        }
        Direction::Vertical => {
            let end = end.min(zero).min(whisker.unwrap_or(end));
            let y = (end - 5.0).max(frame.rect.top + LEGEND.size);
            let text = LEGEND.shorten(text, 1.4 * (place.high - place.low));
            canvas.text(&text, (middle, y), Anchor::Middle, LEGEND)
        }
    }
}
