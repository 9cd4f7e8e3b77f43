//! Text on the recommended next step.

use super::effects::title;
use crate::report::format;
use crate::study::{Advice, DiagnosisStudy};

/// Smallest probability of the right decision for which an experiment is recommended: the usual power of a test
/// (Cohen, Statistical Power Analysis, 1988).
const POWER: f64 = 0.8;

/// The heading of the [`recommendation`]: a recording, unless none can decide.
#[must_use]
pub(in crate::report) fn recommends(diagnosis: &DiagnosisStudy) -> &'static str {
    let by_recording = |advice: &Advice| !matches!(advice, Advice::Equivalent { .. });
    match diagnosis.proposal.is_some() || diagnosis.next.iter().any(by_recording) {
        true => "Next recording",
        false => "To distinguish",
    }
}

/// The recommended next step or recording, with the manoeuvre written for it; `None` if no recording is
/// recommended.
#[must_use]
pub fn recommendation(diagnosis: &DiagnosisStudy) -> Option<String> {
    let mut sentences: Vec<String> = diagnosis.next.iter().map(words).collect();
    sentences.extend(diagnosis.proposal.iter().map(|proposal| {
        let (duration, probability) = (proposal.movement.duration(), proposal.probability);
        let shown = format::probability(probability);
        let files = "next_run.csv (set-points) and next_run.toml (segments)";
        match probability < POWER {
            true => format!(
                "No manoeuvre of {duration:.0} s that was tried distinguishes them; the best, in {files}, identifies the \
                 right effect with a probability of {shown} only. {TWICE}"
            ),
            false => format!(
                "A suitable manoeuvre of {duration:.0} s is in {files}; one run of it identifies the right effect with a \
                 probability of {shown}. {TWICE}"
            ),
        }
    }));
    (!sentences.is_empty()).then(|| sentences.join(" "))
}

/// An effect is accepted if it lowers the error on recordings that nothing was fitted to.
const TWICE: &str = "Drive it twice, once for `train` and once for `validation`: an effect is proven on recordings that \
                     were not fitted.";

fn words(advice: &Advice) -> String {
    match advice {
        Advice::CheckColumns => {
            "Check in the experiment file that the columns are those of the wheels and of their input, and that the \
             units are right, that of the time too: `experiment new` shows the ranges of all columns."
                .to_owned()
        }
        Advice::ChangeSpeed => {
            "Record speeding up, braking and reversals, best by steps of the input without feedback.".to_owned()
        }
        Advice::RecordLonger => {
            "Record longer, at least 20 s with speeding up, braking and reversals, for training and for validation."
                .to_owned()
        }
        Advice::RecordFaster { rate } => {
            format!("Record the input about ten times faster, at {rate} rows per second.")
        }
        Advice::Prove { effect, excitation, faster } => {
            let faster = if *faster { ", at a higher rate" } else { "" };
            format!("To prove {}, record{faster}: {excitation}.", title(effect))
        }
        Advice::Equivalent { effect, others } => format!(
            "No recording of wheel speeds and torques distinguishes {} from {}: their equations are \
             the same. A measurement of another kind is needed, for example of the input with the motors switched off.",
            title(effect),
            others.iter().map(|id| title(id)).collect::<Vec<_>>().join(" or ")
        ),
        Advice::TrainOn { recordings } => format!(
            "Record more of the movement of {} for training: the present training recordings determine too little what it \
             depends on.",
            match &recordings[..] {
                [one] => one.as_str(),
                _ => "the validation recordings",
            }
        ),
        Advice::Closest([first, second]) => format!(
            "The closest effects of the catalogue are {} and {}; neither is proven.",
            title(first),
            title(second)
        ),
        Advice::Distinguish { effects: [one, other], excitations: [shows_one, shows_other] } => {
            format!(
                "To distinguish {} from {}, record: {shows_one}; and: {shows_other}.",
                title(one),
                title(other)
            )
        }
    }
}
