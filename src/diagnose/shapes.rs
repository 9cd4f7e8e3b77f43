//! Initial values of the shapes of a model.

use std::sync::Arc;

use rayon::prelude::*;

use super::fit::fit;
use super::input_timing::InputTiming;
use super::scale::scale_of;
use super::thresholds::THRESHOLDS;
use super::whole::{followed, free_shapes, over_whole_numbers, whole_numbers};
use super::windows::Windows;
use crate::effects::{ParameterKind, Scale};
use crate::identify::{Task, start};
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::Hold;

/// Maximum number of simulated 1 s windows: one minute of motion is sufficient for initial values.
const MOST: usize = 60;

/// The model with the initial values of its effects' free shapes at which simulated windows of the recordings
/// have the lowest error: effect by effect, on a grid for recordings of that scale with linear parameters by
/// the weak form, then by a descent from the best grid point. A model that cannot be simulated is returned as
/// it is.
///
/// The cost has several minima over a shape (resonance frequency, knee, order), and the typical value is that
/// of one robot only.
#[must_use]
pub fn shapes_placed(model: &Model, train: &[Recording], hold: Hold) -> Model {
    let open: Vec<usize> =
        (0..model.effects().len()).filter(|&e| !free_shapes(model, e).is_empty()).collect();
    if open.is_empty() {
        return model.clone();
    }
    let Some(p) = weak_form(model, train, hold) else { return model.clone() };
    let recordings: Vec<&Recording> = train.iter().collect();
    let scale = scale_of(model, &p, &recordings);
    let windows = Windows::new(recordings, hold, model, &p);
    let every = windows.windows.len().div_ceil(MOST).max(1);
    let place = Place { windows: windows.only(|n| n % every == 0), train, hold, scale };
    open.into_iter().fold(model.clone(), |model, e| place.effect(model, e))
}

fn weak_form(model: &Model, train: &[Recording], hold: Hold) -> Option<Vec<f64>> {
    start::start(&Task { model, train, hold, seed: 0 }, "start").ok()
}

struct Place<'a> {
    windows: Windows<'a>,
    train: &'a [Recording],
    hold: Hold,
    scale: Scale,
}

impl Place<'_> {
    /// The model with the shapes of effect number `e` placed.
    fn effect(&self, model: Model, e: usize) -> Model {
        let mut trials: Vec<Model> = vec![model.clone()];
        let shapes = model.effects()[e].shapes(&self.scale);
        trials.extend(shapes.iter().map(|values| at(&model, e, values)));
        let mut starts: Vec<(f64, Model, Vec<f64>)> =
            trials.into_par_iter().filter_map(|trial| self.start(&trial)).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let numbers = |(_, model, p): &(f64, Model, Vec<f64>)| whole_numbers(model, e, p);
        let starts = followed(starts, THRESHOLDS.followed, numbers);
        let fits =
            starts.par_iter().filter_map(|(_, model, p)| fit(&self.windows, model, p, &self.scale));
        let best = fits.min_by(|a, b| a.cost.total_cmp(&b.cost));
        let best = best.map(|fit| over_whole_numbers(&self.windows, fit, e, &self.scale, 0.0));
        let shapes = free_shapes(&model, e).into_iter();
        best.map_or(model.clone(), |best| {
            shapes.fold(model, |model, j| model.starting_at(j, best.p[j]))
        })
    }

    /// The cost of a model at the weak-form estimate, with the time of the input free.
    fn start(&self, model: &Model) -> Option<(f64, Model, Vec<f64>)> {
        let mut p = weak_form(model, self.train, self.hold)?;
        let timed = self.timed(model);
        p.resize(timed.parameters().len(), 0.0);
        let cost = self.windows.cost(&timed, &p)?;
        cost.is_finite().then_some((cost, timed, p))
    }

    fn timed(&self, model: &Model) -> Model {
        let limits = (THRESHOLDS.earliest * self.scale.step, self.scale.logging);
        if model.shifts_input() {
            return model.clone();
        }
        model
            .add_effect(Arc::new(InputTiming { limits, between: self.hold.into() }))
            .unwrap_or_else(|_| model.clone())
    }
}

/// The model with the initial shapes of effect number `e` at `values`, in their order; fixed shapes are
/// unchanged.
fn at(model: &Model, e: usize, values: &[f64]) -> Model {
    let shape = |&j: &usize| model.parameters()[j].spec.kind == ParameterKind::Shape;
    let places = model.slots(e).filter(shape).zip(values);
    places.fold(model.clone(), |model, (j, value)| model.starting_at(j, *value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;
    use crate::simulate::{Movement, NoiseLevel, Recorder, record};

    /// A recording of 15 s at 100 Hz of a model at `truth`.
    fn recorded(model: &Model, truth: &[f64]) -> Recording {
        let noise = NoiseLevel { alpha: 5e-4, dalpha: 0.02, torque: 0.002 };
        let movement = Movement::rich(model.robot(), 3, 15.0, 12.0);
        let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed: 3 };
        record("synthetic", model, truth, &movement, &recorder).unwrap()
    }

    #[test]
    fn a_shape_far_from_its_typical_value_is_where_a_fit_starts() {
        let robot = Robot::amigobot();
        for (id, own, shape) in [
            ("stribeck", vec![0.06, 3.0, 0.0, 1.0], 1),
            ("compliance", vec![1.5, 0.01, 0.02], 0),
            ("torque_ripple", vec![0.03, 0.0, 0.0, 0.03, 17.0], 4),
        ] {
            let model = Model::with_effects(robot.clone(), &[id]).unwrap();
            let mut truth = model.initial();
            truth.splice(5.., own.clone());
            let placed = shapes_placed(&model, &[recorded(&model, &truth)], Hold::Linear);
            let found = placed.initial()[5 + shape] / own[shape];
            // a descent from here is in the right valley: within a fifth, an order exactly
            assert!((found - 1.0).abs() < 0.2, "{id}: {found}");
            assert_eq!(placed.parameters()[5].start.is_some(), shape == 0, "linear ones have none");
        }
    }

    #[test]
    fn a_shape_that_is_held_stays_and_a_model_without_shapes_is_the_same() {
        let robot = Robot::amigobot();
        let model = Model::with_effects(robot.clone(), &["friction_warmup"]).unwrap();
        let held = model.fix("tw", 4.0).unwrap();
        let made = [recorded(&model, &model.initial())];
        assert_eq!(shapes_placed(&held, &made, Hold::Linear).initial(), held.initial());
        let base = Model::base(robot);
        assert_eq!(shapes_placed(&base, &made, Hold::Linear).initial(), base.initial());
    }
}
