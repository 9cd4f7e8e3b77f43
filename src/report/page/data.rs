//! The data of an interactive figure as JSON for the page's script.

use serde::Serialize;

use super::column::Column;
use crate::math::{round_decimals, round_significant};
use crate::report::ReportError;
use crate::report::figure::{Axis, AxisScale, Dash, Figure, Layer};
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
    at: Option<serde_json::Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    text: Option<String>,
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
                .map(|l| layer(l, x_range, far(&panel.y, y_range), y_range, &mut xs))
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

/// Shades lowest, bands above them, remarks on top: as in the printed picture.
fn ordered(layers: &[Layer]) -> impl Iterator<Item = &Layer> {
    let placed = |layer: &&Layer| match layer {
        Layer::HLine { at, .. } | Layer::VLine { at, .. } => at.is_finite(),
        Layer::Text { at, .. } => at.0.is_finite() && at.1.is_finite(),
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

fn layer(
    layer: &Layer,
    x_range: (f64, f64),
    far: (f64, f64),
    y_range: (f64, f64),
    xs: &mut Vec<Column>,
) -> LayerData {
    let round = |values: Vec<f64>| -> Column {
        Column(values.into_iter().map(|v| round_within(v, y_range, Y_DIGITS)).collect())
    };
    let base = |kind: &'static str, label: &str, role: ColourRole| LayerData {
        kind,
        label: label.to_owned(),
        color: role.css_variable(),
        version: match role {
            ColourRole::Given => Some("given"),
            ColourRole::Model => Some("model"),
            _ => None,
        },
        ..LayerData::default()
    };
    match layer {
        Layer::Line { points, label, role, width, dash } => {
            let (x, y) = split(&thinned(points));
            LayerData {
                x: Some(share(x, x_range, xs)),
                y: Some(round(y)),
                width: Some(*width),
                dash: dash_name(*dash),
                ..base("line", label, *role)
            }
        }
        Layer::Points { points, label, role, radius, alpha } => {
            let stride = points.len().div_ceil(DOTS).max(1);
            let (x, y) = split(&points.iter().copied().step_by(stride).collect::<Vec<_>>());
            LayerData {
                x: Some(share(x, x_range, xs)),
                y: Some(round(y)),
                radius: Some(*radius),
                alpha: Some(*alpha),
                ..base("dots", label, *role)
            }
        }
        Layer::Band { x, lower, upper, label, role } => {
            let stride = x.len().div_ceil(DOTS).max(1);
            let edge = |values: &[f64]| {
                round(values.iter().step_by(stride).map(|v| v.clamp(far.0, far.1)).collect())
            };
            LayerData {
                x: Some(share(x.iter().copied().step_by(stride).collect(), x_range, xs)),
                low: Some(edge(lower)),
                high: Some(edge(upper)),
                alpha: Some(BAND_ALPHA),
                ..base("band", label, *role)
            }
        }
        Layer::HLine { at, label, role, dash } => LayerData {
            at: Some((*at).into()),
            dash: dash_name(*dash),
            ..base("hline", label, *role)
        },
        Layer::VLine { at, label, role, dash } => LayerData {
            at: Some((*at).into()),
            dash: dash_name(*dash),
            ..base("vline", label, *role)
        },
        Layer::Shade { ranges, label, role } => LayerData {
            ranges: Some(within(ranges, x_range)),
            alpha: Some(SHADE_ALPHA),
            ..base("shade", label, *role)
        },
        Layer::ErrorBars { points, label, role } => {
            let column = |pick: fn(&crate::report::figure::ErrorBar) -> f64| -> Vec<f64> {
                points.iter().map(pick).collect()
            };
            let within = |values: Vec<f64>| {
                round(values.into_iter().map(|v| v.clamp(far.0, far.1)).collect())
            };
            LayerData {
                x: Some(share(column(|p| p.x), x_range, xs)),
                y: Some(round(column(|p| p.y))),
                low: Some(within(column(|p| p.lower))),
                high: Some(within(column(|p| p.upper))),
                ..base("bars", label, *role)
            }
        }
        Layer::Text { at, text, role } => LayerData {
            at: Some(vec![at.0, at.1].into()),
            text: Some(text.clone()),
            ..base("text", "", *role)
        },
        // never on an interactive figure: see Figure::is_interactive
        Layer::Bars(_) | Layer::HeatMap(_) => base("text", "", ColourRole::Ink),
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

fn split(points: &[Point]) -> (Vec<f64>, Vec<f64>) {
    points.iter().copied().unzip()
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
