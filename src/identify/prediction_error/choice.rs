//! Choice of the horizon by the simulation error on held-out pieces.

use nalgebra::DVector;

use super::descent::{Solution, chosen, descend, descend_from, part};
use crate::effects::ParameterKind;
use crate::filter::HorizonFilter;
use crate::identify::open_loop::{OpenLoop, clearly_smaller, mean};
use crate::identify::start::sound;
use crate::math::Information;
use crate::model::{Model, Parameter};

/// Horizons that are compared \[s\]: from maximum likelihood to the length at which a missing effect
/// begins to be amplified, at equal ratios.
pub(super) const HORIZONS: [f64; 6] = [0.0, 0.05, 0.1, 0.2, 0.35, 0.7];
/// The first of them where noise of the input biases those before \[s\]: beyond it the motion due
/// to the input (proportional to T) exceeds that due to its noise (proportional to √T).
pub(super) const SAFE: f64 = 0.2;

/// A solution with its errors on held-out pieces.
pub(super) struct Candidate {
    pub(super) solution: Solution,
    /// Mean square 2 s error of each piece, by parameters from all others.
    pub(super) held_out: Vec<f64>,
}

impl Candidate {
    pub(super) fn new(model: &Model, solution: Solution, open: &OpenLoop) -> Self {
        let held_out = open.errors(model, &left_out(model, &solution));
        Self { solution, held_out }
    }
}

/// Parameters without each piece in turn, by one step from those of all pieces, limited to values with which the
/// model can be simulated.
///
/// ```text
/// θ_b = θ - (H - H_b)⁻¹ g_b
/// ```
fn left_out(model: &Model, solution: &Solution) -> Vec<Vec<f64>> {
    let all = solution.information();
    (0..solution.sums.len())
        .map(|b| {
            let sums = &solution.sums[b];
            let others = &all - chosen(&sums.information, &solution.columns);
            let back: DVector<f64> = -part(&sums.score, &solution.columns);
            let mut p = solution.moved(model, &Information::new(&others).solve(&back)).0;
            sound(model, &mut p);
            p
        })
        .collect()
}

/// The parameters `p`, with shapes at a bound of their range reset to their initial values: at a delay of zero
/// the derivative vanishes, so that another horizon could not leave it.
fn off_the_edge(model: &Model, p: &[f64], start: &[f64]) -> Vec<f64> {
    let place = |(j, parameter): (usize, &Parameter)| {
        let (low, high) = parameter.spec.range;
        let edge = parameter.spec.kind == ParameterKind::Shape && !(low < p[j] && p[j] < high);
        if edge && parameter.fixed.is_none() { start[j] } else { p[j] }
    };
    model.parameters().iter().enumerate().map(place).collect()
}

/// Fits at every horizon, each from the solution of the one before, the first from `begin`, and selects that with the
/// smallest held-out error if it is clearly smaller than that of the first. `None` where no fit is finite.
pub(super) fn choose(
    filter: &HorizonFilter,
    model: &Model,
    (begin, start): (&Solution, &[f64]),
    horizons: &[f64],
    open: &OpenLoop,
) -> Option<Candidate> {
    let (mut found, mut evaluations) = (Vec::<Candidate>::new(), 0);
    for &horizon in horizons {
        let last = found.last().map_or(begin, |c| &c.solution);
        let p = off_the_edge(model, &last.p, start);
        let solution = match last.is_at(filter, model, &p, horizon) {
            true => Some(descend_from(filter, model, last.clone())),
            false => descend(filter, model, (&p, last.shift), horizon),
        };
        let Some(solution) = solution else { continue };
        evaluations += solution.evaluations;
        found.push(Candidate::new(model, solution, open));
    }
    let by_error =
        |a: &usize, b: &usize| mean(&found[*a].held_out).total_cmp(&mean(&found[*b].held_out));
    let best = (0..found.len()).min_by(by_error)?;
    let better = best > 0 && clearly_smaller(&found[best].held_out, &found[0].held_out);
    let mut out = found.swap_remove(if better { best } else { 0 });
    out.solution.evaluations = evaluations;
    Some(out)
}
