//! Makes a fit of consequents.

use std::sync::Arc;

use super::{DIVERGED, Journal, Problem};
use crate::identify::{Fit, Note, Status, Trace, TraceAxis, TraceKind, Work};
use crate::simulate::Structure;

/// The fit of a fuzzy method: no physical parameters, the emulator as dynamics, and notes on the
/// meaning of its ISE.
#[must_use]
pub(super) fn finish(
    method: &str,
    problem: &Problem,
    theta: &[f64],
    status: Status,
    iterations: usize,
    journal: &Journal,
) -> Fit {
    let dynamics = problem.dynamics(theta);
    let notes = notes(problem, theta, &dynamics.trained);
    let best = journal.best();
    let trace = Trace {
        kind: TraceKind::Cost,
        axis: TraceAxis::Evaluation,
        at: best.iter().map(|b| b.0 as f64).collect(),
        values: best.iter().map(|b| vec![b.1]).collect(),
    };
    Fit {
        method: method.into(),
        dynamics: Arc::new(dynamics),
        estimates: vec![],
        covariance: None,
        status,
        work: Work { iterations, evaluations: journal.evaluations() },
        notes,
        traces: if best.is_empty() { vec![] } else { vec![trace] },
        horizon_s: None,
    }
}

fn notes(problem: &Problem, theta: &[f64], trained: &[bool]) -> Vec<Note> {
    let floor = problem.noise_floor;
    let finite = |ise: f64| (ise < DIVERGED).then_some(ise);
    let fed = Some((problem.structure, problem.gain));
    let mut notes = vec![Note::Emulator { fed, ise: finite(problem.cost(theta)), floor }];
    if problem.gain > 0.0 || problem.structure == Structure::SerialParallel {
        let free = problem.with_gain(0.0).with_structure(Structure::Parallel).cost(theta);
        notes.push(Note::Emulator { fed: None, ise: finite(free), floor });
    }
    let count = trained.iter().filter(|t| **t).count();
    notes.push(Note::ExcitedRules { count, of: trained.len() });
    if problem.system.range().iter().any(|(low, _)| *low >= 0.0) {
        notes.push(Note::ForwardOnly);
    }
    notes
}
