//! The error as effects are added, compared with the noise floor.

use super::{Section, words};
use crate::diagnose::explainable;
use crate::report::block::{Block, Cell, Column, Table};
use crate::report::figure::{Axis, BarSeries, Bars, ColourRole, Figure, Layer, Panel};
use crate::report::format;
use crate::study::Study;

/// Error by model version.
#[derive(Default)]
pub struct Staircase;

impl Section for Staircase {
    fn id(&self) -> &'static str {
        "staircase"
    }

    fn title(&self) -> &'static str {
        "Error by model version"
    }

    fn how_to_read(&self) -> &'static str {
        "Each bar is the error of a model with one more effect; the dashed line is the noise floor, which a correct model \
         reaches to within the uncertainty of the floor (20 %)."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        let mut blocks = Vec::new();
        if let Some(diagnosis) = study.diagnosis.as_ref().filter(|d| !d.staircase.is_empty()) {
            let stairs: Vec<Stair> = diagnosis
                .staircase
                .iter()
                .map(|step| Stair {
                    name: match &step.added {
                        None => words::model(&study.effects),
                        Some(id) => format!("+ {}", words::effect_in_text(id)),
                    },
                    error: step.window_rms_validation,
                    ise: step.ise_validation,
                    floor: study.judged_floor(),
                })
                .collect();
            let lead = if stairs.len() > 1 {
                "Effects found by the diagnosis, added one by one; every model fitted by the diagnosis"
            } else {
                "The diagnosis, which uses its own fit, adds no effect"
            };
            blocks.extend(show(study, "staircase", lead, &stairs));
        }
        if study.versions.len() > 1 {
            let stairs: Vec<Stair> = study
                .versions
                .iter()
                .map(|version| Stair {
                    name: words::model(&version.effects),
                    error: version.window_rms,
                    ise: version.ise,
                    floor: version.floor,
                })
                .collect();
            let lead = "Versions of this model run so far, oldest first, each by the fit that its verdict is \
                 based on";
            blocks.extend(show(study, "staircase-versions", lead, &stairs));
        }
        blocks
    }
}

/// One model version and its error on the judged recordings.
struct Stair {
    name: String,
    /// Over windows [rad/s].
    error: f64,
    /// Quality index [rad^2/s].
    ise: f64,
    /// Of the windows [rad/s].
    floor: f64,
}

impl Stair {
    /// Mean square error above noise, as a share of that of the `first` model; `None` where that has nothing to
    /// explain.
    fn left_of(&self, first: &Self) -> Option<f64> {
        let [own, floor] = [self.error, self.floor].map(|v| v * v);
        let whole = explainable(first.error.powi(2), first.floor.powi(2))?;
        Some(((own - floor) / whole).max(0.0))
    }
}

fn show(study: &Study, id: &str, lead: &str, stairs: &[Stair]) -> Vec<Block> {
    let table = vec![table(study, lead, stairs).into()];
    vec![figure(study, id, lead, stairs).into(), Block::folded("In numbers", table)]
}

fn figure(study: &Study, id: &str, lead: &str, stairs: &[Stair]) -> Figure {
    let floor = stairs.last().map_or(f64::NAN, |stair| stair.floor);
    let errors: Vec<f64> = stairs.iter().map(|stair| stair.error).collect();
    let mut series = BarSeries::new("", ColourRole::Model, errors.clone());
    series.text = errors.iter().map(|v| format::digits(*v, 3)).collect();
    let bars = Bars {
        categories: stairs.iter().map(|stair| stair.name.clone()).collect(),
        series: vec![series],
        highlight: None,
    };
    let first = stairs.first().map_or(f64::NAN, |stair| stair.error);
    let last = stairs.last().map_or(f64::NAN, |stair| stair.error);
    let title = if stairs.len() > 1 {
        format!(
            "{} from {} to {} rad/s; the noise floor is {}",
            if last < first { "The error falls" } else { "The error changes" },
            format::digits(first, 3),
            format::digits(last, 3),
            format::digits(floor, 3)
        )
    } else {
        format!(
            "The error is {} rad/s; the noise floor is {}",
            format::digits(last, 3),
            format::digits(floor, 3)
        )
    };
    let panel =
        Panel::new(Axis::linear(words::simulation_error(study), "rad/s"), Axis::unlabelled())
            .with(Layer::Bars(bars))
            .with(Layer::vline(floor, "noise floor", ColourRole::Ink));
    Figure::new(id, title)
        .with_subtitle(lead)
        .with_caption(format!(
            "Root mean square error of both wheel speeds ({}), on {} data.",
            words::simulation_error(study),
            study.judged_words()
        ))
        .with_panel(panel)
}

fn table(study: &Study, lead: &str, stairs: &[Stair]) -> Table {
    let caption = format!(
        "{lead}. Remaining: mean square simulation error above the noise floor, as a share of that \
         of the first model (a dash where that is at the floor); the quality index is that of the free simulation. On {} data.",
        study.judged_words()
    );
    let columns = vec![
        Column::text("Model"),
        Column::number(words::simulation_error(study), "rad/s"),
        Column::number("Over noise floor", "×"),
        Column::number("Remaining", ""),
        Column::number("Quality index", "rad²/s"),
    ];
    let mut table = Table::new(caption, columns);
    for stair in stairs {
        let ratio = stair.error / stair.floor;
        table.push(vec![
            Cell::text(&stair.name),
            Cell::formatted(format::digits(stair.error, 3), stair.error),
            Cell::formatted(format::digits(ratio, 3), ratio),
            match stair.left_of(&stairs[0]) {
                Some(left) => Cell::formatted(format::percent(left), left).bar(left),
                None => Cell::text(format::MISSING),
            },
            Cell::number(stair.ise),
        ]);
    }
    table
}
