//! The step of the simulation inside the filter: derivatives through stops and reversals against differences of the
//! likelihood, and the noise of an input whose effect decays within the row.
//!
//! The input is held between rows and simulated with the same model, so that nothing is missing. Without noise of the
//! input the variances of the innovations hardly depend on the parameters; then the score is the slope of the
//! log-likelihood, and the information that of the score where the innovations vanish.

use nalgebra::{DVector, Matrix2};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use super::mean_transition;
use crate::filter::tests::distance_from_uniform;
use crate::filter::{HorizonFilter, Prepared, Reading, Sums, prepare};
use crate::math::Information;
use crate::math::distribution::chi2_log_survival;
use crate::model::Model;
use crate::model::base::{A1, A2};
use crate::recording::{Channels, DriveUnit, Recording};
use crate::robot::{Robot, State};
use crate::simulate::{Hold, Input, simulate};

/// Row time \[s\].
const H: f64 = 0.01;
/// Rows: one piece of the filter.
const ROWS: usize = 500;
/// Rows before them, from rest.
const BEFORE: usize = 50;
/// Standard deviations of angle \[rad\] and speed [rad/s].
const NOISE: (f64, f64) = (1e-4, 0.01);

/// A robot whose speeds decay within `1/damped` rows, or without viscous friction.
struct Case {
    model: Model,
    p: Vec<f64>,
    damping: f64,
}

impl Case {
    fn damped(damped: f64) -> Self {
        let base = Model::base(Robot::amigobot());
        let mut p = base.initial();
        if damped == 0.0 {
            return Self { model: base, p, damping: 0.0 };
        }
        let damping = damped * (p[A1] + p[A2]) / H;
        p.push(damping);
        Self { model: base.add("viscous_friction").unwrap(), p, damping }
    }

    /// A drive from rest under the input of every row [N m], to which noise of `sigma` that is not recorded is added;
    /// measured with `share` of [`NOISE`].
    fn drive(
        &self,
        input: impl Fn(f64) -> [f64; 2],
        (sigma, share): (f64, f64),
        seed: u64,
    ) -> Recording {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut noisy = |x: [f64; 2], by: f64| {
            x.map(|x| {
                x + by * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng)
            })
        };
        let t: Vec<f64> = (0..BEFORE + ROWS).map(|k| H * k as f64).collect();
        let torque: Vec<[f64; 2]> = t.iter().map(|t| input(*t)).collect();
        let acting: Vec<[f64; 2]> = torque.iter().map(|m| noisy(*m, sigma)).collect();
        let held = Input { t: &t, torque: &acting, hold: Hold::Constant };
        let motion = simulate(&self.model, &self.p, &held, State::default()).unwrap();
        let alpha = motion.iter().map(|x| noisy(x.alpha, share * NOISE.0)).collect();
        let omega = motion.iter().map(|x| noisy(x.omega, share * NOISE.1)).collect();
        let channels = Channels { t, alpha: Some(alpha), omega: Some(omega), torque };
        let whole = Recording::new("drive", channels, DriveUnit::NewtonMetre).unwrap();
        whole.cut(BEFORE..BEFORE + ROWS).unwrap()
    }

    /// An input that, after a rest, stops and reverses both wheels several times.
    fn reversing(&self) -> impl Fn(f64) -> [f64; 2] + use<> {
        let size = 0.5 + 3.0 * self.damping;
        move |t| {
            let t = (t - 0.8).max(0.0);
            [size * (2.0 * t).sin(), 0.8 * size * (3.1 * t).sin()]
        }
    }
}

/// Prepared with the noise that was added.
fn known(recording: &Recording, torque_noise: f64) -> [Prepared<'_>; 1] {
    let [angle, speed] = [NOISE.0, NOISE.1].map(|s| s * s);
    [Prepared { variance: [angle, angle, speed, speed], torque_noise, ..prepare(recording) }]
}

/// The filter with the weights of maximum likelihood.
struct Filter<'a> {
    filter: HorizonFilter<'a>,
    model: &'a Model,
}

impl<'a> Filter<'a> {
    fn new(prepared: &'a [Prepared<'a>], case: &'a Case) -> Self {
        let filter = HorizonFilter::new(prepared, Hold::Constant, &case.model, &case.p);
        Self { filter, model: &case.model }
    }

    fn sums(&self, p: &[f64]) -> Sums {
        let mut pieces = self.filter.pass(self.model, p, 0.0, 0.0, Reading::Noisy).unwrap();
        assert_eq!(pieces.len(), 1);
        pieces.remove(0)
    }

    fn score(&self, p: &[f64]) -> DVector<f64> {
        self.sums(p).score.rows(0, p.len()).into()
    }
}

/// `p` with parameter `j` larger by `by`.
fn moved(p: &[f64], j: usize, by: f64) -> Vec<f64> {
    let mut q = p.to_vec();
    q[j] += by;
    q
}

/// Viscous friction absent, with a little, and with so much that the effect of a torque decays within about two rows.
/// Not 0.5, at which the integrator takes one more step per row, so that differences contain its truncation error.
const DAMPED: [f64; 3] = [0.0, 0.02, 0.45];

#[test]
fn the_score_is_the_slope_of_the_likelihood_through_stops_and_reversals() {
    for damped in DAMPED {
        let case = Case::damped(damped);
        let recording = case.drive(case.reversing(), (0.0, 1.0), 5);
        let prepared = known(&recording, 0.0);
        let filter = Filter::new(&prepared, &case);
        let here = filter.sums(&case.p);
        for j in 0..case.p.len() {
            // a tenth of a standard error: the third derivative is far below
            let error = here.information[(j, j)].sqrt().recip();
            let cost = |by: f64| {
                let sums = filter.sums(&moved(&case.p, j, by * error));
                0.5 * (sums.square + sums.log_variance)
            };
            let slope = (cost(0.1) - cost(-0.1)) / 0.2;
            let expected = -here.score[j] * error;
            // in standard deviations of the score; the variances of the innovations depend on the parameters by the
            // instants of stops alone
            let off = (slope - expected).abs();
            assert!(off < 0.02 + 0.02 * expected.abs(), "{damped} {j}: {slope} {expected}");
        }
    }
}

#[test]
fn the_information_is_the_slope_of_the_score_through_stops_and_reversals() {
    for damped in DAMPED {
        let case = Case::damped(damped);
        let recording = case.drive(case.reversing(), (0.0, 0.0), 6);
        let turns = |i: usize| recording.omega().windows(2).any(|w| w[0][i] * w[1][i] < 0.0);
        let rests = |i: usize| recording.omega()[50..].iter().any(|w| w[i] == 0.0);
        assert!((0..2).all(|i| turns(i) || rests(i)));
        let prepared = known(&recording, 0.0);
        let filter = Filter::new(&prepared, &case);
        let here = filter.sums(&case.p).information;
        for j in 0..case.p.len() {
            let error = here[(j, j)].sqrt().recip();
            let at = |by: f64| filter.score(&moved(&case.p, j, by * error));
            let slope = (at(0.1) - at(-0.1)) / 0.2;
            for i in 0..case.p.len() {
                // as a correlation; innovations vanish at p, and the third derivative is far below
                let off = (slope[i] + here[(i, j)] * error) / here[(i, i)].sqrt();
                assert!(off.abs() < 1e-3, "{damped} {i} {j}: {off}");
            }
        }
    }
}

#[test]
fn noise_of_an_input_that_decays_within_the_row_has_the_predicted_variance() {
    const SETS: u64 = 100;
    // two rows and one row of decay
    for damped in [0.5, 1.0] {
        let case = Case::damped(damped);
        // speeds scatter by a tenth of a radian per second, ten times the noise of their sensor
        let sigma = 0.1 * case.damping;
        let size = case.damping;
        let forward =
            move |t: f64| [size * (5.0 + (2.0 * t).sin()), size * (6.0 + (3.1 * t).cos())];
        let one = |seed: u64| {
            let recording = case.drive(forward, (sigma, 1.0), seed);
            let prepared = known(&recording, sigma);
            let sums = Filter::new(&prepared, &case).sums(&case.p);
            let n = case.p.len();
            let information = sums.information.view((0, 0), (n, n)).into_owned();
            let statistic = Information::new(&information).statistic(&sums.score.rows(0, n).into());
            (sums.square / sums.count, chi2_log_survival(statistic, n as f64).exp())
        };
        let found: Vec<(f64, f64)> = (0..SETS).into_par_iter().map(one).collect();
        let mean = found.iter().map(|(square, _)| square).sum::<f64>() / SETS as f64;
        // 100 sets of 2000 values scatter by sqrt(2/2e5) = 0.003; the input matrix is within a percent of the exact
        // one. With that of a torque that does not decay the mean is 0.83 at two rows
        assert!((mean - 1.0).abs() < 0.03, "{damped}: {mean}");
        // the distance exceeds 1.95/sqrt(100) once in a thousand times
        let distance = distance_from_uniform(found.into_iter().map(|(_, p)| p).collect());
        assert!(distance < 1.95 / (SETS as f64).sqrt(), "{damped}: {distance}");
    }
}

#[test]
fn the_mean_transition_of_decaying_speeds_is_that_of_exponentials() {
    // straight driving and turning decay at different rates
    for (straight, turning) in [(0.1, 0.3), (0.5, 2.0), (1.0, 3.5)] {
        let along = |f: &dyn Fn(f64) -> f64| {
            let (s, t) = (f(straight), f(turning));
            Matrix2::new(s + t, s - t, s - t, s + t) * 0.5
        };
        let found = mean_transition(&along(&|z: f64| (-z).exp())).unwrap();
        let exact = along(&|z: f64| (1.0 - (-z).exp()) / z);
        // the error of the rule is 4 % of the mean at 3.5 time constants
        assert!((found - exact).amax() < 0.012, "{found} {exact}");
    }
    let stopped = Matrix2::new(1.0, 0.0, 0.0, 0.0);
    assert!(mean_transition(&stopped).is_none());
}
