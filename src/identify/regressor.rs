//! The torque balance as a linear regression: one column per linear parameter.

use std::ops::Range;

use super::Task;
use crate::effects::{Motion, Terms, along};
use crate::math::sgn;
use crate::model::{Linearisation, Model, times};
use crate::recording::Recording;
use crate::simulate::Hold;

/// Separates the torque balance of a model into contributions of its linear parameters.
///
/// ```text
/// column j = balance(parameter j one, other linear ones zero) - balance(all linear ones zero)
/// ```
/// Derived from the effects themselves, so it cannot disagree with the simulation.
pub(super) struct Regressor<'a> {
    model: &'a Model,
    pub(super) linear: Vec<usize>,
    /// Parameters with all linear ones at zero.
    unit: Vec<f64>,
}

/// The acting input around each sample: that of the sample for a linear input; for one held at the
/// value of the earlier sample, the mean of both (otherwise a regression would contain a delay of
/// half a sample).
pub(super) fn input_around(
    task: &Task,
    recording: &Recording,
    input: &[[f64; 2]],
) -> Vec<[f64; 2]> {
    input_along(task, recording.t(), recording.pieces(), input)
}

/// [`input_around`] rows at these times, in pieces without a gap.
pub(super) fn input_along(
    task: &Task,
    t: &[f64],
    pieces: &[Range<usize>],
    input: &[[f64; 2]],
) -> Vec<[f64; 2]> {
    let acting = task.model.input(t, input, &task.model.initial());
    if task.hold == Hold::Linear {
        return acting;
    }
    let mut out = acting.clone();
    for piece in pieces {
        for k in piece.start + 1..piece.end {
            out[k] = [0, 1].map(|i| 0.5 * (acting[k - 1][i] + acting[k][i]));
        }
    }
    out
}

/// Mass and torque of every column at one instant; the last entry is the part with all linear
/// parameters at zero.
#[derive(Clone, Debug, Default)]
pub(super) struct Balance {
    /// Mass matrices as (m11, m12, m22).
    pub(super) mass: Vec<[f64; 3]>,
    /// Resisting torques with dry friction.
    pub(super) torque: Vec<[f64; 2]>,
}

impl Balance {
    /// `mass_c v` of column `c`: its momentum for a speed, its inertial torque for an
    /// acceleration.
    pub(super) fn carried(&self, c: usize, v: &[f64; 2]) -> [f64; 2] {
        times(&self.mass[c], v)
    }

    /// Torque of column `c` at acceleration `a`.
    pub(super) fn total_torque(&self, c: usize, a: &[f64; 2]) -> [f64; 2] {
        let inertial = self.carried(c, a);
        [0, 1].map(|i| inertial[i] + self.torque[c][i])
    }
}

impl<'a> Regressor<'a> {
    /// A regressor for the linear parameters of `model`, the others as in `p`.
    pub(super) fn new(model: &'a Model, p: &[f64]) -> Self {
        let linear = model.linear();
        let mut unit = p.to_vec();
        for &j in &linear {
            unit[j] = 0.0;
        }
        Self { model, linear, unit }
    }

    /// Number of columns.
    pub(super) fn width(&self) -> usize {
        self.linear.len()
    }

    /// The balance at one instant.
    pub(super) fn at(&self, motion: &Motion<f64>) -> Balance {
        let sign = [0, 1, 2, 3].map(|j| sgn(along(j, &motion.omega)));
        let mut unit = self.unit.clone();
        let mut given = Terms::zero();
        let mut out = Balance {
            mass: Vec::with_capacity(self.width() + 1),
            torque: Vec::with_capacity(self.width() + 1),
        };
        let mut linear = self.linear.iter().copied().peekable();
        for (e, effect) in self.model.effects().iter().enumerate() {
            let slots = self.model.slots(e);
            let without = effect.terms(motion, &unit[slots.clone()]);
            given.add(&without);
            let rest = without.total_torque(&[0.0; 2], &sign);
            while let Some(j) = linear.next_if(|j| slots.contains(j)) {
                unit[j] = 1.0;
                let with = effect.terms(motion, &unit[slots.clone()]);
                unit[j] = 0.0;
                let torque = with.total_torque(&[0.0; 2], &sign);
                out.mass.push([0, 1, 2].map(|i| with.mass[i] - without.mass[i]));
                out.torque.push([0, 1].map(|i| torque[i] - rest[i]));
            }
        }
        out.mass.push(given.mass);
        out.torque.push(given.total_torque(&[0.0; 2], &sign));
        out
    }

    /// Room for [`Regressor::slopes`]: the model at each column.
    pub(super) fn work(&self) -> Vec<Linearisation> {
        vec![Linearisation::new(self.unit.len()); self.width() + 1]
    }

    /// Derivatives of every column's torque (not of its inertia) by the two speeds,
    /// `[column][wheel][speed]`, at friction signs as they are; the last entry as in [`Balance`].
    pub(super) fn slopes(
        &self,
        motion: &Motion<f64>,
        work: &mut [Linearisation],
    ) -> Vec<[[f64; 2]; 2]> {
        let sign = [0, 1, 2, 3].map(|j| sgn(along(j, &motion.omega)));
        let mut unit = self.unit.clone();
        let at = |unit: &[f64], work: &mut Linearisation| {
            self.model.evaluate(motion, unit, work);
            self.model.differentiate_by_state(&[0.0; 2], &sign, work);
            work.by_state.map(|row| [row[2], row[3]])
        };
        // each with its own buffer, in which terms that do not depend on the motion remain
        let (last, columns) = work.split_last_mut().expect("room for the given part");
        let given = at(&unit, last);
        let mut out = Vec::with_capacity(self.width() + 1);
        for (&j, work) in self.linear.iter().zip(columns) {
            unit[j] = 1.0;
            let with = at(&unit, work);
            unit[j] = 0.0;
            out.push([0, 1].map(|i| [0, 1].map(|l| with[i][l] - given[i][l])));
        }
        out.push(given);
        out
    }
}
