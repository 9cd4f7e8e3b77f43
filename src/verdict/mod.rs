//! The verdict of a diagnosis: what is missing, with the errors that show it, as plain data.

mod concluded;
mod formula;
mod next;
mod ranking;
mod series;
mod settled;

pub(crate) use self::formula::{curves_of, residual_torques};
pub(crate) use self::settled::Settled;
use crate::diagnose::{Diagnosis, Settings};
use crate::recording::Recording;
use crate::simulate::{Hold, SimulateError};
use crate::study::{DiagnosisStudy, Undetermined};

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
    /// Why the recordings do not determine an estimate of the model as given. If it is the columns, the diagnosis may
    /// identify a1 all the same.
    pub undetermined: Option<Undetermined>,
}

impl<'a> Basis<'a> {
    /// Of a diagnosis with default settings.
    #[must_use]
    pub fn new(train: &'a [Recording], validation: &'a [Recording], hold: Hold) -> Self {
        let Settings { false_alarm, .. } = Settings::default();
        let (slow_moment, seed, undetermined) = (true, 0, None);
        Self { train, validation, hold, false_alarm, slow_moment, seed, undetermined }
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
