//! Base parameters that the movement of the recordings does not excite; they are fixed in the same
//! way for every method.

use std::cell::OnceCell;

use nalgebra::DMatrix;

use super::one_size::{acting_sizes, frictionless};
use super::open_loop::{OpenLoop, smaller_by};
use super::runaway::bounded;
use super::start::start;
use super::torque_regression::TorqueRegression;
use super::{Fit, Identifier, IdentifyError, Note, Task, Unknown};
use crate::effects::SURELY;
use crate::filter::pieces;
use crate::model::Model;
use crate::model::base::{A1, A2, A3};
use crate::recording::{Lacking, Recording, lacking};

/// Factors of the inertia that is not excited which must be distinguishable from its estimate
/// (judgement).
const FACTORS: [f64; 2] = [0.5, 2.0];

/// A task for several methods, with the base parameters fixed that the movement does not excite.
///
/// ```text
/// straight runs only:  a1 + a2 is estimated; a2 and a3 are fixed
/// pivots only:         a1 - a2 is estimated; a2 is fixed
/// ```
/// A robot that is driven straight veers slightly, because its wheels differ. A model without that difference
/// attributes the veer to the inertias, with a small standard error. If the recordings contain hardly any turns (or
/// hardly any travel) they are therefore fixed, unless a regression with free values simulates held-out pieces
/// significantly better (by two paired standard errors) than with half or twice the inertia in question. Fixed values
/// have the ratio to the estimated combination that they have in the construction data; without these they are zero, so
/// that a1 is the combination.
///
/// A command of one size does not determine dry friction, which could explain all of it. It is held at zero then: the
/// motion is simulated by the other parameters, whose scale is unknown.
pub struct Excited<'a> {
    task: Task<'a>,
    /// The size of the input of each wheel, if it has only one.
    sizes: OnceCell<[Option<f64>; 2]>,
    /// The model without the friction that an input of one size does not determine, and the places of that friction.
    frictionless: OnceCell<Option<(Model, Vec<usize>)>>,
    /// Found with the first method that fits the model.
    unexcited: OnceCell<Option<Unexcited>>,
}

impl<'a> Excited<'a> {
    /// The parameters are found with the first method.
    #[must_use]
    pub fn new(task: Task<'a>) -> Self {
        let (sizes, frictionless, unexcited) = Default::default();
        Self { task, sizes, frictionless, unexcited }
    }

    /// The task with all parameters free.
    #[must_use]
    pub fn task(&self) -> &Task<'a> {
        &self.task
    }

    /// Fits a method.
    ///
    /// # Errors
    /// As [`Identifier::identify`], and inertias that grew without limit.
    pub fn identify(&self, method: &dyn Identifier) -> Result<Fit, IdentifyError> {
        bounded(self.fitted(method)?, &self.task)
    }

    /// The fit, however large its inertias.
    fn fitted(&self, method: &dyn Identifier) -> Result<Fit, IdentifyError> {
        let task = &self.task;
        if method.fits_emulator() {
            return method.identify(task);
        }
        if task.model.free().is_empty() {
            return Ok(as_fixed(&method.describe().name, task));
        }
        let frictionless = || frictionless(task, self.sizes());
        let Some((model, places)) = self.frictionless.get_or_init(frictionless) else {
            return self.with_combination(task, method);
        };
        let mut fit = self.with_combination(&Task { model, ..*task }, method)?;
        places.iter().for_each(|&j| fit.set_unidentifiable(j));
        Ok(fit)
    }

    /// A fit to the task with its parameters marked as not identifiable where the unknown input between the rows or an
    /// input of one size may explain them, and with a note on frictions that would drive the robot.
    #[must_use]
    pub fn qualified(&self, fit: Fit) -> Fit {
        let Task { model, train, hold, .. } = self.task;
        fit.between_rows(train, hold).under_one_size(self.sizes()).driving_frictions(model)
    }

    fn sizes(&self) -> [Option<f64>; 2] {
        *self.sizes.get_or_init(|| acting_sizes(&self.task))
    }

    /// Fits a method, with the combination of the inertias that is identifiable if the movement does not excite both.
    fn with_combination(&self, task: &Task, method: &dyn Identifier) -> Result<Fit, IdentifyError> {
        let Some(unexcited) = self.unexcited.get_or_init(|| Unexcited::of(task)) else {
            return method.identify(task);
        };
        let Unexcited { model, sign, places } = unexcited;
        let fit = method.identify(&Task { model, ..*task })?;
        Ok(with_combination(fit, model, *sign, &places[1..]))
    }
}

/// The fit of a model without free parameters: its fixed values, whatever the method.
fn as_fixed(method: &str, task: &Task) -> Fit {
    let p = task.model.initial();
    let covariance = DMatrix::zeros(p.len(), p.len());
    Fit::physical(method, task.model, p, covariance, task.train[0].drive_unit())
}

/// The model of a task with the parameters fixed that its movement does not excite, and a start: what the time of the
/// input is determined with, before it is known whether the data determine them nevertheless.
pub(crate) fn excited_start(task: &Task) -> Option<(Model, Vec<f64>)> {
    let (Unexcited { model, .. }, _) = Unexcited::held(task)?;
    let p = start(&Task { model: &model, ..*task }, "start").ok()?;
    Some((model, p))
}

/// A model with the parameters fixed that the movement does not excite.
struct Unexcited {
    model: Model,
    /// Sign of a2 in the combination that is identifiable.
    sign: f64,
    /// Places of the fixed parameters, a2 first.
    places: Vec<usize>,
}

impl Unexcited {
    /// `None` if the movement excites all parameters, if the inertias are given, or if the data determine them
    /// nevertheless.
    fn of(task: &Task) -> Option<Self> {
        let (held, others) = Self::held(task)?;
        (!determines(task, &others)).then_some(held)
    }

    /// The model by the movement alone, and those with half and twice the inertia in question.
    fn held(task: &Task) -> Option<(Self, Vec<Model>)> {
        let (sign, places) = match lacking(task.train)? {
            Lacking::Turns => (1.0, vec![A2, A3]),
            Lacking::Travel => (-1.0, vec![A2]),
        };
        let parameters = task.model.parameters();
        let is_free = |j: &usize| parameters[*j].fixed.is_none();
        let places: Vec<usize> = places.into_iter().filter(is_free).collect();
        if !(is_free(&A1) && places.first() == Some(&A2)) {
            return None;
        }
        let (initial, found) = (task.model.initial(), start(task, "start").ok()?);
        let combined = |p: &[f64], sign: f64| p[A1] + sign * p[A2];
        let ratio = combined(&found, sign) / combined(&initial, sign);
        let is_built = task.model.robot().assumed.is_none();
        let known = combined(&initial, sign);
        let open = if is_built { combined(&initial, -sign) } else { known };
        // a2 of the estimated combination with `factor` times the other one
        let a2 = |factor: f64| 0.5 * sign * (known - factor * open);
        let a3 = if is_built { initial[A3] } else { 0.0 };
        let fixed = |factor: f64| {
            let fix = |model: Model, &j: &usize| {
                let value = if j == A2 { a2(factor) } else { a3 };
                model.fix(&parameters[j].spec.symbol, ratio * value).ok()
            };
            places.iter().try_fold(task.model.clone(), fix)
        };
        let model = fixed(1.0)?;
        let others: Vec<Model> = FACTORS.into_iter().filter_map(fixed).collect();
        Some((Self { model, sign, places }, others))
    }
}

/// The fit with a1, a2 and the parameters that were fixed at `places` marked as not identifiable, and with the
/// combination a1 + `sign` a2 that is identifiable.
pub(super) fn with_combination(mut fit: Fit, model: &Model, sign: f64, places: &[usize]) -> Fit {
    let [a1, a2] = [A1, A2].map(|j| fit.estimates[j].clone());
    let unknown = Unknown::Two {
        first: a1.symbol,
        second: a2.symbol,
        weight: sign,
        value: a1.value + sign * a2.value,
        std_error: a1.std_error,
    };
    let mut notes = vec![(unknown, A2)];
    for &j in places {
        let held = &fit.estimates[j];
        notes.push((Unknown::Held(held.symbol.clone(), held.value), j));
    }
    let effect = |j: usize| model.parameters()[j].effect.clone();
    let notes = notes.into_iter().map(|(unknown, j)| Note::Unknown { unknown, effect: effect(j) });
    let notes = notes.chain([proportions(model, places)]);
    fit.notes.splice(0..0, notes.collect::<Vec<_>>());
    [A1, A2].iter().chain(places).for_each(|&j| fit.set_unidentifiable(j));
    fit
}

/// Whose proportions a2 and the other `places` have.
fn proportions(model: &Model, places: &[usize]) -> Note {
    let symbol = |j: &usize| model.parameters()[*j].spec.symbol.clone();
    let symbols = [A2].iter().chain(places).map(symbol).collect();
    let robot = model.robot();
    let assumed = robot.assumed.is_some();
    let robot = robot.assumed.clone().unwrap_or_else(|| robot.name.clone());
    Note::Proportions { symbols, robot, assumed }
}

/// Whether a regression of torques with the free parameters of a task simulates held-out pieces significantly better
/// than one with those of one of `others`.
fn determines(task: &Task, others: &[Model]) -> bool {
    let recordings: Vec<&Recording> = task.train.iter().collect();
    let open = OpenLoop { train: task.train, hold: task.hold, pieces: pieces(&recordings) };
    let errors = |model: &Model| {
        let (method, task) = (TorqueRegression::default(), Task { model, ..*task });
        let (_, left_out) = method.left_out(&method.rows(&task).ok()?, &open.pieces).ok()?;
        Some(open.errors(model, &left_out))
    };
    let Some(free) = errors(task.model) else { return false };
    others.iter().filter_map(errors).any(|other| smaller_by(SURELY, &free, &other))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::find;
    use crate::recording::{Channels, DriveUnit};
    use crate::robot::{Robot, State};
    use crate::simulate::{Hold, Input, Movement, NoiseLevel, Recorder, Segment, record, simulate};

    /// Both wheels of an AmigoBot driven by the same torque, with viscous friction on the right one: it veers.
    fn veering() -> (Model, Recording) {
        let model = Model::with_effects(Robot::amigobot(), &["viscous_friction_1"]).unwrap();
        let mut p = model.initial();
        *p.last_mut().unwrap() = 2e-4;
        let t: Vec<f64> = (0..3000).map(|k| 0.01 * f64::from(k)).collect();
        let level = |t: f64| [0.25, 0.16, -0.22, -0.15][(t / 1.5) as usize % 4];
        let torque: Vec<[f64; 2]> = t.iter().map(|t| [level(*t); 2]).collect();
        let input = Input { t: &t, torque: &torque, hold: Hold::Constant };
        let rest = State { alpha: [0.0; 2], omega: [0.0; 2] };
        let states = simulate(&model, &p, &input, rest).unwrap();
        let channels = Channels {
            t: t.clone(),
            alpha: Some(states.iter().map(|s| s.alpha).collect()),
            omega: Some(states.iter().map(|s| s.omega).collect()),
            torque,
        };
        let recording = Recording::new("veer", channels, DriveUnit::NewtonMetre).unwrap();
        (Model::base(Robot::amigobot()), recording)
    }

    #[test]
    fn runs_that_veer_give_the_sum_of_the_inertias_alone() {
        let (model, recording) = veering();
        let train = [recording];
        assert_eq!(lacking(&train), Some(Lacking::Turns));
        let truth = model.initial();
        let task = Task { model: &model, train: &train, hold: Hold::Constant, seed: 0 };
        for name in ["prediction_error", "torque_regression", "output_error"] {
            let fit = Excited::new(task).identify(&*find(name).unwrap()).unwrap();
            assert!(fit.estimates[..3].iter().all(|e| !e.identifiable && !e.fixed), "{name}");
            assert!(fit.estimates[3..].iter().all(|e| e.identifiable), "{name}");
            let said = fit.notes.iter().find_map(|note| match note {
                Note::Unknown { unknown: Unknown::Two { value, .. }, .. } => Some(*value),
                _ => None,
            });
            // the friction that the model lacks makes a few percent of the torque
            let sum = said.unwrap() / (truth[A1] + truth[A2]);
            assert!((sum - 1.0).abs() < 0.05, "{name} {sum}");
            let ratio = fit.estimates[A2].value / fit.estimates[A1].value;
            assert!((ratio - truth[A2] / truth[A1]).abs() < 0.01, "{name} {ratio}");
        }
    }

    #[test]
    fn what_is_held_has_the_proportions_of_the_construction_data_or_is_zero() {
        let (model, recording) = veering();
        let train = [recording];
        let unknown = Robot { assumed: Some("AmigoBot".into()), ..Robot::amigobot() };
        for (robot, is_assumed) in [(unknown, true), (Robot::amigobot(), false)] {
            let model = Model::base(robot);
            let task = Task { model: &model, train: &train, hold: Hold::Constant, seed: 0 };
            let fit = Excited::new(task).identify(&TorqueRegression::default()).unwrap();
            let said = fit.notes.iter().find_map(|note| match note {
                Note::Proportions { symbols, assumed, .. } => Some((symbols.clone(), *assumed)),
                _ => None,
            });
            assert_eq!(said, Some((vec!["a2".into(), "a3".into()], is_assumed)));
            // without construction data a1 is the sum
            assert_eq!(is_assumed, [A2, A3].into_iter().all(|j| fit.estimates[j].value == 0.0));
        }
        assert!(model.robot().assumed.is_none());
    }

    #[test]
    fn gentle_curves_that_show_the_inertia_of_turning_hold_nothing() {
        let model = Model::base(Robot::amigobot());
        let noise = NoiseLevel { dalpha: 0.01, alpha: 1e-4, torque: 1e-3 };
        let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed: 3 };
        let turns = [0.1, -0.1, 0.1, -0.08, 0.1, -0.1, 0.1, -0.1];
        let segment = |(n, turn_rad_s): (usize, f64)| {
            let speed_m_s = if n % 2 == 0 { 0.4 } else { 0.3 };
            Segment { speed_m_s, turn_rad_s, blend_s: 0.4, hold_s: 1.6 }
        };
        let movement = Movement { segments: turns.into_iter().enumerate().map(segment).collect() };
        let mut truth = model.initial();
        // a turning inertia that is 30 % smaller than that of the construction
        (truth[A1], truth[A2]) = (truth[A1] - 0.005, truth[A2] + 0.005);
        let train = [record("curves", &model, &truth, &movement, &recorder).unwrap()];
        assert_eq!(lacking(&train), Some(Lacking::Turns));
        let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 0 };
        let fit = Excited::new(task).identify(&*find("prediction_error").unwrap()).unwrap();
        assert!(fit.estimates.iter().all(|e| e.identifiable), "{:?}", fit.notes);
        let turning = |p: [f64; 2]| p[0] - p[1];
        let found = turning([A1, A2].map(|j| fit.estimates[j].value));
        assert!((found / turning([truth[A1], truth[A2]]) - 1.0).abs() < 0.1, "{found}");
    }

    #[test]
    fn inertias_that_are_given_are_left_to_the_method() {
        let (model, recording) = veering();
        let train = [recording];
        let given = model.fix("a2", -2e-3).unwrap();
        let task = Task { model: &given, train: &train, hold: Hold::Constant, seed: 0 };
        assert!(Unexcited::of(&task).is_none());
    }
}
