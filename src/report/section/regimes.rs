//! In which regimes of driving the model fails.

use super::{Section, words};
use crate::compare::Failure;
use crate::recording::Regime;
use crate::report::block::{Block, Cell, Column, Table, Tone};
use crate::report::figure::{Axis, ColorMap, Figure, HeatMap, Layer, Panel, Size};
use crate::report::format;
use crate::study::Study;

/// Where the model fails.
#[derive(Default)]
pub struct Regimes;

impl Section for Regimes {
    fn id(&self) -> &'static str {
        "regimes"
    }

    fn title(&self) -> &'static str {
        "Where the model fails"
    }

    fn how_to_read(&self) -> &'static str {
        "A ratio of 1 means that noise explains the error, but an error made in one regime is carried \
         into the next until the window ends; a star marks where a constant moment is missing itself, \
         significant at 5 % after correction for looking at all regimes (Holm)."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        if study.failures.is_empty() {
            return vec![];
        }
        vec![map(study).into(), table(study).into()]
    }
}

fn title(failures: &[Failure]) -> String {
    let significant = failures.iter().filter(|f| f.significant);
    match significant.min_by(|a, b| a.p_value.total_cmp(&b.p_value)) {
        Some(worst) => format!(
            "A moment is missing, most clearly in: {} ({} wheel)",
            words::regime(worst.regime),
            words::SIDES[worst.wheel.saturating_sub(1).min(1)],
        ),
        None => "In no regime is a missing moment significant".to_owned(),
    }
}

fn map(study: &Study) -> Figure {
    let of = |regime: Regime, wheel: usize| {
        study.failures.iter().find(|f| f.regime == regime && f.wheel == wheel)
    };
    let regimes: Vec<Regime> = Regime::ALL
        .into_iter()
        .filter(|regime| (1..=2).any(|wheel| of(*regime, wheel).is_some()))
        .collect();
    let rows = |cell: &dyn Fn(Option<&Failure>) -> f64| -> Vec<Vec<f64>> {
        regimes.iter().map(|r| [1, 2].map(|wheel| cell(of(*r, wheel))).to_vec()).collect()
    };
    let text = |f: Option<&Failure>| match f {
        Some(f) => {
            let star = if f.significant { " *" } else { "" };
            format!("{}{star}", format::digits(f.ratio_to_noise, 2))
        }
        None => String::new(),
    };
    let values = rows(&|f| f.map_or(f64::NAN, |f| f.ratio_to_noise));
    let most = values.iter().flatten().copied().filter(|v| v.is_finite()).fold(2.0, f64::max);
    let map = HeatMap {
        rows: regimes.iter().map(|r| words::regime(*r)).collect(),
        columns: words::WHEELS.map(str::to_owned).to_vec(),
        text: regimes.iter().map(|r| [1, 2].map(|wheel| text(of(*r, wheel))).to_vec()).collect(),
        values,
        colors: ColorMap::Sequential,
        label: "window error over noise floor".to_owned(),
        unit: String::new(),
        range: Some((0.5, most)),
    };
    let mut figure = Figure::new("regimes", title(&study.failures))
        .with_subtitle(format!("Window error over noise floor, {} data", study.judged_words()))
        .with_caption(
            "Root mean square window error by regime of driving and wheel, over that of the noise \
             floor. A star: the missing moment is significant.",
        )
        .with_panel(Panel::new(Axis::unlabelled(), Axis::unlabelled()).with(Layer::HeatMap(map)));
    figure.size = Size { width: 620.0, height: None };
    figure
}

fn table(study: &Study) -> Table {
    let unit = study.drive_unit.symbol();
    let columns = vec![
        Column::text("Regime"),
        Column::text("Wheel"),
        Column::number("Share of error", ""),
        Column::number("Over noise", "×"),
        Column::number("Missing moment", unit),
        Column::number("p", ""),
        Column::text("Sure"),
        Column::number("Samples", ""),
    ];
    let caption = format!(
        "Regimes by how far the error exceeds noise, on {} data: share of the summed squared window \
         error, and the constant moment that the model misses there, ± standard error.",
        study.judged_words()
    );
    let mut table = Table::new(caption, columns);
    for f in &study.failures {
        let significant = Cell::text(if f.significant { "yes" } else { "no" });
        table.push(vec![
            Cell::text(words::regime(f.regime)),
            Cell::text(words::SIDES[f.wheel.saturating_sub(1).min(1)]),
            Cell::formatted(format::percent(f.share_of_ise), f.share_of_ise).bar(f.share_of_ise),
            Cell::formatted(format::digits(f.ratio_to_noise, 3), f.ratio_to_noise),
            Cell::estimate(f.moment, f.std_error),
            Cell::p_value(f.p_value),
            if f.significant { significant.tone(Tone::Bad) } else { significant },
            Cell::count(f.samples),
        ]);
    }
    table
}
