//! From consequents to a fit.

use std::sync::Arc;

use super::{DIVERGED, Journal, Problem};
use crate::identify::{Fit, Status, Trace, Work};
use crate::simulate::Structure;

/// The fit of a fuzzy method: no physical parameters, the emulator as dynamics, and notes on what
/// the number it reached means.
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
        axis: "evaluation".into(),
        at: best.iter().map(|b| b.0 as f64).collect(),
        names: vec!["ISE [rad^2/s]".into()],
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

fn notes(problem: &Problem, theta: &[f64], trained: &[bool]) -> Vec<String> {
    let floor = problem.noise_floor;
    let words = |ise: f64| {
        if ise >= DIVERGED {
            return "diverges".to_string();
        }
        if floor > 0.0 {
            format!("is {ise:.4} rad^2/s, {:.2} times the noise floor", ise / floor)
        } else {
            format!("is {ise:.4} rad^2/s")
        }
    };
    let structure = match problem.structure {
        Structure::Parallel => "parallel",
        Structure::SerialParallel => "serial-parallel",
    };
    let ise = problem.cost(theta);
    let mut notes = vec![format!(
        "{structure} structure, K = {} 1/s on the wheel speeds: the in-sample ISE {}",
        problem.gain,
        words(ise)
    )];
    if problem.gain > 0.0 || problem.structure == Structure::SerialParallel {
        let free = problem.with_gain(0.0).with_structure(Structure::Parallel).cost(theta);
        notes.push(format!(
            "the same rules simulated freely (K = 0): the in-sample ISE {}",
            words(free)
        ));
    }
    let count = trained.iter().filter(|t| **t).count();
    notes.push(format!(
        "{count} of {} rules were excited by the training recordings; speeds at which no excited \
         rule fires with at least 0.2 are extrapolation, and the output there is not to be trusted",
        trained.len()
    ));
    if problem.system.range().iter().any(|(low, _)| *low >= 0.0) {
        notes.push(
            "below zero speed the inputs are clamped: backward driving is treated as standstill"
                .into(),
        );
    }
    notes
}
