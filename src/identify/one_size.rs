//! Friction under an input of one size.

use super::start::start;
use super::{Fit, Note, Task, Unknown};
use crate::math::{Moments, correlation};
use crate::model::Model;
use crate::model::base::{A4, A5};
use crate::recording::{DriveUnit, Recording};

/// Wheels slower than this share of the top speed count as at rest, as in the regressions.
const REST: f64 = 0.025;
/// Correlation of the input with the acceleration above which it follows it (judgement: a tenth of the variance). A
/// battery that sags under the current has a negative one.
const FOLLOWS: f64 = 0.3;
/// Variation of an input, relative to its size, below which it has one size, and distance of a friction from that size
/// below which it explains the input alone (judgement: a tenth is more than the sag of a battery).
const ONE: f64 = 0.1;

/// The size of the input of each wheel while it turns, if it has only one: the mean of M sgn(ω) over rows in which the
/// wheel moves, where the values vary by less than a tenth (rms) about it, and not with the acceleration. `input` gives
/// the acting input of a recording.
///
/// ```text
/// a1 dω + a4 sgn(ω) + … = M = c sgn(ω)   has the exact solution a4 = c, all others zero
/// ```
/// A balance of torques takes that solution, though such a robot would not accelerate. The torque of a robot that
/// crawls is that of its friction too, but it varies with the acceleration.
fn sizes(
    recordings: &[Recording],
    input: impl Fn(&Recording) -> Vec<[f64; 2]>,
) -> [Option<f64>; 2] {
    let inputs: Vec<Vec<[f64; 2]>> = recordings.iter().map(input).collect();
    [0, 1].map(|i| {
        // recording, row and sense of the rows in which the wheel moves
        let moving = |(n, r): (usize, &Recording)| {
            let rest = REST * r.top_speed();
            let speeds = r.omega().iter().map(|omega| omega[i]).enumerate();
            let moving = speeds.filter(|(_, speed)| speed.abs() > rest);
            moving.map(|(k, speed)| (n, k, speed.signum())).collect::<Vec<_>>()
        };
        let rows: Vec<(usize, usize, f64)> =
            recordings.iter().enumerate().flat_map(moving).collect();
        // both along the motion
        let input = |&(n, k, sense): &(usize, usize, f64)| inputs[n][k][i] * sense;
        let acceleration = |&(n, k, sense): &(usize, usize, f64)| {
            recordings[n].local_motion()[k].acceleration[i] * sense
        };
        let Moments { mean, variance, .. } = Moments::of(rows.iter().map(input));
        let is_one = mean > 0.0 && variance.sqrt() < ONE * mean;
        // the accelerations of all rows are computed for few recordings only
        let follows =
            || correlation(rows.iter().map(|row| (input(row), acceleration(row)))) > FOLLOWS;
        (is_one && !follows()).then_some(mean)
    })
}

/// The [`sizes`] of the input as the model of a task delays it.
pub(super) fn acting_sizes(task: &Task) -> [Option<f64>; 2] {
    let (model, p) = (task.model, task.model.initial());
    sizes(task.train, |r| model.input_of(r, r.torque(), &p))
}

/// Whether all inputs are voltages, as of commands.
fn are_voltages(train: &[Recording]) -> bool {
    train.iter().all(|r| r.drive_unit() == DriveUnit::Volt)
}

/// Whether the input of a wheel has one size.
fn has_one(sizes: &[Option<f64>; 2]) -> bool {
    sizes.iter().any(Option::is_some)
}

/// The model of a task with dry friction held at zero on wheels whose input has one of these `sizes`, and its places.
fn held_at_zero(task: &Task, sizes: [Option<f64>; 2]) -> Option<(Model, Vec<usize>)> {
    let parameters = task.model.parameters();
    let of_one_size = [A4, A5].into_iter().zip(sizes).filter(|(_, size)| size.is_some());
    let places: Vec<usize> =
        of_one_size.map(|(j, _)| j).filter(|&j| parameters[j].fixed.is_none()).collect();
    let fix = |model: Model, j: &usize| model.fix(&parameters[*j].spec.symbol, 0.0).ok();
    let held = places.iter().try_fold(task.model.clone(), fix)?;
    (!places.is_empty()).then_some((held, places))
}

/// Whether the inputs of a wheel that turns have one magnitude.
fn one_magnitude(train: &[Recording]) -> bool {
    (0..2).any(|i| {
        let sizes = train.iter().flat_map(|r| {
            let rest = REST * r.top_speed();
            let moving = (0..r.len()).filter(move |&k| r.omega()[k][i].abs() > rest);
            moving.map(move |k| r.torque()[k][i].abs())
        });
        let Moments { mean, variance, .. } = Moments::of(sizes);
        mean > 0.0 && variance.sqrt() < ONE * mean
    })
}

/// The model of a task with dry friction held at zero where its voltages, of the [`acting_sizes`], cannot determine it,
/// and the places of that friction.
pub(super) fn frictionless(task: &Task, sizes: [Option<f64>; 2]) -> Option<(Model, Vec<usize>)> {
    let is_one = are_voltages(task.train) && has_one(&sizes);
    is_one.then(|| held_at_zero(task, sizes)).flatten()
}

/// The same model, with a start, if the voltages have one size at some time up to `latest` seconds after their rows, as
/// commands of a motor controller have. With such an input and that time the balance of torques is exact for any
/// motion, and would determine the time.
pub(crate) fn frictionless_start(task: &Task, latest: f64) -> Option<(Model, Vec<f64>)> {
    if !are_voltages(task.train) {
        return None;
    }
    let late = |r: &Recording, rows: usize| -> Vec<[f64; 2]> {
        (0..r.len()).map(|k| r.torque()[k.saturating_sub(rows)]).collect()
    };
    let step = task.train.iter().map(Recording::step).fold(f64::INFINITY, f64::min);
    let at = |rows: usize| match rows {
        0 => acting_sizes(task),
        rows => sizes(task.train, |r| late(r, rows)),
    };
    // inputs of several magnitudes have no one size at any time
    let searched = if one_magnitude(task.train) { (latest / step) as usize } else { 0 };
    let found = (0..=searched).map(at).find(has_one)?;
    let (model, _) = held_at_zero(task, found)?;
    let p = start(&Task { model: &model, ..*task }, "start").ok()?;
    Some((model, p))
}

/// A start without dry friction on wheels whose input has one size; `None` if there are none.
pub(crate) fn start_without_friction(task: &Task) -> Option<Vec<f64>> {
    let (model, _) = held_at_zero(task, acting_sizes(task))?;
    start(&Task { model: &model, ..*task }, "start").ok()
}

impl Fit {
    /// The same with dry friction marked as not identifiable where the input has one of these `sizes` and the fit does
    /// not hold it, as large as that size or with an unknown share of it. Where that holds for both wheels the scale of
    /// all other parameters is unknown too.
    pub(super) fn under_one_size(mut self, sizes: [Option<f64>; 2]) -> Self {
        let is_held = |symbol: &str| {
            let held = |n: &Note| matches!(n, Note::Unknown { unknown: Unknown::Held(s, _), .. } if s == symbol);
            self.notes.iter().any(held)
        };
        let explains = |j: usize, size: f64| {
            let estimate = self.estimates.get(j).filter(|e| !e.fixed && !is_held(&e.symbol));
            estimate.is_some_and(|e| !e.identifiable || (e.value - size).abs() < ONE * size)
        };
        let found = [A4, A5].into_iter().zip(sizes);
        let found: Vec<(usize, f64)> = found
            .filter_map(|(j, size)| Some((j, size?)))
            .filter(|&(j, size)| explains(j, size))
            .collect();
        let Some(&(_, size)) = found.first() else { return self };
        let all = found.len() == 2;
        let is_concerned = |j: &usize| {
            let free = !self.estimates[*j].fixed;
            free && (all || found.iter().any(|(k, _)| k == j))
        };
        let places: Vec<usize> = (0..self.estimates.len()).filter(is_concerned).collect();
        places.iter().for_each(|&j| self.set_unidentifiable(j));
        let symbols = places.iter().map(|&j| self.estimates[j].symbol.clone()).collect();
        self.notes.retain(|note| !(all && matches!(note, Note::Unknown { .. })));
        self.notes.push(Note::OneSize { symbols, size });
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::find;
    use crate::model::base::{A1, A2, COUNT};
    use crate::recording::Channels;
    use crate::robot::{Robot, State};
    use crate::simulate::{Hold, Input, simulate};

    /// A motor under steps of a voltage, J dω = u - k ω - f sgn(ω), as two equal wheels, with noise of its speed.
    fn steps(level: impl Fn(usize) -> f64) -> Recording {
        let model = Model::with_effects(Robot::amigobot(), &["back_emf"]).unwrap();
        let p = [0.03, 0.0, 0.0, 1.0, 1.0, 0.2];
        let t: Vec<f64> = (0..600).map(|k| 0.01 * f64::from(k)).collect();
        let torque: Vec<[f64; 2]> = (0..600).map(|k| [level(k / 50); 2]).collect();
        let noise = |k: usize| 0.05 * ((k * k) as f64).sin();
        let input = Input { t: &t, torque: &torque, hold: Hold::Constant };
        let rest = State { alpha: [0.0; 2], omega: [0.0; 2] };
        let states = simulate(&model, &p, &input, rest).unwrap();
        let channels = Channels {
            alpha: None,
            omega: Some((0..600).map(|k| states[k].omega.map(|w| w + noise(k))).collect()),
            torque,
            t,
        };
        Recording::new("steps", channels, DriveUnit::Volt).unwrap()
    }

    #[test]
    fn friction_is_not_identifiable_where_it_explains_the_only_input() {
        let model = Model::with_effects(Robot::amigobot(), &["back_emf"]).unwrap();
        let of = |level: &dyn Fn(usize) -> f64| {
            let train = [steps(level)];
            let task = Task { model: &model, train: &train, hold: Hold::Constant, seed: 0 };
            let fit = find("torque_regression").unwrap().identify(&task).unwrap();
            (fit.under_one_size(acting_sizes(&task)), start_without_friction(&task))
        };
        let (fit, start) = of(&|n| if n == 0 { 0.0 } else { 8.0 });
        assert!(fit.estimates.iter().all(|e| !e.identifiable), "{:?}", fit.estimates);
        let is_said =
            |n: &Note| matches!(n, Note::OneSize { size, .. } if (size - 8.0).abs() < 0.1);
        assert!(fit.notes.iter().any(is_said), "{:?}", fit.notes);
        // without friction the time constant of the motion is right: J/k = 0.15 s
        let start = start.unwrap();
        let back_emf = start[COUNT]; // behind the base parameters
        assert!(((start[A1] + start[A2]) / back_emf - 0.15).abs() < 0.03, "{start:?}");
        let (fit, start) = of(&|n| [8.0, 4.0, -6.0][n % 3]);
        assert!(fit.estimates[A4].identifiable && start.is_none(), "{:?}", fit.estimates);
    }

    #[test]
    fn the_torque_of_a_robot_that_crawls_has_no_one_size() {
        // friction of 1 N m, and a twentieth of it for a slow acceleration
        let t: Vec<f64> = (0..600).map(|k| 0.01 * f64::from(k)).collect();
        let speed = |t: f64| 2.0 + (1.5 * t).sin();
        let of = |inertia: f64| {
            let torque = t.iter().map(|t| [1.0 + 1.5 * inertia * (1.5 * t).cos(); 2]).collect();
            let omega = Some(t.iter().map(|t| [speed(*t); 2]).collect());
            let channels = Channels { t: t.clone(), alpha: None, omega, torque };
            sizes(&[Recording::new("crawls", channels, DriveUnit::NewtonMetre).unwrap()], |r| {
                r.torque().to_vec()
            })
        };
        assert_eq!(of(0.033), [None; 2]);
        assert!(of(0.0).iter().all(|size| size.is_some_and(|size| (size - 1.0).abs() < 1e-9)));
    }
}
