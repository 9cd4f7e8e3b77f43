//! The filter on robots that are simulated with its own model: derivatives against differences, innovations and
//! score statistics against their distributions.
//!
//! The wheels always turn forward and the input is held between rows, so that nothing of the model is missing or
//! linearised but the centrifugal torque.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::{
    Columns, Innovation, Instant, NoColumns, Pass, PassSettings, Prepared, ProcessNoise,
    filter_pass, prepare,
};
use crate::math::distribution::chi2_log_survival;
use crate::math::{Information, eliminate};
use crate::model::Model;
use crate::model::base::{A4, COUNT};
use crate::recording::Recording;
use crate::robot::{Robot, kinematics};
use crate::simulate::{Movement, NoiseLevel, Recorder, Segment, record};

const RATE: f64 = 100.0;
pub(super) const NOISE: NoiseLevel = NoiseLevel { alpha: 1e-3, dalpha: 0.05, torque: 0.01 };
/// Rows of the start, in which wheels rest.
const START: usize = 150;

/// 5 s of a drive in curves, wheels between 3 and 9 rad/s, measured with `noise`.
pub(super) fn curves(truth: &Model, p: &[f64], seed: u64, noise: NoiseLevel) -> Recording {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut segments = Vec::new();
    for _ in 0..12 {
        let omega = [0, 1].map(|_| rng.random_range(3.0..9.0));
        segments.push(Segment {
            speed_m_s: kinematics::forward_speed(truth.robot(), omega),
            turn_rad_s: kinematics::turn_rate(truth.robot(), omega),
            blend_s: 0.5,
            hold_s: rng.random_range(0.0..0.2),
        });
    }
    let recorder = Recorder { rate: RATE, control_rate: RATE, noise, ticks: None, seed };
    let whole = record("curves", truth, p, &Movement { segments }, &recorder).unwrap();
    whole.cut(START..START + 500).unwrap()
}

/// Prepared with the noise that was added, which is not estimated here.
pub(super) fn known(recording: &Recording) -> Prepared<'_> {
    let (angle, speed) = (NOISE.alpha.powi(2), NOISE.dalpha.powi(2));
    Prepared { variance: [angle, angle, speed, speed], ..prepare(recording) }
}

/// The noise of a held input.
pub(super) fn process(sigma_m: f64) -> ProcessNoise {
    ProcessNoise { sigma_m, sigma_d: 0.0, tau_d: 1.0, later: 0.0 }
}

pub(super) fn pass(model: &Model, p: &[f64], prepared: &Prepared, noise: ProcessNoise) -> Pass {
    let (keep_innovations, input_noise) = (true, true);
    let settings =
        PassSettings { noise, derivatives: true, keep_innovations, input_noise, step_scatter: 1.0 };
    filter_pass(model, p, prepared, &settings, &NoColumns).unwrap()
}

/// Score and information of a pass less those by central differences of its innovations, in standard deviations of the
/// score.
pub(super) fn off_differences(
    model: &Model,
    p: &[f64],
    prepared: &Prepared,
    noise: ProcessNoise,
) -> (DVector<f64>, DMatrix<f64>) {
    let here = pass(model, p, prepared, noise);
    let slopes: Vec<Vec<f64>> = (0..p.len())
        .map(|j| {
            // a hundredth of a standard error: the second derivative is left out to 1e-4 of the first
            let step = 0.01 / here.information[(j, j)].sqrt();
            let moved = |by: f64| {
                let mut q = p.to_vec();
                q[j] += by;
                pass(model, &q, prepared, noise).innovations
            };
            let both = moved(step).into_iter().zip(moved(-step));
            both.map(|(up, down)| (down.value - up.value) / (2.0 * step)).collect()
        })
        .collect();
    let sum = |of: &dyn Fn(usize, &Innovation) -> f64| -> f64 {
        here.innovations.iter().enumerate().map(|(k, i)| of(k, i) / i.variance).sum()
    };
    let n = p.len();
    let h = DMatrix::from_fn(n, n, |i, j| sum(&|k, _| slopes[i][k] * slopes[j][k]));
    let g = DVector::from_fn(n, |j, _| sum(&|k, i| slopes[j][k] * i.value));
    let unit = h.diagonal().map(f64::sqrt);
    let of_score = (&here.score - &g).component_div(&unit);
    (of_score, (&here.information - &h).component_div(&(&unit * unit.transpose())))
}

#[test]
fn score_and_information_of_the_rigid_filter_equal_finite_differences() {
    let model = Model::base(Robot::amigobot());
    let p = model.initial();
    let recording = curves(&model, &p, 1, NOISE);
    let prepared = known(&recording);
    let (of_score, of_information) = off_differences(&model, &p, &prepared, process(NOISE.torque));
    // inertias and the centrifugal torque move the gain, which the derivatives leave out, and bend the motion within a
    // row: percents of a standard deviation; friction of wheels that turn does neither
    assert!(of_score.amax() < 0.04 && of_information.amax() < 0.02, "{of_score} {of_information}");
    assert!(of_score.rows(A4, 2).amax() < 2e-4, "{of_score}");
    assert!(of_information.view((A4, A4), (2, 2)).amax() < 2e-5, "{of_information}");
}

/// Viscous friction that no wheel has, as a column.
struct Viscous;

impl Columns for Viscous {
    fn count(&self) -> usize {
        2
    }
    fn torque(&self, at: &Instant, out: &mut [[f64; 2]]) {
        let [w1, w2] = at.motion.omega;
        (out[0], out[1]) = ([-w1, 0.0], [0.0, -w2]);
    }
}

/// What one simulated recording shows at the true parameters.
pub(super) struct Shown {
    /// Mean of e²/S.
    pub(super) square: f64,
    /// Of the product of neighbouring normalised innovations of each channel.
    pub(super) whiteness: f64,
    /// Of the score of the parameters `of`.
    pub(super) parameters: f64,
    /// Of the score of viscous friction, the parameters estimated too.
    pub(super) missing: f64,
}

/// p-values of recordings of the robot of `effects` at `p`, whose wheels resist with `viscous` N m s/rad more than the
/// model; those of the score for the parameters `of`.
pub(super) fn shown(
    effects: &[&str],
    p: &[f64],
    of: Range<usize>,
    viscous: f64,
    sets: u64,
) -> Vec<Shown> {
    let model = Model::with_effects(Robot::amigobot(), effects).unwrap();
    let truth = model.add("viscous_friction").unwrap();
    let true_p = [p, &[viscous]].concat();
    let one = |seed: u64| shown_by(&curves(&truth, &true_p, seed, NOISE), &model, p, of.clone());
    (0..sets).into_par_iter().map(one).collect()
}

fn shown_by(recording: &Recording, model: &Model, p: &[f64], of: Range<usize>) -> Shown {
    let noise = process(NOISE.torque);
    let (keep_innovations, input_noise) = (true, true);
    let settings =
        PassSettings { noise, derivatives: true, keep_innovations, input_noise, step_scatter: 1.0 };
    let pass = filter_pass(model, p, &known(recording), &settings, &Viscous).unwrap();
    let value = |statistic: f64, degrees: usize| chi2_log_survival(statistic, degrees as f64).exp();
    let own: Vec<usize> = (0..p.len()).collect();
    let mut score = pass.score.clone();
    // errors in the variables, which every user of the score takes out
    for (s, bias) in score.iter_mut().zip(&pass.score_of_input_noise) {
        *s -= bias;
    }
    let (first, count) = (of.start, of.len());
    let information = pass.information.view((first, first), (count, count)).into_owned();
    let parameters = Information::new(&information).statistic(&score.rows(first, count).into());
    let columns = [p.len(), p.len() + 1];
    let (information, left) = eliminate(&pass.information, &score, &own, &columns);
    let missing = Information::new(&information).statistic(&left);
    let (mut whiteness, mut count, mut squares) = (0.0, 0.0, 0.0);
    for channel in 0..4 {
        let of = pass.innovations.iter().filter(|i| i.channel == channel);
        let e: Vec<f64> = of.map(|i| i.value / i.variance.sqrt()).collect();
        let product: f64 = e.windows(2).map(|e| e[0] * e[1]).sum();
        // n r² of each channel is chi-squared of one degree
        whiteness += product * product / (e.len() - 1) as f64;
        squares += e.iter().map(|e| e * e).sum::<f64>();
        count += e.len() as f64;
    }
    Shown {
        square: squares / count,
        whiteness: value(whiteness, 4),
        parameters: value(parameters, of.len()),
        missing: value(missing, 2),
    }
}

/// Largest distance of the distribution of p-values from the uniform one (Kolmogorov and Smirnov).
pub(super) fn distance_from_uniform(mut p: Vec<f64>) -> f64 {
    p.sort_by(f64::total_cmp);
    let n = p.len() as f64;
    let apart =
        |(k, p): (usize, &f64)| (p - k as f64 / n).abs().max((p - (k + 1) as f64 / n).abs());
    p.iter().enumerate().map(apart).fold(0.0, f64::max)
}

/// The same of one of the p-values of all recordings.
pub(super) fn distance(all: &[Shown], of: impl Fn(&Shown) -> f64) -> f64 {
    distance_from_uniform(all.iter().map(of).collect())
}

#[test]
fn innovations_are_white_and_p_values_uniform_where_nothing_is_missing() {
    const SETS: u64 = 300;
    let p = Model::base(Robot::amigobot()).initial();
    let right = shown(&[], &p, 0..COUNT, 0.0, SETS);
    let mean = right.iter().map(|s| s.square).sum::<f64>() / SETS as f64;
    // 300 sets of 2000 values scatter by sqrt(2/6e5) = 0.0018; it is 0.992, since the filter allows for an input that
    // moves between rows wherever two rows differ by 2.4 standard deviations, as noise alone does in 8 % of them
    assert!((mean - 0.992).abs() < 0.008, "{mean}");
    // the distance exceeds 1.95/sqrt(300) = 0.113 once in a thousand times
    let limit = 1.95 / (SETS as f64).sqrt();
    assert!(distance(&right, |s| s.whiteness) < limit);
    assert!(distance(&right, |s| s.parameters) < limit);
    assert!(distance(&right, |s| s.missing) < limit);
    // the test of the test: 2 mN m s/rad, 4 % of the friction at 5 rad/s
    let wrong = shown(&[], &p, 0..COUNT, 0.002, SETS);
    assert!(distance(&wrong, |s| s.missing) > 3.0 * limit);
}
