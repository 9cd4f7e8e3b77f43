//! Draws a figure to SVG by plotters: the only folder that imports this library.
//!
//! plotters writes strokes, fills and text; scales, ticks, layout and clipping are implemented here, because
//! its axes clamp data to the border and cannot align panels.

mod axes;
mod bars;
mod canvas;
mod colour_scale;
mod heat;
mod layers;
mod legend;
mod names_below;
mod pen;
mod plan;
mod stroke;
mod ticks;

use super::ReportError;
use super::figure::{Figure, WIDTH};
use super::palette::SURFACE;
use super::polyline::Rect;
use super::scale::Scale;
pub(super) use pen::printable;
pub(super) use pen::{BAND as BAND_ALPHA, SHADE as SHADE_ALPHA};

use canvas::Canvas;
use pen::{Anchor, SUBTITLE, TITLE};
use plan::{Frame, Plan};

/// Where the drawing is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Separately: on a white background, with its title.
    Standalone,
    /// On a page that has the title and determines the background.
    Inline,
}

const MARGIN: f64 = 14.0;
const BETWEEN_COLUMNS: f64 = 26.0;
const BETWEEN_ROWS: f64 = 12.0;

/// Draws a figure.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`] if the library refuses.
pub(super) fn draw(figure: &Figure, purpose: Purpose) -> Result<String, ReportError> {
    pen::register_fonts()?;
    let width = if figure.size.width.is_finite() { figure.size.width } else { WIDTH };
    let width = width.clamp(240.0, 4000.0).round();
    let margin = if purpose == Purpose::Standalone { MARGIN } else { 2.0 };
    let inner = width - 2.0 * margin;
    let heading = Heading::new(figure, inner, purpose);
    let mut plans = plans(figure);
    let common = common_legend(figure, &mut plans);
    let lines = legend::lines(&common, inner);
    let below_heading = margin + heading.height();
    let top = below_heading + legend::height(lines.len());
    let placed = place(figure, &mut plans, inner, top, margin);
    let size = (width as u32, (placed.bottom + margin).ceil() as u32);

    let mut svg = String::new();
    {
        let canvas = Canvas::new(&mut svg, size, &figure.id)?;
        if purpose == Purpose::Standalone {
            let sheet =
                Rect { left: 0.0, top: 0.0, right: f64::from(size.0), bottom: f64::from(size.1) };
            canvas.rectangle(sheet, SURFACE, 1.0)?;
        }
        heading.draw(&canvas, margin)?;
        legend::draw_lines(&canvas, &lines, (margin, below_heading), inner)?;
        for (plan, frame) in plans.iter().zip(&placed.frames) {
            axes::grid(&canvas, plan, frame)?;
            layers::draw(&canvas, &plan.panel.layers, frame)?;
            axes::axes(&canvas, plan, frame)?;
            bars::value_texts(&canvas, plan.panel, frame)?;
            axes::header(&canvas, plan, frame)?;
        }
        canvas.finish()?;
    }
    Ok(canvas::tidy(&svg, size))
}

struct Heading {
    title: Vec<String>,
    subtitle: Vec<String>,
}

impl Heading {
    fn new(figure: &Figure, width: f64, purpose: Purpose) -> Self {
        if purpose == Purpose::Inline {
            return Self { title: Vec::new(), subtitle: Vec::new() };
        }
        let (title, subtitle) = (&figure.title, &figure.subtitle);
        Self { title: TITLE.wrap(title, width), subtitle: SUBTITLE.wrap(subtitle, width) }
    }

    fn height(&self) -> f64 {
        let lines = self.title.len() as f64 * TITLE.line_height()
            + self.subtitle.len() as f64 * SUBTITLE.line_height();
        if lines > 0.0 { lines + 12.0 } else { 0.0 }
    }

    fn draw(&self, canvas: &Canvas<'_>, margin: f64) -> Result<(), ReportError> {
        let mut y = margin;
        let titles = self.title.iter().map(|line| (line, TITLE));
        for (line, pen) in titles.chain(self.subtitle.iter().map(|line| (line, SUBTITLE))) {
            canvas.text(line, (margin, y + pen.size), Anchor::Start, pen)?;
            y += pen.line_height();
        }
        Ok(())
    }
}

/// Plans the panels: common x ranges if shared, and each legend entry once.
fn plans(figure: &Figure) -> Vec<Plan<'_>> {
    let columns = figure.columns.max(1);
    let count = figure.panels.len();
    let mut plans: Vec<Plan<'_>> = figure.panels.iter().map(Plan::new).collect();
    if figure.shared_x {
        let union = |shared: Option<Scale>, x: Scale| Some(shared.map_or(x, |s| s.union(x)));
        let numeric = |plan: &&Plan<'_>| plan.x_names.is_none();
        let shared = plans.iter().filter(numeric).map(|plan| plan.x).fold(None, union);
        for (i, plan) in plans.iter_mut().enumerate() {
            let Some(shared) = shared.filter(|s| plan.x_names.is_none() && s.kind == plan.x.kind)
            else {
                continue;
            };
            plan.x = shared;
            plan.shows_x = i + columns >= count;
        }
    }
    let mut seen: Vec<legend::Entry> = Vec::new();
    for plan in &mut plans {
        plan.legend.retain(|entry| !seen.contains(entry));
        seen.extend(plan.legend.iter().cloned());
    }
    plans
}

/// The legend of the first of several columns, moved above all panels: within its cell it would shift the
/// plots of the row down.
fn common_legend(figure: &Figure, plans: &mut [Plan<'_>]) -> Vec<legend::Entry> {
    let Some(first) = plans.first_mut().filter(|_| figure.columns > 1) else { return Vec::new() };
    let (own, common) = std::mem::take(&mut first.legend)
        .into_iter()
        .partition(|entry: &legend::Entry| entry.sample == legend::Sample::None);
    first.legend = own;
    common
}

/// The ranges of x and y that each panel shows.
pub(super) fn panel_ranges(figure: &Figure) -> Vec<((f64, f64), (f64, f64))> {
    let range = |scale: Scale| (scale.first, scale.last);
    plans(figure).iter().map(|plan| (range(plan.x), range(plan.y))).collect()
}

struct Placed {
    frames: Vec<Frame>,
    bottom: f64,
}

/// Arranges the panels in a grid with aligned axes and plots.
fn place(figure: &Figure, plans: &mut [Plan<'_>], inner: f64, top: f64, margin: f64) -> Placed {
    let columns = figure.columns.clamp(1, plans.len().max(1));
    let cell_width = (inner - BETWEEN_COLUMNS * (columns - 1) as f64) / columns as f64;
    let alone = plans.len() <= columns;
    let mut heights: Vec<f64> = plans
        .chunks(columns)
        .map(|row| row.iter().map(|plan| plan.wanted_height(cell_width, alone)).fold(0.0, f64::max))
        .collect();
    for (i, plan) in plans.iter_mut().enumerate() {
        plan.measure_above(cell_width, heights[i / columns]);
    }
    let beside = sides(plans, columns, cell_width, &heights);
    let width = |sides: (f64, f64)| (cell_width - sides.0 - sides.1).max(40.0);
    let around: Vec<(f64, f64)> = plans
        .chunks(columns)
        .map(|row| {
            let above = row.iter().map(|plan| plan.above).fold(0.0, f64::max);
            let below = row.iter().enumerate().map(|(c, plan)| plan.below(width(beside[c])));
            (above, below.fold(0.0, f64::max))
        })
        .collect();
    stretch(figure, &mut heights, &around, top + margin);
    // other heights have other ticks
    let beside = sides(plans, columns, cell_width, &heights);
    let mut frames = Vec::with_capacity(plans.len());
    let mut y = top;
    for (r, row) in plans.chunks_mut(columns).enumerate() {
        let (above, below) = around[r];
        for (c, plan) in row.iter_mut().enumerate() {
            let left = margin + c as f64 * (cell_width + BETWEEN_COLUMNS);
            let cell = Rect {
                left,
                top: y,
                right: left + cell_width,
                bottom: y + above + heights[r] + below,
            };
            let start = left + beside[c].0;
            let rect = Rect {
                left: start,
                top: y + above,
                right: start + width(beside[c]),
                bottom: y + above + heights[r],
            };
            plan.equalise(&rect);
            plan.fit_texts(rect.width(), beside[c].1);
            frames.push(Frame { cell, rect, x: plan.x, y: plan.y });
        }
        y += above + heights[r] + below + BETWEEN_ROWS;
    }
    Placed { frames, bottom: if plans.is_empty() { top } else { y - BETWEEN_ROWS } }
}

/// Space to the left and right of the plots of each column, for these plot heights per row.
fn sides(plans: &[Plan<'_>], columns: usize, cell_width: f64, heights: &[f64]) -> Vec<(f64, f64)> {
    (0..columns)
        .map(|column| {
            let own = plans.iter().enumerate().skip(column).step_by(columns);
            own.fold((0.0, 0.0), |(left, right): (f64, f64), (i, plan)| {
                let needed = plan.left(cell_width, heights[i / columns]);
                (left.max(needed), right.max(plan.right()))
            })
        })
        .collect()
}

/// Scales the plots to the requested height, but not below 40 px each.
fn stretch(figure: &Figure, heights: &mut [f64], around: &[(f64, f64)], outside: f64) {
    let Some(height) = figure.size.height.filter(|h| h.is_finite() && !heights.is_empty()) else {
        return;
    };
    let surroundings: f64 = around.iter().map(|(above, below)| above + below).sum();
    let gaps = BETWEEN_ROWS * (heights.len() - 1) as f64;
    let room = height.min(10_000.0) - outside - surroundings - gaps;
    let factor = room / heights.iter().sum::<f64>();
    heights.iter_mut().for_each(|plot| *plot = (*plot * factor).max(40.0));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figure::{Axis, ColourRole, Layer, Panel};

    #[test]
    fn the_legend_of_several_columns_stands_once_above_all_panels() {
        let line = Layer::line(vec![(0.0, 0.0), (1.0, 1.0)], "curve", ColourRole::Model);
        let panel = || Panel::new(Axis::linear("x", ""), Axis::linear("y", "")).with(line.clone());
        let one = Figure::new("f", "").with_panel(panel()).with_panel(panel());
        let two = one.clone().with_columns(2);
        for (figure, above) in [(one, 0), (two, 1)] {
            let mut plans = plans(&figure);
            assert_eq!(common_legend(&figure, &mut plans).len(), above);
            assert_eq!(plans.iter().map(|plan| plan.legend.len()).sum::<usize>(), 1 - above);
        }
    }
}
