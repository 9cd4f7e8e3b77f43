//! The masses of a two-mass drivetrain, where they are constant.

use super::sum::Sum;
use crate::effects::Coupling;
use crate::model::inverse_mass;

/// A coupling between constant masses.
#[derive(Clone)]
pub(super) struct Steady {
    pub(super) coupling: Coupling<f64>,
    /// One over the inertia on the measured side.
    pub(super) rotor: f64,
    /// Inverse of the mass matrix behind the coupling.
    pub(super) body: [f64; 3],
}

impl Steady {
    /// The coupling as it is at `x`; `None` if a mass varies or is not positive definite.
    pub(super) fn new(coupling: Option<Coupling<f64>>, wheel: &Sum, body: &Sum) -> Option<Self> {
        let coupling = coupling.filter(|_| body.has_constant_mass())?;
        let (mut wheel, mut body) = (wheel.constant, body.constant);
        coupling.separate(&mut wheel, &mut body);
        let rotor = Some(1.0 / wheel.mass[0]).filter(|share| *share > 0.0)?;
        Some(Self { coupling, rotor, body: inverse_mass(&body.mass).ok()? })
    }
}
