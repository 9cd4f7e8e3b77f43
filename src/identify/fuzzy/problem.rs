//! The cost of a fuzzy emulator over all training recordings, with its exact derivatives.

use std::cell::RefCell;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::pass::{Emulator, pass};
use super::piece::Piece;
use super::rows::Rows;
use super::sensitivity::{Along, pass_along, pass_closed, pass_with_sensitivities};
use super::side_by_side::{SIDE_BY_SIDE, passes};
use crate::identify::{IdentifyError, Task, Unsupported};
use crate::robot::BaseParameters;
use crate::robot::StateSpace;
use crate::simulate::{FuzzyDynamics, Structure, TakagiSugeno};

/// Cost of a diverged simulation [rad²/s]; finite, because searches end on infinite costs.
pub const DIVERGED: f64 = 1e9;

/// Training recordings, a fuzzy system and the emulator of eq. (19).
///
/// ```text
/// what' = fhat(what or w; theta) + G u + K (w - what)
/// ISE(theta) = ∫ (w1 - what1)² + (w2 - what2)² dt        [rad²/s]
/// ```
/// theta are the consequents of f31, then those of f41. Every piece of a recording starts from its
/// first measured speeds.
#[derive(Clone)]
pub struct Problem {
    pieces: Vec<Piece>,
    /// The system; its consequents are overwritten by theta.
    pub system: TakagiSugeno,
    /// G of eq. (18).
    pub input_gain: [[f64; 2]; 2],
    /// Source of the argument of fhat.
    pub structure: Structure,
    /// K on both wheel speeds [1/s].
    pub gain: f64,
    /// ISE due to the noise of the measured speeds alone [rad²/s].
    pub noise_floor: f64,
    /// Indices of the consequents with derivatives, of both outputs.
    free: Vec<usize>,
}

/// Smallest maximal strength of a rule whose consequents are searched one by one.
const REACHED: f64 = 0.01;
/// The same for derivatives. Consequents of weaker rules are determined by the penalty on the distance from the
/// friction level.
const FELT: f64 = 1e-3;
/// Smallest gain at which the sensitivities are computed that scale the penalty [1/s], in the middle of
/// those of the continuation. Without a gain they would grow with the length of the recording.
const LEAST_GAIN: f64 = 5.0;

/// Cost, gradient and Gauss-Newton matrix: ISE(theta + d) ~ cost - 2 g'd + d'H d.
#[derive(Clone, Debug)]
pub struct Normal {
    /// ISE [rad²/s].
    pub cost: f64,
    /// ∫ S'e dt: minus half the gradient of the ISE.
    pub g: DVector<f64>,
    /// ∫ S'S dt.
    pub h: DMatrix<f64>,
}

impl Problem {
    /// The problem of a task for a fuzzy system and an input gain from `parameters`.
    #[must_use]
    pub fn new(
        task: &Task,
        system: TakagiSugeno,
        parameters: BaseParameters,
        structure: Structure,
        gain: f64,
    ) -> Self {
        let g = StateSpace::new(parameters).g();
        let input_gain = [[g[(0, 0)], g[(0, 1)]], [g[(1, 0)], g[(1, 1)]]];
        let pieces: Vec<Piece> =
            task.train.iter().flat_map(|r| Piece::all(r, &input_gain, task.hold)).collect();
        let noise_floor = pieces.iter().map(Piece::noise_floor).sum();
        let free = (0..system.parameters().len() / 2).collect();
        Self { pieces, system, input_gain, structure, gain, noise_floor, free }
    }

    /// The same problem with derivatives only with respect to the consequents that the measured speeds reach.
    #[must_use]
    pub fn over_reached(&self) -> Self {
        let mut free = self.stronger_than(FELT);
        free.retain(|k| *k < self.consequents() / 2);
        Self { free, ..self.clone() }
    }

    /// Indices of the consequents with derivatives, of both outputs together.
    #[must_use]
    pub fn free(&self) -> Vec<usize> {
        let other = self.free.iter().map(|k| k + self.consequents() / 2);
        self.free.iter().copied().chain(other).collect()
    }

    /// The same problem with another gain.
    #[must_use]
    pub fn with_gain(&self, gain: f64) -> Self {
        Self { gain, ..self.clone() }
    }

    /// The same problem in another structure.
    #[must_use]
    pub fn with_structure(&self, structure: Structure) -> Self {
        Self { structure, ..self.clone() }
    }

    /// Number of consequents, both outputs together.
    #[must_use]
    pub fn consequents(&self) -> usize {
        self.system.parameters().len()
    }

    /// Measured wheel speeds of all pieces [rad/s].
    pub fn speeds(&self) -> impl Iterator<Item = &[f64; 2]> {
        self.pieces.iter().flat_map(|piece| &piece.omega)
    }

    /// Consequents at the friction level: f3, f4 of eq. (18) without centrifugal terms, at the
    /// centre of each rule (-a4/(a1 + a2) where both wheels run forward and a4 = a5).
    #[must_use]
    pub fn friction_level(&self, parameters: BaseParameters) -> DVector<f64> {
        let model = StateSpace::new(BaseParameters { a3: 0.0, ..parameters });
        let (rules, terms) = (self.system.rules(), self.system.consequents().terms());
        let mut theta = DVector::zeros(self.consequents());
        for rule in 0..rules {
            // a centre at zero takes the side on which its input range lies
            let omega = [0, 1].map(|i| {
                let (low, high) = self.system.range()[i];
                let centre = self.system.centre(rule)[i];
                if centre == 0.0 { low + high } else { centre }
            });
            let f = model.f(&crate::robot::State { omega, ..Default::default() });
            for o in 0..2 {
                theta[(o * rules + rule) * terms] = f[o];
            }
        }
        theta
    }

    /// The consequents that the measured speeds reach: strength of the rule of at least 0.01 in
    /// some sample. The others do not change the cost noticeably.
    #[must_use]
    pub fn reached(&self) -> Vec<usize> {
        self.stronger_than(REACHED)
    }

    fn stronger_than(&self, least: f64) -> Vec<usize> {
        let (rules, terms) = (self.system.rules(), self.system.consequents().terms());
        let mut strongest = vec![0.0_f64; rules];
        for omega in self.speeds() {
            for (most, h) in strongest.iter_mut().zip(self.system.firing(omega)) {
                *most = most.max(h);
            }
        }
        let strong = |k: &usize| strongest[k / terms % rules] >= least;
        (0..self.consequents()).filter(strong).collect()
    }

    fn system_with(&self, theta: &[f64]) -> TakagiSugeno {
        let mut system = self.system.clone();
        system.set_parameters(theta);
        system
    }

    /// ISE [rad²/s]; [`DIVERGED`] at the most.
    #[must_use]
    pub fn cost(&self, theta: &[f64]) -> f64 {
        let (system, emulator) = (self.system_with(theta), self.emulator());
        let costs: Vec<f64> = self
            .pieces
            .par_iter()
            .map(|piece| pass(&system, piece, emulator).unwrap_or(DIVERGED))
            .collect();
        costs.iter().sum::<f64>().min(DIVERGED)
    }

    /// [`Self::cost`] of many vectors, several side by side in the lanes of the processor; equal to it
    /// but for rounding.
    #[must_use]
    pub fn costs(&self, thetas: &[Vec<f64>]) -> Vec<f64> {
        let emulator = self.emulator();
        let of_some = |thetas: &[Vec<f64>]| {
            let mut sums = vec![0.0; thetas.len()];
            for piece in &self.pieces {
                let costs = passes(&self.system, thetas, piece, emulator);
                for (sum, cost) in sums.iter_mut().zip(costs) {
                    *sum += cost.unwrap_or(DIVERGED);
                }
            }
            sums.into_iter().map(|sum| sum.min(DIVERGED)).collect::<Vec<f64>>()
        };
        thetas.par_chunks(SIDE_BY_SIDE).flat_map_iter(of_some).collect()
    }

    const fn emulator(&self) -> Emulator {
        Emulator { structure: self.structure, gain: self.gain }
    }

    /// Cost, gradient and Gauss-Newton matrix over [`Self::free`], followed by the premises (in the order
    /// of [`TakagiSugeno::premises`]) if `premises`; `None` where the emulator diverges.
    #[must_use]
    pub fn normal(&self, theta: &[f64], premises: bool) -> Option<Normal> {
        let sum = self.rows(theta, premises, true)?;
        Some(Normal { cost: sum.cost, g: sum.g.column(0).into_owned(), h: sum.h })
    }

    /// Sums over all pieces, with H if `curvature`.
    fn rows(&self, theta: &[f64], premises: bool, curvature: bool) -> Option<Rows> {
        let system = self.system_with(theta);
        let columns = 2 * self.free.len() + if premises { system.premises().len() } else { 0 };
        let parts: Vec<Option<Rows>> = self
            .pieces
            .par_iter()
            .map(|piece| {
                let mut rows = Rows::new(columns, 1, curvature);
                let (emulator, free) = (self.emulator(), &self.free);
                pass_with_sensitivities(&system, piece, emulator, free, premises, &mut rows)
                    .then(|| rows.finished())
            })
            .collect();
        let mut sum = Rows::new(columns, 1, curvature);
        for part in parts {
            sum.add(&part?);
        }
        Some(sum)
    }

    /// Cost and gradient over [`Self::free`] alone, which is a fraction of the work.
    #[must_use]
    pub fn gradient(&self, theta: &[f64]) -> Option<(f64, DVector<f64>)> {
        let sum = self.rows(theta, false, false)?;
        Some((sum.cost, sum.g.column(0) * -2.0))
    }

    /// Cost and its first two derivatives along one consequent; the second one is that of
    /// Gauss and Newton. `None` where the emulator diverges.
    #[must_use]
    pub fn along(&self, theta: &[f64], j: usize) -> Option<[f64; 3]> {
        let system = self.system_with(theta);
        let parts: Option<Vec<Along>> = self
            .pieces
            .par_iter()
            .map(|piece| pass_along(&system, piece, self.emulator(), j))
            .collect();
        let sum = |f: fn(&Along) -> f64, parts: &[Along]| parts.iter().map(f).sum::<f64>();
        let parts = parts?;
        Some([sum(|p| p.cost, &parts), -2.0 * sum(|p| p.g, &parts), 2.0 * sum(|p| p.h, &parts)])
    }

    /// Least squares of the serial-parallel structure in closed form, about `about`.
    ///
    /// ```text
    /// what = what0 + Psi (theta - about),   Psi' = -K Psi + Phi(w)
    /// minimise ∫ |w - what|² dt + ridge tr(H)/n |theta - about|²,   H = ∫ Psi'Psi dt
    /// ```
    /// Phi are the strengths of the rules at the measured speeds; the two outputs share Psi.
    ///
    /// # Errors
    /// If the matrix is not positive definite, as with a ridge of zero and rules never reached.
    pub fn closed_form(
        &self,
        about: &DVector<f64>,
        ridge: f64,
        method: &str,
    ) -> Result<DVector<f64>, IdentifyError> {
        let (sum, n) = (self.closed_rows(about), self.free.len());
        let weight = ridge * sum.h.trace() / (self.consequents() / 2) as f64;
        let factor = (&sum.h + DMatrix::identity(n, n) * weight).cholesky();
        let Some(factor) = factor else {
            return Err(IdentifyError::Unsupported {
                method: method.into(),
                reason: Unsupported::UnreachedRules,
            });
        };
        let step = factor.solve(&sum.g);
        let mut theta = about.clone();
        self.free().iter().zip(step.iter()).for_each(|(&j, step)| theta[j] += step);
        Ok(theta)
    }

    /// ∫ Psi'Psi dt over the given consequents: what an emulator that is held at the data shows of them.
    #[must_use]
    pub fn closed_curvature(&self, consequents: &[usize]) -> DMatrix<f64> {
        let n = self.consequents() / 2;
        let all = Self { free: (0..n).collect(), ..self.clone() };
        let h = all.closed_rows(&DVector::from_column_slice(self.system.parameters())).h;
        let entry = |i: usize, j: usize| if i / n == j / n { h[(i % n, j % n)] } else { 0.0 };
        let count = consequents.len();
        DMatrix::from_fn(count, count, |i, j| entry(consequents[i], consequents[j]))
    }

    /// H = ∫ Psi'Psi dt of one output and ∫ Psi'e dt of both, serial-parallel.
    fn closed_rows(&self, about: &DVector<f64>) -> Rows {
        let system = self.system_with(about.as_slice());
        let parts: Vec<Rows> = self
            .pieces
            .par_iter()
            .map(|piece| {
                let mut rows = Rows::new(self.free.len(), 2, true);
                pass_closed(&system, piece, self.gain, &self.free, &mut rows);
                rows.finished()
            })
            .collect();
        let mut sum = Rows::new(self.free.len(), 2, true);
        parts.iter().for_each(|part| sum.add(part));
        sum
    }

    /// Weight of |theta - friction level|² in the cost of a descent: `ridge` times the mean square
    /// sensitivity of an emulator that is held at the data (serial-parallel), with a gain of 5 1/s where that
    /// of the problem is lower. It does not depend on theta, so that every method has the same minimum,
    /// wherever it starts.
    #[must_use]
    pub fn penalty(&self, ridge: f64) -> f64 {
        let reference = self.with_gain(self.gain.max(LEAST_GAIN));
        let level = DVector::from_column_slice(self.system.parameters());
        ridge * reference.closed_rows(&level).h.trace() / (self.consequents() / 2) as f64
    }

    /// The emulator with these consequents.
    #[must_use]
    pub fn dynamics(&self, theta: &[f64]) -> FuzzyDynamics {
        let system = self.system_with(theta);
        FuzzyDynamics::new(system, self.input_gain, self.gain, self.structure, self.speeds())
    }
}

/// What searches write down: evaluations, and the best cost whenever it improves.
#[derive(Clone, Debug, Default)]
pub struct Journal {
    inner: RefCell<(usize, Vec<(usize, f64)>)>,
}

impl Journal {
    /// Notes one evaluation with its cost.
    pub fn note(&self, cost: f64) {
        self.note_many(1, cost);
    }

    /// Notes several evaluations of which `cost` is the best.
    pub fn note_many(&self, evaluations: usize, cost: f64) {
        let mut inner = self.inner.borrow_mut();
        inner.0 += evaluations;
        let count = inner.0;
        if inner.1.last().is_none_or(|&(_, best)| cost < best) {
            inner.1.push((count, cost));
        }
    }

    /// Begins the curve anew (another gain has another cost) but goes on counting.
    pub fn restart(&self) {
        self.inner.borrow_mut().1.clear();
    }

    /// Evaluations so far.
    #[must_use]
    pub fn evaluations(&self) -> usize {
        self.inner.borrow().0
    }

    /// (evaluation, best cost so far) whenever it fell.
    #[must_use]
    pub fn best(&self) -> Vec<(usize, f64)> {
        self.inner.borrow().1.clone()
    }
}
