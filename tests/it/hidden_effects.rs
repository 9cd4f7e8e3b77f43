//! The fast twin of the hidden-effect benchmark: a few of its cases.

use amigo_ident::diagnose::Conclusion;
use rayon::prelude::*;

// the whole benchmark needs more of these two files than its twin
#[allow(dead_code)]
#[path = "../../benches/hidden_effects/cases.rs"]
mod cases;
#[allow(dead_code)]
#[path = "../../benches/hidden_effects/judge.rs"]
mod judge;
#[path = "../../benches/hidden_effects/made.rs"]
mod made;

use cases::{Case, Stranger, WORLDS};
use judge::{Outcome, judge};

/// What the diagnosis says of all cases, and a failure that names those where `good` is not true.
fn expect(cases: Vec<Case>, good: fn(&Case, &Outcome) -> bool) {
    let wrong: Vec<String> = cases
        .par_iter()
        .filter_map(|case| {
            let said = judge(case);
            (!good(case, &said)).then(|| format!("{case}: {:?} {:?}", said.conclusion, said.found))
        })
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn effects_of_six_kinds_are_named_and_nothing_else() {
    let ids =
        ["viscous_friction", "turning_scrub", "actuator_lag", "slope", "stribeck", "torque_gain"];
    let cases = ids.map(|id| Case::single(id, 1.0, 2, 9)).to_vec();
    expect(cases, |case, said| said.exact(case) && said.conclusion == Conclusion::Missing);
}

#[test]
fn a_healthy_robot_raises_no_alarm_whatever_the_noise_really_is() {
    let cases = WORLDS.map(|world| Case::healthy(world, 2, 77)).to_vec();
    expect(cases, |_, said| said.conclusion == Conclusion::Sufficient);
}

#[test]
fn noise_of_the_drive_does_not_turn_a_delay_into_a_lag() {
    let ids = ["actuator_delay", "actuator_lag"];
    let cases = ids.map(|id| Case::single(id, 1.0, 3, 9)).to_vec();
    expect(cases, |case, said| said.exact(case));
}

#[test]
fn two_effects_are_found_and_no_third() {
    expect(vec![Case::pair(0, 2)], |case, said| said.exact(case));
}

#[test]
fn what_is_not_in_the_catalogue_is_said_to_be_unknown() {
    let strange = [Stranger::Resonance, Stranger::Payload];
    let cases = strange.map(|s| Case::stranger(s, 2, 77)).to_vec();
    expect(cases, |_, said| said.conclusion == Conclusion::Unknown);
}
