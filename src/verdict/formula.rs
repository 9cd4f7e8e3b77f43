//! A formula for the residual torque, tried as an effect.

use rayon::prelude::*;

use super::Basis;
use super::series::Formula;
use crate::compare::{Curve, Unexplained, curves, residual_torque};
use crate::diagnose::{Diagnosis, Judge, THRESHOLDS, WindowFit};
use crate::effects::{CustomDefinition, ParameterKind, ParameterSpec};
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::Hold;
use crate::study::{Coefficient, FormulaStudy, most_pointing};

/// The formula of the curve that explains most of the residual torque, fitted in the model as given and in
/// the model with the effects found.
pub(super) struct Trial {
    formula: Formula,
    /// Whether it replaces the effects found. It is added to them if it does not make them redundant, or
    /// lowers the error further by as much as is required of any effect.
    pub(super) in_place: bool,
    /// Errors on the judged recordings of the last model, and of the model with the formula [rad/s].
    errors: [f64; 2],
}

impl Trial {
    /// `None` if no formula describes the curve, or if none can be simulated.
    pub(super) fn of(curves: &[Curve], diagnosis: &Diagnosis, basis: &Basis) -> Option<Self> {
        let curve = most_pointing(curves)?;
        let formula = Formula::of(curve, basis.train[0].drive_unit())?;
        let judge = Judge::new(basis.judged().to_vec(), basis.hold);
        let error = |fit: &WindowFit| judge.judge(&fit.model, &fit.p).ok().map(|j| j.window_rms);
        let with = |base: &WindowFit| {
            let fit = formula.fitted(base, basis.train, basis.hold)?;
            Some((error(&fit)?, fit))
        };
        let lower = |one: f64, other: f64| one <= (1.0 - THRESHOLDS.least_fall) * other;
        let before = error(diagnosis.last())?;
        let alone = with(&diagnosis.base).map(|(error, _)| error);
        let beside = diagnosis.steps.last().and_then(|step| {
            let (error, fit) = with(&step.fit)?;
            Some((error, holds(&fit, &step.fit)))
        });
        let (after, in_place) = match (alone, beside) {
            (Some(alone), Some((beside, holds))) if !holds && !lower(beside, alone) => {
                (alone, true)
            }
            (_, Some((beside, _))) => (beside, false),
            (alone, None) => (alone?, false),
        };
        Some(Self { formula, in_place, errors: [before, after] })
    }

    /// Whether it explains more than half of the error of the last model above the noise floor [rad/s].
    pub(super) fn explains(&self, floor: f64) -> bool {
        let [before, after] = self.errors.map(|error| error.powi(2) - floor.powi(2));
        after <= THRESHOLDS.unexplained * before
    }

    /// The formula as an effect of an experiment file, with the error of the model with it.
    pub(super) fn study(self) -> FormulaStudy {
        let [_, window_rms] = self.errors;
        FormulaStudy { in_place: self.in_place, window_rms, ..study_of(self.formula) }
    }
}

/// A formula as an effect of an experiment file.
fn study_of(formula: Formula) -> FormulaStudy {
    let toml = formula.toml();
    let CustomDefinition { torque1, torque2, parameters, description } = formula.definition;
    let coefficient = |p: ParameterSpec| {
        (p.symbol, Coefficient { unit: p.unit, range: p.range, typical: p.typical })
    };
    FormulaStudy {
        id: formula.id,
        description,
        torque1,
        torque2,
        parameters: parameters.into_iter().map(coefficient).collect(),
        toml,
        ..FormulaStudy::default()
    }
}

/// Residual torque of every recording after a low-pass with cut-off `cutoff` [Hz].
pub(crate) fn residual_torques(
    model: &Model,
    p: &[f64],
    recordings: &[&Recording],
    hold: Hold,
    cutoff: f64,
) -> Vec<Vec<[f64; 2]>> {
    recordings.par_iter().map(|r| residual_torque(model, p, r, hold, cutoff)).collect()
}

/// Residual torque of the model as given (`before`) and of the model with the effects found (`after`) over
/// the variables, for `recordings`, both after a low-pass with cut-off `cutoff` [Hz].
pub(crate) fn curves_of(
    diagnosis: &Diagnosis,
    recordings: &[&Recording],
    hold: Hold,
    cutoff: f64,
    before: &[Vec<[f64; 2]>],
    after: Option<&[Vec<[f64; 2]>]>,
) -> Vec<Curve> {
    fn of<'a>(fit: &'a WindowFit, hold: Hold, torque: &'a [Vec<[f64; 2]>]) -> Unexplained<'a> {
        Unexplained { model: &fit.model, p: &fit.p, hold, torque }
    }
    let last = diagnosis.last();
    // a second mass is not part of the torque balance
    let after = after.filter(|_| !last.model.is_coupled()).map(|torque| of(last, hold, torque));
    curves(recordings, cutoff, of(&diagnosis.base, hold, before), after)
}

/// Whether a formula makes the effects found redundant, as a series in the heading does for an inclined
/// floor: a linear parameter that was identified is not identifiable together with it. This is tested for
/// linear parameters only, because a shape parameter is also not identifiable if its effect has vanished (a
/// limit that is no longer reached).
fn holds(with_formula: &WindowFit, found: &WindowFit) -> bool {
    let is_known = |fit: &WindowFit, j: usize| fit.covariance[(j, j)].is_finite();
    let parameters = found.model.parameters().iter().enumerate();
    let mut linear = parameters.filter(|(_, p)| p.spec.kind == ParameterKind::Linear);
    linear.any(|(j, _)| is_known(found, j) && !is_known(with_formula, j))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;
    use nalgebra::DMatrix;

    /// A model with an effect, one parameter of which has a covariance.
    fn fit(effect: &str, symbol: &str, variance: f64) -> WindowFit {
        let model = Model::base(Robot::amigobot()).add(effect).unwrap();
        let p = model.initial();
        let mut covariance = DMatrix::identity(p.len(), p.len());
        let j = model.index_of(symbol).unwrap();
        covariance[(j, j)] = variance;
        let at_bound = vec![false; p.len()];
        WindowFit { model, p, cost: 1.0, covariance, at_bound, windows: 60 }
    }

    #[test]
    fn a_series_holds_a_slope_and_not_a_limit_that_is_no_longer_reached() {
        let held =
            |effect, symbol| holds(&fit(effect, symbol, f64::INFINITY), &fit(effect, symbol, 1.0));
        assert!(held("slope", "g_c"));
        assert!(!held("torque_saturation", "limit"));
        assert!(!holds(&fit("slope", "g_c", 1.0), &fit("slope", "g_c", 1.0)));
    }
}
