//! The verdict of a diagnosis: what is missing, with the errors that show it, as plain data.

mod concluded;
mod events;
mod formula;
mod next;
mod ranking;
mod series;
mod settled;
mod unrelated;

pub(crate) use self::formula::{curves_of, residual_torques};
pub(crate) use self::settled::Settled;
use crate::diagnose::{Diagnosis, Settings};
use crate::recording::Recording;
use crate::simulate::{Hold, SimulateError};
use crate::study::{DiagnosisStudy, Undetermined};

/// Data for a verdict in addition to the diagnosis.
#[derive(Clone, Copy, Debug)]
pub struct Basis<'a> {
    /// The training recordings.
    pub train: &'a [Recording],
    /// The held-out recordings; if there are none, errors are computed on the training recordings.
    pub validation: &'a [Recording],
    /// The input between the rows.
    pub hold: Hold,
    /// The false-alarm rate of the diagnosis.
    pub false_alarm: f64,
    /// Whether the residual torque of the filter contains a slow disturbance.
    pub slow_moment: bool,
    /// Seed of the proposed manoeuvre.
    pub seed: u64,
    /// Why the recordings do not determine an estimate of the model as given. If the columns are the reason, the
    /// diagnosis may identify a1 nevertheless.
    pub undetermined: Option<Undetermined>,
}

impl<'a> Basis<'a> {
    /// Basis of a diagnosis with default settings.
    #[must_use]
    pub fn new(train: &'a [Recording], validation: &'a [Recording], hold: Hold) -> Self {
        let Settings { false_alarm, .. } = Settings::default();
        let (slow_moment, seed, undetermined) = (true, 0, None);
        Self { train, validation, hold, false_alarm, slow_moment, seed, undetermined }
    }

    /// The recordings on which errors are computed.
    fn judged(&self) -> &'a [Recording] {
        if self.validation.is_empty() { self.train } else { self.validation }
    }
}

/// The verdict of a diagnosis: errors of its first and its last model on the judged recordings compared with
/// the noise floor, the dependence of the residual torque, a formula for it, and recommended recordings.
/// Effects that only approximate such a formula are removed.
///
/// # Errors
/// The mass matrix is not positive definite, or the motion diverges.
pub fn verdict(diagnosis: &Diagnosis, basis: &Basis) -> Result<DiagnosisStudy, SimulateError> {
    let settled = Settled::of(diagnosis.clone(), basis, None);
    let curves = settled.curves(basis);
    settled.verdict(&curves, basis, None)
}
