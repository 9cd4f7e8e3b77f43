use argmin::core::{CostFunction, Executor};
use argmin::solver::neldermead::NelderMead;

use crate::filter::{Likelihood, ProcessNoise, clarity, prepare};
use crate::model::Model;
use crate::recording::Recording;
use crate::robot::Robot;
use crate::simulate::{Hold, Movement, NoiseLevel, Recorder, record};

/// Noise of the recorded torques [N m].
const TORQUE: f64 = 0.005;

/// A simulated recording of 15 s of a robot with the effects `hidden`, and the base parameters of it.
fn recorded(hidden: &[&str]) -> (Vec<f64>, Recording) {
    let truth = Model::with_effects(Robot::amigobot(), hidden).unwrap();
    let movement = Movement::rich(truth.robot(), 4, 15.0, 10.0);
    let noise = NoiseLevel { alpha: 1e-3, dalpha: 0.05, torque: TORQUE };
    let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed: 5 };
    let recording = record("made", &truth, &truth.initial(), &movement, &recorder).unwrap();
    (Model::base(Robot::amigobot()).initial(), recording)
}

fn likelihood(recording: &Recording) -> Likelihood<'_> {
    let prepared = vec![prepare(recording)];
    Likelihood { prepared, hold: Hold::Linear, slow_moment: true, timing: false, step_scatter: 1.0 }
}

/// The same search by Nelder-Mead on the logarithms.
struct Simplex<'a> {
    likelihood: &'a Likelihood<'a>,
    model: &'a Model,
    p: &'a [f64],
}

impl CostFunction for Simplex<'_> {
    type Param = Vec<f64>;
    type Output = f64;
    fn cost(&self, x: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        let (sigma_m, sigma_d) = (x[0].exp(), x[1].exp());
        let tau_d = x[2].exp().clamp(0.05, 1.0);
        let noise = ProcessNoise { sigma_m, sigma_d, tau_d, later: 0.5 };
        Ok(self.likelihood.value(self.model, self.p, &noise).map_or(1e300, |v| -v))
    }
}

#[test]
fn scoring_finds_noise_as_likely_as_a_simplex_does_from_either_side() {
    let model = Model::base(Robot::amigobot());
    for hidden in [&[][..], &["viscous_friction"], &["turning_scrub"], &["slope"]] {
        let (p, recording) = recorded(hidden);
        let likelihood = likelihood(&recording);
        let value = |noise: &ProcessNoise| likelihood.value(&model, &p, noise).unwrap();
        for (sigma_m, sigma_d, tau_d) in [(5e-4, 0.0, 1.0), (0.1, 2e-4, 0.1), (1e-3, 0.05, 0.3)] {
            let start = ProcessNoise { sigma_m, sigma_d, tau_d, later: 0.5 };
            let (found, passes) = likelihood.noise(&model, &p, &start);
            let x = [found.sigma_m, found.sigma_d, found.tau_d].map(f64::ln);
            // a simplex around what was found, wide enough to leave it
            let simplex = (0..4).map(|k| {
                let mut corner = x.to_vec();
                if k > 0 {
                    corner[k - 1] += 0.7;
                }
                corner
            });
            let search = Simplex { likelihood: &likelihood, model: &model, p: &p };
            let solver = NelderMead::new(simplex.collect()).with_sd_tolerance(1e-3).unwrap();
            let run = Executor::new(search, solver).configure(|s| s.max_iters(200)).run().unwrap();
            let best = -run.state().get_best_cost();
            // a slow torque that is not there gains one nat by chance: half of chi-squared with two
            // degrees of freedom has the mean 1
            assert!(value(&found) > best - 1.0, "{hidden:?} {found:?} {} {best}", value(&found));
            assert!(passes < 80, "{passes}");
        }
    }
}

#[test]
fn white_noise_of_the_input_is_recovered_where_nothing_else_is_there() {
    let (p, recording) = recorded(&[]);
    let model = Model::base(Robot::amigobot());
    let likelihood = likelihood(&recording);
    let (found, _) = likelihood.noise(&model, &p, &likelihood.initial_noise());
    // 1500 rows on two wheels: a standard error of some 2 % plus what the sensors hide of it
    assert!((found.sigma_m / TORQUE - 1.0).abs() < 0.1, "{found:?}");
    assert!(found.sigma_d < 0.1 * TORQUE, "{found:?}");
}

#[test]
fn the_direction_of_a_body_becomes_clear_without_a_jump() {
    let at = |v: f64| clarity(2, v, 4.0);
    assert_eq!((at(-4.0), at(0.0), at(4.0)), (0.0, 0.0, 0.0));
    assert_eq!((at(-8.0), at(8.0), at(1e3)), (1.0, 1.0, 1.0));
    assert!((at(6.0) - 0.5).abs() < 1e-12);
    let steps = (0..2000).map(|k| at(0.005 * f64::from(k + 1)) - at(0.005 * f64::from(k)));
    assert!(steps.fold(0.0, f64::max) < 0.003);
    // the friction of a wheel is always in the step, whose spread smooths it
    assert_eq!(clarity(0, 0.0, 4.0), 1.0);
}

#[test]
fn scrub_that_holds_the_robot_straight_is_not_noise_of_the_input() {
    let (mut p, recording) = recorded(&["turning_scrub"]);
    let model = Model::with_effects(Robot::amigobot(), &["turning_scrub"]).unwrap();
    p.extend(&model.initial()[5..]);
    let likelihood = likelihood(&recording);
    let (found, _) = likelihood.noise(&model, &p, &likelihood.initial_noise());
    // left out of the steps in which it holds, it raised sigma_m to 0.008 N m on three runs of 60 s
    assert!((found.sigma_m / TORQUE - 1.0).abs() < 0.2, "{found:?}");
}
