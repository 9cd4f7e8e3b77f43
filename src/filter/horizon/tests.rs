//! The filter of the default method: its sums against differences of its cost.
//!
//! Without noise of the input the variances of the innovations hardly depend on the parameters, so that the score is
//! the slope of the cost, and, where the innovations vanish, the information that of the score.

use nalgebra::DVector;

use super::{HorizonFilter, Reading};
use crate::filter::tests::{NOISE, curves, known};
use crate::filter::{Prepared, Sums};
use crate::model::Model;
use crate::robot::Robot;
use crate::simulate::{Hold, NoiseLevel};

/// Any horizon: without noise of the input all are the same.
const HORIZON: f64 = 0.1;

/// Sums over all pieces at `p`.
fn sums(filter: &HorizonFilter, model: &Model, p: &[f64]) -> Vec<Sums> {
    filter.pass(model, p, 0.0, HORIZON, Reading::Noisy).unwrap()
}

fn score(sums: &[Sums], of: usize) -> DVector<f64> {
    sums.iter().map(|s| s.score.rows(0, of).into_owned()).sum()
}

/// The filter of recordings whose input, held between the rows, has no noise.
fn exact<'a>(prepared: &'a [Prepared<'a>], model: &Model, p: &[f64]) -> HorizonFilter<'a> {
    let filter = HorizonFilter::new(prepared, Hold::Constant, model, p);
    HorizonFilter { alike: true, whole_noise: 1e-9, ..filter }
}

/// A model with its true parameters.
fn case(effects: &[&str]) -> (Model, Vec<f64>) {
    let model = Model::with_effects(Robot::amigobot(), effects).unwrap();
    let truth = model.initial();
    (model, truth)
}

#[test]
fn the_score_is_the_slope_of_the_cost() {
    for effects in [&[][..], &["viscous_friction", "turning_scrub"], &["quadratic_drag"]] {
        let (model, truth) = case(effects);
        let recording = curves(&model, &truth, 3, NoiseLevel { torque: 0.0, ..NOISE });
        let prepared = [known(&recording)];
        let filter = exact(&prepared, &model, &truth);
        let information = sums(&filter, &model, &truth)[0].information.clone();
        let (p, n) = (truth, model.parameters().len());
        let found = score(&sums(&filter, &model, &p), n);
        for j in 0..n {
            // a tenth of a standard error: the third derivative is far below
            let error = 1.0 / information[(j, j)].sqrt();
            let cost = |by: f64| {
                let mut q = p.clone();
                q[j] += by * error;
                let half = |s: &Sums| 0.5 * (s.square + s.log_variance);
                sums(&filter, &model, &q).iter().map(half).sum::<f64>()
            };
            let slope = (cost(0.1) - cost(-0.1)) / 0.2;
            let expected = -found[j] * error;
            // in standard deviations of the score; what the variances of the innovations add has mean zero
            let off = (slope - expected).abs();
            assert!(off < 0.02 + 0.02 * expected.abs(), "{effects:?} {j}: {slope} {expected}");
        }
    }
}

#[test]
fn the_information_is_the_slope_of_the_score_where_innovations_vanish() {
    let (model, truth) = case(&["viscous_friction"]);
    let recording = curves(&model, &truth, 4, NOISE.scaled(0.0));
    let prepared = [known(&recording)];
    let filter = exact(&prepared, &model, &truth);
    let n = truth.len();
    let here = &sums(&filter, &model, &truth)[0].information;
    for j in 0..n {
        let error = 1.0 / here[(j, j)].sqrt();
        let at = |by: f64| {
            let mut q = truth.clone();
            q[j] += by * error;
            score(&sums(&filter, &model, &q), n)
        };
        let slope = (at(0.1) - at(-0.1)) / 0.2;
        for i in 0..n {
            // as a correlation
            let scale = here[(i, i)].sqrt();
            let off = (slope[i] + here[(i, j)] * error) / scale;
            assert!(off.abs() < 1e-3, "{i} {j}: {off}");
        }
    }
}
