//! A fuzzy system, sampled for figures.

use super::plan::Plan;
use crate::export::{FuzzyIdentified, fuzzy_files};
use crate::simulate::FuzzyDynamics;
use crate::study::FuzzyStudy;

/// Points of a grid of speeds.
const POINTS: usize = 61;

/// Membership functions, rules and output surface of a system fitted by `method`, and the system as a
/// function.
pub(super) fn fuzzy_study(plan: &Plan, method: &str, dynamics: &FuzzyDynamics) -> FuzzyStudy {
    let system = &dynamics.system;
    let range = system.range();
    let grid = [0, 1].map(|input: usize| -> Vec<f64> {
        let (low, high) = (range[input].0, range[input].1);
        (0..POINTS).map(|k| low + (high - low) * k as f64 / (POINTS - 1) as f64).collect()
    });
    let memberships = [0, 1].map(|input: usize| {
        system
            .memberships(input)
            .iter()
            .map(|m| grid[input].iter().map(|w| m.membership(*w)).collect())
            .collect()
    });
    let consequents = [0, 1].map(|output: usize| {
        (0..system.rules()).map(|r| system.consequent(output, r)[0]).collect()
    });
    let surface = [0, 1].map(|output: usize| {
        grid[0]
            .iter()
            .map(|w1| grid[1].iter().map(|w2| system.output(&[*w1, *w2])[output]).collect())
            .collect()
    });
    let functions = fuzzy_files(&FuzzyIdentified {
        dynamics,
        robot: &plan.model.robot().name,
        drive_unit: plan.drive_unit(),
        hold: plan.hold,
        experiment: &plan.name,
        method,
    });
    FuzzyStudy { grid, memberships, consequents, surface, functions }
}
