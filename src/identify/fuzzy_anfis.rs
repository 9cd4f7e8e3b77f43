//! Fuzzy emulator with adapted membership functions.

use nalgebra::DVector;
use serde::{Deserialize, Serialize};

use super::fuzzy::{
    Found, Fuzzy, Job, Journal, Limits, Penalty, Problem, Search, continuation, levenberg_marquardt,
};
use super::{IdentifyError, MethodDescription, Status};
use crate::simulate::Structure;

/// Hybrid learning: consequents by least squares, centres and widths down the gradient.
///
/// ```text
/// repeat:  theta  = arg min ISE at fixed premises  (closed form; parallel: Levenberg-Marquardt)
///          premises -= step · gradient / |gradient|
///          step up by 1.2 after a fall of the cost, halved after a rise
/// ```
/// The premises are counted in units of their spacing. Centres keep their order, and widths stay
/// between a fifth and three times the first.
///
/// Source: Jang, ANFIS, IEEE Trans. SMC 23 (1993); the paper's conclusion names learning of the
/// fuzzy sets by neural networks, which this is.
#[derive(Clone, Debug, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Anfis {
    /// Rounds of fitting consequents and moving premises.
    pub epochs: usize,
    /// First step of the premises, in units of their spacing.
    #[schemars(range(max = 1.0), extend("exclusiveMinimum" = 0))]
    pub step: f64,
}

impl Default for Anfis {
    fn default() -> Self {
        Self { epochs: 40, step: 0.05 }
    }
}

/// Step below which the premises have converged.
const SMALLEST_STEP: f64 = 1e-4;
/// Largest number of steps of the consequents per epoch.
const INNER: usize = 6;

/// The method: this search with the options of all fuzzy methods.
pub type FuzzyAnfis = Fuzzy<Anfis>;

impl Search for Anfis {
    const NAME: &'static str = "fuzzy_anfis";

    fn describe() -> MethodDescription {
        MethodDescription {
            name: Self::NAME.into(),
            title: "Fuzzy emulator: ANFIS (adaptive membership functions)".into(),
            equation: "consequents by least squares, then centres and widths by a gradient step, \
                       in turns"
                .into(),
            source: "Jang 1993; Giergiel and Buratowski 2010, conclusion".into(),
            use_when:
                "fixed membership functions cannot resolve the friction near rest: few of them, or \
                       the paper's range of 0 to 30 rad/s"
                    .into(),
            avoid_when: "36 rules over the range of the data already reach the noise floor".into(),
        }
    }

    fn search(&self, job: &mut Job) -> Result<Found, IdentifyError> {
        let Job { problem, level, ridge, journal, .. } = job;
        let limits = Limits { iterations: 60, tolerance: 1e-4 };
        let penalty = Penalty { about: level, weight: problem.penalty(*ridge) };
        let descend = |problem: &Problem, theta: &DVector<f64>, limits| {
            Ok(levenberg_marquardt(problem, theta, penalty, limits, journal))
        };
        let (theta, ..) =
            continuation(problem, level, *ridge, limits, journal, Self::NAME, descend)?;
        let mut learner = Learner { theta, penalty, ridge: *ridge, journal };
        let (iterations, status) = learner.learn(problem, self.epochs, self.step)?;
        Ok(Found { theta: learner.theta.as_slice().to_vec(), iterations, status })
    }
}

struct Learner<'a> {
    theta: DVector<f64>,
    penalty: Penalty<'a>,
    ridge: f64,
    journal: &'a Journal,
}

impl Learner<'_> {
    /// Adapts the premises of `problem` and the consequents; returns the number of epochs and the status.
    fn learn(
        &mut self,
        problem: &mut Problem,
        epochs: usize,
        mut step: f64,
    ) -> Result<(usize, Status), IdentifyError> {
        let first = problem.system.premises();
        let scale = spacings(problem);
        let mut cost = problem.cost(self.theta.as_slice());
        for epoch in 0..epochs {
            let Some(direction) = self.downhill(problem, &scale) else {
                return Ok((epoch, Status::Stalled));
            };
            let now = problem.system.premises();
            let mut moved = problem.clone();
            let trial: Vec<f64> =
                (0..now.len()).map(|k| now[k] + step * scale[k] * direction[k]).collect();
            moved.system.set_premises(&sound(&trial, &first, problem));
            let theta = self.consequents(&moved)?;
            let new = moved.cost(theta.as_slice());
            self.journal.note(new);
            if new < cost {
                (*problem, self.theta, cost) = (moved, theta, new);
                step *= 1.2;
            } else {
                step *= 0.5;
                if step < SMALLEST_STEP {
                    return Ok((epoch + 1, Status::Converged));
                }
            }
        }
        Ok((epochs, Status::IterationLimit))
    }

    /// Unit vector of steepest descent of the ISE in the scaled premises.
    fn downhill(&self, problem: &Problem, scale: &[f64]) -> Option<Vec<f64>> {
        let normal = problem.normal(self.theta.as_slice(), true)?;
        self.journal.note(normal.cost);
        let from = problem.free().len();
        let slope: Vec<f64> =
            scale.iter().enumerate().map(|(k, s)| s * normal.g[from + k]).collect();
        let norm = slope.iter().map(|x| x * x).sum::<f64>().sqrt();
        (norm > 0.0 && norm.is_finite()).then(|| slope.iter().map(|x| x / norm).collect())
    }

    fn consequents(&self, problem: &Problem) -> Result<DVector<f64>, IdentifyError> {
        if problem.structure == Structure::SerialParallel {
            return problem.closed_form(self.penalty.about, self.ridge, Anfis::NAME);
        }
        let limits = Limits { iterations: INNER, tolerance: 1e-4 };
        let (theta, journal) = (&self.theta, self.journal);
        Ok(levenberg_marquardt(problem, theta, self.penalty, limits, journal).0)
    }
}

/// Scale of each premise: the spacing of its membership functions [rad/s].
fn spacings(problem: &Problem) -> Vec<f64> {
    let one = |i: usize| {
        let (low, high) = problem.system.range()[i];
        let count = problem.system.memberships(i).len();
        vec![(high - low) / (count - 1) as f64; 2 * count]
    };
    [one(0), one(1)].concat()
}

/// Premises with centres in order and widths within their bounds relative to `first`.
fn sound(trial: &[f64], first: &[f64], problem: &Problem) -> Vec<f64> {
    let mut out = trial.to_vec();
    let mut from = 0;
    for input in 0..2 {
        let count = problem.system.memberships(input).len();
        let (low, high) = problem.system.range()[input];
        let least = 0.1 * (high - low) / (count - 1) as f64;
        for k in from + 1..from + count {
            out[k] = out[k].max(out[k - 1] + least);
        }
        for k in from + count..from + 2 * count {
            out[k] = out[k].clamp(0.2 * first[k], 3.0 * first[k]);
        }
        from += 2 * count;
    }
    out
}
