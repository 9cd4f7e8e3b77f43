//! All effects that a model may lack, at every shape that is tried.

use std::cell::OnceCell;
use std::sync::Arc;

use super::candidate::{Candidate, Form, REST, still_instant};
use super::joint::{Around, Forces};
use crate::effects::{Change, Effect, ParameterKind, Scale};
use crate::model::{Model, Variations};
use crate::recording::Recording;

/// All candidates of a model at parameters `p`: registered effects and the user's `own` that it lacks
/// (or those named) and that recordings of that `scale` could show, at every shape that is tried. Effects
/// that are the same for any wheel recording appear once; formulas without a linear parameter are left
/// out, and a second body where the model has one.
#[must_use]
pub fn candidates(
    model: &Model,
    p: &[f64],
    named: &[String],
    own: &[Arc<dyn Effect>],
    recordings: &[&Recording],
    scale: &Scale,
) -> Vec<Candidate> {
    let present = model.effect_ids();
    let mut out: Vec<Candidate> = Vec::new();
    let around = Arc::new(Around { model: model.clone(), p: p.to_vec() });
    let forces = OnceCell::new();
    let registered = crate::effects::all().into_iter().map(Arc::from);
    for effect in registered.chain(own.iter().cloned()) {
        let description = effect.description();
        let id = description.id.clone();
        let asked = named.is_empty() || named.contains(&id);
        let equivalent =
            description.equivalent.iter().any(|e| free(model, e) || out.iter().any(|c| c.id == *e));
        let second_body = effect.change() == Change::TwoMass && model.is_coupled();
        if !asked || present.contains(&id) || equivalent || second_body || !effect.admissible(scale)
        {
            continue;
        }
        let grid = grid(&id, &effect, scale, &around, recordings, &forces);
        out.extend(grid.into_iter().filter(|c| c.columns() > 0));
    }
    if recordings.iter().all(|r| r.is_single_axis()) {
        out.retain(|candidate| candidate.treats_wheels_alike(model, recordings[0]));
        // turning effects do nothing here, and a slope of one heading is an offset
        out.retain(|candidate| {
            let sizes = common_size(candidate, model, recordings[0]);
            let largest = sizes.iter().fold(0.0_f64, |a, b| a.max(*b));
            sizes.iter().all(|size| *size > 1e-9 * largest)
        });
    }
    out
}

/// Whether the model has an effect and estimates all of its parameters; with a held parameter, another
/// candidate may differ from it.
fn free(model: &Model, id: &str) -> bool {
    let mut own = model.parameters().iter().filter(|p| p.effect == id).peekable();
    own.peek().is_some() && own.all(|p| p.fixed.is_none())
}

/// The candidates of an effect, one a shape.
fn grid(
    id: &str,
    effect: &Arc<dyn Effect>,
    scale: &Scale,
    around: &Arc<Around>,
    recordings: &[&Recording],
    forces: &OnceCell<Vec<Forces>>,
) -> Vec<Candidate> {
    let specs = effect.parameters();
    let linear: Vec<usize> =
        (0..specs.len()).filter(|&j| specs[j].kind == ParameterKind::Linear).collect();
    let shapes: Vec<usize> = (0..specs.len()).filter(|j| !linear.contains(j)).collect();
    let torque_alone = Variations::of(&**effect, around.model.robot()).is_torque_alone();
    let within = |values: &Vec<f64>| {
        let mut pairs = values.iter().zip(&shapes);
        pairs.all(|(v, &j)| (specs[j].range.0..=specs[j].range.1).contains(v))
    };
    effect
        .shapes(scale)
        .into_iter()
        .filter(within)
        .map(|values| {
            let mut p = vec![0.0; specs.len()];
            shapes.iter().zip(values).for_each(|(&j, value)| p[j] = value);
            let candidate = Candidate {
                id: id.into(),
                effect: effect.clone(),
                p,
                linear: linear.clone(),
                form: Form::Instant,
                rest: REST * scale.speed,
                torque_alone,
                around: around.clone(),
            };
            candidate.seen_on(recordings, forces)
        })
        .collect()
}

/// The common part of each column of a candidate on the two wheels: largest value [N m per unit].
fn common_size(candidate: &Candidate, model: &Model, recording: &Recording) -> Vec<f64> {
    let mut largest = vec![0.0_f64; candidate.columns()];
    let mut row = vec![[0.0; 2]; candidate.columns()];
    for (k, m) in recording.local_motion().iter().enumerate().step_by(7) {
        candidate.torque(0, &still_instant(model, recording, k, m), &mut row);
        for (size, torque) in largest.iter_mut().zip(&row) {
            *size = size.max((torque[0] + torque[1]).abs());
        }
    }
    largest
}
