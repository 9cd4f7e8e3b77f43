//! The verdict of a diagnosis: what is missing, with the errors that show it, in plain data and in words.

mod dependence;
mod formula;
mod next;
mod ranking;
mod sentence;
mod series;
mod settled;
mod undetermined;

pub(crate) use self::formula::{curves_of, residual_torques};
pub(crate) use self::sentence::title;
pub(crate) use self::settled::Settled;
use self::undetermined::unless_undetermined;

use self::dependence::{is_most_of_it, most_left, residual_torque};
use self::next::{advice, propose, to_prove};
use self::ranking::{ranking, staircase};
use self::sentence::{Finding, Withheld};
use crate::compare::{Curve, Variable, WindowFloor};
use crate::diagnose::{
    Conclusion, Diagnosis, Judge, Settings, WindowFit, conclude, likely, withheld,
};
use crate::filter::{Likelihood, prepare};
use crate::recording::Recording;
use crate::simulate::{Hold, SimulateError};
use crate::study::{DiagnosisStudy, FormulaStudy, FoundEffect, Verdict, parameters_of};

/// What a verdict rests on beside the diagnosis.
#[derive(Clone, Copy, Debug)]
pub struct Basis<'a> {
    /// The recordings that were fitted.
    pub train: &'a [Recording],
    /// The recordings that no model was fitted to; without any, errors are judged on those that were fitted.
    pub validation: &'a [Recording],
    /// The input between the rows.
    pub hold: Hold,
    /// The false-alarm rate that the diagnosis was asked for.
    pub false_alarm: f64,
    /// Whether the residual torque of the filter contains a slow disturbance.
    pub slow_moment: bool,
    /// Seed of the proposed manoeuvre.
    pub seed: u64,
    /// Whether an estimate of the model as given stalled without an identifiable a1, though the wheels turn against each
    /// other. Unless the diagnosis identifies a1, the columns do not determine the model then.
    pub is_stalled: bool,
}

impl<'a> Basis<'a> {
    /// Of a diagnosis with default settings.
    #[must_use]
    pub fn new(train: &'a [Recording], validation: &'a [Recording], hold: Hold) -> Self {
        let Settings { false_alarm, .. } = Settings::default();
        let (slow_moment, seed, is_stalled) = (true, 0, false);
        Self { train, validation, hold, false_alarm, slow_moment, seed, is_stalled }
    }

    /// The recordings whose error is judged.
    fn judged(&self) -> &'a [Recording] {
        if self.validation.is_empty() { self.train } else { self.validation }
    }
}

/// The verdict of a diagnosis: errors of its first and its last model over the judged recordings against the
/// noise floor, what the residual torque depends on, with a formula of that, and what to record next. Effects that only
/// stand in for such a formula are not found.
///
/// # Errors
/// A model that cannot move, or diverges.
pub fn verdict(diagnosis: &Diagnosis, basis: &Basis) -> Result<DiagnosisStudy, SimulateError> {
    let settled = Settled::of(diagnosis.clone(), basis, None);
    let curves = settled.curves(basis);
    settled.verdict(&curves, basis, None)
}

/// A verdict without what the residual torque depends on.
struct Concluded {
    /// The verdict.
    words: DiagnosisStudy,
    /// Noise floor of the judged recordings under the last model [rad/s].
    floor: f64,
    /// The effect that is likely beside it, in words.
    likely: String,
    /// The variable on which the residual torque of the last model depends significantly.
    depends_on: Option<Variable>,
    /// Whether the last model is far above the noise floor.
    is_far: bool,
}

impl Concluded {
    /// The verdict, taken back where the columns do not determine the model.
    fn unless_undetermined(self, is_undetermined: bool) -> Self {
        Self { words: unless_undetermined(self.words, is_undetermined), ..self }
    }

    /// Whether the verdict says what the residual torque depends on, by its `curves`: where something outside the
    /// catalogue is missing, and where more is missing than was found, by the error or by a variable that shows the
    /// larger part of it.
    fn says_dependence(&self, curves: &[Curve]) -> bool {
        let plainly = || most_left(curves).is_some_and(is_most_of_it);
        match self.words.verdict {
            Verdict::UnknownEffect => !self.words.is_undetermined,
            Verdict::EffectsMissing | Verdict::EffectLikely => self.is_far || plainly(),
            Verdict::ModelSufficient => false,
        }
    }

    /// The verdict with what the residual torque depends on, by its `curves`, where it says so, and with a `formula` of
    /// that, beside which no effect of the catalogue is likely and no recording is needed to decide.
    fn with_dependence(
        self,
        curves: &[Curve],
        basis: &Basis,
        formula: Option<FormulaStudy>,
    ) -> DiagnosisStudy {
        let says = self.says_dependence(curves);
        let Self { words, floor, likely, depends_on, .. } = self;
        let likely = if formula.is_some() { String::new() } else { likely };
        if !says {
            return DiagnosisStudy { sentence: words.sentence + &likely, ..words };
        }
        let depends = residual_torque(curves, depends_on, basis.train[0].drive_unit());
        let sentence = format!("{}{likely} {depends}", words.sentence);
        let Some(formula) = formula else { return DiagnosisStudy { sentence, ..words } };
        DiagnosisStudy {
            sentence: sentence + &formula::words(&formula, floor),
            formula: Some(formula),
            likely: vec![],
            next_run: None,
            proposal: None,
            ..words
        }
    }
}

/// The verdict without what the residual torque depends on; `floor`: that of the judged recordings under the last model,
/// where it is known already.
fn concluded(
    diagnosis: &Diagnosis,
    basis: &Basis,
    floor: Option<WindowFloor>,
) -> Result<Concluded, SimulateError> {
    let likelihood = Likelihood {
        prepared: basis.train.iter().map(prepare).collect(),
        hold: basis.hold,
        slow_moment: basis.slow_moment,
        timing: false,
    };
    let unit = basis.train[0].drive_unit();
    let judge = Judge::new(basis.judged().to_vec(), basis.hold);
    let WindowFit { model, p, .. } = diagnosis.last();
    let floor = floor.unwrap_or_else(|| judge.floor(model, p));
    let before = judge.judge(&diagnosis.base.model, &diagnosis.base.p)?;
    let errors = judge.errors(diagnosis, floor)?;
    let left = judge.structure_left(diagnosis, &likelihood)?;
    let found = diagnosis.found();
    let probable = likely(diagnosis, &errors);
    let leaves = probable.and_then(|r| r.fall).map(|fall| fall.ratio);
    let conclusion = conclude(found.len(), &errors, leaves, left.is_some());
    // where nothing is missing there is nothing to record
    let open = conclusion != Conclusion::Sufficient;
    let proposal = open.then(|| propose(diagnosis, &likelihood, basis.seed)).flatten();
    let withheld = withheld(diagnosis, basis.false_alarm).filter(|_| !open);
    let refit = withheld.and_then(|r| r.refit.as_ref());
    let reason = refit.map(|fit| reason(&judge, errors.after, fit));
    let next_run = match withheld {
        Some(ranked) => Some(to_prove(ranked, matches!(reason, Some(Withheld::BetweenRows)))),
        None => open.then(|| advice(diagnosis, probable, proposal.as_ref())).flatten(),
    };
    let finding = Finding {
        conclusion,
        diagnosis,
        errors: &errors,
        likely: probable,
        withheld,
        reason,
        false_alarm: basis.false_alarm,
        unit,
        if_held: (basis.hold == Hold::Linear)
            .then(|| 0.5 * basis.train.iter().map(Recording::step).fold(0.0, f64::max)),
        speeds_alone: basis.train.iter().all(|r| !r.measured().alpha),
    };
    let estimates = parameters_of(diagnosis.last(), unit).into_iter().map(|p| p.estimate);
    let words = DiagnosisStudy {
        verdict: match conclusion {
            Conclusion::Sufficient => Verdict::ModelSufficient,
            Conclusion::Missing => Verdict::EffectsMissing,
            Conclusion::Likely => Verdict::EffectLikely,
            Conclusion::Unknown => Verdict::UnknownEffect,
        },
        sentence: finding.sentence(),
        found,
        likely: probable.map(|r| r.candidate.id.clone()).into_iter().collect(),
        estimates: estimates.collect(),
        ranking: ranking(diagnosis, &judge, before, floor.expected)?,
        staircase: staircase(diagnosis, &judge, before)?,
        unexplained_fraction: errors.unexplained(),
        next_run,
        proposal,
        false_alarm: basis.false_alarm,
        effects: diagnosis.steps.iter().map(found_effect).collect(),
        formula: None,
        is_undetermined: false,
    };
    let depends_on = left.map(|dependence| dependence.variable);
    let (likely, is_far) = (finding.likely_beside(), errors.far_above_all());
    Ok(Concluded { words, floor: floor.expected, likely, depends_on, is_far })
}

/// Why a fit that lowers the held-out error is not accepted; `now`: square of the error that is shown [rad^2/s^2].
fn reason(judge: &Judge, now: f64, fit: &WindowFit) -> Withheld {
    let with =
        judge.judge(&fit.model, &fit.p).map_or(f64::INFINITY, |with| with.window_rms.powi(2));
    let open = judge.unresolved(&fit.model, &fit.p);
    // one that cannot be simulated raises it too
    if !(with <= now) {
        Withheld::Raises
    } else if fit.model.is_coupled() || now - with < open.powi(2).min(with) {
        Withheld::BetweenRows
    } else {
        Withheld::Small
    }
}

/// An accepted effect in words.
fn found_effect(step: &crate::diagnose::Step) -> FoundEffect {
    let effects = step.fit.model.effects();
    let description = effects.iter().map(|e| e.description()).find(|d| d.id == step.id);
    let (title, cause) = description.map_or_else(Default::default, |d| (d.title, d.cause));
    FoundEffect { id: step.id.clone(), title, cause, indistinguishable: step.equals.clone() }
}
