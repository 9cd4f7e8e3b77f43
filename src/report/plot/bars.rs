//! Bars over categories.

use crate::report::ReportError;
use crate::report::figure::{Bars, Direction, Panel};
use crate::report::palette::{AXIS, INK, Role, SURFACE};
use crate::report::polyline::Rect;

use super::canvas::Canvas;
use super::pen::{Anchor, LEGEND};
use super::plan::Frame;

/// Share of a category that its bars fill.
const FILLED: f64 = 0.68;

/// One bar: across its length from `low` to `high` \[px\], along it by the frame.
struct Place {
    low: f64,
    high: f64,
}

pub(super) fn draw(canvas: &Canvas<'_>, bars: &Bars, frame: &Frame) -> Result<(), ReportError> {
    for (s, series) in bars.series.iter().enumerate() {
        for (i, value) in series.values.iter().enumerate().take(bars.categories.len()) {
            let place = place(bars, frame, s, i);
            let role = if bars.highlight == Some(i) { Role::Highlight } else { series.role };
            bar(canvas, bars.direction, frame, &place, *value, role)?;
            whisker(canvas, bars.direction, frame, &place, series.intervals.get(i).copied())?;
        }
    }
    let (rect, zero) = (frame.rect, along(bars.direction, frame, 0.0));
    let foot = match bars.direction {
        Direction::Horizontal => [(zero, rect.top), (zero, rect.bottom)],
        Direction::Vertical => [(rect.left, zero), (rect.right, zero)],
    };
    canvas.line(&foot, AXIS, 1.0, 1.0)
}

/// The texts at the ends of the bars, above everything else.
pub(super) fn value_texts(
    canvas: &Canvas<'_>,
    panel: &Panel,
    frame: &Frame,
) -> Result<(), ReportError> {
    let Some(bars) = super::plan::bars(panel) else { return Ok(()) };
    for (s, series) in bars.series.iter().enumerate() {
        for (i, text) in series.text.iter().enumerate().take(bars.categories.len()) {
            let value = series.values.get(i).copied().unwrap_or(f64::NAN);
            let whisker = series.intervals.get(i).copied().unwrap_or((value, value));
            let ends = [value, whisker.0, whisker.1].into_iter().filter(|v| !v.is_nan());
            let ends: Vec<f64> = ends.map(|v| along(bars.direction, frame, v)).collect();
            value_text(canvas, bars.direction, frame, &place(bars, frame, s, i), &ends, text)?;
        }
    }
    Ok(())
}

fn place(bars: &Bars, frame: &Frame, series: usize, category: usize) -> Place {
    let count = bars.series.len().max(1) as f64;
    let across = |share: f64| {
        let at = category as f64 + 0.5 + FILLED * (share / count - 0.5);
        if bars.direction == Direction::Horizontal { frame.y(at) } else { frame.x(at) }
    };
    let (a, b) = (across(series as f64), across(series as f64 + 1.0));
    // a sliver of paper between bars of one category
    let sliver = if count > 1.0 { 0.5 } else { 0.0 };
    Place { low: a.min(b) + sliver, high: a.max(b) - sliver }
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
    canvas.rectangle(rect, role.color(), 1.0)
}

fn whisker(
    canvas: &Canvas<'_>,
    direction: Direction,
    frame: &Frame,
    place: &Place,
    interval: Option<(f64, f64)>,
) -> Result<(), ReportError> {
    let Some((lower, upper)) = interval.filter(|(l, u)| !l.is_nan() && !u.is_nan()) else {
        return Ok(());
    };
    let middle = (place.low + place.high) / 2.0;
    let cap = (0.3 * (place.high - place.low)).min(4.0);
    let (from, to) = (along(direction, frame, lower), along(direction, frame, upper));
    let turned = |along: f64, across: f64| match direction {
        Direction::Horizontal => (along, across),
        Direction::Vertical => (across, along),
    };
    canvas.line(&[turned(from, middle), turned(to, middle)], INK, 1.3, 1.0)?;
    for (end, value) in [(from, lower), (to, upper)] {
        if value.is_finite() {
            canvas.line(&[turned(end, middle - cap), turned(end, middle + cap)], INK, 1.3, 1.0)?;
        }
    }
    Ok(())
}

/// Text behind the far end of the bar and its whisker, on a strip of paper.
fn value_text(
    canvas: &Canvas<'_>,
    direction: Direction,
    frame: &Frame,
    place: &Place,
    ends: &[f64],
    text: &str,
) -> Result<(), ReportError> {
    if text.is_empty() {
        return Ok(());
    }
    let middle = (place.low + place.high) / 2.0;
    let zero = along(direction, frame, 0.0);
    let (text, left, baseline) = match direction {
        Direction::Horizontal => {
            let end = ends.iter().copied().fold(zero, f64::max);
            let x = (end + 6.0).min(frame.cell.right - LEGEND.width(text));
            (text.to_owned(), x, middle + LEGEND.half_capital())
        }
        Direction::Vertical => {
            let end = ends.iter().copied().fold(zero, f64::min);
            let text = LEGEND.shorten(text, 1.4 * (place.high - place.low));
            let x = middle - LEGEND.width(&text) / 2.0;
            (text, x, (end - 5.0).max(frame.rect.top + LEGEND.size))
        }
    };
    let paper = Rect {
        left: left - 2.0,
        right: left + LEGEND.width(&text) + 2.0,
        top: baseline - 0.8 * LEGEND.size,
        bottom: baseline + 0.1 * LEGEND.size,
    };
    canvas.rectangle(paper, SURFACE, 1.0)?;
    canvas.text(&text, (left, baseline), Anchor::Start, LEGEND)
}
