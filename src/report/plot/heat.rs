//! Heat maps and their colour bar.

use crate::report::ReportError;
use crate::report::figure::{ColorMap, HeatMap};
use crate::report::palette::{AXIS, CELL_EMPTY, MUTED, Rgb, diverging, sequential, text_on};
use crate::report::polyline::Rect;
use crate::report::scale::Scale;

use super::canvas::Canvas;
use super::colour_scale::scale;
use super::pen::{Anchor, Pen, TICK_LABEL};
use super::plan::Frame;

/// Cells overlap later neighbours by a pixel: otherwise anti-aliasing would show a seam.
const OVERLAP: f64 = 1.0;

fn color(map: &HeatMap, share: f64) -> Rgb {
    match map.colors {
        ColorMap::Diverging => diverging(2.0 * share - 1.0),
        ColorMap::Sequential => sequential(share),
    }
}

pub(super) fn draw(canvas: &Canvas<'_>, map: &HeatMap, frame: &Frame) -> Result<(), ReportError> {
    let scale = scale(map);
    for row in 0..map.rows.len() {
        for column in 0..map.columns.len() {
            let value = map.values.get(row).and_then(|values| values.get(column));
            let text = map.text.get(row).and_then(|texts| texts.get(column));
            let rect = Rect {
                left: frame.x(column as f64),
                right: frame.x(column as f64 + 1.0),
                top: frame.y(row as f64),
                bottom: frame.y(row as f64 + 1.0),
            };
            let value = value.copied().unwrap_or(f64::NAN);
            let overlap = |more: bool| if more { OVERLAP } else { 0.0 };
            let covered = Rect {
                right: rect.right + overlap(column + 1 < map.columns.len()),
                bottom: rect.bottom + overlap(row + 1 < map.rows.len()),
                ..rect
            };
            let fill = scale.share(value);
            let fill = if fill.is_nan() { CELL_EMPTY } else { color(map, fill) };
            canvas.rectangle(covered, fill, 1.0)?;
            cell_text(canvas, rect, fill, text.map_or("", String::as_str))?;
        }
    }
    color_bar(canvas, map, &scale, frame)
}

fn cell_text(canvas: &Canvas<'_>, rect: Rect, fill: Rgb, text: &str) -> Result<(), ReportError> {
    let size = (0.55 * rect.height()).clamp(8.0, 12.0);
    let pen = Pen::new(size, text_on(fill));
    if pen.width(text) + 4.0 > rect.width() || size + 2.0 > rect.height() {
        return Ok(());
    }
    let middle = ((rect.left + rect.right) / 2.0, (rect.top + rect.bottom) / 2.0);
    canvas.text(text, (middle.0, middle.1 + pen.half_capital()), Anchor::Middle, pen)
}

fn color_bar(
    canvas: &Canvas<'_>,
    map: &HeatMap,
    scale: &Scale,
    frame: &Frame,
) -> Result<(), ReportError> {
    const STEPS: usize = 64;
    let height = frame.rect.height().min(220.0);
    let bar = Rect {
        left: frame.rect.right + 16.0,
        right: frame.rect.right + 28.0,
        top: frame.rect.top,
        bottom: frame.rect.top + height,
    };
    let step = height / STEPS as f64;
    for i in 0..STEPS {
        let top = bar.top + i as f64 * step;
        let overlap = if i + 1 < STEPS { OVERLAP } else { 0.0 };
        let slice = Rect { top, bottom: top + step + overlap, ..bar };
        canvas.rectangle(slice, color(map, 1.0 - (i as f64 + 0.5) / STEPS as f64), 1.0)?;
    }
    let ticks = scale.ticks((height / 40.0).clamp(2.0, 6.0));
    for tick in ticks.ticks {
        let y = bar.bottom - scale.share(tick.at) * height;
        canvas.line(&[(bar.right, y), (bar.right + 4.0, y)], AXIS, 1.0, 1.0)?;
        let at = (bar.right + 7.0, y + TICK_LABEL.half_capital());
        canvas.text(&tick.label, at, Anchor::Start, TICK_LABEL.with_color(MUTED))?;
    }
    Ok(())
}
