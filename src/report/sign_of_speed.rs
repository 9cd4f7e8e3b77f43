//! Inputs whose sign is that of the speed: what a verdict on them is conditional on.

use crate::conditioning::{Action, Channel, Finding};
use crate::study::Study;

/// The caution where `sign_from_speed` gave an input the sign of the speed that the model has to predict.
#[must_use]
pub fn sign_of_speed(study: &Study) -> Option<String> {
    let findings = || study.recordings.iter().flat_map(|r| &r.conditioning);
    let is_given = |f: &&Finding| f.action == Action::Corrected("sign_from_speed");
    let names = [0, 1].map(Channel::Input).into_iter();
    let names = names.filter(|c| findings().filter(is_given).any(|f| f.channel == *c));
    let names: Vec<String> = names.map(Channel::name).collect();
    (!names.is_empty()).then(|| {
        format!(
            "The sign of {} is that of the speed, which the model has to predict: error and effects are conditional on it, \
             and it is wrong while a wheel brakes.",
            names.join(" and ")
        )
    })
}
