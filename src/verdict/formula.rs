//! What the residual torque depends on, tried as a formula.

use super::Basis;
use super::dependence::most_left;
use crate::compare::{Curve, Unexplained, curves, residual_torque};
use crate::diagnose::{Diagnosis, Formula, Judge, THRESHOLDS, WindowFit, cutoff, mobility};
use crate::effects::{CustomDefinition, ParameterSpec};
use crate::recording::Recording;
use crate::report::format;
use crate::study::{Coefficient, FormulaStudy};

/// The formula of the curve that shows most of the residual torque, in the model as given or beside what was found;
/// `None` where it does not explain the larger part of what the last model leaves on the judged recordings. It stands
/// beside what was found where that lowers the error further by as much as is asked of any effect.
pub(crate) fn tried(
    curves: &[Curve],
    diagnosis: &Diagnosis,
    basis: &Basis,
) -> Option<FormulaStudy> {
    let curve = most_left(curves).filter(|c| c.left() >= THRESHOLDS.named_share)?;
    let formula = Formula::of(curve, basis.train[0].drive_unit())?;
    let judge = Judge::new(basis.judged.to_vec(), basis.hold);
    let error = |fit: &WindowFit| judge.judge(&fit.model, &fit.p).ok().map(|j| j.window_rms);
    let with = |base: &WindowFit| {
        let fit = formula.fitted(base, basis.train, basis.hold)?;
        Some((error(&fit)?, fit))
    };
    let lower = |one: f64, other: f64| one <= (1.0 - THRESHOLDS.least_fall) * other;
    let floor = basis.floor?.expected;
    let above = |error: f64| error.powi(2) - floor.powi(2);
    let before = error(diagnosis.last())?;
    let alone = with(&diagnosis.base);
    let beside = diagnosis.steps.last().and_then(|step| Some((with(&step.fit)?, step)));
    let (window_rms, in_place) = match (alone, beside) {
        (Some((alone, _)), Some(((beside, fit), step))) => {
            match lower(beside, alone) || holds(&fit, &step.fit) {
                true => (beside, false),
                false => (alone, true),
            }
        }
        (None, Some(((beside, _), _))) => (beside, false),
        (alone, None) => (alone?.0, false),
    };
    (above(window_rms) <= THRESHOLDS.unexplained * above(before)).then(|| FormulaStudy {
        in_place,
        window_rms,
        ..study_of(formula)
    })
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

/// How the residual torque of the model as given depends on anything over `recordings`, and that of the model with what
/// was found.
pub(crate) fn curves_of(diagnosis: &Diagnosis, recordings: &[&Recording]) -> Vec<Curve> {
    let fits = [&diagnosis.base, diagnosis.last()];
    let WindowFit { model, p, .. } = fits[0];
    let cutoff = cutoff(recordings, mobility(model, p));
    let torque = |fit: &WindowFit| -> Vec<Vec<[f64; 2]>> {
        recordings.iter().map(|r| residual_torque(&fit.model, &fit.p, r, cutoff)).collect()
    };
    let torques = fits.map(torque);
    let [before, after] =
        [0, 1].map(|n| Unexplained { model: &fits[n].model, p: &fits[n].p, torque: &torques[n] });
    // a second mass is no part of the torque balance
    curves(recordings, cutoff, before, (!after.model.is_coupled()).then_some(after))
}

/// Whether a formula holds what was found, as a series in the heading holds a slope of the floor: a parameter that was
/// identified is not beside it.
fn holds(with_formula: &WindowFit, found: &WindowFit) -> bool {
    let is_known = |fit: &WindowFit, j: usize| fit.covariance[(j, j)].is_finite();
    (0..found.p.len()).any(|j| is_known(found, j) && !is_known(with_formula, j))
}

/// "A formula of it (heading_resistance) lowers the 2 s simulation error to 0.061 rad/s, 1.7 times the noise floor."
pub(super) fn words(formula: &FormulaStudy, floor: Option<f64>) -> String {
    let FormulaStudy { id, in_place, window_rms, .. } = formula;
    let place = if *in_place { " in place of what was found" } else { "" };
    let over = match floor.filter(|floor| *floor > 0.0) {
        Some(floor) if window_rms / floor <= THRESHOLDS.at_floor => ", the noise floor".to_owned(),
        Some(floor) => format!(", {:.1} times the noise floor", window_rms / floor),
        None => String::new(),
    };
    let error = format::significant(*window_rms, 3);
    format!(
        " A formula of it ({id}){place} lowers the 2 s simulation error to {error} rad/s{over}."
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_compare_with_the_floor() {
        let formula = |window_rms, in_place| FormulaStudy {
            id: "heading_resistance".into(),
            in_place,
            window_rms,
            ..FormulaStudy::default()
        };
        assert_eq!(
            words(&formula(0.0612, true), Some(0.0358)),
            " A formula of it (heading_resistance) in place of what was found lowers the 2 s simulation error to \
             0.0612 rad/s, 1.7 times the noise floor."
        );
        assert!(
            words(&formula(0.0412, false), Some(0.0358))
                .ends_with("0.0412 rad/s, the noise floor.")
        );
    }
}
