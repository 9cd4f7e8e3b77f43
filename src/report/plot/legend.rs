//! A legend in one or more lines, without a box.

use crate::report::ReportError;
use crate::report::figure::{Dash, Layer, Panel};
use crate::report::palette::ColourRole;
use crate::report::polyline::Rect;

use super::canvas::Canvas;
use super::colour_scale;
use super::pen::{Anchor, BAND, LEGEND, SHADE};
use super::stroke::stroke;

const SWATCH: f64 = 20.0;
const BETWEEN: f64 = 18.0;
/// Line spacing \[px\].
const ROW: f64 = 20.0;

/// Symbol of a series in the legend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sample {
    /// Dashes and width of the stroke \[px\].
    Line(Dash, f64),
    Dot,
    Dots,
    Patch(f64),
    Whisker,
    /// Text only, for the colour bar.
    None,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) label: String,
    pub(super) role: ColourRole,
    pub(super) sample: Sample,
}

impl Entry {
    pub(super) fn width(&self) -> f64 {
        self.swatch() + LEGEND.width(&self.label) + BETWEEN
    }

    fn swatch(&self) -> f64 {
        if self.sample == Sample::None { 0.0 } else { SWATCH + 6.0 }
    }

    fn draw(
        &self,
        canvas: &Canvas<'_>,
        x: f64,
        baseline: f64,
        room: f64,
    ) -> Result<(), ReportError> {
        let middle = baseline - LEGEND.half_capital();
        let color = self.role.color();
        let square = |half: f64| Rect {
            left: x,
            top: middle - half,
            right: x + SWATCH,
            bottom: middle + half,
        };
        match self.sample {
            Sample::Line(dash, width) => {
                stroke(canvas, &[(x, middle), (x + SWATCH, middle)], color, width, dash)?;
            }
            Sample::Dot => canvas.dot((x + 0.5 * SWATCH, middle), 3.0, color, 1.0)?,
            Sample::Dots => {
                for share in [0.2, 0.5, 0.8] {
                    canvas.dot((x + share * SWATCH, middle), 2.2, color, 0.8)?;
                }
            }
            Sample::Patch(alpha) => canvas.rectangle(square(5.0), color, alpha)?,
            Sample::Whisker => {
                let centre = x + SWATCH / 2.0;
                canvas.line(&[(centre, middle - 7.0), (centre, middle + 7.0)], color, 1.5, 1.0)?;
                canvas.dot((centre, middle), 3.0, color, 1.0)?;
            }
            Sample::None => {}
        }
        let label = LEGEND.shorten(&self.label, room - self.swatch());
        canvas.text(&label, (x + self.swatch(), baseline), Anchor::Start, LEGEND)
    }
}

/// The distinct entries of a panel.
pub(super) fn entries(panel: &Panel) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    let mut add = |label: &str, role: ColourRole, sample: Sample| {
        let entry = Entry { label: label.to_owned(), role, sample };
        if !label.is_empty() && !entries.contains(&entry) {
            entries.push(entry);
        }
    };
    for layer in &panel.layers {
        match layer {
            // thin lines are drawn thicker in the legend
            Layer::Line { label, role, dash, width, .. } => {
                add(label, *role, Sample::Line(*dash, width.max(2.0)));
            }
            Layer::HLine { label, role, dash, .. } | Layer::VLine { label, role, dash, .. } => {
                add(label, *role, Sample::Line(*dash, 2.0));
            }
            Layer::Points { points, label, role, .. } => {
                add(label, *role, if points.len() == 1 { Sample::Dot } else { Sample::Dots });
            }
            Layer::Band { label, role, .. } => add(label, *role, Sample::Patch(BAND)),
            Layer::Shade { label, role, .. } => {
                add(label, *role, Sample::Patch(SHADE));
            }
            Layer::ErrorBars { label, role, .. } => add(label, *role, Sample::Whisker),
            Layer::Bars(bars) => {
                for series in &bars.series {
                    add(&series.label, series.role, Sample::Patch(1.0));
                }
            }
            Layer::HeatMap(map) => add(&colour_scale::label(map), ColourRole::Ink, Sample::None),
        }
    }
    // data come before reference lines
    entries.sort_by_key(|entry| matches!(entry.sample, Sample::Patch(alpha) if alpha < 1.0));
    entries
}

/// The entries broken into lines of at most the width.
pub(super) fn lines(entries: &[Entry], width: f64) -> Vec<&[Entry]> {
    let mut lines = Vec::new();
    let (mut start, mut used) = (0, 0.0);
    for (i, entry) in entries.iter().enumerate() {
        if i > start && used + entry.width() - BETWEEN > width {
            lines.push(&entries[start..i]);
            (start, used) = (i, 0.0);
        }
        used += entry.width();
    }
    if start < entries.len() {
        lines.push(&entries[start..]);
    }
    lines
}

/// Height of these lines above all panels, including a gap \[px\].
pub(super) fn height(lines: usize) -> f64 {
    if lines == 0 { 0.0 } else { lines as f64 * ROW + 8.0 }
}

/// Draws lines of entries below a place.
pub(super) fn draw_lines(
    canvas: &Canvas<'_>,
    lines: &[&[Entry]],
    (left, top): (f64, f64),
    room: f64,
) -> Result<(), ReportError> {
    lines.iter().enumerate().try_for_each(|(i, line)| {
        let baseline = top + LEGEND.size + i as f64 * ROW;
        draw_line(canvas, line, (left, baseline), Anchor::Start, room)
    })
}

/// Draws one line of entries; `x` is its left or right end.
pub(super) fn draw_line(
    canvas: &Canvas<'_>,
    line: &[Entry],
    (x, baseline): (f64, f64),
    anchor: Anchor,
    room: f64,
) -> Result<(), ReportError> {
    let total: f64 = line.iter().map(Entry::width).sum::<f64>() - BETWEEN;
    let mut x = if anchor == Anchor::End { x - total } else { x };
    for entry in line {
        entry.draw(canvas, x, baseline, room)?;
        x += entry.width();
    }
    Ok(())
}
