//! Recordings of robots that are not one.

use super::*;

/// A recording of the AmigoBot with another a1.
fn with_inertia(factor: f64, seed: u64) -> Recording {
    let model = Model::base(Robot::amigobot());
    let mut p = model.initial();
    p[A1] *= factor;
    let movement = Movement::rich(model.robot(), seed, 15.0, 12.0);
    let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise: NOISE, ticks: None, seed };
    record(&format!("run{seed}"), &model, &p, &movement, &recorder).unwrap()
}

#[test]
fn a_load_in_one_recording_is_named_with_its_share_and_recordings_of_one_robot_agree() {
    let model = Model::base(Robot::amigobot());
    let all: Vec<Recording> =
        [(1.0, 31), (1.0, 32), (1.3, 33)].map(|(f, seed)| with_inertia(f, seed)).into();
    let of = |recordings: &[&Recording]| {
        let owned: Vec<Recording> = recordings.iter().map(|r| (*r).clone()).collect();
        let first = started(&model, &owned);
        let windows = Windows::new(recordings.to_vec(), Hold::Linear, &model, &first);
        let common = fit(&windows, &model, &first, &scale(&model, &first, recordings)).unwrap();
        difference(&common, recordings, Hold::Linear)
    };
    let found = of(&all.iter().collect::<Vec<_>>()).unwrap();
    assert_eq!((found.recording.as_str(), found.symbol.as_str()), ("run33", "a1"));
    assert!((found.share - 0.3).abs() < 4.0 * found.std_error, "{found:?}");
    assert!(found.std_error < 0.05, "{found:?}");
    for seed in [41, 51, 61] {
        let same = [with_inertia(1.0, seed), with_inertia(1.0, seed + 1)];
        assert_eq!(of(&same.iter().collect::<Vec<_>>()), None);
    }
}
