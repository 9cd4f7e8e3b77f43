//! Fixes parameters that are not identifiable.

use nalgebra::DMatrix;

use super::descent::{Solution, descend};
use crate::filter::HorizonFilter;
use crate::identify::identifiability::{held_value, least_known};
use crate::identify::open_loop::OpenLoop;
use crate::identify::{Note, Task, Unknown};
use crate::model::Model;
use crate::model::base::{A1, A2, A3, A4, A5};
use crate::recording::Recording;

/// Largest radius of gyration of a robot in half tracks: that of a rod nine tracks long (chosen by
/// judgement). The smallest is its reciprocal.
const WIDEST: f64 = 5.0;

/// A model with unidentifiable parameters fixed, and its maximum of the likelihood.
pub(super) struct Held {
    pub(super) model: Model,
    pub(super) solution: Solution,
    /// Indices of the held parameters.
    pub(super) places: Vec<usize>,
}

impl Held {
    /// Fixes, one after the other, parameters whose estimates would be misleading ([`least_known`]): the others may
    /// then be identifiable. An inertia of turning that is smaller than that of any robot is misleading too: with a
    /// torque that is missing in the model, small differences between the wheels of a robot that drives straight make
    /// it vanish. Then a2 and a3 have the ratio to a1 + a2 that they have in the construction data. The friction of a
    /// wheel, which those do not contain, is its [`held_value`] or that of `start`, whichever simulates better over 2 s.
    pub(super) fn of(
        task: &Task,
        filter: &HorizonFilter,
        first: Solution,
        (start, open): (&[f64], &OpenLoop),
    ) -> Self {
        let mut out = Self { model: task.model.clone(), solution: first, places: vec![] };
        let at = |j: usize, p: &[f64]| match j {
            A2 | A3 => in_proportion(task.model, j, p),
            _ => held_value(task, j, start[j]),
        };
        let error = |held: &Self| open.mean(&held.model, &held.solution.p);
        // where the information is not a number, a held parameter would be found again
        while let Some(j) = out.least_known(task).filter(|j| !out.places.contains(j)) {
            let mut values = vec![at(j, &out.solution.p)];
            // a start at the construction data is no estimate of a friction in another unit
            let is_of_data = matches!(j, A4 | A5) && start[j] != task.model.initial()[j];
            values.extend(is_of_data.then_some(start[j]));
            let held = values.into_iter().filter_map(|value| out.holding(filter, j, value));
            let Some(best) = held.min_by(|a, b| error(a).total_cmp(&error(b))) else { break };
            out = best;
        }
        if is_narrow(&out.model, task.train, &out.solution.p) {
            let free =
                |j: &usize| task.model.parameters()[*j].fixed.is_none() && !out.places.contains(j);
            let held: Vec<usize> = [A2, A3].into_iter().filter(free).collect();
            for j in held {
                let value = at(j, &out.solution.p);
                out = out.holding(filter, j, value).unwrap_or(out);
            }
        }
        out
    }

    /// The same with parameter `j` fixed at `value`, after a descent from there; `None` if that is not possible.
    fn holding(&self, filter: &HorizonFilter, j: usize, value: f64) -> Option<Self> {
        let symbol = self.model.parameters()[j].spec.symbol.clone();
        let model = self.model.fix(&symbol, value).ok()?;
        let mut p = self.solution.p.clone();
        // the sum of the inertias may be identifiable if one of them is not
        if j == A2 {
            p[A1] += p[A2] - value;
        }
        p[j] = value;
        crate::identify::start::sound(&model, &mut p);
        let solution = descend(filter, &model, (&p, self.solution.shift), 0.0)?;
        let places = self.places.iter().copied().chain([j]).collect();
        Some(Self { model, solution, places })
    }

    /// Fixes a2 at zero, as for a mass distributed over the track, if the inertia of turning of `chosen` is larger than
    /// that of any robot; returns whether it did. If a resistance that is missing in the model prevents the robot from
    /// turning (tyres that scrub), the estimated inertia of turning grows without limit.
    pub(super) fn spread_over_track(
        &mut self,
        task: &Task,
        filter: &HorizonFilter,
        chosen: &Solution,
    ) -> bool {
        let too_wide = gyration(&self.model, task.train, &chosen.p)
            .is_some_and(|squared| squared > WIDEST * WIDEST);
        let held = too_wide.then(|| self.holding(filter, A2, 0.0)).flatten();
        let Some(held) = held else { return false };
        *self = held;
        true
    }

    fn least_known(&self, task: &Task) -> Option<usize> {
        let total = self.solution.p.len();
        let mut information = DMatrix::zeros(total, total);
        for sums in &self.solution.sums {
            information += sums.information.view((0, 0), (total, total));
        }
        let information = information / self.solution.scale();
        least_known(&self.model, &self.solution.p, &information, task.train)
    }

    /// The notes on the held parameters.
    pub(super) fn notes(&self, task: &Task) -> Vec<Note> {
        let one = |&j: &usize| {
            let parameter = &task.model.parameters()[j];
            let effect = parameter.effect.clone();
            let unknown = Unknown::Held(parameter.spec.symbol.clone(), self.solution.p[j]);
            Note::Unknown { unknown, effect }
        };
        self.places.iter().map(one).collect()
    }
}

/// The inertia a2 or a3, number `j`, in the ratio to a1 + a2 that it has in the construction data; zero without these.
pub(super) fn in_proportion(model: &Model, j: usize, p: &[f64]) -> f64 {
    if model.robot().assumed.is_some() {
        return 0.0;
    }
    let (initial, sum) = (model.initial(), |p: &[f64]| p[A1] + p[A2]);
    if sum(p) > 0.0 { sum(p) / sum(&initial) * initial[j] } else { initial[j] }
}

/// Radius of gyration about the vertical in half tracks, squared; `None` for a single axis or a fixed a2.
///
/// ```text
/// (a1 - a2)/(a1 + a2) ≈ (radius of gyration about the vertical / half the track)²
/// ```
fn gyration(model: &Model, train: &[Recording], p: &[f64]) -> Option<f64> {
    let two = !train.iter().all(Recording::is_single_axis);
    let free = model.parameters()[A2].fixed.is_none();
    (two && free).then(|| (p[A1] - p[A2]) / (p[A1] + p[A2]))
}

/// Whether the inertia of turning is smaller than that of any robot.
pub(super) fn is_narrow(model: &Model, train: &[Recording], p: &[f64]) -> bool {
    gyration(model, train, p).is_some_and(|squared| squared < 1.0 / (WIDEST * WIDEST))
}
