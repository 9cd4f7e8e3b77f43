//! What the missing moment depends on: the trail to the missing effect.

mod window_error;

use super::{Section, words};
use crate::compare::{self, MissingMoment};
use crate::report::block::{Block, Cell, Column, Table, Tone};
use crate::report::figure::{Axis, Dash, ErrorBar, Figure, Layer, Panel, Role};
use crate::report::format;
use crate::study::Study;

/// What the error depends on.
#[derive(Default)]
pub struct Dependence;

/// Panels drawn, the strongest first.
const PANELS: usize = 6;
/// Error rate over all variables together.
const FALSE_ALARM: f64 = 0.05;

impl Section for Dependence {
    fn id(&self) -> &'static str {
        "dependence"
    }

    fn title(&self) -> &'static str {
        "What the error depends on"
    }

    fn how_to_read(&self) -> &'static str {
        "The missing moment is what would have to be added to the drive to explain the measurement; \
         a curve that leaves its band away from zero shows the shape of the missing effect: a slope \
         over speed is viscous friction, a step at zero is dry friction, a wave over the heading is \
         a slope of the floor."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        let mut blocks = Vec::new();
        if let Some((missing, data)) = missing_moment(study) {
            blocks.push(figure(study, missing, data).into());
            blocks.push(table(study, missing, data).into());
        }
        blocks.extend(window_error::figure(study).map(Block::from));
        blocks
    }
}

/// The missing moment over the training data where there is a diagnosis, else over the judged data,
/// and those data in words.
fn missing_moment(study: &Study) -> Option<(&MissingMoment, &'static str)> {
    let train = study.diagnosis.as_ref().and_then(|d| d.missing_moment.as_ref());
    let judged = study.missing_moment.as_ref().map(|m| (m, study.judged_words()));
    let missing = train.map(|m| (m, "training")).or(judged);
    missing.filter(|(m, _)| !m.dependences.is_empty())
}

/// Whether a dependence stands out among all that are looked at (Bonferroni).
fn is_significant(dependence: &compare::Dependence, count: usize) -> bool {
    dependence.log_significance > (count as f64 / FALSE_ALARM).ln()
}

fn figure(study: &Study, missing: &MissingMoment, data: &str) -> Figure {
    let shown = &missing.dependences[..missing.dependences.len().min(PANELS)];
    let strongest = &shown[0];
    let title = if is_significant(strongest, missing.dependences.len()) {
        format!("The missing moment depends most clearly on the {}", strongest.variable.words())
    } else {
        "The missing moment depends on nothing that was looked at".to_owned()
    };
    let mut figure = Figure::new("dependence", title)
        .with_subtitle(format!("On {data} data; strongest first, bins of equal counts"))
        .with_caption(
            "Moment that the model misses, by wheel, in bins of each variable, with 95 % intervals \
             (±1.96 standard errors). Effects that vary together share their trail: the first panel \
             is the best clue.",
        )
        .with_columns(2);
    figure.panels = shown.iter().map(|dependence| panel(study, dependence)).collect();
    figure
}

fn panel(study: &Study, dependence: &compare::Dependence) -> Panel {
    let unit = study.drive_unit.symbol();
    let variable = dependence.variable;
    let mut panel = Panel::new(
        Axis::linear(variable.words(), variable.unit(unit)),
        Axis::linear("missing moment", unit),
    )
    .with(Layer::HLine { at: 0.0, label: String::new(), role: Role::Ink, dash: Dash::Solid });
    let (first, last) = (dependence.bins.first(), dependence.bins.last());
    let width = first.zip(last).map_or(0.0, |(a, b)| b.at - a.at);
    for (i, role) in [Role::Wheel1, Role::Wheel2].into_iter().enumerate() {
        // the two wheels stand side by side, not on each other
        let aside = (i as f64 - 0.5) * 0.012 * width;
        let points: Vec<ErrorBar> = dependence
            .bins
            .iter()
            .filter(|bin| bin.moment[i].is_finite() && bin.std_error[i].is_finite())
            .map(|bin| {
                let (y, reach) = (bin.moment[i], 1.96 * bin.std_error[i]);
                ErrorBar { x: bin.at + aside, y, lower: y - reach, upper: y + reach }
            })
            .collect();
        let line = points.iter().map(|p| (p.x, p.y)).collect();
        let label = String::new();
        panel = panel
            .with(Layer::Line { points: line, label, role, width: 1.0, dash: Dash::Solid })
            .with(Layer::ErrorBars { points, label: words::WHEELS[i].to_owned(), role });
    }
    panel
}

fn table(study: &Study, missing: &MissingMoment, data: &str) -> Table {
    let unit = study.drive_unit.symbol();
    let columns = vec![
        Column::text("Variable"),
        Column::text("Evidence"),
        Column::number("p", ""),
        Column::number("Chi-square", ""),
        Column::number("Degrees", ""),
        Column::number("Largest, right", unit),
        Column::number("Largest, left", unit),
    ];
    let caption = format!(
        "Dependence of the missing moment on each variable, by a score test on {data} data \
         (chi-square with so many degrees of freedom), and the largest moment of all bins. Evidence \
         in words accounts for looking at all variables."
    );
    let mut table = Table::new(caption, columns);
    let count = missing.dependences.len();
    for d in &missing.dependences {
        let (words, tone) = evidence(d, count);
        let largest = |i: usize| {
            let known = d.bins.iter().map(|b| b.moment[i]).filter(|m| m.is_finite());
            known.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(f64::NAN)
        };
        let moment = |v: f64| Cell::formatted(format::significant(v, 2), v);
        let words = Cell::text(words);
        table.push(vec![
            Cell::text(d.variable.words()),
            if tone == Tone::Neutral { words } else { words.tone(tone) },
            Cell::p_value((-d.log_significance).exp()),
            Cell::number(d.statistic),
            Cell::count(d.rank),
            moment(largest(0)),
            moment(largest(1)),
        ]);
    }
    table
}

/// The strength of a dependence in words.
fn evidence(d: &compare::Dependence, count: usize) -> (&'static str, Tone) {
    let beyond = d.log_significance - (count as f64 / FALSE_ALARM).ln();
    match beyond {
        b if b > 50.0 => ("overwhelming", Tone::Bad),
        b if b > 10.0 => ("strong", Tone::Bad),
        b if b > 0.0 => ("clear", Tone::Notice),
        _ => ("none", Tone::Neutral),
    }
}
