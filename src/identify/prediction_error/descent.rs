//! Gauss-Newton on the filter with a horizon.

use nalgebra::{DMatrix, DVector};

use crate::effects::ParameterKind;
use crate::filter::{HorizonFilter, Reading, Sums};
use crate::identify::Status;
use crate::math::{Attempt, DampedSearch, Information, MinimumStatus, Proposal, take_steps};
use crate::model::Model;
use crate::model::base::{A1, A2};
use crate::simulate::Hold;

/// Steps, at most.
const STEPS: usize = 30;
/// Decrease that no longer matters [nats]: a step of 0.03 standard errors.
const NEGLIGIBLE: f64 = 5e-4;
/// A step with a smaller predicted decrease [nats] (less than one standard error) is accepted
/// without comparing the cost: the score neglects the dependence of the gain on the parameters, so
/// the cost need not decrease there.
const NEAR: f64 = 0.5;
/// Rise of the cost per row [nats] that such a step may cause: innovations larger by a hundredth (judgement). A larger
/// one is another motion: a wheel that rests, or turns that diverge.
const LEAP: f64 = 0.01;
/// Damping after the first failure, and its factor.
const DAMPING: (f64, f64) = (1e-2, 10.0);
/// Ratio of the inertias of turning and of driving straight below which a step is refused: a radius of gyration of a
/// tenth of half the track, smaller than that of any robot (judgement).
const VANISHING: f64 = 0.01;
/// Largest shift of the input in rows.
const MOST_SHIFT: f64 = 0.5;

/// Where a descent ended.
#[derive(Clone)]
pub(super) struct Solution {
    /// Horizon \[s\].
    pub(super) horizon: f64,
    /// Parameters of the model.
    pub(super) p: Vec<f64>,
    /// Rows by which the input acts early.
    pub(super) shift: f64,
    /// Columns that were estimated; the shift follows the parameters.
    pub(super) columns: Vec<usize>,
    /// Of each piece.
    pub(super) sums: Vec<Sums>,
    pub(super) status: Status,
    pub(super) iterations: usize,
    pub(super) evaluations: usize,
}

/// A step of the estimated columns, and its predicted decrease of the cost [nats].
struct Towards {
    step: DVector<f64>,
    promise: f64,
}

/// The estimated columns: the free parameters and, after all parameters, the shift.
fn estimated(filter: &HorizonFilter, model: &Model) -> Vec<usize> {
    let mut columns = model.free();
    if filter.hold == Hold::Linear && !model.delays_input() {
        columns.push(model.parameters().len());
    }
    columns
}

impl Solution {
    /// A point at which the filter runs; `None` where its cost is not finite.
    fn at(
        filter: &HorizonFilter,
        model: &Model,
        (p, shift): (Vec<f64>, f64),
        horizon: f64,
    ) -> Option<Self> {
        let sums = filter.pass(model, &p, shift, horizon, Reading::Whole).ok()?;
        let (columns, status) = (estimated(filter, model), Status::Converged);
        let out = Self { horizon, p, shift, columns, sums, status, iterations: 0, evaluations: 0 };
        out.cost().is_finite().then_some(out)
    }

    /// Whether a descent of this model from `p` at this horizon can start from this evaluation of the filter. Beyond
    /// a horizon of zero it may have been made with other weights of the rows.
    pub(super) fn is_at(
        &self,
        filter: &HorizonFilter,
        model: &Model,
        p: &[f64],
        horizon: f64,
    ) -> bool {
        let here = self.p == p && self.horizon == horizon;
        here && (horizon == 0.0 || !filter.alike) && self.columns == estimated(filter, model)
    }

    fn total(&self, of: impl Fn(&Sums) -> f64) -> f64 {
        self.sums.iter().map(of).sum()
    }

    /// Mean square of the normalised innovations.
    pub(super) fn scale(&self) -> f64 {
        self.total(|s| s.square) / self.total(|s| s.count).max(1.0)
    }

    /// Half of `N ln(Σ e²/S / N) + Σ ln S` [nats].
    pub(super) fn cost(&self) -> f64 {
        0.5 * (self.total(|s| s.count) * self.scale().ln() + self.total(|s| s.log_variance))
    }

    /// Information over the estimated columns.
    pub(super) fn information(&self) -> DMatrix<f64> {
        let n = self.columns.len();
        let mut out = DMatrix::zeros(n, n);
        for sums in &self.sums {
            out += chosen(&sums.information, &self.columns);
        }
        out
    }

    /// Change of the solution if the input were read differently, to first order.
    pub(super) fn moved_by(
        &self,
        filter: &HorizonFilter,
        model: &Model,
        reading: Reading,
    ) -> Option<DVector<f64>> {
        let there = filter.pass(model, &self.p, self.shift, self.horizon, reading).ok()?;
        let mut change = DVector::zeros(self.columns.len());
        for (there, here) in there.iter().zip(&self.sums) {
            change += part(&(&there.score - &here.score), &self.columns);
        }
        let moved = Information::new(&self.information()).solve(&change);
        moved.iter().all(|v| v.is_finite()).then_some(moved)
    }

    /// The step by the score, without the columns that are at a bound and would cross it.
    fn towards(&self, model: &Model, damping: f64) -> Towards {
        let score = (0..self.sums.len())
            .fold(DVector::zeros(self.columns.len()), |sum, piece| sum + self.score_of(piece));
        let information = self.information();
        let mut open: Vec<usize> = (0..self.columns.len()).collect();
        loop {
            let (h, g) = (chosen(&information, &open), part(&score, &open));
            let short = Information::new(&h).solve_damped(&g, damping);
            let mut whole = DVector::zeros(self.columns.len());
            open.iter().zip(short.iter()).for_each(|(&i, v)| whole[i] = *v);
            let (p, shift) = self.moved(model, &whole);
            let stays = |i: usize| match self.columns[i] {
                j if j == p.len() => shift == self.shift,
                j => p[j] == self.p[j],
            };
            let count = open.len();
            open.retain(|&i| whole[i] == 0.0 || !stays(i));
            if open.len() == count {
                let promise = 0.5 * whole.dot(&score) / self.scale();
                return Towards { step: whole, promise };
            }
        }
    }

    /// Score of a piece over the estimated columns.
    pub(super) fn score_of(&self, piece: usize) -> DVector<f64> {
        part(&self.sums[piece].score, &self.columns)
    }

    /// Parameters after a step of the estimated columns; shapes stay in their ranges.
    pub(super) fn moved(&self, model: &Model, step: &DVector<f64>) -> (Vec<f64>, f64) {
        let (mut p, mut shift) = (self.p.clone(), self.shift);
        for (step, &j) in step.iter().zip(&self.columns) {
            let Some(parameter) = model.parameters().get(j) else {
                shift = (shift + step).clamp(-MOST_SHIFT, MOST_SHIFT);
                continue;
            };
            p[j] += step;
            if parameter.spec.kind == ParameterKind::Shape {
                p[j] = p[j].clamp(parameter.spec.range.0, parameter.spec.range.1);
            }
        }
        (p, shift)
    }
}

/// Rows and columns of a matrix.
pub(super) fn chosen(matrix: &DMatrix<f64>, columns: &[usize]) -> DMatrix<f64> {
    let n = columns.len();
    DMatrix::from_fn(n, n, |i, k| matrix[(columns[i], columns[k])])
}

/// Entries of a vector.
pub(super) fn part(vector: &DVector<f64>, columns: &[usize]) -> DVector<f64> {
    DVector::from_fn(columns.len(), |i, _| vector[columns[i]])
}

/// The solution of `Σ ψ e/S = 0` by damped Gauss-Newton steps; `None` where the start has no finite cost.
///
/// A step is accepted if it lowers the cost with its scale profiled out. The score neglects the dependence
/// of the gain on the parameters; if the innovations are much larger than their predicted variance, this
/// term can reverse the sign of the gradient. A step that halves the predicted decrease is therefore
/// accepted too.
pub(super) fn descend(
    filter: &HorizonFilter,
    model: &Model,
    (p, shift): (&[f64], f64),
    horizon: f64,
) -> Option<Solution> {
    let here = Solution::at(filter, model, (p.to_vec(), shift), horizon)?;
    let mut end = descend_from(filter, model, here);
    end.evaluations += 1;
    Some(end)
}

/// [`descend`] from a point at which the filter has run.
pub(super) fn descend_from(filter: &HorizonFilter, model: &Model, here: Solution) -> Solution {
    let (damping, share, promised) = (0.0, 1.0, f64::INFINITY);
    let mut descent = Descent { filter, model, here, damping, share, promised, evaluations: 0 };
    let (status, iterations) = take_steps(&mut descent);
    let Descent { here, evaluations, .. } = descent;
    Solution { status: status.into(), iterations, evaluations, ..here }
}

/// Whether a step from `before` makes the inertia of turning vanish beside that of driving straight: such a robot has
/// no turning that the rows resolve, and its simulation takes the more steps the smaller it is.
fn vanishes(p: &[f64], before: &[f64]) -> bool {
    let ratio = |p: &[f64]| (p[A1] - p[A2]) / (p[A1] + p[A2]);
    ratio(p) < VANISHING && ratio(p) < ratio(before)
}

/// A descent under way.
struct Descent<'a> {
    filter: &'a HorizonFilter<'a>,
    model: &'a Model,
    here: Solution,
    damping: f64,
    /// Share of a step that is accepted without comparing the cost.
    share: f64,
    /// Decrease that the last undamped step promised [nats].
    promised: f64,
    evaluations: usize,
}

/// A step of a [`Descent`].
struct Trial {
    step: DVector<f64>,
    /// Whether it is accepted without comparing the cost.
    near: bool,
    /// Decrease that the undamped step promises [nats].
    promise: f64,
}

impl DampedSearch for Descent<'_> {
    type Step = Trial;

    fn propose(&mut self, accepted: usize, _: usize) -> Proposal<Trial> {
        let whole = self.here.towards(self.model, 0.0);
        let promise = whole.promise;
        // steps accepted without comparing the cost are halved if the last one did not halve the
        // predicted decrease
        if self.damping == 0.0 && promise < NEAR && promise > 0.5 * self.promised {
            self.share *= 0.5;
        }
        self.promised = promise;
        if self.share * self.share * promise < NEGLIGIBLE {
            return Proposal::End(MinimumStatus::Converged);
        }
        if accepted == STEPS {
            return Proposal::End(MinimumStatus::MaxIterations);
        }
        let damped = self.damping > 0.0;
        let next = if damped { self.here.towards(self.model, self.damping) } else { whole };
        // NaN too: an information that overflows under its damping promises nothing
        if !(next.promise >= NEGLIGIBLE) {
            return Proposal::End(MinimumStatus::Stalled);
        }
        let near = !damped && next.promise < NEAR;
        let step = if near { next.step * self.share } else { next.step };
        Proposal::Step(Trial { step, near, promise })
    }

    fn attempt(&mut self, Trial { step, near, promise }: Trial) -> Attempt {
        let (here, model) = (&self.here, self.model);
        self.evaluations += 1;
        let kept = |there: &Solution| {
            let halved = || there.towards(model, 0.0).promise < 0.5 * promise;
            let rise = there.cost() - here.cost();
            near && rise < LEAP * here.total(|s| s.count) || rise < 0.0 || halved()
        };
        let place = here.moved(model, &step);
        let point = Some(place).filter(|(p, _)| !vanishes(p, &here.p));
        let there = point.and_then(|point| Solution::at(self.filter, model, point, here.horizon));
        match there.filter(kept) {
            Some(there) => {
                self.here = there;
                let most = self.damping > DAMPING.0;
                self.damping = if most { self.damping / DAMPING.1 } else { 0.0 };
                Attempt::Accepted
            }
            None => {
                self.damping = (self.damping * DAMPING.1).max(DAMPING.0);
                Attempt::Rejected
            }
        }
    }
}
