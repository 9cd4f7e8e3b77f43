//! Dependence of the residual torque on variables, without and with the effects found.

use super::intervals::intervals;
use super::{Section, words};
use crate::compare::{Acting, Curve, CurveBin, Mean};
use crate::diagnose::THRESHOLDS;
use crate::math::distribution::NORMAL_95;
use crate::report::block::{Block, Cell, Column, Table};
use crate::report::figure::{Axis, ColourRole, Dash, ErrorBar, Figure, Layer, Panel};
use crate::report::format;
use crate::study::Study;

/// Section "What the residual torque depends on".
#[derive(Default)]
pub struct Dependence;

/// Number of variables drawn, those that explain most first.
const DRAWN: usize = 3;

impl Section for Dependence {
    fn id(&self) -> &'static str {
        "dependence"
    }

    fn title(&self) -> &'static str {
        "What the residual torque depends on"
    }

    fn how_to_read(&self) -> &'static str {
        "The residual torque is the recorded input minus the torque that the model requires for the \
         measured motion: a straight line over speed indicates viscous friction, a step at zero dry \
         friction, a wave over the heading an inclined floor or, as a resistance, the pile of a carpet."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        if study.curves.is_empty() {
            return vec![];
        }
        let table = vec![table(study).into()];
        let mut out = vec![figure(study).into()];
        out.extend(intervals(study).map(Block::from));
        out.push(Block::folded("All variables", table));
        out
    }
}

fn figure(study: &Study) -> Figure {
    let first = &study.curves[0];
    let before = format::percent(first.share_before);
    let (variable, acting) = (first.variable.words(), first.acting.words());
    let title = match first.share_after {
        _ if first.share_before < THRESHOLDS.named_share => {
            "The residual torque does not depend on any of the variables tested".to_owned()
        }
        Some(after) => format!(
            "The {variable} explains {before} of the residual torque{acting}, and {after} with {} in the model",
            words::found(study),
            after = format::percent(after)
        ),
        None => format!("The {variable} explains {before} of the residual torque{acting}"),
    };
    let mut figure = Figure::new("dependence", title)
        .with_subtitle("All recordings; means of bins with 95 % intervals")
        .with_caption(caption(study))
        .with_columns(2)
        .interactive()
        .with_height(560.0);
    for curve in drawn(study) {
        for i in 0..2 {
            let mut panel = panel(study, curve, i);
            if !figure.panels.is_empty() {
                panel.layers.iter_mut().for_each(Layer::unlabel);
            }
            figure.panels.push(panel);
        }
    }
    figure
}

/// The variables that explain most for the model as given; the last is replaced by the one that explains most
/// of the remaining residual torque, if not among them.
fn drawn(study: &Study) -> Vec<&Curve> {
    let mut drawn: Vec<&Curve> = study.curves.iter().take(DRAWN).collect();
    let left = |c: &Curve| c.share_after.unwrap_or(0.0);
    let most = study.curves.iter().max_by(|a, b| left(a).total_cmp(&left(b)));
    if let Some(most) = most.filter(|c| left(c) >= THRESHOLDS.named_share)
        && drawn.iter().all(|c| c.variable != most.variable)
    {
        drawn.pop();
        drawn.push(most);
    }
    drawn
}

fn caption(study: &Study) -> String {
    let line = match study.curves[0].share_after {
        Some(_) => {
            " The line is the torque that the effects found, with all parameters fitted again, add to the model."
        }
        None => "",
    };
    let geometry = match study.track_is_known {
        true => "",
        false => {
            " The track of the robot is unknown: turn rate and heading are computed with another track, so the shape of the curves is valid, but not their scale."
        }
    };
    let acting = match study.curves.iter().all(|c| c.acting == Acting::Torque) {
        true => "",
        false => {
            " Resistance: residual torque times the sign of the wheel speed. Share of the input: ratio of \
             the residual torque to the input. In both, the part that is constant over the whole range is \
             omitted."
        }
    };
    format!(
        "Recorded input minus the torque that the model requires for the measured motion, after a low-pass, in bins of a \
         variable; rows near rest or a reversal, where the direction of dry friction is not known, are left out. No line crosses a range without data.{line} Variables that \
         varied together in these recordings have the same curve.{acting}{geometry}"
    )
}

/// The residual torque of a wheel over a variable: without and with the effects found, and their torque.
fn panel(study: &Study, curve: &Curve, i: usize) -> Panel {
    let unit = study.drive_unit.symbol();
    let variable = curve.variable;
    let zero = Layer::HLine {
        at: 0.0,
        label: String::new(),
        role: ColourRole::NoiseFloor,
        dash: Dash::Solid,
    };
    let mut x = Axis::linear(variable.words(), variable.unit(unit));
    if let (Some(first), Some(last)) = (curve.bins.first(), curve.bins.last()) {
        let room = 0.04 * (last.at - first.at);
        x = x.with_range(first.at - room, last.at + room);
    }
    let side = words::SIDES[i];
    let y = match curve.acting {
        Acting::Torque => Axis::linear(format!("residual torque, {side} wheel"), unit),
        Acting::Resistance => Axis::linear(format!("resistance, {side} wheel"), unit),
        Acting::Gain => Axis::linear(format!("share of the input, {side} wheel"), ""),
    };
    let mut panel = Panel::new(x, y).with(zero);
    let is_after = curve.share_after.is_some();
    if is_after {
        let points =
            joined(curve, |bin| bin.before[i].value - bin.after.map_or(0.0, |a| a[i].value));
        let label = words::found(study);
        let (role, dash) = (ColourRole::Highlight, Dash::Solid);
        panel = panel.with(Layer::Line { points, label, role, width: 2.4, dash });
    }
    let role = if is_after { ColourRole::Given } else { ColourRole::Model };
    let points = joined(curve, |bin| bin.before[i].value);
    let dash = Dash::Dotted;
    panel = panel
        .with(Layer::Line { points, label: String::new(), role, width: 1.0, dash })
        .with(bars(curve, |bin| Some(bin.before[i]), words::given(study), role));
    if is_after {
        let after = |bin: &CurveBin| bin.after.map(|a| a[i]);
        let (label, role) = (words::added(study), ColourRole::Model);
        panel = panel.with(bars(curve, after, label, role));
    }
    panel
}

/// A line through the bins, interrupted at gaps in the data.
fn joined(curve: &Curve, value: impl Fn(&CurveBin) -> f64) -> Vec<(f64, f64)> {
    let mut out = Vec::new();
    for bin in &curve.bins {
        if !bin.joined && !out.is_empty() {
            out.push((bin.at, f64::NAN));
        }
        out.push((bin.at, value(bin)));
    }
    out
}

fn bars(
    curve: &Curve,
    mean: impl Fn(&CurveBin) -> Option<Mean>,
    label: String,
    role: ColourRole,
) -> Layer {
    let bar = |bin: &CurveBin| {
        let Mean { value, std_error, .. } = mean(bin)?;
        let reach = if std_error.is_finite() { NORMAL_95 * std_error } else { 0.0 };
        let (x, y) = (bin.at, value);
        y.is_finite().then_some(ErrorBar { x, y, lower: y - reach, upper: y + reach })
    };
    Layer::ErrorBars { points: curve.bins.iter().filter_map(bar).collect(), label, role }
}

fn table(study: &Study) -> Table {
    let unit = study.drive_unit.symbol();
    let mut columns = vec![
        Column::text("Variable"),
        Column::number(format!("Explains, {}", words::given(study)), ""),
        Column::number("Largest", unit),
    ];
    let is_after = study.curves.iter().any(|c| c.share_after.is_some());
    if is_after {
        columns.push(Column::number(format!("Explains, {}", words::added(study)), ""));
        columns.push(Column::number("Largest", unit));
    }
    let caption = "Share of the mean square of the residual torque that is explained by its means in bins \
                   of a variable (adjusted for degrees of freedom), and the largest bin mean; of both \
                   models as a share of the model as given. All recordings.";
    let mut table = Table::new(caption, columns);
    let largest = |curve: &Curve, of: &dyn Fn(&CurveBin) -> Option<[Mean; 2]>| {
        let means = curve.bins.iter().filter_map(of).flatten().map(|m| m.value);
        let known = means.filter(|m| m.is_finite());
        let v = known.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(f64::NAN);
        match curve.acting {
            Acting::Gain => Cell::formatted(format!("{} of the input", format::percent(v)), v),
            _ => Cell::formatted(format::significant(v, 2), v),
        }
    };
    let share = |v: f64| Cell::formatted(format::percent(v), v).bar(v);
    for curve in &study.curves {
        let mut row = vec![
            Cell::text(format!("{}{}", curve.variable.words(), curve.acting.words())),
            share(curve.share_before),
            largest(curve, &|b| Some(b.before)),
        ];
        if let Some(after) = curve.share_after {
            row.extend([share(after), largest(curve, &|b| b.after)]);
        }
        table.push(row);
    }
    table
}
