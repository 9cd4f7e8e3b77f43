//! On what the missing moment depends.

use super::{Section, thinned};
use crate::compare::{Bin, Dependence, MissingMoment};
use crate::report::block::{Block, Cell, Column, Table};
use crate::report::figure::{Axis, Figure, Layer, Panel};
use crate::report::format;
use crate::report::palette::Role;
use crate::study::Study;

/// Missing moment against every variable.
#[derive(Default)]
pub struct DependenceSection;

/// Dependences that are drawn.
const DRAWN: usize = 6;

impl Section for DependenceSection {
    fn id(&self) -> &'static str {
        "dependence"
    }
    fn title(&self) -> &'static str {
        "On what the missing moment depends"
    }
    fn how_to_read(&self) -> &'static str {
        "A curve that stays in its band about zero is noise; the shape of one that does not is the \
         missing physics, drawn without a formula."
    }
    fn blocks(&self, study: &Study) -> Vec<Block> {
        let mut blocks = Vec::new();
        if let Some(missing) = &study.missing_moment {
            blocks.push(curves(study, missing).into());
            blocks.push(table(missing).into());
        }
        if let Some(figure) = residuals(study) {
            blocks.push(figure.into());
        }
        blocks
    }
}

fn curves(study: &Study, missing: &MissingMoment) -> Figure {
    let unit = study.drive_unit.symbol();
    let mut figure = Figure::new("missing_moment", "Missing moment against what it depends on most")
        .with_subtitle(format!(
            "Score test at the fitted parameters, {} recordings; bands are 95 %",
            study.judged_words()
        ));
    for (n, d) in missing.dependences.iter().take(DRAWN).enumerate() {
        let mut panel = Panel::new(
            Axis::linear(d.variable.words(), d.variable.unit(unit)),
            Axis::linear("missing moment", unit),
        )
        .with(Layer::hline(0.0, "", Role::Ink));
        for (wheel, role) in [(0, Role::Wheel1), (1, Role::Wheel2)] {
            let label = if n == 0 { format!("wheel {}", wheel + 1) } else { String::new() };
            panel = with_curve(panel, d, wheel, label, role);
        }
        figure = figure.with_panel(panel);
    }
    figure.with_columns(2)
}

fn with_curve(panel: Panel, d: &Dependence, wheel: usize, label: String, role: Role) -> Panel {
    let known: Vec<&Bin> =
        d.bins.iter().filter(|b| b.moment[wheel].is_finite()).collect();
    let edge = |sign: f64| -> Vec<f64> {
        known.iter().map(|b| b.moment[wheel] + sign * 1.96 * b.std_error[wheel]).collect()
    };
    let line = known.iter().map(|b| (b.at, b.moment[wheel])).collect();
    panel
        .with(Layer::Band {
            x: known.iter().map(|b| b.at).collect(),
            lower: edge(-1.0),
            upper: edge(1.0),
            label: String::new(),
            role,
        })
        .with(Layer::line(line, label, role))
}

fn table(missing: &MissingMoment) -> Table {
    let mut table = Table::new(
        "Tests of the dependences, strongest first; nothing missing: p is large.",
        vec![
            Column::text("Variable"),
            Column::number("Chi-square", ""),
            Column::number("Degrees of freedom", ""),
            Column::number("p", ""),
        ],
    );
    for d in &missing.dependences {
        table.push(vec![
            Cell::text(d.variable.words()),
            Cell::formatted(format::significant(d.statistic, 3), d.statistic),
            Cell::count(d.rank),
            Cell::p_value((-d.log_significance).exp()),
        ]);
    }
    table
}

/// The plain window error against speed, turn rate, acceleration, heading and time.
fn residuals(study: &Study) -> Option<Figure> {
    let method = study.reference_method()?;
    let turn = std::f64::consts::TAU;
    type Pick = fn(&crate::study::RecordingStudy, usize) -> f64;
    let axes: [(&str, &str, Pick); 5] = [
        ("wheel speed", "rad/s", |r, k| r.omega[k][0]),
        ("speed difference w1 − w2", "rad/s", |r, k| r.omega[k][0] - r.omega[k][1]),
        ("acceleration", "rad/s²", |r, k| r.acceleration[k][0]),
        ("heading", "rad", |r, k| r.path[k][2]),
        ("time", "s", |r, k| r.t[k]),
    ];
    let mut figure = Figure::new("residuals", "Window error of wheel 1 against what it may depend on")
        .with_subtitle(format!("Measured minus simulated, {} recordings", study.judged_words()));
    for (name, unit, pick) in axes {
        let mut points = Vec::new();
        for &i in &study.judged() {
            let (r, p) = (&study.recordings[i], method.performance.get(i)?);
            for (k, w) in p.windows.iter().enumerate() {
                let x = pick(r, k);
                let x = if name == "heading" { x.rem_euclid(turn) } else { x };
                points.push((x, r.omega[k][0] - w[0]));
            }
        }
        let panel = Panel::new(Axis::linear(name, unit), Axis::linear("error", "rad/s"))
            .with(Layer::points(thinned(points, 900), "", Role::Measured))
            .with(Layer::hline(0.0, "", Role::Ink));
        figure = figure.with_panel(panel);
    }
    Some(figure.with_columns(2))
}
