//! Comparison of a diagnosis with the noise floor, and the resulting verdict.

use super::Basis;
use super::events::events;
use super::next::{advice, propose, to_prove};
use super::ranking::{ranking, staircase};
use super::unrelated::unrelated;
use crate::compare::{Curve, Variable, WindowFloor};
use crate::diagnose::{
    Conclusion, Diagnosis, Difference, Errors, Judge, Judgement, Ranked, Step, THRESHOLDS,
    WindowFit, conclude, difference, likely, structured, structured_by_blocks, withheld,
};
use crate::filter::{Likelihood, prepare};
use crate::math::correlations;
use crate::recording::Recording;
use crate::simulate::{Hold, SimulateError};
use crate::study::{
    Advice, DependenceStudy, DiagnosisStudy, Events, FormulaStudy, FoundEffect, Logging,
    Undetermined, UnprovenEffect, Verdict, Withheld, is_plain, parameters_of,
};

/// A diagnosis compared with the noise floor of the judged recordings.
pub(super) struct Concluded<'a> {
    diagnosis: &'a Diagnosis,
    basis: &'a Basis<'a>,
    judge: Judge,
    likelihood: Likelihood<'a>,
    /// The model as given on the judged recordings.
    before: Judgement,
    errors: Errors,
    /// Noise floor of the judged recordings under the last model [rad/s].
    pub(super) floor: f64,
    conclusion: Conclusion,
    /// Why the recordings do not determine the model; then nothing else is valid.
    undetermined: Option<Undetermined>,
    likely: Option<&'a Ranked>,
    /// The candidate that lowers the held-out error without being accepted, and the reason.
    withheld: Option<(&'a Ranked, Withheld)>,
    /// A parameter of the last model that differs between the recordings.
    differs: Option<Difference>,
    /// The variable on which the residual torque of the last model depends significantly.
    depends_on: Option<Variable>,
    /// Where the residual torque of the last model is larger than any stationary noise explains.
    events: Option<Events>,
}

impl<'a> Concluded<'a> {
    /// Conclusion from a diagnosis with the `curves` of its residual torque; `floor`: that of the judged recordings
    /// under the last model, if already known.
    pub(super) fn of(
        (diagnosis, curves): (&'a Diagnosis, &[Curve]),
        basis: &'a Basis,
        floor: Option<WindowFloor>,
        undetermined: Option<Undetermined>,
    ) -> Result<Self, SimulateError> {
        let likelihood = Likelihood {
            prepared: basis.train.iter().map(prepare).collect(),
            hold: basis.hold,
            slow_moment: basis.slow_moment,
            timing: false,
            step_scatter: 1.0,
        };
        let judge = Judge::new(basis.judged().to_vec(), basis.hold);
        let WindowFit { model, p, .. } = diagnosis.last();
        let floor = floor.unwrap_or_else(|| judge.floor(model, p));
        let before = judge.judge(&diagnosis.base.model, &diagnosis.base.p)?;
        let errors = judge.errors(diagnosis, floor, basis.train)?;
        let undetermined = undetermined
            .or_else(|| unrelated(diagnosis, (&judge, basis.hold), &errors, basis.train));
        let left = judge.left_by(diagnosis, &likelihood, !basis.validation.is_empty())?;
        let depends_on = left.structure.map(|dependence| dependence.variable);
        let likely = likely_effect(diagnosis, &judge, &bounded(diagnosis, &judge, errors));
        let leaves = likely.and_then(|ranked| leaves(ranked, diagnosis.validated, &judge, &errors));
        let all: Vec<&Recording> = basis.train.iter().chain(basis.validation).collect();
        let differs = difference(diagnosis.last(), &all, basis.hold);
        let by_blocks = structured_by_blocks(curves);
        let events =
            if errors.above_floor() { events(diagnosis.last(), &all, basis.hold) } else { None };
        let structure =
            by_blocks.is_some() || events.is_some() || depends_on.is_some() && structured(curves);
        let depends_on = depends_on.or(by_blocks);
        // slow noise of the input, as the innovations show it, may cause an error without structure that no effect
        // lowers
        let asked = !structure && likely.is_none() && errors.above_floor();
        let coloured = if asked { judge.coloured_floor(model, p, left.slow).powi(2) } else { 0.0 };
        let most = errors.most.max(coloured);
        let conclusion =
            conclude(diagnosis.steps.len(), &Errors { most, ..errors }, leaves, structure);
        // a single model for recordings that differ does not contain the change between them
        let conclusion = match conclusion {
            Conclusion::Sufficient if differs.is_some() => Conclusion::Unknown,
            other => other,
        };
        let too_few = of_few_windows(diagnosis, &judge, basis.train, (conclusion, &errors))?;
        let withheld = match conclusion {
            Conclusion::Sufficient => withheld_effect(diagnosis, &judge, basis, &errors),
            _ => None,
        };
        Ok(Self {
            diagnosis,
            basis,
            judge,
            likelihood,
            before,
            errors,
            floor: floor.expected,
            conclusion,
            undetermined: undetermined.or(too_few),
            likely,
            withheld,
            differs,
            depends_on,
            events,
        })
    }

    /// Dependence of the residual torque according to its `curves`, if the verdict states it: if something
    /// outside the catalogue is missing, or if more is missing than was found, according to the error or to a
    /// variable that explains more than half of it.
    pub(super) fn dependence(&self, curves: &[Curve]) -> Option<DependenceStudy> {
        let is_stated = match self.conclusion {
            _ if self.undetermined.is_some() => false,
            Conclusion::Unknown => self.errors.above_floor(),
            Conclusion::Missing | Conclusion::Likely => {
                self.errors.far_above_all() || is_plain(curves)
            }
            Conclusion::Sufficient => false,
        };
        is_stated.then(|| DependenceStudy::of(curves, self.depends_on, self.events.clone()))
    }

    /// The verdict, with the dependence of the residual torque if it states this, and with a `formula` for
    /// it; with a formula no effect of the catalogue is likely and no further recording is recommended.
    /// Effects of a fit that the columns do not determine are not reported.
    pub(super) fn study(
        &self,
        dependence: Option<DependenceStudy>,
        formula: Option<FormulaStudy>,
    ) -> Result<DiagnosisStudy, SimulateError> {
        let Self { diagnosis, basis, judge, errors, .. } = self;
        let steps = if self.undetermined.is_some() { &[][..] } else { &diagnosis.steps };
        let logging = self.logging();
        let crossed = !diagnosis.validated;
        // if nothing is missing, no recording is recommended
        let is_open = self.conclusion != Conclusion::Sufficient
            && self.undetermined.is_none()
            && formula.is_none();
        let proposal = is_open.then(|| propose(diagnosis, &self.likelihood, basis.seed)).flatten();
        let next = match (self.undetermined, self.withheld) {
            (
                Some(
                    Undetermined::Columns
                    | Undetermined::Noisy { .. }
                    | Undetermined::Unrelated { .. },
                ),
                _,
            ) => vec![Advice::CheckColumns],
            (Some(Undetermined::Steady { .. }), _) => vec![Advice::ChangeSpeed],
            (
                Some(
                    Undetermined::Short { .. }
                    | Undetermined::Windows { .. }
                    | Undetermined::Untested { .. },
                ),
                _,
            ) => vec![Advice::RecordLonger],
            (Some(Undetermined::BetweenRows { rate, .. }), _) => {
                vec![Advice::RecordFaster { rate }]
            }
            (None, Some((ranked, why))) => vec![to_prove(ranked, why == Withheld::BetweenRows)],
            (None, None) if is_open => advice(diagnosis, self.likely),
            (None, None) => vec![],
        };
        let next = self.lacking().into_iter().chain(next).collect();
        Ok(DiagnosisStudy {
            verdict: self.verdict(),
            errors: *errors,
            found: steps.iter().map(|step| step.id.clone()).collect(),
            unproven: self.likely.map(|ranked| unproven(ranked, crossed)),
            withheld: self.withheld.map(|(ranked, why)| (unproven(ranked, crossed), why)),
            logging,
            at_floor: None,
            differs: self.differs.clone(),
            dependence,
            parameters: parameters_of(diagnosis.last(), logging.unit),
            correlations: correlations(&diagnosis.last().covariance),
            ranking: ranking(diagnosis, judge, self.before)?,
            staircase: staircase(diagnosis, judge, self.before)?,
            next,
            proposal,
            false_alarm: basis.false_alarm,
            effects: steps.iter().map(found_effect).collect(),
            formula,
            undetermined: self.undetermined,
        })
    }

    /// The recording for training where the error on the validation recordings is above the floor because the training
    /// recordings determine the parameters too little.
    fn lacking(&self) -> Option<Advice> {
        let Self { errors, basis, .. } = self;
        let stands = matches!(self.conclusion, Conclusion::Sufficient | Conclusion::Missing)
            && self.undetermined.is_none()
            && self.withheld.is_none();
        let names = basis.validation.iter().map(|r| r.name().to_owned());
        let is_due = stands && errors.above_floor() && errors.above_input() && !errors.above_all();
        is_due.then(|| Advice::TrainOn { recordings: names.collect() })
    }

    fn verdict(&self) -> Verdict {
        match self.conclusion {
            _ if self.undetermined.is_some() => Verdict::UnknownEffect,
            Conclusion::Sufficient => Verdict::ModelSufficient,
            Conclusion::Missing => Verdict::EffectsMissing,
            Conclusion::Likely => Verdict::EffectLikely,
            Conclusion::Unknown => Verdict::UnknownEffect,
        }
    }

    fn logging(&self) -> Logging {
        let Basis { train, hold, .. } = self.basis;
        let judged = self.basis.judged();
        let half_a_row = || 0.5 * train.iter().map(Recording::step).fold(0.0, f64::max);
        Logging {
            unit: train[0].drive_unit(),
            if_held: (*hold == Hold::Linear).then(half_a_row),
            speeds_alone: train.iter().all(|r| !r.measured().alpha),
            longest_s: judged.iter().map(|r| r.duration()).fold(0.0, f64::max),
        }
    }
}

/// The errors with a noise floor that the best candidate does not refute: no correct model has a larger error than a
/// fitted one on recordings that neither was fitted to. Where the input jumps from row to row, the floor is an upper bound
/// far above it.
fn bounded(diagnosis: &Diagnosis, judge: &Judge, errors: Errors) -> Errors {
    let best = diagnosis.rest.first().and_then(|r| r.refit.as_ref());
    let held_out = best.filter(|_| diagnosis.validated);
    let judged = held_out.and_then(|fit| judge.judge(&fit.model, &fit.p).ok());
    let least = judged.map_or(f64::INFINITY, |with| with.window_rms.powi(2));
    Errors { floor: errors.floor.min(least), ..errors }
}

/// The effect that is likely although it is not proven. One that does not act in the judged recordings lowers their error
/// through the parameters that the training recordings bias without it: where that is all of the error, it is the likely
/// cause.
fn likely_effect<'a>(
    diagnosis: &'a Diagnosis,
    judge: &Judge,
    errors: &Errors,
) -> Option<&'a Ranked> {
    let acts = |r: &Ranked| r.refit.as_ref().is_some_and(|f| judge.acts(f, &r.candidate.id));
    let explains = |r: &Ranked| r.fall.is_some_and(|fall| errors.falls_to_floor(fall.ratio));
    likely(diagnosis, errors).filter(|r| explains(r) || acts(r))
}

/// The candidate that lowers the held-out error without being accepted, and the reason.
fn withheld_effect<'a>(
    diagnosis: &'a Diagnosis,
    judge: &Judge,
    basis: &Basis,
    errors: &Errors,
) -> Option<(&'a Ranked, Withheld)> {
    let ranked = withheld(diagnosis, basis.false_alarm)?;
    let reason = reason(judge, errors.after, ranked.refit.as_ref()?, &ranked.candidate.id);
    Some((ranked, reason))
}

/// Why a conclusion does not hold with so few windows: of a sufficient model if they determine none of its parameters, of
/// an unknown effect if they prove none.
fn of_few_windows(
    diagnosis: &Diagnosis,
    judge: &Judge,
    train: &[Recording],
    (conclusion, errors): (Conclusion, &Errors),
) -> Result<Option<Undetermined>, SimulateError> {
    let sufficient = conclusion == Conclusion::Sufficient;
    let unknown = conclusion == Conclusion::Unknown || sufficient && errors.above_floor();
    let fails = if unknown { judge.fails(diagnosis.last(), train)? } else { None };
    let undetermined = of_windows(diagnosis).filter(|_| sufficient || unknown && fails.is_none());
    Ok(undetermined.or_else(|| untested(diagnosis, fails).filter(|_| unknown)))
}

/// Why a model in which nothing was found is not sufficient: its windows determine none of the free parameters, for
/// example because there are no more windows than parameters.
fn of_windows(diagnosis: &Diagnosis) -> Option<Undetermined> {
    let WindowFit { model, covariance, windows, .. } = diagnosis.last();
    let is_unknown = |j: usize| !covariance[(j, j)].is_finite();
    let free = model.free();
    let none = !free.is_empty() && free.into_iter().all(is_unknown);
    none.then_some(Undetermined::Windows { windows: *windows })
}

/// Why the judged recordings prove no effect: a test has [fewest_windows](crate::diagnose::Thresholds) at least.
fn untested(diagnosis: &Diagnosis, fails: Option<f64>) -> Option<Undetermined> {
    let Diagnosis { tested: windows, validated, .. } = *diagnosis;
    let untested = Undetermined::Untested { windows, validated, fails };
    (windows < THRESHOLDS.fewest_windows).then_some(untested)
}

/// Ratio of the reported error with a likely effect to that without it; without validation recordings that of the
/// windows of the other fold, since the recordings in the report were fitted.
fn leaves(ranked: &Ranked, validated: bool, judge: &Judge, errors: &Errors) -> Option<f64> {
    let fall = ranked.fall?.ratio;
    let fit = ranked.refit.as_ref().filter(|_| validated);
    let with = fit.and_then(|fit| judge.judge(&fit.model, &fit.p).ok());
    Some(with.map_or(fall, |with| with.window_rms / errors.after.sqrt()))
}

/// Why a fit with the effect `id`, which lowers the held-out error, is not accepted; `now`: square of the reported
/// error [rad^2/s^2].
fn reason(judge: &Judge, now: f64, fit: &WindowFit, id: &str) -> Withheld {
    let with =
        judge.judge(&fit.model, &fit.p).map_or(f64::INFINITY, |with| with.window_rms.powi(2));
    let open = || judge.sampling(&fit.model, &fit.p).part_of(with.sqrt());
    let between = fit.model.effects().iter().any(|effect| effect.change().acts_between_rows());
    // a fit that cannot be simulated also raises it
    if !(with <= now) {
        Withheld::Raises
    } else if fit.is_short() {
        Withheld::Short { windows: fit.windows, parameters: fit.model.free().len() }
    } else if !judge.acts(fit, id) {
        Withheld::Idle
    } else if between || now - with < open() {
        Withheld::BetweenRows
    } else {
        Withheld::Small
    }
}

/// A candidate as an effect that is not proven.
fn unproven(ranked: &Ranked, crossed: bool) -> UnprovenEffect {
    let lowers = ranked.fall.map_or(0.0, |fall| 1.0 - fall.ratio);
    UnprovenEffect { id: ranked.candidate.id.clone(), lowers, crossed }
}

/// An accepted effect with its name and cause.
fn found_effect(step: &Step) -> FoundEffect {
    let effects = step.fit.model.effects();
    let description = effects.iter().map(|e| e.description()).find(|d| d.id == step.id);
    let (title, cause) = description.map_or_else(Default::default, |d| (d.title, d.cause));
    FoundEffect { id: step.id.clone(), title, cause, indistinguishable: step.equals.clone() }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::model::Model;
    use crate::robot::Robot;

    #[test]
    fn windows_that_determine_no_parameter_or_are_too_few_show_nothing_about_effects() {
        let model = Model::base(Robot::amigobot());
        let p = model.initial();
        let with = |variance: f64, tested: usize| {
            let covariance = DMatrix::from_diagonal_element(p.len(), p.len(), variance);
            let (at_bound, windows) = (vec![false; p.len()], 3);
            let (model, p) = (model.clone(), p.clone());
            let base = WindowFit { model, p, cost: 1.0, covariance, at_bound, windows };
            let (ranking, steps, rest) = (vec![], vec![], vec![]);
            Diagnosis { base, ranking, steps, rest, validated: false, tested }
        };
        let of = |variance: f64| of_windows(&with(variance, 30));
        assert_eq!(of(f64::INFINITY), Some(Undetermined::Windows { windows: 3 }));
        assert_eq!(of(1e-6), None);
        let few = Undetermined::Untested { windows: 3, validated: false, fails: Some(2.0) };
        assert_eq!(untested(&with(1e-6, 3), Some(2.0)), Some(few));
        assert_eq!(untested(&with(1e-6, 4), Some(2.0)), None);
    }
}
