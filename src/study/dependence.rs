//! Dependence of the residual torque on a variable.

use crate::compare::{Curve, Interval, Variable};
use crate::diagnose::THRESHOLDS;

/// Dependence of the residual torque of the last model, as shown by the curves of the report.
#[derive(Clone, Debug)]
pub struct DependenceStudy {
    /// The curve that explains most of the residual torque, if the share is worth naming.
    pub shown: Option<Curve>,
    /// If its variable responds to every disturbance under feedback control: the curve that explains most
    /// among the other variables.
    pub beside: Option<Curve>,
    /// The variable on which it depends significantly, taking coloured noise into account.
    pub tested: Option<Variable>,
    /// Whether this is the residual torque that remains with the effects found.
    pub is_left: bool,
    /// Where it is larger than any stationary noise explains.
    pub events: Option<Events>,
}

/// Intervals in which the residual torque is larger than any stationary noise explains, at least one.
#[derive(Clone, Debug)]
pub struct Events {
    /// In the order of time, recording by recording.
    pub intervals: Vec<Interval>,
    /// Names of the recordings.
    pub names: Vec<String>,
}

impl Events {
    /// The one with the largest residual torque.
    #[must_use]
    pub fn largest(&self) -> &Interval {
        let size = |interval: &&Interval| interval.torque.abs();
        let all = self.intervals.iter();
        all.max_by(|a, b| size(a).total_cmp(&size(b))).expect("at least one")
    }
}

impl DependenceStudy {
    /// Dependence from the `curves` of a residual torque that depends significantly on `tested`, with its `events`.
    #[must_use]
    pub fn of(curves: &[Curve], tested: Option<Variable>, events: Option<Events>) -> Self {
        let shown = most_left(curves).filter(|curve| curve.left() >= THRESHOLDS.named_share);
        let answers = shown.is_some_and(|curve| curve.variable.answers());
        let beside = answers.then(|| most_pointing(curves)).flatten();
        let is_left = curves.iter().any(|curve| curve.share_after.is_some());
        Self { shown: shown.cloned(), beside: beside.cloned(), tested, is_left, events }
    }
}

/// The curve that explains most of the residual torque among the variables that do not respond to every
/// disturbance, if the share is worth naming.
#[must_use]
pub fn most_pointing(curves: &[Curve]) -> Option<&Curve> {
    let pointing = curves.iter().filter(|curve| !curve.variable.answers());
    let most = pointing.max_by(|a, b| a.left().total_cmp(&b.left()));
    most.filter(|curve| curve.left() >= THRESHOLDS.named_share)
}

/// Whether a single curve explains more than half of the residual torque of the model as given.
#[must_use]
pub fn is_plain(curves: &[Curve]) -> bool {
    most_left(curves).is_some_and(is_most_of_it)
}

/// Whether a curve explains more than half of the residual torque of the model as given.
#[must_use]
pub fn is_most_of_it(curve: &Curve) -> bool {
    curve.left() >= THRESHOLDS.unexplained
}

/// The curve that explains most of the remaining residual torque.
fn most_left(curves: &[Curve]) -> Option<&Curve> {
    curves.iter().max_by(|a, b| a.left().total_cmp(&b.left()))
}
