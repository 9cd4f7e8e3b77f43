//! Fallback: if a simpler method simulates better, its values are used.

use super::choice::Candidate;
use super::disagreement::with_disagreement;
use super::held::{in_proportion, is_narrow};
use super::held_shapes::{shaped, with_shapes_of};
use crate::identify::inverse_dynamics::Regression;
use crate::identify::open_loop::{OpenLoop, clearly_smaller, mean};
use crate::identify::output_error::OutputError;
use crate::identify::torque_regression::TorqueRegression;
use crate::identify::unexcited::with_combination;
use crate::identify::weak_form::WeakForm;
use crate::identify::{Fit, Identifier, Note, Task, Unknown};
use crate::model::Model;
use crate::model::base::{A1, A2, A3, A4, A5};

/// Relative reduction of the error for which another method is used: that required of an effect.
const MATTERS: f64 = 0.01;

/// Ratio of the errors above which a few pieces are sufficient for the decision: errors of two valid fits
/// differ by a few percent, so that an error larger by one half means that a fit fails on a kind of motion.
const FAILS: f64 = 1.5;

/// The fit, or that of the regression of torques (of `rows` where the model has no shapes) if its 2 s simulation
/// error on held-out pieces is smaller by one percent, and its logarithm by more than a paired standard error: it
/// must be better on most pieces, not only on the few with the largest errors, unless the fit fails on those. A fit
/// whose error on its own training pieces is larger by one half (both have the same number of parameters) is replaced
/// whatever the held-out errors. A kind of motion that was driven once cannot be predicted from the others: if the
/// error of the regression is larger by one half on held-out pieces than with all pieces, only the errors with all
/// pieces are compared. Where the model `errs` by more than noise, the intervals of a fit that is kept include the
/// disagreement of the two, unless the regression fails.
pub(super) fn better(
    (task, rows): (&Task, Option<Regression>),
    open: &OpenLoop,
    chosen: &Candidate,
    fit: Fit,
    errs: bool,
) -> Fit {
    let shaped = shaped(task.model, &fit);
    let regressed = Task { model: shaped.as_ref().unwrap_or(task.model), ..*task };
    let method = TorqueRegression::default();
    let rows = if shaped.is_some() { method.rows(&regressed).ok() } else { rows };
    let left_out = rows.and_then(|rows| method.left_out(&rows, &open.pieces).ok());
    let Some((mut rival, left_out)) = left_out else { return fit };
    let errors = open.errors(task.model, &left_out);
    let [own, other] = [&fit, &rival].map(|fit| open.mean(task.model, &parameters(fit)).sqrt());
    let fails_in_sample = !(own <= FAILS * other);
    let matters = mean(&errors).sqrt() < (1.0 - MATTERS) * mean(&chosen.held_out).sqrt();
    let logs = |errors: &[f64]| errors.iter().map(|e| e.ln()).collect::<Vec<f64>>();
    let fails = mean(&chosen.held_out).sqrt() > FAILS * mean(&errors).sqrt();
    let clear = fails || clearly_smaller(&logs(&errors), &logs(&chosen.held_out));
    let is_predictable = mean(&errors).sqrt() <= FAILS * other;
    if !other.is_finite() || !(fails_in_sample || (matters && clear && is_predictable)) {
        let is_second_opinion = errs && other <= FAILS * own;
        return if is_second_opinion { with_disagreement(fit, &rival) } else { fit };
    }
    with_shapes_of(&fit, &mut rival, &regressed);
    let held_out = !fails_in_sample;
    let found = match held_out {
        true => [mean(&errors).sqrt(), mean(&chosen.held_out).sqrt()],
        false => [other, own],
    };
    in_place_of(fit, rival, held_out, (found, open.unit()))
}

/// The fit, or that of a regression (shapes at their initial values) or of the free simulation if its 2 s simulation
/// error on the training pieces is smaller by more than one half: all have the same parameters, so that the fit fails.
/// Predictions over single rows are good with inertias far too large, where the speeds hardly change or the rows are
/// slow. Without a reason for this, an error of the model (`errs`) or an initial value that `simulates` better, the
/// other methods are not tried.
pub(super) fn unless_it_fails(
    task: &Task,
    open: &OpenLoop,
    fit: Fit,
    (errs, simulates): (bool, f64),
) -> Fit {
    let error = |fit: &Fit| open.mean(task.model, &parameters(fit)).sqrt();
    let own = error(&fit);
    let fails = |other: f64| !(own <= FAILS * other);
    if !errs && !fails(simulates) {
        return fit;
    }
    let methods: [&dyn Identifier; 3] =
        [&TorqueRegression::default(), &WeakForm::default(), &OutputError::default()];
    let others = methods.into_iter().filter_map(|method| of_a_robot(task, method));
    let others = others.map(|other| (error(&other), other));
    match others.min_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((error, other)) if fails(error) => {
            in_place_of(fit, other, false, ([error, own], open.unit()))
        }
        _ => fit,
    }
}

/// The fit of a method to a robot as it can be built: if the inertia of turning is smaller than that of any robot, a2
/// and a3 are held in the ratio to a1 + a2 that they have in the construction data, and a negative friction that the
/// data do not determine is held at zero.
fn of_a_robot(task: &Task, method: &dyn Identifier) -> Option<Fit> {
    let fit = method.identify(task).ok()?;
    let p = parameters(&fit);
    let mut held: Vec<(usize, f64)> = Vec::new();
    if is_narrow(task.model, task.train, &p) {
        held.extend([A2, A3].map(|j| (j, in_proportion(task.model, j, &p))));
    }
    let is_impossible = |j: &usize| p[*j] < 0.0 && !fit.estimates[*j].identifiable;
    held.extend([A4, A5].into_iter().filter(is_impossible).map(|j| (j, 0.0)));
    held.retain(|(j, _)| task.model.parameters()[*j].fixed.is_none());
    if held.is_empty() {
        return Some(fit);
    }
    let symbol = |j: usize| task.model.parameters()[j].spec.symbol.clone();
    let fix = |model: Model, &(j, value): &(usize, f64)| model.fix(&symbol(j), value);
    let model = held.iter().try_fold(task.model.clone(), fix).ok()?;
    let mut fit = method.identify(&Task { model: &model, ..*task }).ok()?;
    for (j, value) in held {
        let (unknown, effect) =
            (Unknown::Held(symbol(j), value), model.parameters()[j].effect.clone());
        fit.notes.push(Note::Unknown { unknown, effect });
        fit.set_unidentifiable(j);
    }
    let sum = !fit.estimates[A2].identifiable && fit.estimates[A1].identifiable;
    Some(if sum { with_combination(fit, task.model, 1.0, &[]) } else { fit })
}

/// The fit of another method in the place of `fit`, with the errors of both and their unit.
fn in_place_of(
    fit: Fit,
    mut rival: Fit,
    held_out: bool,
    ([other, filter], unit): ([f64; 2], &'static str),
) -> Fit {
    let method = std::mem::replace(&mut rival.method, fit.method);
    rival.notes.insert(0, Note::BetterMethod { method, held_out, other, filter, unit });
    rival.work.evaluations += fit.work.evaluations;
    rival
}

fn parameters(fit: &Fit) -> Vec<f64> {
    fit.estimates.iter().map(|e| e.value).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::filter::pieces;
    use crate::identify::prediction_error::PredictionError;
    use crate::identify::{IdentifyError, MethodDescription, OptionError};
    use crate::recording::Recording;
    use crate::robot::Robot;
    use crate::simulate::{Hold, Movement, NoiseLevel, Recorder, record};

    #[test]
    fn a_fit_that_simulates_far_worse_than_another_method_is_replaced() {
        let model = Model::base(Robot::amigobot());
        let truth = model.initial();
        let movement = Movement::rich(model.robot(), 3, 15.0, 12.0);
        let noise = NoiseLevel { dalpha: 0.05, alpha: 1e-3, torque: 0.005 };
        let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed: 3 };
        let train = [record("made", &model, &truth, &movement, &recorder).unwrap()];
        let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 0 };
        let recordings: Vec<&Recording> = train.iter().collect();
        let open = OpenLoop { train: &train, hold: Hold::Linear, pieces: pieces(&recordings) };
        let fit = PredictionError::default().identify(&task).unwrap();
        let simulates = open.mean(&model, &truth).sqrt();
        let kept = unless_it_fails(&task, &open, fit.clone(), (true, simulates));
        assert_eq!(kept.estimates, fit.estimates);
        // a flywheel keeps its speed from row to row, whatever the input
        let mut flywheel = fit.clone();
        flywheel.estimates[A1].value *= 1000.0;
        let replaced = unless_it_fails(&task, &open, flywheel, (false, simulates));
        let a1 = &replaced.estimates[A1];
        assert!((a1.value / truth[A1] - 1.0).abs() < 0.05, "{a1:?}");
        let Note::BetterMethod { method, held_out: false, .. } = &replaced.notes[0] else {
            panic!("{:?}", replaced.notes)
        };
        assert!(
            ["torque_regression", "weak_form", "output_error"].contains(&method.as_str()),
            "{method}"
        );
        assert_eq!(replaced.method, fit.method);
    }

    /// A method whose estimates are those of a robot that cannot be built.
    #[derive(Debug)]
    struct Impossible(Vec<f64>);

    impl Identifier for Impossible {
        fn describe(&self) -> MethodDescription {
            PredictionError::default().describe()
        }

        fn schema(&self) -> schemars::Schema {
            PredictionError::default().schema()
        }

        fn configure(&self, _: &toml::Table) -> Result<Box<dyn Identifier>, OptionError> {
            unreachable!("it has no options")
        }

        fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
            let parameters = task.model.parameters();
            let value = |(j, own): (usize, &f64)| parameters[j].fixed.unwrap_or(*own);
            let p: Vec<f64> = self.0.iter().enumerate().map(value).collect();
            let mut covariance = DMatrix::from_diagonal_element(p.len(), p.len(), 1e-12);
            covariance[(A5, A5)] = f64::INFINITY;
            let unit = task.train[0].drive_unit();
            Ok(Fit::physical("impossible", task.model, p, covariance, unit))
        }
    }

    #[test]
    fn another_method_cannot_give_a_robot_that_no_one_could_build() {
        let model = Model::base(Robot::amigobot());
        let truth = model.initial();
        let movement = Movement::rich(model.robot(), 3, 4.0, 12.0);
        let noise = NoiseLevel { dalpha: 0.05, alpha: 1e-3, torque: 0.005 };
        let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed: 3 };
        let train = [record("made", &model, &truth, &movement, &recorder).unwrap()];
        let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 0 };
        // turns without inertia, and a friction below zero that is not determined
        let mut p = truth.clone();
        (p[A2], p[A5]) = (0.999 * p[A1], -0.01);
        let fit = of_a_robot(&task, &Impossible(p.clone())).unwrap();
        let ratio = (p[A1] + p[A2]) / (truth[A1] + truth[A2]);
        for j in [A2, A3] {
            let held = &fit.estimates[j];
            assert!((held.value / (ratio * truth[j]) - 1.0).abs() < 1e-12, "{held:?}");
            assert!(!held.identifiable);
        }
        assert_eq!(fit.estimates[A5].value, 0.0);
        assert!(!fit.estimates[A5].identifiable && fit.estimates[A4].identifiable);
        // one that could be built is returned unchanged
        let fit = of_a_robot(&task, &Impossible(truth.clone())).unwrap();
        assert_eq!(parameters(&fit), truth);
    }
}
