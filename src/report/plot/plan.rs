//! Plan of a panel before drawing: its axes and the space around them.

use crate::report::figure::{AxisScale, Bars, Layer, Panel};
use crate::report::polyline::{Point, Rect};
use crate::report::scale::{Scale, Ticks};

use super::colour_scale::BAR_ROOM;
use super::legend::{self, Entry};
use super::names_below::names_below;
use super::pen::{AXIS_LABEL, CATEGORY, GAP, LEGEND, PANEL_TITLE, TICK_LABEL};
use super::ticks::{x_ticks, y_ticks};

/// Largest share of the width for names to the left of a plot.
const NAMES_SHARE: f64 = 0.34;
/// Distance between a bar and the text at its end, and after the text \[px\].
const TEXT_GAP: f64 = 10.0;
/// Pixel coordinates beyond this are treated as infinite.
const FAR: f64 = 1e6;

/// An axis of numbers or of names.
#[derive(Clone, Debug)]
pub(super) enum Marks {
    Numbers(Ticks),
    Names(Vec<String>),
}

/// The plot area, the cell of the figure around it, and the two scales.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) cell: Rect,
    pub(super) rect: Rect,
    pub(super) x: Scale,
    pub(super) y: Scale,
}

impl Frame {
    /// Position of an x value; NaN if it has none.
    pub(super) fn x(&self, value: f64) -> f64 {
        let place = self.rect.left + self.x.share(value) * self.rect.width();
        place.clamp(-FAR, FAR)
    }

    /// Position of a y value; NaN if it has none.
    pub(super) fn y(&self, value: f64) -> f64 {
        let place = self.rect.bottom - self.y.share(value) * self.rect.height();
        place.clamp(-FAR, FAR)
    }

    pub(super) fn at(&self, point: Point) -> Point {
        let finite = point.0.is_finite() && point.1.is_finite();
        if finite { (self.x(point.0), self.y(point.1)) } else { (f64::NAN, f64::NAN) }
    }
}

/// A panel with its scales and the measured space around it.
pub(super) struct Plan<'a> {
    pub(super) panel: &'a Panel,
    pub(super) x: Scale,
    pub(super) y: Scale,
    pub(super) x_names: Option<Vec<String>>,
    pub(super) y_names: Option<Vec<String>>,
    pub(super) legend: Vec<Entry>,
    /// Space above the plot for title, axis label and legend \[px\].
    pub(super) above: f64,
    pub(super) legend_beside_label: bool,
    /// Whether this panel has the labels of its x axis.
    pub(super) shows_x: bool,
}

impl<'a> Plan<'a> {
    pub(super) fn new(panel: &'a Panel) -> Self {
        let names = Names::of(panel);
        let mut x = Scale::new(&panel.x, extent(panel, Along::X).into_iter(), x_padding(panel));
        let mut y = Scale::new(&panel.y, extent(panel, Along::Y).into_iter(), 0.06);
        if let Some(bars) = bars(panel)
            && panel.x.range.is_none()
        {
            x = Scale::new(&panel.x, extent(panel, Along::X).into_iter(), 0.06);
            start_at_zero(&mut x, bars);
        }
        let across =
            |count: usize| Scale { kind: AxisScale::Linear, first: 0.0, last: count.max(1) as f64 };
        if let Some(names) = &names.x {
            x = across(names.len());
        }
        if let Some(names) = &names.y {
            // the first name is at the top
            let up = across(names.len());
            y = Scale { first: up.last, last: 0.0, ..up };
        }
        Self {
            panel,
            x,
            y,
            x_names: names.x,
            y_names: names.y,
            legend: legend::entries(panel),
            above: 0.0,
            legend_beside_label: true,
            shows_x: true,
        }
    }

    /// Widens one range for equal scales in x and y.
    pub(super) fn equalise(&mut self, rect: &Rect) {
        let linear = [self.x, self.y].iter().all(|scale| scale.kind == AxisScale::Linear);
        if !self.panel.equal_units || !linear {
            return;
        }
        let pixel = |scale: &Scale, room: f64| (scale.last - scale.first).abs() / room;
        let unit = pixel(&self.x, rect.width()).max(pixel(&self.y, rect.height()));
        let widen = |scale: &mut Scale, room: f64| {
            let middle = 0.5 * (scale.first + scale.last);
            let half = 0.5 * unit * room;
            (scale.first, scale.last) = (middle - half, middle + half);
        };
        widen(&mut self.x, rect.width());
        widen(&mut self.y, rect.height());
    }

    /// Extends the axis of bars until the texts at their ends fit, for this plot width and space to its
    /// right.
    pub(super) fn fit_texts(&mut self, width: f64, right: f64) {
        let Some(bars) = bars(self.panel) else { return };
        let texts = bars.series.iter().flat_map(|series| &series.text);
        let widest = texts.map(|text| LEGEND.width(text)).fold(0.0, f64::max);
        let behind = (widest + TEXT_GAP - right).clamp(0.0, 0.5 * width);
        if self.x.kind == AxisScale::Linear && self.panel.x.range.is_none() {
            self.x.last += (self.x.last - self.x.first) * behind / (width - behind);
        }
    }

    pub(super) fn x_marks(&self, width: f64) -> Marks {
        match &self.x_names {
            Some(names) => Marks::Names(names.clone()),
            None => Marks::Numbers(x_ticks(&self.x, width)),
        }
    }

    pub(super) fn y_marks(&self, height: f64) -> Marks {
        match &self.y_names {
            Some(names) => Marks::Names(names.clone()),
            None => Marks::Numbers(y_ticks(&self.y, height)),
        }
    }

    /// Preferred height of the plot \[px\].
    pub(super) fn wanted_height(&self, cell_width: f64, alone: bool) -> f64 {
        let is_broken = |name: &String| CATEGORY.width(name) > NAMES_SHARE * cell_width;
        match (&self.y_names, bars(self.panel)) {
            (Some(names), Some(bars)) => {
                let lines = if names.iter().any(is_broken) { 2.0 } else { 1.0 };
                let slot = (14.0 * bars.series.len() as f64 + 10.0)
                    .max(10.0 + lines * CATEGORY.line_height());
                (names.len() as f64 * slot).clamp(60.0, 1400.0)
            }
            (Some(names), None) if names.iter().any(is_broken) => {
                (names.len() as f64 * (4.0 + 2.0 * CATEGORY.line_height())).clamp(90.0, 1400.0)
            }
            (Some(names), None) => {
                let count = names.len() as f64;
                (30.0 * count).min(340.0).max(20.0 * count).clamp(90.0, 1400.0)
            }
            _ if alone => 300.0,
            _ => 170.0,
        }
    }

    /// Space to the left of the plot for the labels of the y axis \[px\].
    pub(super) fn left(&self, cell_width: f64, height: f64) -> f64 {
        let widest = match self.y_marks(height) {
            Marks::Names(names) => {
                let most = NAMES_SHARE * cell_width;
                let lines = names.iter().flat_map(|name| CATEGORY.fit(name, most, 2));
                lines.map(|line| CATEGORY.width(&line)).fold(0.0, f64::max)
            }
            Marks::Numbers(ticks) => {
                ticks.ticks.iter().map(|t| TICK_LABEL.width(&t.label)).fold(0.0, f64::max)
            }
        };
        widest + GAP + 1.0
    }

    /// Space to the right of the plot \[px\]: half a tick label, or a colour bar.
    pub(super) fn right(&self) -> f64 {
        match heat_map(self.panel) {
            Some(_) => BAR_ROOM,
            None => 22.0,
        }
    }

    /// Space below the plot for the labels of the x axis \[px\].
    pub(super) fn below(&self, width: f64) -> f64 {
        if !self.shows_x {
            return 8.0;
        }
        let marks = self.x_marks(width);
        let ticks = match &marks {
            Marks::Names(names) => names_below(names, width).height,
            Marks::Numbers(_) => GAP + TICK_LABEL.line_height(),
        };
        let label =
            if self.x_label(&marks).is_empty() { 0.0 } else { 4.0 + AXIS_LABEL.line_height() };
        ticks + label + 6.0
    }

    pub(super) fn x_label(&self, marks: &Marks) -> String {
        axis_label(marks, &self.panel.x)
    }

    pub(super) fn y_label(&self, marks: &Marks) -> String {
        axis_label(marks, &self.panel.y)
    }

    /// Determines the space above the plot: panel title, then axis label and legend in one line if both fit,
    /// otherwise the legend in separate lines.
    pub(super) fn measure_above(&mut self, cell_width: f64, height: f64) {
        let title = if self.panel.title.is_empty() { 0.0 } else { PANEL_TITLE.line_height() + 4.0 };
        let label = self.y_label(&self.y_marks(height));
        let row = AXIS_LABEL.line_height() + 5.0;
        let legend_width: f64 = self.legend.iter().map(Entry::width).sum();
        let label_width = AXIS_LABEL.width(&label);
        self.legend_beside_label = label_width + 24.0 + legend_width <= cell_width - self.right();
        let rows = match (label.is_empty(), self.legend.is_empty()) {
            (true, true) => 0.0,
            (false, true) => 1.0,
            _ if self.legend_beside_label => 1.0,
            (no_label, _) => {
                let lines = legend::lines(&self.legend, cell_width).len() as f64;
                lines + if no_label { 0.0 } else { 1.0 }
            }
        };
        self.above = title + rows * row + 6.0;
    }
}

fn axis_label(marks: &Marks, axis: &crate::report::figure::Axis) -> String {
    match marks {
        Marks::Numbers(ticks) => ticks.axis_label(axis),
        Marks::Names(_) => Ticks::default().axis_label(axis),
    }
}

struct Names {
    x: Option<Vec<String>>,
    y: Option<Vec<String>>,
}

impl Names {
    fn of(panel: &Panel) -> Self {
        if let Some(map) = heat_map(panel) {
            return Self { x: Some(map.columns.clone()), y: Some(map.rows.clone()) };
        }
        match bars(panel) {
            Some(bars) => Self { x: None, y: Some(bars.categories.clone()) },
            None => Self { x: None, y: None },
        }
    }
}

pub(super) fn heat_map(panel: &Panel) -> Option<&crate::report::figure::HeatMap> {
    panel.layers.iter().find_map(|layer| match layer {
        Layer::HeatMap(map) => Some(map),
        _ => None,
    })
}

pub(super) fn bars(panel: &Panel) -> Option<&Bars> {
    panel.layers.iter().find_map(|layer| match layer {
        Layer::Bars(bars) => Some(bars),
        _ => None,
    })
}

/// Bars on a linear scale start at zero: their length is proportional to their value.
fn start_at_zero(scale: &mut Scale, bars: &Bars) {
    if scale.kind == AxisScale::Log {
        return;
    }
    let ends =
        || bars.series.iter().flat_map(|s| s.values.iter().copied().chain(ends_of(&s.intervals)));
    if !ends().any(|v| v < 0.0) {
        scale.first = 0.0;
    }
    if !ends().any(|v| v > 0.0) {
        scale.last = 0.0;
    }
    if scale.first >= scale.last {
        (scale.first, scale.last) = (0.0, 1.0);
    }
}

fn ends_of(intervals: &[(f64, f64)]) -> impl Iterator<Item = f64> {
    intervals.iter().flat_map(|(lower, upper)| [*lower, *upper])
}

/// Lines over time fill their axis; dots keep a distance from the edge.
fn x_padding(panel: &Panel) -> f64 {
    let fills = |layer: &Layer| matches!(layer, Layer::Line { .. } | Layer::Band { .. });
    if panel.layers.iter().any(fills) { 0.0 } else { 0.03 }
}

#[derive(Clone, Copy, PartialEq)]
enum Along {
    X,
    Y,
}

/// All values of a panel along one axis that its range must contain.
fn extent(panel: &Panel, along: Along) -> Vec<f64> {
    let mut values = Vec::new();
    for layer in &panel.layers {
        let pick = |p: &Point| if along == Along::X { p.0 } else { p.1 };
        match layer {
            Layer::Line { points, .. } | Layer::Points { points, .. } => {
                let whole = points.iter().filter(|p| p.0.is_finite() && p.1.is_finite());
                values.extend(whole.map(pick));
            }
            Layer::Band { x, .. } if along == Along::X => values.extend(x),
            Layer::Band { lower, upper, .. } => values.extend(lower.iter().chain(upper)),
            Layer::Bars(bars) if along == Along::X => {
                values.extend((panel.x.scale == AxisScale::Linear).then_some(0.0));
                for series in &bars.series {
                    values.extend(&series.values);
                    values.extend(ends_of(&series.intervals));
                }
            }
            Layer::HLine { at, .. } if along == Along::Y => values.push(*at),
            Layer::VLine { at, .. } if along == Along::X => values.push(*at),
            Layer::Shade { ranges, .. } if along == Along::X => values.extend(ends_of(ranges)),
            Layer::ErrorBars { points, .. } => {
                values.extend(points.iter().flat_map(|p| match along {
                    Along::X => vec![p.x],
                    Along::Y => vec![p.y, p.lower, p.upper],
                }));
            }
            _ => {}
        }
    }
    values
}
