//! The driving regimes in which the model fails.

use super::{Section, words};
use crate::compare::Failure;
use crate::diagnose::THRESHOLDS;
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
         into the next until the simulation ends (after 2 s at most); a star marks where the error is above 1.2 times the floor and the mean \
         residual torque is significant at 5 % after correction for multiple tests (Holm)."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        let Some(given) = study.given.as_ref().filter(|m| !m.failures.is_empty()) else {
            return vec![];
        };
        let models = [(words::given(study), given)].into_iter();
        let models = models.chain(study.completed.as_ref().map(|m| (words::added(study), m)));
        let models: Vec<(String, &[Failure])> =
            models.map(|(name, m)| (name, m.failures.as_slice())).collect();
        let table = vec![table(study, &models).into()];
        vec![map(study, &models).into(), Block::folded("All regimes in numbers", table)]
    }
}

fn title(models: &[(String, &[Failure])]) -> String {
    let words = |(name, failures): &(String, &[Failure])| match models.len() {
        1 => format::capital(&of_model(failures)),
        _ => format!("{name}: {}", of_model(failures)),
    };
    format::capital(&models.iter().map(words).collect::<Vec<_>>().join("; "))
}

/// Where the residual torque is significant, and where the error is largest: one regime may show the cause, and another
/// one the larger error, which earlier motion brings there.
fn of_model(failures: &[Failure]) -> String {
    let place = |f: &Failure| {
        let side = words::SIDES[f.wheel.saturating_sub(1).min(1)];
        format!("{} ({side} wheel)", words::regime(f.regime))
    };
    let times = |f: &Failure| format::significant(f.ratio_to_noise, 2);
    let significant = failures.iter().filter(|f| f.significant);
    let clearest = significant.min_by(|a, b| {
        a.p_value.total_cmp(&b.p_value).then(b.ratio_to_noise.total_cmp(&a.ratio_to_noise))
    });
    let ratios = failures.iter().filter(|f| f.ratio_to_noise.is_finite());
    let largest = ratios.max_by(|a, b| a.ratio_to_noise.total_cmp(&b.ratio_to_noise));
    let largest = largest.filter(|f| f.ratio_to_noise > THRESHOLDS.above_floor);
    match (clearest, largest) {
        (None, None) => "no regime stands out".to_owned(),
        // which does not prove a small error
        (None, Some(f)) => format!(
            "no regime has a significant residual torque, but the error is up to {} times the floor ({})",
            times(f),
            words::regime(f.regime)
        ),
        (Some(f), Some(most)) if !std::ptr::eq(f, most) => format!(
            "significant residual torque, most clearly in {}; largest error, {} times the floor, in {}",
            place(f),
            times(most),
            place(most)
        ),
        (Some(f), _) => format!(
            "significant residual torque, most clearly in {}, with an error of {} times the floor",
            place(f),
            times(f)
        ),
    }
}

fn map(study: &Study, models: &[(String, &[Failure])]) -> Figure {
    let regimes: Vec<Regime> = Regime::ALL
        .into_iter()
        .filter(|regime| models[0].1.iter().any(|f| f.regime == *regime))
        .collect();
    let all = models.iter().flat_map(|m| m.1).map(|f| f.ratio_to_noise);
    let most = all.filter(|v| v.is_finite()).fold(2.0, f64::max);
    let mut figure = Figure::new("regimes", title(models))
        .with_subtitle(format!("{} over noise floor, {} data", words::simulation_error(study), study.judged_words()))
        .with_caption(
            "Root mean square simulation error by regime of driving and wheel, over that of the noise \
             floor of the recording: where recordings differ in their floors, ratios differ from that of all \
             together. A star: the residual torque is significant, and the error above 1.2 times the floor.",
        )
        .with_columns(models.len());
    for (name, failures) in models {
        let of = |regime: Regime, wheel: usize| {
            failures.iter().find(|f| f.regime == regime && f.wheel == wheel)
        };
        let ratio = |f: Option<&Failure>| f.map_or(f64::NAN, |f| f.ratio_to_noise);
        let text = |f: Option<&Failure>| match f {
            Some(f) => {
                let star = if f.significant { " *" } else { "" };
                format!("{}{star}", format::digits(f.ratio_to_noise, 2))
            }
            None => String::new(),
        };
        let map = HeatMap {
            rows: regimes.iter().map(|r| words::regime(*r)).collect(),
            columns: words::SIDES.map(|side| format!("{side} wheel")).to_vec(),
            text: regimes
                .iter()
                .map(|r| [1, 2].map(|wheel| text(of(*r, wheel))).to_vec())
                .collect(),
            values: regimes
                .iter()
                .map(|r| [1, 2].map(|wheel| ratio(of(*r, wheel))).to_vec())
                .collect(),
            colors: ColorMap::Sequential,
            label: "error over floor".to_owned(),
            unit: String::new(),
            range: Some((0.5, most)),
        };
        let panel = Panel::new(Axis::unlabelled(), Axis::unlabelled()).with(Layer::HeatMap(map));
        figure.panels.push(if models.len() > 1 { panel.with_title(name) } else { panel });
    }
    if models.len() == 1 {
        figure.size = Size { width: 620.0, height: None };
    }
    figure
}

/// The residual torque of a regime and its p-value; dashes where its blocks are too few for a test.
fn tested(failure: &Failure) -> [Cell; 2] {
    match failure.p_value {
        1.0 => [0, 1].map(|_| Cell::formatted(format::MISSING, f64::NAN)),
        p => [Cell::estimate(failure.torque, failure.std_error), Cell::p_value(p)],
    }
}

fn table(study: &Study, models: &[(String, &[Failure])]) -> Table {
    let unit = study.drive_unit.symbol();
    let mut columns =
        vec![Column::text("Regime"), Column::text("Wheel"), Column::number("Samples", "")];
    for (name, _) in models {
        columns.push(Column::number(format!("Share of error, {name}"), ""));
        columns.push(Column::number("Over floor", "×"));
        columns.push(Column::number("Residual torque", unit));
        columns.push(Column::number("p, one regime", ""));
    }
    let caption = format!(
        "Driving regimes on {} data, those with a significant residual torque and an error above 1.2 times the floor (marked) \
         first, then by the ratio of error to noise: share of the summed squared simulation error, and the mean \
         residual torque ± standard error (over blocks of 1 s), with its p-value, not corrected for the number of regimes; a \
         dash where fewer than four blocks are in motion.",
        study.judged_words()
    );
    let mut table = Table::new(caption, columns).with_heads(2);
    for first in models[0].1 {
        let mut row = vec![
            Cell::text(words::regime(first.regime)),
            Cell::text(words::SIDES[first.wheel.saturating_sub(1).min(1)]),
            Cell::count(first.samples),
        ];
        for (_, failures) in models {
            let same = |f: &&Failure| f.regime == first.regime && f.wheel == first.wheel;
            let Some(f) = failures.iter().find(same) else { continue };
            let over = Cell::formatted(format::digits(f.ratio_to_noise, 3), f.ratio_to_noise);
            row.extend([
                Cell::formatted(format::percent(f.share_of_ise), f.share_of_ise)
                    .bar(f.share_of_ise),
                if f.significant { over.tone(Tone::Bad) } else { over },
            ]);
            row.extend(tested(f));
        }
        table.push(row);
    }
    table
}
