//! Grid, axis lines, tick labels, and the header of a plot.

use crate::report::ReportError;
use crate::report::palette::{AXIS, GRID};
use crate::report::scale::Tick;

use super::canvas::Canvas;
use super::legend::{self, draw_line as legend_line};
use super::names_below::{NamesBelow, names_below};
use super::pen::{AXIS_LABEL, Anchor, CATEGORY, GAP, PANEL_TITLE, TICK_LABEL};
use super::plan::{Frame, Marks, Plan, heat_map};

/// Horizontal grid lines; vertical ones if the y axis has names.
pub(super) fn grid(canvas: &Canvas<'_>, plan: &Plan<'_>, frame: &Frame) -> Result<(), ReportError> {
    let rect = frame.rect;
    if heat_map(plan.panel).is_some() {
        return Ok(());
    }
    let labelled = |tick: &&Tick| !tick.label.is_empty();
    match (plan.x_marks(rect.width()), plan.y_marks(rect.height())) {
        (_, Marks::Numbers(ticks)) => ticks.ticks.iter().filter(labelled).try_for_each(|tick| {
            let y = frame.y(tick.at);
            canvas.line(&[(rect.left, y), (rect.right, y)], GRID, 1.0, 1.0)
        }),
        (Marks::Numbers(ticks), _) => ticks.ticks.iter().filter(labelled).try_for_each(|tick| {
            let x = frame.x(tick.at);
            canvas.line(&[(x, rect.top), (x, rect.bottom)], GRID, 1.0, 1.0)
        }),
        _ => Ok(()),
    }
}

/// Axis lines and tick labels.
pub(super) fn axes(canvas: &Canvas<'_>, plan: &Plan<'_>, frame: &Frame) -> Result<(), ReportError> {
    let rect = frame.rect;
    let is_map = heat_map(plan.panel).is_some();
    // where bars stand, at zero or at the border, is drawn with them
    if !is_map && plan.x_names.is_none() {
        canvas.line(&[(rect.left, rect.bottom), (rect.right, rect.bottom)], AXIS, 1.0, 1.0)?;
    }
    y_axis(canvas, plan, frame)?;
    x_axis(canvas, plan, frame)
}

fn y_axis(canvas: &Canvas<'_>, plan: &Plan<'_>, frame: &Frame) -> Result<(), ReportError> {
    let rect = frame.rect;
    match plan.y_marks(rect.height()) {
        Marks::Numbers(ticks) => ticks.ticks.iter().try_for_each(|tick| {
            let y = frame.y(tick.at);
            if tick.label.is_empty() {
                return canvas.line(&[(rect.left - 3.0, y), (rect.left, y)], AXIS, 0.75, 1.0);
            }
            let at = (rect.left - GAP, y + TICK_LABEL.half_capital());
            canvas.text(&tick.label, at, Anchor::End, TICK_LABEL)
        }),
        Marks::Names(names) => {
            let slot = rect.height() / names.len().max(1) as f64;
            let lines = if slot >= 2.0 * CATEGORY.line_height() { 2 } else { 1 };
            let stride = (1.2 * CATEGORY.size / slot).ceil().max(1.0) as usize;
            for (i, name) in names.iter().enumerate().step_by(stride) {
                let lines = CATEGORY.fit(name, rect.left - GAP - frame.cell.left + 0.5, lines);
                let middle = frame.y(i as f64 + 0.5) + CATEGORY.half_capital();
                let first = middle - CATEGORY.line_height() * (lines.len() as f64 - 1.0) / 2.0;
                for (j, line) in lines.iter().enumerate() {
                    let y = first + j as f64 * CATEGORY.line_height();
                    canvas.text(line, (rect.left - GAP, y), Anchor::End, CATEGORY)?;
                }
            }
            Ok(())
        }
    }
}

fn x_axis(canvas: &Canvas<'_>, plan: &Plan<'_>, frame: &Frame) -> Result<(), ReportError> {
    let rect = frame.rect;
    let marks = plan.x_marks(rect.width());
    let is_map = heat_map(plan.panel).is_some();
    let mut below = rect.bottom + GAP;
    match &marks {
        Marks::Numbers(ticks) => {
            for tick in &ticks.ticks {
                let x = frame.x(tick.at);
                let length = if tick.label.is_empty() { 3.0 } else { 4.5 };
                canvas.line(&[(x, rect.bottom), (x, rect.bottom + length)], AXIS, 1.0, 1.0)?;
                if plan.shows_x {
                    let at = (x, below + TICK_LABEL.size);
                    canvas.text(&tick.label, at, Anchor::Middle, TICK_LABEL)?;
                }
            }
            below += TICK_LABEL.line_height();
        }
        Marks::Names(names) if plan.shows_x || is_map => {
            let layout = names_below(names, rect.width());
            draw_names_below(canvas, &layout, frame)?;
            below = rect.bottom + layout.height;
        }
        Marks::Names(_) => {}
    }
    let label = plan.x_label(&marks);
    if !plan.shows_x || label.is_empty() {
        return Ok(());
    }
    let middle = (rect.left + rect.right) / 2.0;
    let label = AXIS_LABEL.shorten(&label, frame.cell.width());
    canvas.text(&label, (middle, below + 4.0 + AXIS_LABEL.size), Anchor::Middle, AXIS_LABEL)
}

fn draw_names_below(
    canvas: &Canvas<'_>,
    layout: &NamesBelow,
    frame: &Frame,
) -> Result<(), ReportError> {
    let top = frame.rect.bottom + GAP;
    for (i, lines) in layout.names.iter().enumerate().step_by(layout.stride) {
        let middle = frame.x(i as f64 + 0.5);
        for (j, line) in lines.iter().enumerate() {
            if layout.upright {
                let at = (middle + CATEGORY.half_capital(), top);
                canvas.text(line, at, Anchor::End, CATEGORY.upright())?;
            } else {
                let y = top + CATEGORY.size + j as f64 * CATEGORY.line_height();
                canvas.text(line, (middle, y), Anchor::Middle, CATEGORY)?;
            }
        }
    }
    Ok(())
}

/// Panel title, label of the y axis and legend.
pub(super) fn header(
    canvas: &Canvas<'_>,
    plan: &Plan<'_>,
    frame: &Frame,
) -> Result<(), ReportError> {
    let (cell, rect) = (frame.cell, frame.rect);
    if !plan.panel.title.is_empty() {
        let title = PANEL_TITLE.shorten(&plan.panel.title, cell.width());
        canvas.text(
            &title,
            (cell.left, cell.top + PANEL_TITLE.size),
            Anchor::Start,
            PANEL_TITLE,
        )?;
    }
    let label = plan.y_label(&plan.y_marks(rect.height()));
    let row = AXIS_LABEL.line_height() + 5.0;
    // the labels of a row of panels stand in line, next to their plots; legends above them
    let baseline = rect.top - 10.0;
    if plan.legend_beside_label {
        let right = if heat_map(plan.panel).is_some() { cell.right } else { rect.right };
        legend_line(canvas, &plan.legend, (right, baseline), Anchor::End, cell.width())?;
    } else {
        let lines = legend::lines(&plan.legend, cell.width());
        let lowest = if label.is_empty() { baseline } else { baseline - row };
        for (i, line) in lines.iter().rev().enumerate() {
            let at = (cell.left, lowest - i as f64 * row);
            legend_line(canvas, line, at, Anchor::Start, cell.width())?;
        }
    }
    let label = AXIS_LABEL.shorten(&label, cell.width());
    canvas.text(&label, (cell.left, baseline), Anchor::Start, AXIS_LABEL)
}
