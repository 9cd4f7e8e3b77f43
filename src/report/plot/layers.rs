//! Lines, dots, bands, shades and whiskers.

use crate::report::ReportError;
use crate::report::figure::{Dash, ErrorBar, Layer};
use crate::report::palette::{ColourRole, Rgb};
use crate::report::polyline::{Point, Rect, clip_line, clip_polygon, decimate, runs, thin_dots};

use super::canvas::Canvas;
use super::pen::{BAND, SHADE};
use super::plan::Frame;
use super::stroke::stroke;

/// Shades lie lowest, bands above them, everything else above both in the given order.
pub(super) fn draw(
    canvas: &Canvas<'_>,
    layers: &[Layer],
    frame: &Frame,
) -> Result<(), ReportError> {
    let mut ordered: Vec<&Layer> = layers.iter().collect();
    ordered.sort_by_key(|layer| layer.height());
    ordered.into_iter().try_for_each(|layer| draw_layer(canvas, layer, frame))
}

fn draw_layer(canvas: &Canvas<'_>, layer: &Layer, frame: &Frame) -> Result<(), ReportError> {
    let rect = frame.rect;
    match layer {
        Layer::Line { points, role, width, dash, .. } => {
            polyline(canvas, points, frame, role.color(), *width, *dash)
        }
        Layer::Points { points, role, radius, alpha, .. } => {
            let places: Vec<Point> =
                points.iter().map(|p| frame.at(*p)).filter(|p| rect.contains(*p)).collect();
            let thinned = if places.len() > 4000 { thin_dots(&places, 1.0) } else { places };
            thinned.iter().try_for_each(|place| canvas.dot(*place, *radius, role.color(), *alpha))
        }
        Layer::Band { x, lower, upper, role, .. } => band(canvas, (x, lower, upper), frame, *role),
        Layer::Bars(bars) => super::bars::draw(canvas, bars, frame),
        Layer::HeatMap(map) => super::heat::draw(canvas, map, frame),
        Layer::HLine { at, role, dash, .. } => {
            let y = frame.y(*at);
            let line = [(rect.left, y), (rect.right, y)];
            inside(y, rect.top, rect.bottom, || stroke(canvas, &line, role.color(), 1.5, *dash))
        }
        Layer::VLine { at, role, dash, .. } => {
            let x = frame.x(*at);
            let line = [(x, rect.top), (x, rect.bottom)];
            inside(x, rect.left, rect.right, || stroke(canvas, &line, role.color(), 1.5, *dash))
        }
        Layer::Shade { ranges, role, .. } => ranges.iter().try_for_each(|(from, to)| {
            let left = frame.x(from.min(*to)).max(rect.left);
            let right = frame.x(from.max(*to)).min(rect.right);
            let area = Rect { left, right, ..rect };
            if left < right { canvas.rectangle(area, role.color(), SHADE) } else { Ok(()) }
        }),
        Layer::ErrorBars { points, role, .. } => {
            points.iter().try_for_each(|point| whisker(canvas, point, frame, role.color()))
        }
    }
}

fn inside(
    place: f64,
    from: f64,
    to: f64,
    draw: impl FnOnce() -> Result<(), ReportError>,
) -> Result<(), ReportError> {
    if (from..=to).contains(&place) { draw() } else { Ok(()) }
}

fn polyline(
    canvas: &Canvas<'_>,
    points: &[Point],
    frame: &Frame,
    color: Rgb,
    width: f64,
    dash: Dash,
) -> Result<(), ReportError> {
    let places: Vec<Point> = points.iter().map(|p| frame.at(*p)).collect();
    let is_whole = runs(&places).count() == 1;
    for run in runs(&places) {
        if let [single] = run {
            if frame.rect.contains(*single) {
                canvas.dot(*single, width, color, 1.0)?;
            }
            continue;
        }
        let thinned = decimate(run, if is_whole { COLUMNS } else { columns(run, frame) });
        // a line that oscillates this much would appear as a solid area with a thick stroke
        let travel: f64 = thinned.windows(2).map(|pair| (pair[1].1 - pair[0].1).abs()).sum();
        let crowded = travel > 8.0 * frame.rect.width();
        let width = if crowded { width.min(0.9) } else { width };
        for part in clip_line(&thinned, frame.rect) {
            stroke(canvas, &part, color, width, dash)?;
        }
    }
    Ok(())
}

/// Columns of a picture over which a line is thinned.
const COLUMNS: usize = 1000;

/// Those under one of several runs; all of them for a line that turns back.
fn columns(run: &[Point], frame: &Frame) -> usize {
    if run.windows(2).any(|pair| pair[1].0 < pair[0].0) {
        return COLUMNS;
    }
    let share = (run[run.len() - 1].0 - run[0].0) / frame.rect.width();
    (COLUMNS as f64 * share).ceil().clamp(1.0, COLUMNS as f64) as usize
}

/// Infinite edges extend to the border; a missing edge interrupts the band.
fn band(
    canvas: &Canvas<'_>,
    (x, lower, upper): (&[f64], &[f64], &[f64]),
    frame: &Frame,
    role: ColourRole,
) -> Result<(), ReportError> {
    // an edge that a logarithmic axis cannot show lies below it
    let edge = |v: f64| {
        let place = frame.y(v);
        if place.is_nan() && !v.is_nan() { frame.rect.bottom } else { place }
    };
    let columns: Vec<(f64, f64, f64)> = x
        .iter()
        .zip(lower.iter().zip(upper))
        .map(|(x, (low, high))| (frame.x(*x), edge(*low), edge(*high)))
        .collect();
    let missing = |c: &(f64, f64, f64)| c.0.is_nan() || c.1.is_nan() || c.2.is_nan();
    for run in columns.split(missing) {
        let low: Vec<Point> = run.iter().map(|c| (c.0, c.1)).collect();
        let high: Vec<Point> = run.iter().map(|c| (c.0, c.2)).collect();
        let mut outline = decimate(&high, 500);
        outline.extend(decimate(&low, 500).into_iter().rev());
        canvas.polygon(&clip_polygon(&outline, frame.rect), role.color(), BAND)?;
    }
    Ok(())
}

fn whisker(
    canvas: &Canvas<'_>,
    point: &ErrorBar,
    frame: &Frame,
    color: Rgb,
) -> Result<(), ReportError> {
    const CAP: f64 = 3.5;
    let rect = frame.rect;
    let x = frame.x(point.x);
    if !(rect.left..=rect.right).contains(&x) {
        return Ok(());
    }
    let (low, high) = (frame.y(point.lower), frame.y(point.upper));
    if !low.is_nan() && !high.is_nan() {
        let ends = [(x, low), (x, high)];
        for part in clip_line(&ends, rect) {
            canvas.line(&part, color, 1.5, 1.0)?;
        }
        for (_, y) in ends {
            let cap = [(x - CAP, y), (x + CAP, y)];
            inside(y, rect.top, rect.bottom, || canvas.line(&cap, color, 1.5, 1.0))?;
        }
    }
    let y = frame.y(point.y);
    inside(y, rect.top, rect.bottom, || canvas.dot((x, y), 3.2, color, 1.0))
}
