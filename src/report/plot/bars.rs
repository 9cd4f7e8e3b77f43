//! Bars over categories, from top to bottom.

use crate::report::ReportError;
use crate::report::figure::{Bars, Panel};
use crate::report::palette::{AXIS, ColourRole, INK, SURFACE};
use crate::report::polyline::Rect;

use super::canvas::Canvas;
use super::pen::{Anchor, LEGEND};
use super::plan::Frame;

/// Share of a category that its bars fill.
const FILLED: f64 = 0.68;

/// The height of one bar \[px\].
struct Place {
    top: f64,
    bottom: f64,
}

pub(super) fn draw(canvas: &Canvas<'_>, bars: &Bars, frame: &Frame) -> Result<(), ReportError> {
    for (s, series) in bars.series.iter().enumerate() {
        for (i, value) in series.values.iter().enumerate().take(bars.categories.len()) {
            let place = place(bars, frame, s, i);
            let role = if bars.highlight == Some(i) { ColourRole::Highlight } else { series.role };
            bar(canvas, frame, &place, *value, role)?;
            whisker(canvas, frame, &place, series.intervals.get(i).copied())?;
        }
    }
    let zero = along(frame, 0.0);
    canvas.line(&[(zero, frame.rect.top), (zero, frame.rect.bottom)], AXIS, 1.0, 1.0)
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
            let ends: Vec<f64> = ends.map(|v| along(frame, v)).collect();
            value_text(canvas, frame, &place(bars, frame, s, i), &ends, text)?;
        }
    }
    Ok(())
}

fn place(bars: &Bars, frame: &Frame, series: usize, category: usize) -> Place {
    let count = bars.series.len().max(1) as f64;
    let across = |share: f64| frame.y(category as f64 + 0.5 + FILLED * (share / count - 0.5));
    let (a, b) = (across(series as f64), across(series as f64 + 1.0));
    // a small gap between bars of one category
    let sliver = if count > 1.0 { 0.5 } else { 0.0 };
    Place { top: a.min(b) + sliver, bottom: a.max(b) - sliver }
}

/// Position of a value along the bars, within the plot; values that a log axis cannot represent are at its
/// start.
fn along(frame: &Frame, value: f64) -> f64 {
    let (rect, x) = (frame.rect, frame.x(value));
    if x.is_nan() { rect.left } else { x.clamp(rect.left, rect.right) }
}

fn bar(
    canvas: &Canvas<'_>,
    frame: &Frame,
    place: &Place,
    value: f64,
    role: ColourRole,
) -> Result<(), ReportError> {
    if value.is_nan() {
        return Ok(());
    }
    let (from, to) = (along(frame, 0.0), along(frame, value));
    let rect =
        Rect { left: from.min(to), right: from.max(to), top: place.top, bottom: place.bottom };
    canvas.rectangle(rect, role.color(), 1.0)
}

fn whisker(
    canvas: &Canvas<'_>,
    frame: &Frame,
    place: &Place,
    interval: Option<(f64, f64)>,
) -> Result<(), ReportError> {
    let Some((lower, upper)) = interval.filter(|(l, u)| !l.is_nan() && !u.is_nan()) else {
        return Ok(());
    };
    let middle = (place.top + place.bottom) / 2.0;
    let cap = (0.3 * (place.bottom - place.top)).min(4.0);
    let (from, to) = (along(frame, lower), along(frame, upper));
    canvas.line(&[(from, middle), (to, middle)], INK, 1.3, 1.0)?;
    for (end, value) in [(from, lower), (to, upper)] {
        // an interval that is cut at the edge has no end there
        if value.is_finite() && (frame.x(value) - end).abs() < 1.0 {
            canvas.line(&[(end, middle - cap), (end, middle + cap)], INK, 1.3, 1.0)?;
        }
    }
    Ok(())
}

/// Text after the far end of the bar and its whisker, on a background strip.
fn value_text(
    canvas: &Canvas<'_>,
    frame: &Frame,
    place: &Place,
    ends: &[f64],
    text: &str,
) -> Result<(), ReportError> {
    if text.is_empty() {
        return Ok(());
    }
    let middle = (place.top + place.bottom) / 2.0;
    let end = ends.iter().copied().fold(along(frame, 0.0), f64::max);
    let left = (end + 6.0).min(frame.cell.right - LEGEND.width(text));
    let baseline = middle + LEGEND.half_capital();
    let paper = Rect {
        left: left - 2.0,
        right: left + LEGEND.width(text) + 2.0,
        top: baseline - 0.8 * LEGEND.size,
        bottom: baseline + 0.1 * LEGEND.size,
    };
    canvas.rectangle(paper, SURFACE, 1.0)?;
    canvas.text(text, (left, baseline), Anchor::Start, LEGEND)
}
