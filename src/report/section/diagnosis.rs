//! Which effect is missing, with the evidence.

use super::{Depth, Section, words};
use crate::diagnose::{Judgement, Proposal, THRESHOLDS, explainable};
use crate::report::block::{Block, Cell, Column, Table, Text, Tone};
use crate::report::figure::{Axis, BarSeries, Bars, ColourRole, Figure, Layer, Panel};
use crate::report::verdict::{caused, recommends};
use crate::report::{evidence, format, recommendation};
use crate::study::{CandidateStudy, DiagnosisStudy, Study, Verdict};

/// Candidates by rank, with the evidence for each.
#[derive(Default)]
pub struct Diagnosis;

/// Candidates drawn and described in words.
const SHOWN: usize = 10;
/// Smallest probability of a candidate described in words, unless it is one of the first.
const LIKELY: f64 = 0.01;
/// Number of candidates that are always described.
const DESCRIBED: usize = 3;

impl Section for Diagnosis {
    fn id(&self) -> &'static str {
        "diagnosis"
    }

    fn title(&self) -> &'static str {
        "Which effect is missing"
    }

    fn depth(&self) -> Depth {
        Depth::Details
    }

    fn how_to_read(&self) -> &'static str {
        "Each effect of the catalogue is added to the model separately; the criterion (BIC) compares them \
         on the training data, and an effect is found only if it lowers the error on data that it was not fitted to."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        let Some(diagnosis) = &study.diagnosis else { return vec![] };
        let mut blocks = Vec::new();
        blocks.extend(ranking_figure(diagnosis).map(Block::from));
        blocks.push(summary(diagnosis));
        if !diagnosis.ranking.is_empty() {
            blocks.push(Block::Heading("Evidence for each candidate".to_owned()));
            blocks.push(Block::List(described(diagnosis)));
            blocks.push(table(study, &diagnosis.ranking).into());
            blocks.extend(ruled_out(&diagnosis.ranking));
        }
        if let Some(next) = recommendation(diagnosis) {
            blocks.push(Block::Heading(recommends(diagnosis).to_owned()));
            blocks.push(Block::paragraph(next));
        }
        blocks.extend(diagnosis.proposal.as_ref().map(manoeuvre).map(Block::from));
        blocks
    }
}

/// The best candidates by their criterion.
fn ranking_figure(diagnosis: &DiagnosisStudy) -> Option<Figure> {
    let mut shown: Vec<&CandidateStudy> =
        diagnosis.ranking.iter().filter(|c| c.delta_bic.is_finite()).collect();
    // the candidate accepted first may differ from the one ranked first in the screening
    shown.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
    shown.truncate(SHOWN);
    shown.first()?;
    let accepted = diagnosis.found.first();
    let place = accepted.and_then(|id| shown.iter().position(|c| c.effect == *id));
    let values: Vec<f64> = shown.iter().map(|c| c.delta_bic).collect();
    let mut series = BarSeries::new("", ColourRole::Measured, values);
    series.text = shown.iter().map(|c| probability(c)).collect();
    let bars = Bars {
        categories: shown.iter().map(|c| words::effect(&c.effect)).collect(),
        series: vec![series],
        highlight: place,
    };
    let is_lower = |c: &&CandidateStudy| !c.no_better;
    let title = match place.map(|place| (place, shown[place])) {
        None if !shown.iter().any(is_lower) && shown[0].delta_bic > 0.0 => {
            "No effect of the catalogue lowers the simulation error".to_owned()
        }
        None if shown[0].delta_bic > 0.0 => format!(
            "{} fits the training data best, but is not proven on data that it was not fitted to",
            words::effect(&shown[0].effect)
        ),
        None => "No effect of the catalogue improves the fit".to_owned(),
        Some((0, best)) => format!(
            "{} explains the data best (probability among the candidates {})",
            words::effect(&best.effect),
            probability(best)
        ),
        Some((_, accepted)) => {
            let (name, best) =
                (words::effect_in_text(&accepted.effect), words::effect(&shown[0].effect));
            format!(
                "{best} fits the training data best; {name} lowers the error on data that it was not fitted to"
            )
        }
    };
    let panel = Panel::new(Axis::linear("ΔBIC", ""), Axis::unlabelled()).with(Layer::Bars(bars));
    let figure = Figure::new("ranking", title)
        .with_subtitle("Each candidate added separately; labels: probability among the candidates")
        .with_caption(format!(
            "ΔBIC: by how much the Bayesian information criterion prefers the model with the candidate, on training \
             data; the best {} of {}. A difference of 6 in ΔBIC means odds of e³ = 20 to 1. No better: with the candidate the \
             simulation error is no lower, so that it is no more probable than no effect, whatever its ΔBIC.",
            shown.len(),
            diagnosis.ranking.len()
        ))
        .with_panel(panel);
    Some(figure)
}

/// The probability of a candidate in a label; of one that does not lower the simulation error, these words.
fn probability(candidate: &CandidateStudy) -> String {
    match candidate.no_better {
        true => NO_BETTER.to_owned(),
        false => format::probability(candidate.probability),
    }
}

const NO_BETTER: &str = "no better";

fn summary(diagnosis: &DiagnosisStudy) -> Block {
    let found: Vec<String> = diagnosis.found.iter().map(|id| words::effect_in_text(id)).collect();
    let text = if found.is_empty() {
        Text::from("No effect was added.")
    } else {
        let order = if found.len() > 1 { "Found, in this order: " } else { "Found: " };
        Text::from(order).strong(words::list(&found)).plain(".")
    };
    let left = left(diagnosis).map_or_else(String::new, |left| format!(" {left}"));
    Block::Paragraph(text.plain(left).plain(format!(
        " If nothing is missing, an effect is found in at most {} of experiments (false alarms).",
        format::percent(diagnosis.false_alarm)
    )))
}

/// What remains of the error above the noise floor, as the verdict has it.
fn left(diagnosis: &DiagnosisStudy) -> Option<String> {
    let errors = &diagnosis.errors;
    if explainable(errors.before, errors.floor).is_none() {
        return Some("There is no error above the noise floor to explain.".to_owned());
    }
    let share = Some(errors.unexplained()).filter(|share| share.is_finite())?;
    if share == 0.0 {
        return Some("No error above the noise floor remains.".to_owned());
    }
    let share = match format::percent(share) {
        small if small.starts_with('<') => small.replacen('<', "Less than", 1),
        share => share,
    };
    let error = "of the mean square error above the noise floor";
    match (diagnosis.found.is_empty(), caused(errors)) {
        // the verdict states what the error is compared with
        (true, _) if diagnosis.verdict == Verdict::ModelSufficient => None,
        (_, Some(cause))
            if diagnosis.verdict == Verdict::EffectsMissing
                && errors.ratio() > THRESHOLDS.at_floor =>
        {
            Some(format!("{share} {error} remains, {cause}."))
        }
        _ => Some(format!("{share} {error} remains unexplained.")),
    }
}

/// Candidates, the most probable first, those that are no better last; equally probable ones by their ΔBIC.
fn by_probability(ranking: &[CandidateStudy]) -> Vec<&CandidateStudy> {
    let mut sorted: Vec<&CandidateStudy> = ranking.iter().collect();
    let key = |c: &CandidateStudy| (!c.no_better, c.probability);
    sorted.sort_by(|a, b| {
        let ((better, p), (other, q)) = (key(a), key(b));
        other.cmp(&better).then(q.total_cmp(&p)).then(b.delta_bic.total_cmp(&a.delta_bic))
    });
    sorted
}

fn described(diagnosis: &DiagnosisStudy) -> Vec<Text> {
    let ranking = by_probability(&diagnosis.ranking).into_iter().enumerate().take(SHOWN);
    let likely = ranking.filter(|(place, c)| *place < DESCRIBED || c.probability > LIKELY);
    likely.map(|(_, candidate)| describe(candidate, diagnosis)).collect()
}

fn describe(candidate: &CandidateStudy, diagnosis: &DiagnosisStudy) -> Text {
    let mut text = Text::default()
        .strong(words::effect(&candidate.effect))
        .plain(" (")
        .code(&candidate.effect)
        .plain(match is_compared(candidate) {
            true if candidate.no_better => "), no better in simulation: ".into(),
            true => format!(
                "), probability among the candidates {}: ",
                format::probability(candidate.probability)
            ),
            false => "), without a probability, since its fit could not be compared: ".into(),
        })
        .plain(format!("{}.", evidence(candidate, diagnosis)));
    if !candidate.parameters.is_empty() {
        text = text.plain(format!(" {}.", words::list(&parameters(candidate))));
    }
    if !candidate.indistinguishable.is_empty() {
        let others: Vec<String> =
            candidate.indistinguishable.iter().map(|id| words::effect_in_text(id)).collect();
        text = text
            .plain(format!(" Not distinguishable by these data from {}.", words::list(&others)));
    }
    text
}

/// "f_t = 0.02010 ± 0.00020 N m", with a line break only before the unit.
fn parameters(candidate: &CandidateStudy) -> Vec<String> {
    candidate
        .parameters
        .iter()
        .map(|e| {
            let value = format::estimate(e.value, e.std_error);
            let unit = if value == format::NOT_IDENTIFIABLE {
                String::new()
            } else {
                words::unit(&e.unit)
            };
            let whole = |text: &str| text.replace(' ', "\u{a0}");
            let value = whole(&format!("{} = {value}", e.symbol));
            format!("{value} {}", whole(&unit)).trim_end().to_owned()
        })
        .collect()
}

fn table(study: &Study, ranking: &[CandidateStudy]) -> Table {
    let columns = vec![
        Column::text("Effect"),
        Column::number("Probability", ""),
        Column::number("p on data not fitted", ""),
        Column::number("ΔBIC", ""),
        Column::number(words::simulation_error(study), "rad/s"),
        Column::number("Quality index", "rad²/s"),
        Column::number("RMS torque", study.drive_unit.symbol()),
        Column::text("Parameters"),
    ];
    let before = ranking.first().map_or(String::new(), |c| {
        format!(
            " Without any: {} {} rad/s, quality index {} rad²/s.",
            words::simulation_error(study),
            format::digits(c.before.window_rms, 3),
            format::digits(c.before.ise, 3)
        )
    });
    let caption = format!(
        "The fitted candidates, best first, each added separately: probability among the candidates (a dash where the \
         simulation is no better or the fit could not be compared), p-value of the fall of the error on data that it was not \
         fitted to; errors with it on {} data, green if at least 1 % lower than without it.{before}",
        study.judged_words()
    );
    let mut table = Table::new(caption, columns);
    for c in by_probability(ranking).into_iter().filter(|c| is_fitted(c)) {
        let digits = |v: f64| Cell::formatted(format::digits(v, 3), v);
        let after = |value: fn(&Judgement) -> f64| c.after.as_ref().map_or(f64::NAN, value);
        let window_after = after(|j| j.window_rms);
        let better = window_after < 0.99 * c.before.window_rms;
        let window_after = digits(window_after);
        table.push(vec![
            Cell::text(words::effect(&c.effect)).noted(equivalents(c)),
            match is_compared(c) && !c.no_better {
                true => Cell::formatted(format::probability(c.probability), c.probability)
                    .bar(c.probability),
                false => Cell::formatted(format::MISSING, f64::NAN),
            },
            Cell::p_value(c.p_value),
            digits(if is_compared(c) { c.delta_bic } else { f64::NAN }),
            if better { window_after.tone(Tone::Good) } else { window_after },
            digits(after(|j| j.ise)),
            Cell::formatted(format::significant(c.torque_rms, 2), c.torque_rms),
            Cell::text(parameters(c).join("; ")),
        ]);
    }
    table
}

/// "or back-EMF": effects that these data do not distinguish from a candidate; may be empty.
fn equivalents(candidate: &CandidateStudy) -> String {
    let others = candidate.indistinguishable.iter().map(|id| words::effect_in_text(id));
    let others: Vec<String> = others.collect();
    if others.is_empty() { String::new() } else { format!("or {}", others.join(" or ")) }
}

/// Whether its criterion is finite.
fn is_compared(candidate: &CandidateStudy) -> bool {
    candidate.delta_bic.is_finite()
}

/// Whether it was fitted, though its criterion may not be finite.
fn is_fitted(candidate: &CandidateStudy) -> bool {
    is_compared(candidate) || candidate.after.is_some()
}

/// The candidates that the screening ranked last, in a sentence.
fn ruled_out(ranking: &[CandidateStudy]) -> Option<Block> {
    let names: Vec<String> = ranking
        .iter()
        .filter(|c| !is_fitted(c))
        .map(|c| words::effect_in_text(&c.effect))
        .collect();
    (!names.is_empty()).then(|| {
        Block::paragraph(format!(
            "Ruled out by the screening, before a fit: {}.",
            words::list(&names)
        ))
    })
}

/// The manoeuvre that distinguishes the two best candidates.
fn manoeuvre(proposal: &Proposal) -> Table {
    let columns = vec![
        Column::number("Segment", ""),
        Column::number("Forward speed", "m/s"),
        Column::number("Turn rate", "rad/s"),
        Column::number("Blending", "s"),
        Column::number("Holding", "s"),
    ];
    let caption = format!(
        "A manoeuvre that distinguishes the two best candidates; one run of it identifies the correct one \
         with a probability of {}. Its statistic is {} (chi-square, one degree), against {} for a random \
         manoeuvre of the same length.",
        format::probability(proposal.probability),
        format::digits(proposal.discrimination, 3),
        format::digits(proposal.random, 3)
    );
    let mut table = Table::new(caption, columns);
    for (k, segment) in proposal.movement.segments.iter().enumerate() {
        let digits = |v: f64| Cell::formatted(format::digits(v, 3), v);
        table.push(vec![
            Cell::count(k + 1),
            digits(segment.speed_m_s),
            digits(segment.turn_rad_s),
            digits(segment.blend_s),
            digits(segment.hold_s),
        ]);
    }
    table
}
