//! The cost of output error: a free simulation against what was measured, with derivatives.

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::Task;
use super::screening::lowest;
use crate::effects::ParameterKind;
use crate::filter::{Prepared, ScoreSums, prepare};
use crate::math::Information;
use crate::math::descent::Quadratic;
use crate::model::Model;
use crate::robot::State;
use crate::simulate::{Hold, Input, LANES, column_of_start, follow, simulate};

/// Standard deviation of the logarithm of scattered starts.
const SCATTER: f64 = 0.3;
/// Scattered values that are simulated for each one from which a descent starts.
const SCREENED: usize = 8;
/// Standard errors within which a wheel starts at rest, and standard deviations of the noise beyond which
/// it turns.
const AT_REST: f64 = 3.0;
const TURNS: f64 = 6.0;
/// Blocks within which residuals may be correlated \[s\].
const BLOCK: f64 = 5.0;

/// Parameters that are estimated, then four initial states of every piece.
pub(super) struct Problem<'a> {
    pub(super) task: &'a Task<'a>,
    pub(super) p: Vec<f64>,
    pub(super) free: Vec<usize>,
    pub(super) pieces: Vec<(usize, std::ops::Range<usize>)>,
    pub(super) prepared: Vec<Prepared<'a>>,
}

impl<'a> Problem<'a> {
    pub(super) fn new(task: &'a Task<'a>, p: Vec<f64>) -> Self {
        let pieces = task
            .train
            .iter()
            .enumerate()
            .flat_map(|(r, recording)| {
                recording.pieces().iter().filter(|p| p.len() > 4).map(move |p| (r, p.clone()))
            })
            .collect();
        let prepared = task.train.iter().map(prepare).collect();
        Self { task, free: task.model.free(), p, pieces, prepared }
    }

    pub(super) fn model(&self) -> &Model {
        self.task.model
    }

    fn first(&self) -> DVector<f64> {
        let mut x: Vec<f64> = self.free.iter().map(|&j| self.p[j]).collect();
        for (r, piece) in &self.pieces {
            let m = self.task.train[*r].local_motion_at(piece.start);
            let still = self.prepared[*r].still[piece.start];
            let at_rest =
                |i: usize| still[i] || m.omega[i].abs() < AT_REST * m.omega_variance[i].sqrt();
            x.extend(m.alpha);
            x.extend([0, 1].map(|i| if at_rest(i) { 0.0 } else { m.omega[i] }));
        }
        DVector::from_vec(x)
    }

    /// The first start, and the best by their ISE of many with parameters scattered around it.
    pub(super) fn starts(&self, count: usize) -> Vec<DVector<f64>> {
        let mut rng = ChaCha8Rng::seed_from_u64(self.task.seed);
        let first = self.first();
        let scattered: Vec<DVector<f64>> = (0..SCREENED * (count - 1))
            .map(|_| {
                let mut x = first.clone();
                for i in 0..self.free.len() {
                    let draw: f64 = StandardNormal.sample(&mut rng);
                    x[i] *= (SCATTER * draw).exp();
                }
                x
            })
            .collect();
        let best = self.lowest(&scattered, count - 1);
        std::iter::once(first).chain(best.into_iter().map(|n| scattered[n].clone())).collect()
    }

    /// The places of the `count` starts whose simulations come nearest.
    fn lowest(&self, starts: &[DVector<f64>], count: usize) -> Vec<usize> {
        let Some(first) = starts.first() else { return vec![] };
        let vectors: Vec<Vec<f64>> = starts.iter().map(|x| self.parameters(x)).collect();
        let stretches = self.pieces.iter().enumerate().map(|(n, (r, piece))| {
            let measured = &self.task.train[*r].omega()[piece.clone()];
            (self.input(*r, piece), self.start(first, n), measured)
        });
        lowest(self.model(), &vectors, count, stretches)
    }

    /// Lower and upper bounds of shape parameters, and of initial speeds that are zero at `start`: such a
    /// wheel starts at rest or the way it turns first. Friction would stop it at once if it started the
    /// other way, so that the cost has an edge at rest which no descent follows.
    pub(super) fn bounds(&self, start: &DVector<f64>) -> [DVector<f64>; 2] {
        let mut lower = DVector::repeat(start.len(), f64::NEG_INFINITY);
        let mut upper = DVector::repeat(start.len(), f64::INFINITY);
        for (i, &j) in self.free.iter().enumerate() {
            let spec = &self.model().parameters()[j].spec;
            if spec.kind == ParameterKind::Shape {
                (lower[i], upper[i]) = spec.range;
            }
        }
        for (n, (r, piece)) in self.pieces.iter().enumerate() {
            for wheel in 0..2 {
                let i = self.free.len() + 4 * n + 2 + wheel;
                match self.first_way(*r, piece, wheel) {
                    Some(way) if start[i] == 0.0 && way > 0.0 => lower[i] = 0.0,
                    Some(_) if start[i] == 0.0 => upper[i] = 0.0,
                    _ => {}
                }
            }
        }
        [lower, upper]
    }

    /// The first speed of a wheel that is clear of the noise.
    fn first_way(&self, r: usize, piece: &std::ops::Range<usize>, wheel: usize) -> Option<f64> {
        let clear = TURNS * self.prepared[r].variance[2 + wheel].sqrt();
        let speeds = self.task.train[r].omega()[piece.clone()].iter().map(|omega| omega[wheel]);
        speeds.into_iter().find(|speed| speed.abs() > clear)
    }

    pub(super) fn parameters(&self, x: &DVector<f64>) -> Vec<f64> {
        let mut p = self.p.clone();
        for (i, &j) in self.free.iter().enumerate() {
            p[j] = x[i];
        }
        p
    }

    fn start(&self, x: &DVector<f64>, piece: usize) -> State {
        let at = |i: usize| x[self.free.len() + 4 * piece + i];
        State { alpha: [at(0), at(1)], omega: [at(2), at(3)] }
    }

    fn input(&self, r: usize, piece: &std::ops::Range<usize>) -> Input<'a> {
        let recording = &self.task.train[r];
        let hold: Hold = self.task.hold;
        Input { t: &recording.t()[piece.clone()], torque: &recording.torque()[piece.clone()], hold }
    }

    /// Measured less simulated values of one sample; zero in rows without new ones.
    #[inline]
    fn error(&self, r: usize, k: usize, state: &State) -> [f64; 4] {
        let recording = &self.task.train[r];
        let (a, w) = (recording.alpha()[k], recording.omega()[k]);
        let measured = [a[0], a[1], w[0], w[1]];
        let simulated = [state.alpha[0], state.alpha[1], state.omega[0], state.omega[1]];
        let new = if recording.is_reading(k) { 1.0 } else { 0.0 };
        std::array::from_fn(|i| new * (measured[i] - simulated[i]))
    }

    /// One over the standard deviation of each channel; zero for those not measured.
    fn weight(&self, r: usize) -> [f64; 4] {
        let prepared = &self.prepared[r];
        let one_over = |i: usize| 1.0 / prepared.variance[i].sqrt();
        std::array::from_fn(|i| if prepared.used[i] { one_over(i) } else { 0.0 })
    }

    /// Number of measured values, without those that repeat a slow sensor, minus number of estimated quantities.
    pub(super) fn degrees(&self) -> f64 {
        let channels = |r: usize| self.prepared[r].used.iter().filter(|used| **used).count();
        let values = |(r, piece): &(usize, std::ops::Range<usize>)| {
            self.task.train[*r].readings_in(piece) * channels(*r)
        };
        let samples: usize = self.pieces.iter().map(values).sum();
        samples.saturating_sub(self.free.len() + 4 * self.pieces.len()).max(1) as f64
    }

    /// Half the sum of squared residuals.
    pub(super) fn cost(&self, x: &DVector<f64>) -> Option<f64> {
        let p = self.parameters(x);
        let mut sum = 0.0;
        for (n, (r, piece)) in self.pieces.iter().enumerate() {
            let (input, weight) = (self.input(*r, piece), self.weight(*r));
            let motion = simulate(self.model(), &p, &input, self.start(x, n)).ok()?;
            for (k, state) in piece.clone().zip(&motion) {
                let error = self.error(*r, k, state);
                sum += (0..4).map(|i| 0.5 * (weight[i] * error[i]).powi(2)).sum::<f64>();
            }
        }
        sum.is_finite().then_some(sum)
    }

    /// The cost with gradient and curvature, and the gradients of blocks of 5 s, one per row; `None` if it is not below
    /// `most`, which ends the simulation as soon as the sum of squares reaches it.
    pub(super) fn evaluate(
        &self,
        x: &DVector<f64>,
        most: f64,
    ) -> Option<(Quadratic, DMatrix<f64>)> {
        let (p, size, count) = (self.parameters(x), x.len(), self.free.len());
        let mut hessian = DMatrix::zeros(size, size);
        let (mut cost, mut scores) = (0.0, Vec::new());
        for (n, (r, piece)) in self.pieces.iter().enumerate() {
            let (input, weight) = (self.input(*r, piece), self.weight(*r));
            let stride = (p.len() + 4).next_multiple_of(LANES);
            let (mut sums, mut blocks) = (ScoreSums::new(p.len() + 4), Vec::new());
            let mut block_ends = input.t[0] + BLOCK;
            follow(self.model(), &p, &input, self.start(x, n), &mut |k, state, derivatives| {
                let error = self.error(*r, piece.start + k, state);
                while input.t[k] >= block_ends {
                    blocks.push(sums.take_score());
                    block_ends += BLOCK;
                }
                // a row that repeats a slow sensor is no measurement
                if !self.task.train[*r].is_reading(piece.start + k) {
                    return true;
                }
                for i in (0..4).filter(|&i| weight[i] > 0.0) {
                    let residual = weight[i] * error[i];
                    cost += 0.5 * residual * residual;
                    sums.add_row(&derivatives[i * stride..][..stride], weight[i], error[i]);
                }
                !(cost >= most)
            })
            .ok()?;
            if cost >= most {
                return None;
            }
            blocks.push(sums.take_score());
            let (curvature, _) = sums.finish();
            let of_start = (0..4).map(|i| column_of_start(p.len(), i));
            let columns = self.free.iter().copied().chain(of_start);
            let places = (0..count).chain(count + 4 * n..count + 4 * n + 4);
            let own: Vec<(usize, usize)> = columns.zip(places).collect();
            for &(c, i) in &own {
                own.iter().for_each(|&(d, k)| hessian[(i, k)] += curvature[(c, d)]);
            }
            for block in &blocks {
                let mut score = DVector::zeros(size);
                own.iter().for_each(|&(c, i)| score[i] = block[c]);
                scores.push(score);
            }
        }
        let scores = DMatrix::from_fn(scores.len(), size, |b, j| scores[b][j]);
        let gradient = -scores.row_sum().transpose();
        let scatter = scatter(&hessian, &scores);
        cost.is_finite().then_some((Quadratic { cost, gradient, hessian, scatter }, scores))
    }
}

/// [`Quadratic::scatter`] with the gradients of blocks, one per row. Far from the minimum the blocks share a mean, and
/// it is at most twice the expected decrease of the cost.
fn scatter(hessian: &DMatrix<f64>, scores: &DMatrix<f64>) -> f64 {
    statistics(&Information::new(hessian), scores) / hessian.nrows() as f64
}

/// Sum of the score statistics of blocks, one per row of `scores`.
pub(super) fn statistics(information: &Information, scores: &DMatrix<f64>) -> f64 {
    (scores * information.whitening()).norm_squared()
}
