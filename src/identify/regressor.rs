//! The torque balance as a linear regression: one column per linear parameter.

use std::ops::Range;

use super::Task;
use super::combined::{Combined, Factors, factors_of};
use crate::effects::{Motion, Terms, along, with_friction};
use crate::math::sgn;
use crate::model::{Linearisation, Model, SpeedPolynomial, Variation, times};
use crate::recording::Recording;
use crate::simulate::at_rows;

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
    /// The columns of each effect if they are polynomials.
    polynomials: Vec<Option<Polynomials>>,
    /// The factors of the columns of all effects, if all are polynomials, and the same combined.
    factors: Option<Vec<Factors>>,
    combined: Option<Combined>,
}

/// The columns of an effect: its given part, and its linear parameters.
type Polynomials = (Column, Vec<Column>);

/// A column whose torque is a second-degree polynomial of the speeds, with a constant mass matrix and constant
/// levels of dry friction.
struct Column {
    mass: [f64; 3],
    torque: SpeedPolynomial,
    level: [f64; 4],
}

impl Column {
    /// The column with these terms at given speeds.
    fn of(terms: impl Fn([f64; 2]) -> Terms<f64>) -> Self {
        let Terms { mass, level, .. } = terms([0.0; 2]);
        Self { mass, torque: SpeedPolynomial::through(|omega| terms(omega).torque), level }
    }

    fn torque(&self, omega: [f64; 2], sign: &[f64; 4]) -> [f64; 2] {
        let ([constant, ..], [first, second]) = (self.torque.factors, self.torque.rest(omega));
        with_friction([constant[0] + first, constant[1] + second], &self.level, sign)
    }

    fn factors(&self) -> Factors {
        factors_of(self.mass, &self.torque, &self.level)
    }
}

/// The columns of effect `e`, if all are polynomials; `unit` are the parameters with the linear ones at zero.
fn columns(model: &Model, e: usize, unit: &[f64]) -> Option<Polynomials> {
    let (slots, variations) = (model.slots(e), model.variations(e));
    let constant =
        variations.mass <= Variation::Constant && variations.level <= Variation::Constant;
    if !constant || variations.torque > Variation::Quadratic {
        return None;
    }
    let at = |omega: [f64; 2], p: &[f64]| {
        model.effects()[e].terms(&Motion::at(0.0, [0.0; 2], omega, model.robot()), p)
    };
    let none = &unit[slots.clone()];
    let one = |j: usize| {
        let mut p = none.to_vec();
        p[j - slots.start] = 1.0;
        Column::of(|omega| difference(&at(omega, &p), &at(omega, none)))
    };
    let own = model.linear().into_iter().filter(|j| slots.contains(j)).map(one).collect();
    Some((Column::of(|omega| at(omega, none)), own))
}

/// The factors of all columns, ordered as in [`Balance`]; `None` if an effect has other terms.
fn factors(polynomials: &[Option<Polynomials>]) -> Option<Vec<Factors>> {
    let (mut out, mut sum) = (vec![], Factors::default());
    for effect in polynomials {
        let (given, own) = effect.as_ref()?;
        out.extend(own.iter().map(Column::factors));
        let both = sum.iter_mut().flatten().zip(given.factors().into_iter().flatten());
        both.for_each(|(sum, factor)| *sum += factor);
    }
    out.push(sum);
    Some(out)
}

/// `with` minus `without`.
fn difference(with: &Terms<f64>, without: &Terms<f64>) -> Terms<f64> {
    Terms {
        mass: [0, 1, 2].map(|i| with.mass[i] - without.mass[i]),
        torque: [0, 1].map(|i| with.torque[i] - without.torque[i]),
        level: [0, 1, 2, 3].map(|j| with.level[j] - without.level[j]),
    }
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
    at_rows(pieces, &task.model.input(t, input, &task.model.initial()), task.hold)
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
        let polynomials: Vec<_> =
            (0..model.effects().len()).map(|e| columns(model, e, &unit)).collect();
        let factors = factors(&polynomials);
        let combined = factors.as_deref().map(Combined::new);
        Self { model, linear, unit, polynomials, factors, combined }
    }

    /// Number of columns.
    pub(super) fn width(&self) -> usize {
        self.linear.len()
    }

    /// The factors of the columns, the last those of the part with all linear parameters at zero, if no effect has
    /// other terms than polynomials.
    pub(super) fn factors(&self) -> Option<&[Factors]> {
        self.factors.as_deref()
    }

    /// All columns combined, if no effect has other terms than polynomials.
    pub(super) fn combined(&self) -> Option<&Combined> {
        self.combined.as_ref()
    }

    /// The balance at one instant.
    pub(super) fn at(&self, motion: &Motion<f64>) -> Balance {
        let mut balance = Balance::default();
        self.write(motion, &mut balance);
        balance
    }

    /// [`Regressor::at`] in place of another balance.
    pub(super) fn write(&self, motion: &Motion<f64>, out: &mut Balance) {
        let sign = [0, 1, 2, 3].map(|j| sgn(along(j, &motion.omega)));
        let (mut mass, mut torque) = ([0.0; 3], [0.0; 2]);
        out.mass.clear();
        out.torque.clear();
        for (e, columns) in self.polynomials.iter().enumerate() {
            let (given, given_torque) = match columns {
                Some((given, own)) => {
                    out.mass.extend(own.iter().map(|column| column.mass));
                    out.torque.extend(own.iter().map(|column| column.torque(motion.omega, &sign)));
                    (given.mass, given.torque(motion.omega, &sign))
                }
                None => self.write_effect(e, motion, &sign, out),
            };
            (0..3).for_each(|i| mass[i] += given[i]);
            (0..2).for_each(|i| torque[i] += given_torque[i]);
        }
        out.mass.push(mass);
        out.torque.push(torque);
    }

    /// Adds the columns of an effect that has other terms; returns mass and torque of its given part.
    fn write_effect(
        &self,
        e: usize,
        motion: &Motion<f64>,
        sign: &[f64; 4],
        out: &mut Balance,
    ) -> ([f64; 3], [f64; 2]) {
        let (effect, slots) = (&self.model.effects()[e], self.model.slots(e));
        let mut unit = self.unit[slots.clone()].to_vec();
        let without = effect.terms(motion, &unit);
        for j in self.linear.iter().filter(|j| slots.contains(j)) {
            unit[j - slots.start] = 1.0;
            let column = difference(&effect.terms(motion, &unit), &without);
            unit[j - slots.start] = 0.0;
            out.mass.push(column.mass);
            out.torque.push(column.total_torque(&[0.0; 2], sign));
        }
        (without.mass, without.total_torque(&[0.0; 2], sign))
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

#[cfg(test)]
mod tests {
    use super::super::combined::quantities;
    use super::*;
    use crate::effects;
    use crate::robot::Robot;

    #[test]
    fn columns_that_are_polynomials_are_those_of_the_terms() {
        let mut polynomials = 0;
        for effect in effects::all() {
            let Ok(model) = Model::with_effects(Robot::amigobot(), &[effect.id()]) else {
                continue;
            };
            let regressor = Regressor::new(&model, &model.initial());
            polynomials += regressor.polynomials.iter().flatten().count();
            for omega in [[1.3, -0.8], [4.0, 6.5], [-2.0, 0.0]] {
                let motion = Motion::at(0.4, [0.2, -0.7], omega, model.robot());
                let (found, mut expected) = (regressor.at(&motion), Balance::default());
                let sign = [0, 1, 2, 3].map(|j| sgn(along(j, &omega)));
                let (mut mass, mut torque) = ([0.0; 3], [0.0; 2]);
                for e in 0..model.effects().len() {
                    let given = regressor.write_effect(e, &motion, &sign, &mut expected);
                    (0..3).for_each(|i| mass[i] += given.0[i]);
                    (0..2).for_each(|i| torque[i] += given.1[i]);
                }
                expected.mass.push(mass);
                expected.torque.push(torque);
                assert_eq!(found.mass, expected.mass, "{}", effect.id());
                for (found, expected) in found.torque.iter().zip(&expected.torque) {
                    for i in 0..2 {
                        // rounding of products of speeds up to 42 rad²/s²
                        assert!((found[i] - expected[i]).abs() < 1e-13, "{}", effect.id());
                    }
                }
            }
        }
        assert!(polynomials > 40, "{polynomials}");
    }
    #[test]
    fn combined_columns_are_those_of_the_balance() {
        let mut count = 0;
        for effect in effects::all() {
            let Ok(model) = Model::with_effects(Robot::amigobot(), &[effect.id()]) else {
                continue;
            };
            let regressor = Regressor::new(&model, &model.initial());
            let Some(combined) = regressor.combined() else { continue };
            count += 1;
            let width = regressor.width();
            for omega in [[1.3, -0.8], [4.0, 6.5], [-2.0, 0.0]] {
                let a = [3.0, -1.7];
                let balance = regressor.at(&Motion::at(0.4, [0.2, -0.7], omega, model.robot()));
                let groups = combined.at(quantities(omega, a));
                let found: Vec<f64> = groups.flat_map(|group| group.to_array()).collect();
                for c in 0..=width {
                    let side = if c < width { 1.0 } else { -1.0 };
                    for (wheel, torque) in balance.total_torque(c, &a).into_iter().enumerate() {
                        let found = side * found[wheel * (width + 1) + c];
                        // rounding of a dozen terms, products of speeds up to 42 rad²/s²
                        assert!((found - torque).abs() < 1e-13, "{} {c} {wheel}", effect.id());
                    }
                }
            }
        }
        assert!(count > 10, "{count}");
    }
}
