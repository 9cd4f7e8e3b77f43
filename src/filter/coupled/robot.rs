//! The robot with a second body as the filter holds it.

use nalgebra::{Matrix2, SMatrix};

use crate::effects::{Coupling, Jet, Terms};
use crate::filter::correction::{Covariance, Mean};
use crate::model::Model;

/// The six states of the rigid robot, body speeds u1, u2, twists phi1, phi2.
pub(super) const STATES: usize = 10;
/// Index of the speeds of the body.
pub(super) const BODY: usize = 6;
/// Index of the twists.
pub(super) const TWIST: usize = 8;

/// Torques and masses at one instant.
#[derive(Clone, Copy)]
pub(super) struct Sides {
    pub(super) coupling: Coupling<f64>,
    pub(super) rotor: f64,
    /// Inverse of the body's mass matrix.
    pub(super) mobility: Matrix2<f64>,
    pub(super) body_torque: [f64; 2],
    pub(super) wheel_torque: [f64; 2],
    pub(super) level: [f64; 4],
}

/// One part of a step.
pub(super) struct Part {
    pub(super) transition: Covariance<STATES>,
    /// Map of a torque on the wheels.
    pub(super) gain: SMatrix<f64, STATES, 2>,
    /// Map of a torque on the body.
    pub(super) body_gain: SMatrix<f64, STATES, 2>,
    pub(super) shift: Mean<STATES>,
    /// At the start of the part [rad/s^2].
    pub(super) wheel_acceleration: [f64; 2],
    pub(super) body_acceleration: [f64; 2],
}

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
    /// Effects that act on the body.
    pub(super) on_body: Vec<bool>,
    /// What every effect adds at the present instant, with derivatives.
    pub(super) terms: Vec<Terms<Jet>>,
    /// Derivatives of stiffness and damping by parameters.
    pub(super) joint: Vec<(usize, [f64; 3])>,
    /// Derivative of the state after the step by each parameter, at the state before it.
    pub(super) forced: Vec<Mean<STATES>>,
    /// Torques and masses where the effects were evaluated last.
    pub(super) sides: Option<Sides>,
    /// The last part of a step.
    pub(super) part: Option<Part>,
    /// Transition matrix of the step so far, and the effect of a torque on the wheels that lasts over it.
    pub(super) transition: Covariance<STATES>,
    pub(super) gain: SMatrix<f64, STATES, 2>,
}
