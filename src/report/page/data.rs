//! The data of an interactive figure as JSON for the page's script.

use serde::Serialize;

use super::column::Column;
use crate::math::{round_decimals, round_significant};
use crate::report::ReportError;
use crate::report::figure::{Axis, AxisScale, Dash, ErrorBar, Figure, Layer};
use crate::report::palette::ColourRole;
use crate::report::plot::{BAND_ALPHA, SHADE_ALPHA, panel_ranges};
use crate::report::polyline::{Point, decimate, runs};

/// A line keeps about four points for each of these columns.
const COLUMNS: usize = 1000;
/// Dots shown at most.
const DOTS: usize = 4000;
/// Digits of the range of an axis to which its values are rounded. A panel is at most 340 pixels high, so
/// values are accurate to a pixel at a zoom factor of 30; the x axis, with higher zoom factors, has more
/// digits.
const Y_DIGITS: i32 = 4;
const X_DIGITS: i32 = 5;
/// Height of a panel, alone and among others \[px\].
const HEIGHT: (f64, f64) = (340.0, 165.0);

#[derive(Serialize)]
pub(super) struct FigureData<'a> {
    columns: usize,
    shared: bool,
    #[serde(skip_serializing_if = "str::is_empty")]
    link: &'a str,
    /// Columns of x values; layers refer to them by index, since most share one.
    xs: Vec<Column>,
    panels: Vec<PanelData>,
}

#[derive(Serialize)]
struct PanelData {
    title: String,
    x: AxisData,
    y: AxisData,
    height: f64,
    layers: Vec<LayerData>,
}

#[derive(Serialize)]
struct AxisData {
    label: String,
    unit: String,
    log: bool,
    range: (f64, f64),
}

#[derive(Serialize, Default)]
struct LayerData {
    kind: &'static str,
    label: String,
    color: String,
    /// Which of the two models it shows.
    #[serde(skip_serializing_if = "Option::is_none")]
    version: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    x: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    y: Option<Column>,
    #[serde(skip_serializing_if = "Option::is_none")]
    low: Option<Column>,
    #[serde(skip_serializing_if = "Option::is_none")]
    high: Option<Column>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ranges: Option<Vec<(f64, f64)>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    at: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    width: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    radius: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    dash: Option<&'static str>,
}

/// Data as JSON, with `<` written as `\u003c` so that no text can close the script element.
pub(super) fn json(data: &impl Serialize, figure: &str) -> Result<String, ReportError> {
    let text = serde_json::to_string(data)
        .map_err(|source| ReportError::Data { figure: figure.to_owned(), source })?;
    Ok(text.replace('<', "\\u003c"))
}

/// What the script draws of a figure.
pub(super) fn of(figure: &Figure) -> FigureData<'_> {
    let alone = figure.panels.len() <= figure.columns.max(1);
    let mut xs = Vec::new();
    let mut panels = Vec::new();
    for (panel, (x_range, y_range)) in figure.panels.iter().zip(panel_ranges(figure)) {
        panels.push(PanelData {
            title: panel.title.clone(),
            x: axis(&panel.x, x_range),
            y: axis(&panel.y, y_range),
            height: if alone { HEIGHT.0 } else { HEIGHT.1 },
            layers: ordered(&panel.layers)
                .map(|l| {
                    let far = far(&panel.y, y_range);
                    layer(l, &mut Scaled { x: x_range, y: y_range, far, xs: &mut xs })
                })
                .collect(),
        });
    }
    FigureData {
        columns: figure.columns.max(1),
        shared: figure.shared_x,
        link: &figure.link,
        xs,
        panels,
    }
}

/// Shades lowest, bands above them: as in the printed picture.
fn ordered(layers: &[Layer]) -> impl Iterator<Item = &Layer> {
    let placed = |layer: &&Layer| match layer {
        Layer::HLine { at, .. } | Layer::VLine { at, .. } => at.is_finite(),
        _ => true,
    };
    let mut ordered: Vec<&Layer> = layers.iter().filter(placed).collect();
    ordered.sort_by_key(|layer| layer.height());
    ordered.into_iter()
}

/// Finite substitute for infinite edges and whiskers, far outside the zoom range.
fn far(axis: &Axis, range: (f64, f64)) -> (f64, f64) {
    match axis.scale {
        AxisScale::Log => (range.0 / 1e3, range.1 * 1e3),
        AxisScale::Linear => {
            let far = 1e3 * (range.1 - range.0);
            (range.0 - far, range.1 + far)
        }
    }
}

/// Shaded ranges limited to the axis, which makes infinite ends finite.
fn within(ranges: &[(f64, f64)], (first, last): (f64, f64)) -> Vec<(f64, f64)> {
    let (low, high) = (first.min(last), first.max(last));
    let known = ranges.iter().filter(|(a, b)| !a.is_nan() && !b.is_nan());
    known.map(|(a, b)| (a.clamp(low, high), b.clamp(low, high))).collect()
}

fn axis(axis: &Axis, range: (f64, f64)) -> AxisData {
    AxisData {
        label: axis.label.clone(),
        unit: axis.unit.clone(),
        log: axis.scale == AxisScale::Log,
        range: (round_significant(range.0, 9), round_significant(range.1, 9)),
    }
}

/// Values as the page draws them in a panel: rounded, and with finite substitutes for infinite edges.
struct Scaled<'a> {
    x: (f64, f64),
    y: (f64, f64),
    far: (f64, f64),
    /// The columns of x values of the figure.
    xs: &'a mut Vec<Column>,
}

impl Scaled<'_> {
    fn x(&mut self, values: impl Iterator<Item = f64>) -> Option<usize> {
        Some(share(values.collect(), self.x, self.xs))
    }

    fn y(&self, values: impl Iterator<Item = f64>) -> Option<Column> {
        Some(Column(values.map(|v| round_within(v, self.y, Y_DIGITS)).collect()))
    }

    /// Edges and whiskers.
    fn edge(&self, values: impl Iterator<Item = f64>) -> Option<Column> {
        self.y(values.map(|v| v.clamp(self.far.0, self.far.1)))
    }

    fn points(&mut self, points: &[Point]) -> LayerData {
        let x = self.x(points.iter().map(|p| p.0));
        LayerData { x, y: self.y(points.iter().map(|p| p.1)), ..LayerData::default() }
    }

    fn band(&mut self, x: &[f64], lower: &[f64], upper: &[f64]) -> LayerData {
        let stride = x.len().div_ceil(DOTS).max(1);
        LayerData {
            x: self.x(x.iter().copied().step_by(stride)),
            low: self.edge(lower.iter().copied().step_by(stride)),
            high: self.edge(upper.iter().copied().step_by(stride)),
            alpha: Some(BAND_ALPHA),
            ..LayerData::default()
        }
    }

    fn bars(&mut self, points: &[ErrorBar]) -> LayerData {
        LayerData {
            x: self.x(points.iter().map(|p| p.x)),
            y: self.y(points.iter().map(|p| p.y)),
            low: self.edge(points.iter().map(|p| p.lower)),
            high: self.edge(points.iter().map(|p| p.upper)),
            ..LayerData::default()
        }
    }
}

fn layer(layer: &Layer, scaled: &mut Scaled) -> LayerData {
    let named = |kind: &'static str, label: &str, role: ColourRole, data: LayerData| LayerData {
        kind,
        label: label.to_owned(),
        color: role.css_variable(),
        version: match role {
            ColourRole::Given => Some("given"),
            ColourRole::Model => Some("model"),
            _ => None,
        },
        ..data
    };
    let reference = |at: f64, dash: Dash| LayerData {
        at: Some(at),
        dash: dash_name(dash),
        ..LayerData::default()
    };
    match layer {
        Layer::Line { points, label, role, width, dash } => {
            let (width, dash) = (Some(*width), dash_name(*dash));
            let data = LayerData { width, dash, ..scaled.points(&thinned(points)) };
            named("line", label, *role, data)
        }
        Layer::Points { points, label, role, radius, alpha } => {
            let stride = points.len().div_ceil(DOTS).max(1);
            let some: Vec<Point> = points.iter().copied().step_by(stride).collect();
            let (radius, alpha) = (Some(*radius), Some(*alpha));
            named("dots", label, *role, LayerData { radius, alpha, ..scaled.points(&some) })
        }
        Layer::Band { x, lower, upper, label, role } => {
            named("band", label, *role, scaled.band(x, lower, upper))
        }
        Layer::HLine { at, label, role, dash } => {
            named("hline", label, *role, reference(*at, *dash))
        }
        Layer::VLine { at, label, role, dash } => {
            named("vline", label, *role, reference(*at, *dash))
        }
        Layer::Shade { ranges, label, role } => {
            let (ranges, alpha) = (Some(within(ranges, scaled.x)), Some(SHADE_ALPHA));
            named("shade", label, *role, LayerData { ranges, alpha, ..LayerData::default() })
        }
        Layer::ErrorBars { points, label, role } => {
            named("bars", label, *role, scaled.bars(points))
        }
        // never on an interactive figure: see Figure::is_interactive
        Layer::Bars(_) | Layer::HeatMap(_) => LayerData::default(),
    }
}

/// Thins each stretch without gaps; missing points between stretches are kept.
fn thinned(points: &[Point]) -> Vec<Point> {
    let stretches = runs(points).count().max(1);
    let mut kept = Vec::new();
    for run in runs(points) {
        if !kept.is_empty() {
            kept.push((f64::NAN, f64::NAN));
        }
        let columns = (COLUMNS * run.len()).div_ceil(points.len()).max(1);
        kept.extend(decimate(run, if stretches == 1 { COLUMNS } else { columns }));
    }
    kept
}

/// Index of a column of x values, stored once.
fn share(x: Vec<f64>, range: (f64, f64), xs: &mut Vec<Column>) -> usize {
    let x: Vec<f64> = x.into_iter().map(|v| round_within(v, range, X_DIGITS)).collect();
    let same = |Column(a): &Column| {
        a.len() == x.len() && a.iter().zip(&x).all(|(a, b)| a.to_bits() == b.to_bits())
    };
    xs.iter().position(same).unwrap_or_else(|| {
        xs.push(Column(x));
        xs.len() - 1
    })
}

/// Rounded to this number of digits of the range shown, but never finer than one digit more.
fn round_within(value: f64, range: (f64, f64), digits: i32) -> f64 {
    let span = (range.1 - range.0).abs();
    let finest = digits as usize + 1;
    let decimals = digits - span.log10().ceil() as i32;
    if !value.is_finite()
        || !(0..=12).contains(&decimals)
        || range.0 > 0.0 && range.1 > 100.0 * range.0
    {
        return round_significant(value, finest);
    }
    round_significant(round_decimals(value, decimals as usize), finest)
}

fn dash_name(dash: Dash) -> Option<&'static str> {
    match dash {
        Dash::Solid => None,
        Dash::Dashed => Some("dashed"),
        Dash::Dotted => Some("dotted"),
    }
}
