//! Recordings whose angles start anew against known starts.

use super::*;
use crate::effects::Cycle;

/// Recordings of a robot with `effects`, of which each starts to record its angles `later` \[rad\] than they are.
fn recorded_from(effects: &[(&str, &[f64])], later: &[[f64; 2]]) -> Vec<Recording> {
    let one = |(seed, later): (u64, &[f64; 2])| {
        recorded(effects, NOISE, seed).with_later_angles([-later[0], -later[1]])
    };
    (18..).zip(later).map(one).collect()
}

fn found(recordings: &[Recording]) -> Option<Vec<Vec<StartAngle>>> {
    let all: Vec<&Recording> = recordings.iter().collect();
    start_angles(&Model::base(Robot::amigobot()), &all, Hold::Linear)
}

/// The starts that were found, against the first recording, where all are known.
fn against_first(found: &[Vec<StartAngle>], of: Cycle) -> Vec<(f64, f64)> {
    let angle = |starts: &Vec<StartAngle>| {
        let start = starts.iter().find(|start| start.of == of);
        start.map_or((0.0, 0.0), |start| (start.angle_rad, start.std_error_rad))
    };
    let first = angle(&found[0]);
    found.iter().map(|f| (angle(f).0 - first.0, angle(f).1.hypot(first.1))).collect()
}

#[test]
fn headings_that_differ_between_recordings_are_found_on_an_inclined_floor() {
    let robot = Robot::amigobot();
    let headings = [0.0_f64, 1.2, -2.0];
    let later = headings.map(|heading| {
        let turn = heading * robot.l1() / robot.r();
        [turn, -turn]
    });
    let slope: &[(&str, &[f64])] = &[("slope", &[0.04, 0.02, 0.3])];
    let starts = found(&recorded_from(slope, &later)).unwrap();
    for ((angle, error), heading) in against_first(&starts, Cycle::Heading).iter().zip(headings) {
        let off = (angle - heading).sin().abs();
        // four standard errors, and what is too small to be taken out of either
        assert!(off < 4.0 * error + 0.1, "{heading}: {angle} ± {error}");
    }
    // nothing to bring together where all start alike, and where no torque repeats with an angle
    assert_eq!(found(&recorded_from(slope, &[[0.0; 2]; 3])), None);
    assert_eq!(found(&recorded_from(&[], &later)), None);
    let scrub: &[(&str, &[f64])] = &[("turning_scrub", &[0.03])];
    assert_eq!(found(&recorded_from(scrub, &later)), None);
}

#[test]
fn a_slope_that_similar_headings_let_the_parameters_absorb_shows_in_the_torque_balance() {
    let robot = Robot::amigobot();
    let headings = [0.0_f64, 0.3, 3.0];
    let later = headings.map(|heading| {
        let turn = heading * robot.l1() / robot.r();
        [turn, -turn]
    });
    let slope: &[(&str, &[f64])] = &[("slope", &[0.008, 0.004, 0.3])];
    let starts = found(&recorded_from(slope, &later)).unwrap();
    let (angle, error) = against_first(&starts, Cycle::Heading)[2];
    assert!((angle - headings[2]).sin().abs() < 4.0 * error + 0.1, "{angle} ± {error}");
}

#[test]
fn wheels_that_start_elsewhere_are_found_by_a_ripple_beside_a_larger_effect() {
    let effects: &[(&str, &[f64])] =
        &[("viscous_friction", &[0.02]), ("torque_ripple", &[0.03, 0.0, 0.02, 0.02, 5.0])];
    let later = [[0.0, 0.0], [0.5, 0.2], [-0.3, 0.45]];
    let starts = found(&recorded_from(effects, &later)).unwrap();
    for wheel in [0, 1] {
        let found = against_first(&starts, Cycle::Wheel(wheel));
        for ((angle, error), later) in found.iter().zip(&later) {
            // waves of five a turn are the same a fifth of a turn later
            let off = (2.5 * (angle - later[wheel])).sin().abs() / 2.5;
            assert!(off < 4.0 * error + 0.02, "{wheel}: {angle} ± {error}, {later:?}");
        }
    }
}
