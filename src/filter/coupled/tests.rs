use nalgebra::DVector;

use crate::filter::{Likelihood, Prepared, prepare};
use crate::model::Model;
use crate::recording::Recording;
use crate::robot::Robot;
use crate::simulate::{Hold, Movement, NoiseLevel, Recorder, record};

/// A simulated recording of 15 s of a robot with the effect at `own`.
fn recorded(id: &str, own: &[f64]) -> (Model, Vec<f64>, Recording) {
    let model = Model::base(Robot::amigobot()).add(id).unwrap();
    let mut p = model.initial();
    let first = p.len() - own.len();
    p[first..].copy_from_slice(own);
    let movement = Movement::rich(model.robot(), 4, 15.0, 10.0);
    let noise = NoiseLevel { alpha: 1e-3, dalpha: 0.05, torque: 0.005 };
    let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed: 5 };
    let recording = record("made", &model, &p, &movement, &recorder).unwrap();
    (model, p, recording)
}

fn likelihood(prepared: Prepared) -> Likelihood {
    Likelihood { prepared: vec![prepared], hold: Hold::Linear, slow_moment: true, timing: false }
}

#[test]
fn a_joint_too_stiff_to_be_seen_has_the_likelihood_of_the_rigid_robot() {
    let rigid = Model::base(Robot::amigobot());
    let (model, p, recording) = recorded("wheel_slip", &[20.0, 0.025]);
    let likelihood = likelihood(prepare(&recording));
    let noise = likelihood.initial_noise();
    let jointed = likelihood.value(&model, &p, &noise).unwrap();
    let plain = likelihood.value(&rigid, &p[..5], &noise).unwrap();
    // of some 27 000 nats: slip of 0.2 N m / 20 N m s/rad, which the recording does have, is 1 % of
    // its smallest speed
    assert!((jointed - plain).abs() < 12.0, "{jointed} {plain}");
}

#[test]
fn the_derivatives_of_the_innovations_are_those_of_the_likelihood() {
    for (id, own) in [("wheel_slip", vec![0.1, 0.025]), ("compliance", vec![2.0, 0.02, 0.025])] {
        let (model, p, recording) = recorded(id, &own);
        let likelihood = likelihood(prepare(&recording));
        let noise = likelihood.initial_noise();
        let passes = likelihood.passes(&model, &p, &noise, true, &[]).unwrap();
        let (h, g): (_, DVector<f64>) = (&passes[0].information, passes[0].score.clone());
        let value = |p: &[f64]| likelihood.value(&model, p, &noise).unwrap();
        for j in 0..p.len() {
            // a step of a tenth of a standard deviation, far above rounding
            let step = 0.1 / h[(j, j)].sqrt();
            let moved = |by: f64| {
                let mut q = p.clone();
                q[j] += by;
                value(&q)
            };
            let (up, down) = (moved(step), moved(-step));
            let slope = (up - down) / (2.0 * step);
            let bend = (up - 2.0 * value(&p) + down) / (step * step);
            let sigma = h[(j, j)].sqrt();
            // in standard deviations of the score; the score leaves out how the innovations'
            // variance depends on the parameter, and friction near rest is linearised
            assert!((slope - g[j]).abs() < 0.6 * sigma, "{id} {j}: {slope} {} {sigma}", g[j]);
            // the curvature of one realisation scatters around its mean, the information
            assert!((-bend / h[(j, j)] - 1.0).abs() < 0.4, "{id} {j}: {bend} {}", h[(j, j)]);
        }
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
