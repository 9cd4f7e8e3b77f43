//! The verdict, first on the page.

use super::{Section, spoken};
use crate::report::block::{Block, Tone};
use crate::report::format;
use crate::study::{self, Study};

/// The verdict in one sentence.
#[derive(Default)]
pub struct Verdict;

impl Section for Verdict {
    fn id(&self) -> &'static str {
        "verdict"
    }
    fn title(&self) -> &'static str {
        "Verdict"
    }
    fn how_to_read(&self) -> &'static str {
        "The window error is the rms wheel-speed error of open-loop simulations of 2 s; the noise \
         floor is what the right model would still have."
    }
    fn blocks(&self, study: &Study) -> Vec<Block> {
        let Some(method) = study.reference_method() else {
            return vec![Block::verdict(Tone::Bad, "No method has a fit.", "")];
        };
        let (error, floor) = (study.judged_window_rms(method), study.judged_floor());
        let ratio = error / floor;
        let detail = format!(
            "Judged on the {} recordings with {}: window error {} rad/s, noise floor {} rad/s, \
             ratio {}.",
            study.judged_words(),
            method.name,
            format::significant(error, 3),
            format::significant(floor, 3),
            format::significant(ratio, 3)
        );
        let (tone, sentence) = match &study.diagnosis {
            Some(d) => (
                match d.verdict {
                    study::Verdict::ModelSufficient => Tone::Good,
                    study::Verdict::EffectsMissing => Tone::Notice,
                    study::Verdict::UnknownEffect => Tone::Bad,
                },
                d.sentence.clone(),
            ),
            None if ratio < 1.1 => {
                (Tone::Good, "The model fits to the noise of the measurements.".to_string())
            }
            None => (Tone::Notice, failing(study)),
        };
        let mut blocks = vec![Block::verdict(tone, sentence, detail)];
        if let Some(found) = study.diagnosis.as_ref().and_then(|d| d.found.first()) {
            blocks.push(Block::paragraph("Next: add it to the model and see the error fall."));
            blocks.push(Block::Code(format!("experiment add {found} {}.toml", study.experiment)));
        } else if study.diagnosis.is_none() && ratio >= 1.1 {
            blocks.push(Block::paragraph(
                "Next: let the program look for the missing effect; add to the experiment file:",
            ));
            blocks.push(Block::Code("[diagnosis]\ncandidates = \"all\"".into()));
        }
        blocks
    }
}

/// Where the model fails, for a study without a diagnosis.
fn failing(study: &Study) -> String {
    let worst: Vec<String> = study
        .failures
        .iter()
        .filter(|f| f.significant)
        .take(2)
        .map(|f| format!("{} (wheel {})", spoken(f.regime.name()), f.wheel))
        .collect();
    if worst.is_empty() {
        "The model does not reach the noise floor; no single regime of driving stands out.".into()
    } else {
        format!("The model fails beyond noise, most in: {}.", worst.join(", "))
    }
}
