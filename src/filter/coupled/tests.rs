use crate::filter::tests::{
    NOISE, Shown, curves, distance, known, off_differences, process, shown,
};
use crate::filter::{Likelihood, Prepared, prepare};
use crate::model::Model;
use crate::model::base::{A4, COUNT};
use crate::recording::Recording;
use crate::robot::Robot;
use crate::simulate::{Hold, Movement, NoiseLevel, Recorder, record};

/// A simulated recording of 15 s of a robot with the effect at `own`.
fn recorded(id: &str, own: &[f64]) -> (Model, Vec<f64>, Recording) {
    let (model, p) = with_coupling(id, own);
    let movement = Movement::rich(model.robot(), 4, 15.0, 10.0);
    let noise = NoiseLevel { alpha: 1e-3, dalpha: 0.05, torque: 0.005 };
    let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed: 5 };
    let recording = record("made", &model, &p, &movement, &recorder).unwrap();
    (model, p, recording)
}

fn likelihood(prepared: Prepared) -> Likelihood {
    Likelihood {
        prepared: vec![prepared],
        hold: Hold::Linear,
        slow_moment: true,
        timing: false,
        step_scatter: 1.0,
    }
}

#[test]
fn a_joint_too_stiff_to_be_seen_has_the_likelihood_of_the_rigid_robot() {
    let rigid = Model::base(Robot::amigobot());
    let (model, p, recording) = recorded("wheel_slip", &[20.0, 0.025]);
    let likelihood = likelihood(prepare(&recording));
    let noise = likelihood.initial_noise();
    let jointed = likelihood.value(&model, &p, &noise).unwrap();
    let plain = likelihood.value(&rigid, &p[..COUNT], &noise).unwrap();
    // of some 27 000 nats: slip of 0.2 N m / 20 N m s/rad, which the recording does have, is 1 % of
    // its smallest speed
    assert!((jointed - plain).abs() < 12.0, "{jointed} {plain}");
}

/// A soft slip and a spring, each with its parameters.
const COUPLINGS: [(&str, &[f64]); 2] =
    [("wheel_slip", &[0.1, 0.025]), ("compliance", &[2.0, 0.02, 0.025])];

/// Parameters of the model with one of [`COUPLINGS`].
fn with_coupling(id: &str, own: &[f64]) -> (Model, Vec<f64>) {
    let model = Model::base(Robot::amigobot()).add(id).unwrap();
    let mut p = model.initial();
    let first = p.len() - own.len();
    p[first..].copy_from_slice(own);
    (model, p)
}

#[test]
fn score_and_information_of_a_second_body_equal_finite_differences() {
    for (id, own) in COUPLINGS {
        let (model, p) = with_coupling(id, own);
        let recording = curves(&model, &p, 1, NOISE);
        let (score, information) =
            off_differences(&model, &p, &known(&recording), process(NOISE.torque));
        // the derivatives leave out that of the gain, which depends on inertias, as without a second body, and on the
        // coupling: about a tenth of a standard deviation
        let (base, coupling) = (score.rows(0, COUNT), score.rows(COUNT, own.len()));
        assert!(base.amax() < 0.1 && coupling.amax() < 0.25, "{id} {score}");
        assert!(information.amax() < 0.05, "{id} {information}");
        // friction of wheels that turn changes the variance of the start only
        assert!(score.rows(A4, 2).amax() < 1e-2, "{id} {score}");
        assert!(information.view((A4, A4), (2, 2)).amax() < 1e-3, "{id} {information}");
    }
}

#[test]
fn innovations_of_a_second_body_are_white_and_p_values_uniform() {
    const SETS: u64 = 100;
    // the distance exceeds 1.95/sqrt(n) once in a thousand times
    let limit = 1.95 / (SETS as f64).sqrt();
    for (id, own) in COUPLINGS {
        let (_, p) = with_coupling(id, own);
        // inertias and coupling have errors in the variables, whose mean score is computed for rigid robots only
        let right = shown(&[id], &p, A4..COUNT, 0.0, SETS);
        let mean = right.iter().map(|s| s.square).sum::<f64>() / SETS as f64;
        let far = |of: fn(&Shown) -> f64| distance(&right, of);
        let [white, score, missing] =
            [far(|s| s.whiteness), far(|s| s.parameters), far(|s| s.missing)];
        // as of the rigid robot; 100 sets of 2000 values scatter by 0.003
        assert!((mean - 0.99).abs() < 0.012, "{id} {mean}");
        assert!(
            white < limit && score < limit && missing < limit,
            "{id} {white} {score} {missing}"
        );
        // the test of the test, as for the rigid robot
        let wrong = shown(&[id], &p, A4..COUNT, 0.002, SETS);
        assert!(distance(&wrong, |s| s.missing) > 3.0 * limit, "{id}");
    }
}

#[test]
fn stiffness_and_damping_of_a_hidden_spring_come_back_within_their_errors() {
    let (model, p, recording) = recorded("compliance", &[2.0, 0.02, 0.025]);
    let likelihood = likelihood(prepare(&recording));
    let placed =
        crate::diagnose::shapes_placed(&model, std::slice::from_ref(&recording), Hold::Linear);
    let start = placed.initial();
    let maximum = likelihood.maximise(&model, &start, None).unwrap();
    let covariance = maximum.information.clone().try_inverse().unwrap();
    for j in 0..p.len() {
        let z = (maximum.p[j] - p[j]) / covariance[(j, j)].sqrt();
        // one recording: 3.5 standard errors leave one false alarm in 2000 for each of eight
        assert!(z.abs() < 3.5, "{j}: {} {} z = {z}", maximum.p[j], p[j]);
    }
}
