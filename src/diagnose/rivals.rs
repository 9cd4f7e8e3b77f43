//! Models with an effect more, which may explain the motion as well as what the logger did.

use std::sync::Arc;

use crate::effects::{self, Change, Effect, ParameterKind, Scale};
use crate::model::Model;

/// Which effects are added to a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Bodies {
    /// Those of a robot whose wheels are one body with it.
    One,
    /// Second bodies behind the wheels; their fit is ten times as expensive.
    Two,
}

/// The model near `p` with each effect of the catalogue that may make speeds late, from the middle of its shapes: all
/// of these `bodies` but a pure delay, which every fit contains.
pub(super) fn rivals(
    model: &Model,
    p: &[f64],
    scale: &Scale,
    bodies: Bodies,
) -> Vec<(Model, Vec<f64>)> {
    let of = |e: &Arc<dyn Effect>| (e.change() == Change::TwoMass) == (bodies == Bodies::Two);
    let counts = |e: &Arc<dyn Effect>| of(e) && !e.is_delay() && e.admissible(scale);
    let effects = effects::all().into_iter().map(Arc::from).filter(counts);
    effects.filter_map(|effect| extended(model, p, effect, scale)).collect()
}

/// The model with an effect more, from the middle of its shapes.
fn extended(
    model: &Model,
    p: &[f64],
    effect: Arc<dyn Effect>,
    scale: &Scale,
) -> Option<(Model, Vec<f64>)> {
    let shapes = effect.shapes(scale);
    let middle = shapes.get(shapes.len() / 2)?.clone();
    let model = model.add_effect(effect).ok()?;
    let mut middle = middle.into_iter();
    let initial = model.initial();
    let more = (p.len()..initial.len()).map(|j| match model.parameters()[j].spec.kind {
        ParameterKind::Shape => middle.next().unwrap_or(initial[j]),
        ParameterKind::Linear => initial[j],
    });
    let start = p.iter().copied().chain(more).collect();
    Some((model, start))
}
