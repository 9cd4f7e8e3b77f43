//! What comes out, in one sentence, and what to do next.

use super::{Section, words};
use crate::report::block::{Block, Text, Tone};
use crate::report::format;
use crate::study::{self, MethodStudy, Role, Study};

/// The verdict.
#[derive(Default)]
pub struct Verdict;

/// An error above this many times the noise floor is worth words even if no regime stands out.
const ABOVE_NOISE: f64 = 1.1;

impl Section for Verdict {
    fn id(&self) -> &'static str {
        "verdict"
    }

    fn title(&self) -> &'static str {
        "Verdict"
    }

    fn how_to_read(&self) -> &'static str {
        "The noise floor is the error that a perfect model would still have, because speeds and \
         drives are measured with noise; what lies above it is the model's."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        let mut blocks = vec![finding(study)];
        blocks.extend(cautions(study));
        blocks.extend(next_step(study));
        blocks
    }
}

fn finding(study: &Study) -> Block {
    let Some(method) = study.reference_method() else {
        let reasons = study.methods.iter().filter_map(|m| m.failure.clone());
        let detail = reasons.collect::<Vec<_>>().join(" ");
        return Block::verdict(Tone::Bad, "No method has a fit, so nothing is judged.", detail);
    };
    let (tone, sentence) = match &study.diagnosis {
        Some(diagnosis) => (tone(diagnosis.verdict), diagnosis.sentence.clone()),
        None => compared(study, method),
    };
    Block::verdict(tone, sentence, judged_on(study, method))
}

fn tone(verdict: study::Verdict) -> Tone {
    match verdict {
        study::Verdict::ModelSufficient => Tone::Good,
        study::Verdict::EffectsMissing => Tone::Notice,
        study::Verdict::UnknownEffect => Tone::Bad,
    }
}

/// The verdict where no diagnosis was asked for: the error against its floor, and where.
fn compared(study: &Study, method: &MethodStudy) -> (Tone, String) {
    let ratio = study.judged_window_rms(method) / study.judged_floor();
    if !ratio.is_finite() {
        return (Tone::Bad, "The simulation of the fitted model diverges.".to_owned());
    }
    let times = format::significant(ratio, 2);
    let mut places: Vec<String> = Vec::new();
    for failure in study.failures.iter().filter(|f| f.significant) {
        let place = words::regime(failure.regime);
        if !places.contains(&place) {
            places.push(place);
        }
    }
    if places.is_empty() {
        return if ratio < ABOVE_NOISE {
            (Tone::Good, "The model follows the measurement down to the noise.".to_owned())
        } else {
            let sentence = format!(
                "The error is {times} times the noise floor, but no regime of driving stands out."
            );
            (Tone::Notice, sentence)
        };
    }
    let more = places.len().saturating_sub(3);
    places.truncate(3);
    if more > 0 {
        places.push(format!("{more} more"));
    }
    let places = words::list(&places);
    if ratio < ABOVE_NOISE {
        let sentence = format!(
            "The error is at the noise floor, yet a small moment is missing beyond doubt in: \
             {places}."
        );
        return (Tone::Notice, sentence);
    }
    (
        Tone::Bad,
        format!("The error is {times} times the noise floor; the model fails in: {places}."),
    )
}

fn judged_on(study: &Study, method: &MethodStudy) -> String {
    let (error, floor) = (study.judged_window_rms(method), study.judged_floor());
    let said = format::digits(error, 3);
    let start = study.diagnosis.as_ref().and_then(|d| d.staircase.first());
    let own = start
        .map(|step| format::digits(step.window_rms_validation, 3))
        .filter(|own| *own != said)
        .map_or(String::new(), |own| {
            format!(" The diagnosis fits the model by itself, and starts from {own} rad/s.")
        });
    format!(
        "Window error {} rad/s, noise floor {} rad/s (ratio {}); fit by {}, judged on {} data. \
         Model: {}.{own}",
        said,
        format::digits(floor, 3),
        format::digits(error / floor, 3),
        words::method(study, method),
        study.judged_words(),
        words::model(study),
    )
}

/// What a reader must know before relying on the verdict.
fn cautions(study: &Study) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut notice = |sentence: String, detail: &str| {
        blocks.push(Block::verdict(Tone::Notice, sentence, detail));
    };
    if !study.recordings.iter().any(|r| r.role == Role::Validation) {
        notice(
            "No validation recording is given: the model is judged on the data it was fitted to."
                .to_owned(),
            "A model with enough parameters follows its training data, right or wrong. Name a \
             recording under `validation`.",
        );
    }
    if let Some(method) = study.reference_method() {
        if words::status(method) != "converged" {
            let sentence = format!(
                "The fit is not settled: {} {}.",
                words::method(study, method),
                words::status(method)
            );
            notice(sentence, "Take its numbers as provisional; another method may settle.");
        }
        let unknown: Vec<String> = method
            .estimates
            .iter()
            .filter(|e| !e.identifiable && !e.fixed)
            .map(|e| words::symbol(&e.symbol))
            .collect();
        if !unknown.is_empty() {
            let sentence = format!("The data cannot give {}.", words::list(&unknown));
            notice(sentence, "See the parameters for what to record or to hold fixed.");
        }
    }
    let failed: Vec<String> = study
        .methods
        .iter()
        .filter(|m| m.failure.is_some())
        .map(|m| words::method(study, m))
        .collect();
    if !failed.is_empty() && study.reference.is_some() {
        let sentence = format!(
            "{} of {} methods failed: {}.",
            failed.len(),
            study.methods.len(),
            words::list(&failed)
        );
        notice(sentence, "The reasons stand with the methods.");
    }
    let found = study.findings().len();
    if found > 0 {
        let sentence = match found {
            1 => "The check of the recordings has one remark.".to_owned(),
            many => format!("The check of the recordings has {many} remarks."),
        };
        notice(sentence, "They stand with the recordings.");
    }
    blocks
}

fn next_step(study: &Study) -> Vec<Block> {
    let file = words::file_name(study);
    let Some(diagnosis) = &study.diagnosis else {
        let text = Text::from("Next step: to learn whether an effect is missing, and which, add ")
            .code("[diagnosis]")
            .plain(" to the experiment file, or try one with ")
            .code(format!("experiment add viscous_friction {file}"))
            .plain(".");
        return if study.reference.is_some() { vec![Block::Paragraph(text)] } else { vec![] };
    };
    let mut blocks = Vec::new();
    if let Some(first) = diagnosis.found.first() {
        let text = Text::from("Next step: add ")
            .plain(words::effect_in_text(first))
            .plain(" to the model with ")
            .code(format!("experiment add {first} {file}"))
            .plain(" and see whether the error falls on data that were not fitted.");
        blocks.push(Block::Paragraph(text));
    }
    if let Some(next) = &diagnosis.next_run {
        blocks.push(Block::paragraph(Text::default().strong("Next recording. ").plain(next)));
    }
    blocks
}
