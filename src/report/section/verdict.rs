//! The verdict in one sentence, and the recommended next step.

mod rest_offset;

use super::overlay::Overlay;
use super::{Depth, Section, words};
use crate::diagnose::THRESHOLDS;
use crate::effects;
use crate::identify::Status;
use crate::report::block::{Block, Number, Text, Tone};
use crate::report::verdict::{recommends, sentences};
use crate::report::{format, not_determined, recommendation, sign_of_speed};
use crate::study::{self, DiagnosisStudy, Grade, MethodStudy, Role, Study};

/// The missing effects, with the errors as evidence and the recommended next recording.
#[derive(Default)]
pub struct Verdict;

impl Section for Verdict {
    fn id(&self) -> &'static str {
        "verdict"
    }

    fn title(&self) -> &'static str {
        "Verdict"
    }

    fn depth(&self) -> Depth {
        Depth::Summary
    }

    fn how_to_read(&self) -> &'static str {
        "The noise floor is the error that a perfect model would still have, because speeds and \
         inputs are measured with noise; only the error above it is due to the model."
    }

    fn blocks(&self, study: &Study) -> Vec<Block> {
        let mut blocks = vec![finding(study)];
        blocks.extend(numbers(study));
        blocks.extend(next_step(study));
        blocks.extend(Overlay::of(study).map(|overlay| Block::from(overlay.stretch())));
        blocks.extend(cautions(study));
        blocks
    }
}

/// Number of issues of the recordings that are stated below the verdict.
const STATED: usize = 3;

fn finding(study: &Study) -> Block {
    let Some(model) = study.last_model() else {
        let reasons = study.methods.iter().filter_map(|m| Some(m.failure.as_ref()?.to_string()));
        let detail = reasons.collect::<Vec<_>>().join(" ");
        return Block::verdict(Tone::Bad, "No method has a fit, so there is no verdict.", detail);
    };
    let (tone, sentences) = match &study.diagnosis {
        Some(diagnosis) => (tone(diagnosis), sentences(diagnosis)),
        None => {
            let (tone, sentence) = compared(study, study.error_of(model));
            (tone, vec![sentence])
        }
    };
    Block::findings(tone, sentences, causes(study))
}

/// Physical causes of the effects found.
fn causes(study: &Study) -> String {
    let effects = study.diagnosis.iter().flat_map(|d| &d.effects);
    let with_cause = effects.filter(|e| !e.cause.is_empty());
    with_cause.map(|e| format!("{}: {}.", e.title, e.cause)).collect::<Vec<_>>().join(" ")
}

/// Error, floor, ratio and grade of the fit on which the verdict is based.
fn numbers(study: &Study) -> Option<Block> {
    let (model, grade) = study.last_model().zip(study.grade())?;
    let (error, floor) = (study.error_of(model), study.judged_floor());
    let three = |v: f64| format::digits(v, 3);
    let before = match (&study.completed, &study.given) {
        (Some(_), Some(given)) => {
            format!("{} without {}", three(study.error_of(given)), words::found(study))
        }
        _ => format!("of the {}", words::given(study)),
    };
    let tone = match grade {
        Grade::AtFloor | Grade::Near => Tone::Good,
        Grade::Useful => Tone::Neutral,
        Grade::Poor => Tone::Notice,
        Grade::NotUsable => Tone::Bad,
    };
    let number = |label: &str, value: String, unit: &str, note: String| Number {
        label: label.to_owned(),
        value,
        unit: unit.to_owned(),
        note,
        tone: Tone::Neutral,
    };
    let share = format::percent(error / study.top_speed());
    let (holds, meaning) = match error < study::FAR_BELOW_FLOOR * floor {
        true => ("an upper bound from noise and sampling", "its error is below that bound"),
        false => ("the error expected from noise alone", means(grade)),
    };
    let meaning = match study.undetermined().filter(|why| !why.is_of_tests()) {
        Some(_) => "its parameters cannot be determined from these recordings",
        None => meaning,
    };
    let judged = format!("on {} data; {holds}", study.judged_words());
    let is = match &study.completed {
        Some(_) => format!("{} the model is", format::capital(&words::added(study))),
        // another fit of the model is at the floor
        None if study.diagnosis.as_ref().is_some_and(|d| d.at_floor.is_some()) => {
            "As fitted by the diagnosis, the model is".to_owned()
        }
        None => "The model is".to_owned(),
    };
    Some(Block::Numbers(vec![
        number(&words::simulation_error(study), three(error), "rad/s", before),
        number("Noise floor", three(floor), "rad/s", judged),
        number(
            "Error over floor",
            three(error / floor),
            "",
            format!("error: {share} of the top speed"),
        ),
        Number { tone, ..number(&is, grade.words().to_owned(), "", meaning.to_owned()) },
    ]))
}

/// Meaning of a grade.
fn means(grade: Grade) -> &'static str {
    match grade {
        Grade::AtFloor => "these recordings cannot reveal a better one",
        Grade::Near => "the remaining error is small compared with noise or speed",
        Grade::Useful => "its error is within 5 % of the top speed",
        Grade::Poor => "its error is within 20 % of the top speed",
        Grade::NotUsable => "its error is above 20 % of the top speed",
    }
}

fn tone(diagnosis: &DiagnosisStudy) -> Tone {
    match diagnosis.verdict {
        study::Verdict::ModelSufficient if diagnosis.is_open() => Tone::Neutral,
        study::Verdict::ModelSufficient => Tone::Good,
        study::Verdict::EffectsMissing | study::Verdict::EffectLikely => Tone::Notice,
        study::Verdict::UnknownEffect => Tone::Bad,
    }
}

/// The verdict without a diagnosis: the error compared with its floor, and the regimes.
fn compared(study: &Study, error: f64) -> (Tone, String) {
    if let Some(why) = study.undetermined() {
        return (Tone::Bad, not_determined(why));
    }
    let ratio = error / study.judged_floor();
    if !ratio.is_finite() {
        return (Tone::Bad, "The simulation of the fitted model diverges.".to_owned());
    }
    let times = format::significant(ratio, 2);
    let mut places: Vec<String> = Vec::new();
    let failures = study.given.iter().flat_map(|m| &m.failures);
    for failure in failures.filter(|f| f.significant) {
        let place = words::regime(failure.regime);
        if !places.contains(&place) {
            places.push(place);
        }
    }
    if ratio <= THRESHOLDS.at_floor {
        let sentence = "The model follows the measurement down to the noise floor.";
        return (Tone::Good, sentence.to_owned());
    }
    if places.is_empty() {
        let sentence = format!(
            "The error is {times} times the noise floor, but no driving regime stands out."
        );
        return (Tone::Notice, sentence);
    }
    let more = places.len().saturating_sub(3);
    places.truncate(3);
    if more > 0 {
        places.push(format!("{more} more"));
    }
    let places = words::list(&places);
    (
        Tone::Bad,
        format!("The error is {times} times the noise floor; the model fails in: {places}."),
    )
}

/// Cautions for the use of the verdict.
fn cautions(study: &Study) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut notice = |sentence: String, detail: Text| {
        blocks.push(Block::verdict(Tone::Notice, sentence, detail));
    };
    if !study.recordings.iter().any(|r| r.role == Role::Validation) {
        notice(
            "No validation recording is given: the model is judged on the data it was fitted to."
                .to_owned(),
            Text::from(
                "A model with enough parameters fits its training data whether it is correct or not. Name a recording under ",
            )
            .code("validation")
            .plain("."),
        );
    }
    // with a diagnosis the verdict is based on its own fits
    if let Some(method) = study.reference_method().filter(|_| study.diagnosis.is_none()) {
        fit_cautions(study, method, &mut notice);
    }
    let sign = sign_of_speed(study).map(|sentence| (sentence, SIGN_REMEDY.to_owned()));
    let others =
        [sign, failures(study), late_input(study), rest_offset::notice(study), issues(study)];
    for (sentence, detail) in others.into_iter().flatten() {
        notice(sentence, detail.into());
    }
    blocks
}

/// What to record in place of a magnitude.
const SIGN_REMEDY: &str =
    "To test an effect, record the signed input, or the commanded voltage or its direction.";

/// The methods without a fit.
fn failures(study: &Study) -> Option<(String, String)> {
    let failed = study.methods.iter().filter(|m| m.failure.is_some());
    let failed: Vec<String> = failed.map(|m| words::method(study, m)).collect();
    if failed.is_empty() || study.reference.is_none() {
        return None;
    }
    let (count, all) = (failed.len(), study.methods.len());
    let sentence = format!("{count} of {all} methods failed: {}.", words::list(&failed));
    Some((sentence, "The reasons are listed with the methods, below.".to_owned()))
}

/// An input delay that was found without a diagnosis.
fn late_input(study: &Study) -> Option<(String, String)> {
    let timing = study.timing.ok().filter(|t| study.diagnosis.is_none() && t.is_late())?;
    let sentence = format!(
        "The motion starts {} ms after the recorded input, later than logging explains; the fit \
         represents it as an input delay.",
        format::fixed(1e3 * timing.dead_time_s, 1)
    );
    let detail = "A diagnosis distinguishes an input delay from an actuator lag.";
    Some((sentence, detail.to_owned()))
}

/// What the check of the recordings found.
fn issues(study: &Study) -> Option<(String, String)> {
    let found = study.findings();
    let sentence = match found.len() {
        0 => return None,
        1 => "The check of the recordings found one issue.".to_owned(),
        many => format!("The check of the recordings found {many} issues."),
    };
    // the section on the recordings is not printed
    let mut stated: Vec<String> =
        found.iter().take(STATED).map(|(files, issue)| format!("{files}: {issue}.")).collect();
    if found.len() > STATED {
        stated.push("See Recordings, below, for the others.".to_owned());
    }
    Some((sentence, stated.join(" ")))
}

/// Cautions for the use of a fit: no convergence, parameters that are not identifiable.
fn fit_cautions(study: &Study, method: &MethodStudy, notice: &mut impl FnMut(String, Text)) {
    if method.failure.is_some() || method.status != Some(Status::Converged) {
        let sentence = format!(
            "The fit did not converge: {} {}.",
            words::method(study, method),
            words::status(method)
        );
        notice(sentence, "Take its numbers as provisional; another method may converge.".into());
    }
    let unknown: Vec<String> = method
        .estimates
        .iter()
        .filter(|e| !e.identifiable && !e.fixed)
        .map(|e| e.symbol.clone())
        .collect();
    if !unknown.is_empty() {
        let sentence = format!("Not identifiable from these data: {}.", words::list(&unknown));
        notice(sentence, "The section on parameters states what to record or to fix.".into());
    }
}

fn next_step(study: &Study) -> Vec<Block> {
    let Some(diagnosis) = &study.diagnosis else {
        // a fuzzy system has no effects to add
        let is_fuzzy = study.reference_method().is_none_or(|m| m.fuzzy.is_some());
        return if is_fuzzy { vec![] } else { vec![Block::Paragraph(to_diagnose(study))] };
    };
    let mut blocks = Vec::new();
    let in_place = diagnosis.formula.as_ref().is_some_and(|f| f.in_place);
    if let Some(first) = diagnosis.found.first().filter(|_| !in_place) {
        let text = Text::from("Next step: add ")
            .plain(words::effect_in_text(first))
            .plain(" to the model and check that the error falls on data that were not fitted");
        let text = match study.invocation.has_file() {
            true => add_command(study, first, text.plain(": ")),
            false => text,
        };
        blocks.push(Block::Paragraph(text.plain(".")));
    }
    if let Some(formula) = &diagnosis.formula {
        let has_file = study.invocation.has_file();
        blocks.push(Block::paragraph(match has_file {
            true => {
                "To try the formula, copy it into the experiment file and run it again: the diagnosis then tests it \
                 together with the catalogue."
            }
            false => {
                "To try the formula, add it to the model as an effect of your own; in an experiment file:"
            }
        }));
        blocks.push(Block::Code(formula.toml.clone()));
        if has_file {
            let text = add_command(study, &formula.id, Text::from("With the block in the file, "));
            blocks.push(Block::Paragraph(text.plain(" adds it to the model.")));
        }
    }
    if let Some(next) = recommendation(diagnosis) {
        let heading = format!("{}. ", recommends(diagnosis));
        blocks.push(Block::paragraph(Text::default().strong(heading).plain(next)));
    }
    blocks
}

/// How to run a diagnosis.
fn to_diagnose(study: &Study) -> Text {
    let text = Text::from("Next step: to learn whether an effect is missing, and which, ");
    if !study.invocation.has_file() {
        return text.plain("run a diagnosis.");
    }
    let text = text.plain("add ").code("[diagnosis]").plain(" to the experiment file");
    // the delay of a dead time is fitted without being in the file
    let delay = || effects::delay().filter(|_| words::has_fitted_delay(study)).map(|e| e.id());
    let text = match delay().or_else(effects::most_common) {
        Some(id) => add_command(study, &id, text.plain(", or try one: ")),
        None => text,
    };
    text.plain(".")
}

/// The command that adds an effect, preceded by the one that writes the experiment file if there is none yet.
fn add_command(study: &Study, effect: &str, text: Text) -> Text {
    let text = match study.invocation.new_file() {
        Some(command) => text.code(command).plain(", then "),
        None => text,
    };
    text.code(study.invocation.add(effect))
}
