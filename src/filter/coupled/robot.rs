//! The robot with a second body as the filter holds it.

use nalgebra::SVector;

use crate::effects::{Jet, Terms};
use crate::filter::ProcessNoise;
use crate::filter::correction::Covariance;
use crate::model::Model;

/// The six states of the rigid robot, body speeds u1, u2, twists phi1, phi2.
pub(super) const STATES: usize = 10;
/// Index of the speeds of the body.
pub(super) const BODY: usize = 6;
/// Index of the twists.
pub(super) const TWIST: usize = 8;

/// A robot of two inertias a wheel.
///
/// ```text
/// J_r dw/dt = M + d - k φ - c (w - u) - friction(w)
/// (A - J_r) du/dt = k φ + c (w - u) - torque(u),   dφ/dt = w - u
/// ```
/// Each part of a step is linearly implicit, x <- x + h (1 - h J/2)⁻¹ f(x) with the Jacobian J of f:
/// of second order and stable for any stiffness. Dry friction is linearised as for the rigid robot
/// and taken fully implicitly.
///
/// Source: [`Coupling`](crate::effects::Coupling); Rosenbrock's method of one stage.
pub(in crate::filter) struct Coupled<'a> {
    pub(super) model: &'a Model,
    pub(super) p: &'a [f64],
    pub(super) noise: ProcessNoise,
    /// Effects that act on the body.
    pub(super) on_body: Vec<bool>,
    /// What every effect adds at the present instant, with derivatives.
    pub(super) terms: Vec<Terms<Jet>>,
    /// Derivatives of stiffness and damping by parameters.
    pub(super) joint: Vec<(usize, [f64; 3])>,
    /// Derivative of the state after the step by each parameter, at the state before it.
    pub(super) forced: Vec<SVector<f64, STATES>>,
    /// Transition matrix of the last step.
    pub(super) transition: Covariance<STATES>,
}
