//! What the residual torque depends on.

use crate::compare::{Curve, Variable};
use crate::diagnose::THRESHOLDS;

/// What the residual torque of the last model depends on, as the curves of the report show it.
#[derive(Clone, Debug)]
pub struct DependenceStudy {
    /// The curve that shows most of it, where it shows a part worth naming.
    pub shown: Option<Curve>,
    /// Where that is over what answers every disturbance: the one that shows most over anything else.
    pub beside: Option<Curve>,
    /// The variable on which it depends significantly beside noise that is coloured.
    pub tested: Option<Variable>,
    /// Whether it is what effects that were found leave.
    pub is_left: bool,
}

impl DependenceStudy {
    /// Of the `curves` of a residual torque that depends significantly on `tested`.
    #[must_use]
    pub fn of(curves: &[Curve], tested: Option<Variable>) -> Self {
        let shown = most_left(curves).filter(|curve| curve.left() >= THRESHOLDS.named_share);
        let answers = shown.is_some_and(|curve| curve.variable.answers());
        let beside = answers.then(|| most_pointing(curves)).flatten();
        let is_left = curves.iter().any(|curve| curve.share_after.is_some());
        Self { shown: shown.cloned(), beside: beside.cloned(), tested, is_left }
    }
}

/// The curve that shows most of the residual torque over anything but what answers every disturbance, where it shows a
/// part worth naming.
#[must_use]
pub fn most_pointing(curves: &[Curve]) -> Option<&Curve> {
    let pointing = curves.iter().filter(|curve| !curve.variable.answers());
    let most = pointing.max_by(|a, b| a.left().total_cmp(&b.left()));
    most.filter(|curve| curve.left() >= THRESHOLDS.named_share)
}

/// Whether a single curve shows the larger part of the residual torque of the model as given.
#[must_use]
pub fn is_plain(curves: &[Curve]) -> bool {
    most_left(curves).is_some_and(is_most_of_it)
}

/// Whether a curve is the larger part of the residual torque of the model as given.
#[must_use]
pub fn is_most_of_it(curve: &Curve) -> bool {
    curve.left() >= THRESHOLDS.unexplained
}

/// The curve that shows most of the residual torque that is left.
fn most_left(curves: &[Curve]) -> Option<&Curve> {
    curves.iter().max_by(|a, b| a.left().total_cmp(&b.left()))
}
