//! How the speeds follow changes of the recorded input within a neighbourhood, for the initial states of simulations.

use std::ops::Range;

use nalgebra::{Matrix2, Vector2};
use wide::f64x2;

use super::Parabolas;
use super::corner::around;
use super::source::Source;
use crate::math::mean;
use crate::recording::response::{Acts, Neighbourhoods, Response};
use crate::recording::{LocalMotion, Recording, Start};

/// Rows from which the response is estimated (cost: five neighbourhoods each).
const ROWS: usize = 500;
/// Standard errors by which the error by the shape of the motion exceeds that by noise where the input is considered: one
/// recording in seven hundred by chance.
const ERRORS: f64 = 3.0;
/// Rows to either side that corners of the angles need.
const CORNERS: usize = 4;

impl Recording {
    /// Initial state of a simulation from row `k`, with the mean square error of its speeds.
    ///
    /// The [`Recording::local_motion`] beside the part that changes of the input cause: a parabola through rows between
    /// which the input steps has an error far above that of the noise, and an error of the start grows in a robot whose
    /// centre of mass is behind the axle.
    ///
    /// ```text
    /// ω - G ∫M dt,  α - G ∬M dt:  parabolas as of the local motion, ∫ from row k
    /// ```
    /// G, by wheels, makes a neighbourhood of half the width agree best with the widest one, least squares over at most
    /// 500 rows; it is zero unless the shape of the motion causes the larger part of the error of the local motion, and G
    /// lowers it. What is left of the disagreement is part of the error, as for an acceleration that steps.
    #[must_use]
    pub fn start_at(&self, k: usize) -> Start {
        let Some(piece) = self.piece_of(k) else { return Start::default() };
        let Response { neighbourhoods, curvature, .. } = self.response();
        let source = self.response().source(self, piece, k);
        let mut out = [LocalMotion::default()];
        neighbourhoods.parabolas(&source, piece, k..k + 1, &mut out);
        out[0].start(*curvature)
    }

    /// The response of the speeds to the recorded input, computed once; copies of the recording with another input share
    /// it.
    pub(in crate::recording) fn response(&self) -> &Response {
        self.kept().response.get_or_init(|| Response::of(self))
    }
}

impl Response {
    fn of(recording: &Recording) -> Self {
        let neighbourhoods = Neighbourhoods::of(recording);
        let (gain, acts, curvature) = ([[0.0; 2]; 2], Acts::default(), [0.0; 2]);
        let input = recording.shared_torque();
        let none = Self { neighbourhoods, input, gain, acts, curvature };
        // corners of the angles already stand for steps of the input, and their roughness is part of the variance
        if none.neighbourhoods.angles_alone.is_some() {
            return none;
        }
        let rows = rows_of(recording);
        let bare = none.left(recording, &rows);
        let exceeds = bare.each_ref().map(Left::exceeds_noise);
        if !exceeds.iter().any(|exceeds| *exceeds) {
            return Self { curvature: bare.map(|left| left.shape), ..none };
        }
        let fits =
            Acts::ALL.map(|acts| (acts, Fit::of(recording, &none.neighbourhoods, &rows, acts)));
        let left = |fit: &[Fit; 2]| fit.iter().map(|fit| fit.left / fit.all).sum::<f64>();
        let Some((acts, fit)) = fits.into_iter().min_by(|a, b| left(&a.1).total_cmp(&left(&b.1)))
        else {
            return none;
        };
        let gain = [0, 1].map(|i| if exceeds[i] { fit[i].gain } else { [0.0; 2] });
        let found = Self { gain, acts, ..none };
        let beside = found.left(recording, &rows);
        // noise of the input may add more than its changes explain
        let lowers = [0, 1].map(|i| beside[i].shape < bare[i].shape);
        let of = |i: usize| {
            if lowers[i] { (gain[i], beside[i].shape) } else { ([0.0; 2], bare[i].shape) }
        };
        let [right, left] = [of(0), of(1)];
        Self { gain: [right.0, left.0], curvature: [right.1, left.1], ..found }
    }

    /// Angles and speeds around row `k` without what changes of the input cause.
    fn source<'a>(&self, recording: &'a Recording, piece: &Range<usize>, k: usize) -> Source<'a> {
        if self.gain == [[0.0; 2]; 2] {
            return Source::measured(recording);
        }
        let rows = self.neighbourhoods.reach(piece, k);
        let [alpha, omega] = integrals((recording.t(), &self.input), &rows, k, self.acts);
        let of = |measured: &[[f64; 2]], by_input: Vec<[f64; 2]>| {
            let pairs = measured[rows.clone()].iter().zip(by_input);
            let beside = |(x, m): (&[f64; 2], [f64; 2])| {
                [0, 1].map(|i| x[i] - self.gain[i][0] * m[0] - self.gain[i][1] * m[1])
            };
            pairs.map(beside).collect()
        };
        let (alpha, omega) = (of(recording.alpha(), alpha), of(recording.omega(), omega));
        Source::other(recording, rows.start, alpha, omega)
    }

    /// Errors of the speeds of each wheel in the `rows` in which it moves.
    fn left(&self, recording: &Recording, rows: &[usize]) -> [Left; 2] {
        let (mut shape, mut noise) = ([vec![], vec![]], [vec![], vec![]]);
        for &k in rows {
            let Some(piece) = recording.piece_of(k) else { continue };
            let source = self.source(recording, piece, k);
            let mut out = LocalMotion::default();
            let parabolas = Parabolas::new(&source, k, &self.neighbourhoods.weights);
            let curvature = self.neighbourhoods.parabola(piece, parabolas, [None; 2], &mut out);
            for i in (0..2).filter(|&i| out.moves(i)) {
                shape[i].extend(curvature[i]);
                noise[i].push(out.omega_variance[i]);
            }
        }
        [0, 1].map(|i| Left::of(&shape[i], &noise[i]))
    }
}

/// Mean square errors of the speeds of a wheel [rad^2/s^2].
struct Left {
    /// By the shape of the motion.
    shape: f64,
    /// Its standard error.
    uncertain: f64,
    /// By noise.
    noise: f64,
}

impl Left {
    fn of(shape: &[f64], noise: &[f64]) -> Self {
        let count = shape.len() as f64;
        let of = mean(shape.iter().copied());
        let square = mean(shape.iter().map(|s| (s - of).powi(2)));
        // the mean of no rows is not a number, and the estimate may be negative by chance
        let positive = |v: f64| v.max(0.0);
        let uncertain = positive((square / count).sqrt());
        Self { shape: positive(of), uncertain, noise: positive(mean(noise.iter().copied())) }
    }

    fn exceeds_noise(&self) -> bool {
        self.shape > self.noise + ERRORS * self.uncertain
    }
}

/// Rows of a recording, evenly distributed, at most [`ROWS`].
fn rows_of(recording: &Recording) -> Vec<usize> {
    (0..recording.len()).step_by(recording.len().div_ceil(ROWS).max(1)).collect()
}

impl Neighbourhoods {
    /// Rows around `k` that its parabolas need.
    fn reach(&self, piece: &Range<usize>, k: usize) -> Range<usize> {
        around(piece, k, self.widest.max(CORNERS))
    }
}

/// Double and single integral of an input with its times over `rows`, both zero at row `k`, of each wheel.
fn integrals(
    (t, m): (&[f64], &[[f64; 2]]),
    rows: &Range<usize>,
    k: usize,
    acts: Acts,
) -> [Vec<[f64; 2]>; 2] {
    let count = rows.len();
    let (mut double, mut single) = (vec![[0.0; 2]; count], vec![[0.0; 2]; count]);
    let at = k - rows.start;
    for i in 0..2 {
        for n in at + 1..count {
            let (h, mean) =
                (t[rows.start + n] - t[rows.start + n - 1], acts.mean(m, rows.start + n - 1, i));
            single[n][i] = single[n - 1][i] + h * mean;
            double[n][i] = double[n - 1][i] + h * (single[n - 1][i] + 0.5 * h * mean);
        }
        for n in (0..at).rev() {
            let (h, mean) =
                (t[rows.start + n + 1] - t[rows.start + n], acts.mean(m, rows.start + n, i));
            single[n][i] = single[n + 1][i] - h * mean;
            double[n][i] = double[n + 1][i] - h * (single[n + 1][i] - 0.5 * h * mean);
        }
    }
    [double, single]
}

/// Least squares of the disagreement of two neighbourhoods in terms of that of the integrals of the input.
#[derive(Default)]
struct Fit {
    gain: [f64; 2],
    /// Sums of the squares of the disagreement, of what is left and of all.
    left: f64,
    all: f64,
}

impl Fit {
    fn of(
        recording: &Recording,
        neighbourhoods: &Neighbourhoods,
        rows: &[usize],
        acts: Acts,
    ) -> [Self; 2] {
        let Neighbourhoods { narrower, widest, weights, .. } = neighbourhoods;
        let Some(&half) = narrower.iter().rev().find(|half| 2 * **half <= *widest) else {
            return Default::default();
        };
        let mut sums = [Sums::default(), Sums::default()];
        let measured = Source::measured(recording);
        for &k in rows {
            let Some(piece) = recording.piece_of(k) else { continue };
            let apart = |source: &Source, weights: &[f64x2; 2]| {
                let mut parabolas = Parabolas::new(source, k, weights);
                let [narrow, wide] = [half, *widest].map(|half| {
                    parabolas.widen(around(piece, k, half));
                    parabolas.fit()
                });
                [0, 1].map(|i| narrow.omega[i] - wide.omega[i])
            };
            let of_speeds = apart(&measured, weights);
            let rows = neighbourhoods.reach(piece, k);
            let input = (recording.t(), recording.torque());
            let [double, single] = integrals(input, &rows, k, acts);
            let by_input = Source::other(recording, rows.start, double, single);
            for (i, sums) in sums.iter_mut().enumerate() {
                // both inputs weighted as the speeds of this wheel
                let own = weights.map(|w| f64x2::splat(w.to_array()[i]));
                sums.add(of_speeds[i], apart(&by_input, &own));
            }
        }
        [0, 1].map(|i| sums[i].fit(i))
    }
}

/// Normal equations of a wheel.
#[derive(Default)]
struct Sums {
    matrix: Matrix2<f64>,
    vector: Vector2<f64>,
    square: f64,
}

impl Sums {
    fn add(&mut self, apart: f64, by_input: [f64; 2]) {
        let row = Vector2::from(by_input);
        if apart.is_finite() && row.iter().all(|v| v.is_finite()) {
            self.matrix += row * row.transpose();
            self.vector += row * apart;
            self.square += apart * apart;
        }
    }

    /// The solution for wheel `i`; with its own input alone where both inputs are the same, and zero without one.
    fn fit(&self, i: usize) -> Fit {
        let [m, v] = [self.matrix[(i, i)], self.vector[i]];
        let both = self.matrix.cholesky().map(|c| c.solve(&self.vector));
        let alike = self.matrix.determinant() <= ALIKE * self.matrix.diagonal().product();
        let gain = match both.filter(|_| !alike) {
            Some(gain) => [gain[0], gain[1]],
            None if m > 0.0 => [0, 1].map(|j| if j == i { v / m } else { 0.0 }),
            None => [0.0; 2],
        };
        let explained = self.vector.dot(&Vector2::from(gain));
        Fit {
            gain,
            left: (self.square - explained).max(0.0),
            all: self.square.max(f64::MIN_POSITIVE),
        }
    }
}

/// Determinant of the normal equations, as a share of the product of their diagonal, below which both inputs are the same
/// (precision of their solution).
const ALIKE: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::model::Model;
    use crate::recording::{Channels, DriveUnit};
    use crate::robot::{Robot, State};
    use crate::simulate::{Hold, Input, simulate};

    /// 40 s at 100 Hz with a held input that steps at a row in five, with its true speeds.
    fn driven() -> (Recording, Vec<[f64; 2]>) {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let model = Model::base(Robot::amigobot());
        let p = model.initial();
        let t: Vec<f64> = (0..4000).map(|k| 0.01 * f64::from(k)).collect();
        let mut step = [0.0; 2];
        let torque: Vec<[f64; 2]> = (0..t.len())
            .map(|k| {
                if k % 5 == 0 {
                    step = [normal(), normal()].map(|v| 0.2 * v);
                }
                let turn = 0.1 * (0.002 * k as f64).sin();
                [0.35 + step[0] + turn, 0.35 + step[1] - turn]
            })
            .collect();
        let input = Input { t: &t, torque: &torque, hold: Hold::Constant };
        let states = simulate(&model, &p, &input, State::default()).unwrap();
        let alpha = states.iter().map(|s| s.alpha.map(|a| a + 5e-4 * normal())).collect();
        let omega = states.iter().map(|s| s.omega.map(|w| w + 0.05 * normal())).collect();
        let channels = Channels { t: t.clone(), alpha: Some(alpha), omega: Some(omega), torque };
        let recording = Recording::new("steps", channels, DriveUnit::NewtonMetre).unwrap();
        (recording, states.iter().map(|s| s.omega).collect())
    }

    /// Root mean square error of speeds \[rad/s\] in some rows, and in units of the stated one.
    fn errors(truth: &[[f64; 2]], of: impl Fn(usize) -> ([f64; 2], [f64; 2])) -> [f64; 2] {
        let (mut square, mut relative, mut count) = (0.0, 0.0, 0.0);
        for k in (200..3800).step_by(37) {
            let (omega, error) = of(k);
            for i in 0..2 {
                let off = (omega[i] - truth[k][i]).powi(2);
                (square, relative, count) = (square + off, relative + off / error[i], count + 1.0);
            }
        }
        [square / count, relative / count].map(f64::sqrt)
    }

    #[test]
    fn a_start_among_steps_of_the_input_is_as_accurate_as_it_states() {
        let (recording, truth) = driven();
        let local = |k: usize| {
            let motion = recording.local_motion()[k];
            (motion.omega, motion.omega_variance)
        };
        let start = |k: usize| {
            let start = recording.start_at(k);
            (start.state.omega, start.omega_square_error)
        };
        let ([bare, far], [beside, stated]) = (errors(&truth, local), errors(&truth, start));
        // 98 rows of two wheels leave 5 % of a root mean square
        assert!(far > 2.0, "{far}");
        assert!(beside < 0.7 * bare, "{beside} {bare}");
        // an error in proportion to the width is assumed, the largest that a smoother one can be
        assert!((0.3..1.2).contains(&stated), "{stated}");
    }

    #[test]
    fn a_start_is_the_same_whatever_input_is_tried() {
        let (recording, _) = driven();
        let later = recording.torque().iter().skip(3).copied().chain([[0.0; 2]; 3]).collect();
        let other = recording.with_torque(later);
        assert!(recording.response().gain != [[0.0; 2]; 2]);
        for k in (200..3800).step_by(400) {
            assert_eq!(other.start_at(k), recording.start_at(k));
        }
    }

    #[test]
    fn a_smooth_motion_starts_where_the_local_motion_is() {
        // an input of noise that moves nothing
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(4);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let t: Vec<f64> = (0..4000).map(|k| 0.01 * f64::from(k)).collect();
        let truth: Vec<[f64; 2]> =
            t.iter().map(|t| [5.0 + 2.0 * (0.5 * t).sin(), 6.0 + (0.7 * t).cos()]).collect();
        let angles =
            t.iter().map(|t| [5.0 * t - 4.0 * (0.5 * t).cos(), 6.0 * t + (0.7 * t).sin() / 0.7]);
        let alpha = angles.map(|a| a.map(|a| a + 5e-4 * normal())).collect();
        let omega = truth.iter().map(|w| w.map(|w| w + 0.05 * normal())).collect();
        let torque = t.iter().map(|_| [0.01 * normal(), 0.01 * normal()]).collect();
        let channels = Channels { t, alpha: Some(alpha), omega: Some(omega), torque };
        let recording = Recording::new("smooth", channels, DriveUnit::NewtonMetre).unwrap();
        assert_eq!(recording.response().gain, [[0.0; 2]; 2]);
        let start = |k: usize| {
            let start = recording.start_at(k);
            assert_eq!(start.state.omega, recording.local_motion()[k].omega);
            (start.state.omega, start.omega_square_error)
        };
        // the mean estimate of what is left is positive by chance
        let [_, stated] = errors(&truth, start);
        assert!((0.4..1.2).contains(&stated), "{stated}");
    }
}
