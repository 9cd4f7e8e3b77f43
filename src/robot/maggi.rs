//! The derivation of the equations of motion, done in numbers: an executable check of eq. (14).
//!
//! With the generalised coordinates q = [x_A, y_A, beta, alpha1, alpha2] and the independent
//! velocities e' = [w1, w2] the Maggi equations are
//!
//! ```text
//! sum_j C_ij L_j = sum_j C_ij Q_j,   L_j = d/dt(dE/dq'_j) - dE/dq_j      (i = 1, 2; j = 1..5)
//! q'_j = sum_i C_ij e'_i + G_j,      L = M(q) q'' + C(q, q') q'
//! ```
//!
//! Here the kinetic energy is written from the velocities of the wheel centres and of S alone,
//! L comes from it by automatic differentiation, and the forces between wheel and floor stay in
//! Q until C makes them vanish. The tests show that this gives (8), (9) and (13)-(15) to
//! rounding, for random states and random construction data.
//!
//! Source: the paper, eq. (1)-(13).
//!
//! Deviations, all of them signs or symbols that the transcription lost; each follows from S
//! lying at A - l2 (cos beta, sin beta), wheel 1 at A + l1 (sin beta, -cos beta), wheel 2 at
//! A - l1 (sin beta, -cos beta):
//! - (7) lacks the factor 1/2 of the kinetic energy; its m4 terms are
//!   `+ m4 l2 sin(beta) beta' x'_A` and `- m4 l2 cos(beta) beta' y'_A`.
//! - (8): `M13 = M31 = + m4 l2 sin(beta)`, `M23 = M32 = - m4 l2 cos(beta)`.
//! - (9): `C13 = + m4 l2 beta' cos(beta)`, `C23 = + m4 l2 beta' sin(beta)`.
//! - (10): the side forces enter Q1 as `- T_P sin(beta)`, Q2 as `+ T_P cos(beta)`;
//!   `Q3 = T_10 l1 - T_20 l1`; friction and T_0 r are subtracted in Q4 and Q5.
//! - (11): `beta' = r/(2 l1) (w1 - w2)`.
//! - (12): the second entry named C22 is `C23 = -r/(2 l1)`.
//! - (13): in both equations `- r³ m4 l2/(4 l1²) w1 w2`, with `+ w2²` in the first and `+ w1²`
//!   in the second; the three last terms of the coefficient a2 are subtracted.

use nalgebra::{Matrix2x5, Matrix5, Vector2, Vector5, matrix};

use super::{Construction, State};
use crate::math::{Dual, Real, sgn};

/// Contact forces between floor and wheel, in the plane of contact.
///
/// Source: the paper, Fig. 2 and eq. (10).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct ContactForce {
    /// Along the rolling direction, T_0 \[N\].
    along: f64,
    /// Along the axle, toward the left, T_P \[N\].
    across: f64,
}

/// Kinetic energy E \[J\] from the velocities of the bodies; the caster's mass is neglected.
///
/// ```text
/// 2 E = m1 v_B² + m2 v_C² + m4 v_S² + (2 Ix1 + Iz4) beta'² + Iz1 (alpha1'² + alpha2'²)
/// ```
///
/// B is the centre of wheel 1, C of wheel 2. Source: the paper, eq. (7), written before
/// expansion; m1 and m2 may differ.
fn kinetic_energy<T: Real>(c: &Construction, q: [T; 5], q_dot: [T; 5]) -> T {
    let [_, _, beta, _, _] = q;
    let [x_dot, y_dot, beta_dot, w1, w2] = q_dot;
    let (sin, cos) = (beta.sin(), beta.cos());
    // velocity of the point at `ahead` along the frame and `left` across it
    let speed_squared = |ahead: f64, left: f64| {
        let x = x_dot - (sin * ahead + cos * left) * beta_dot;
        let y = y_dot + (cos * ahead - sin * left) * beta_dot;
        x.squared() + y.squared()
    };
    (speed_squared(0.0, -c.l1_m) * c.m1_kg
        + speed_squared(0.0, c.l1_m) * c.m2_kg
        + speed_squared(-c.l2_m, 0.0) * c.m4_kg
        + beta_dot.squared() * (2.0 * c.ix1_kg_m2 + c.iz4_kg_m2)
        + (w1.squared() + w2.squared()) * c.iz1_kg_m2)
        * 0.5
}

/// The vector L of eq. (5), straight from the kinetic energy [N, N, N m, N m, N m].
///
/// ```text
/// L_j = d/dt(dE/dq'_j) - dE/dq_j
/// ```
///
/// E is quadratic in q', so dE/dq'_j = (E(q' + u_j) - E(q' - u_j)) / 2 exactly, u_j the unit
/// vector; its rate along the motion (q, q', q'') and dE/dq_j come from dual numbers.
fn lagrange_terms(
    c: &Construction,
    q: [f64; 5],
    q_dot: [f64; 5],
    q_ddot: [f64; 5],
) -> Vector5<f64> {
    let moving = |value: f64, rate: f64| Dual::<1> { value, partial: [rate] };
    let position: [_; 5] = std::array::from_fn(|k| moving(q[k], q_dot[k]));
    let gradient = kinetic_energy(
        c,
        std::array::from_fn(|k| Dual::<5>::variable(q[k], k)),
        q_dot.map(Dual::constant),
    );
    Vector5::from_fn(|j, _| {
        let energy = |shift: f64| {
            let mut velocity: [_; 5] = std::array::from_fn(|k| moving(q_dot[k], q_ddot[k]));
            velocity[j] = velocity[j] + shift;
            kinetic_energy(c, position, velocity)
        };
        let momentum = (energy(1.0) - energy(-1.0)) / 2.0;
        momentum.partial[0] - gradient.partial[j]
    })
}

/// Inertia matrix M(q) of eq. (8), for a heading beta \[rad\]; m1 = m2 as in the paper.
fn inertia_matrix(c: &Construction, beta: f64) -> Matrix5<f64> {
    let (sin, cos) = beta.sin_cos();
    let mass = 2.0 * c.m1_kg + c.m4_kg;
    let s = c.m4_kg * c.l2_m;
    let yaw = 2.0 * c.m1_kg * c.l1_m * c.l1_m + 2.0 * c.ix1_kg_m2 + c.iz4_kg_m2 + s * c.l2_m;
    let iz1 = c.iz1_kg_m2;
    // eq. (8)
    matrix![
        mass,    0.0,      s * sin,  0.0, 0.0;
        0.0,     mass,     -s * cos, 0.0, 0.0;
        s * sin, -s * cos, yaw,      0.0, 0.0;
        0.0,     0.0,      0.0,      iz1, 0.0;
        0.0,     0.0,      0.0,      0.0, iz1
    ]
}

/// Matrix C(q, q') of centrifugal and Coriolis terms of eq. (9), for a heading beta \[rad\] and a
/// turn rate [rad/s].
fn coriolis_matrix(c: &Construction, beta: f64, beta_dot: f64) -> Matrix5<f64> {
    let (sin, cos) = beta.sin_cos();
    let mut coriolis = Matrix5::zeros();
    // eq. (9)
    coriolis[(0, 2)] = c.m4_kg * c.l2_m * beta_dot * cos;
    coriolis[(1, 2)] = c.m4_kg * c.l2_m * beta_dot * sin;
    coriolis
}

/// Generalised forces Q of eq. (10) [N, N, N m, N m, N m].
fn generalised_forces(
    c: &Construction,
    beta: f64,
    omega: [f64; 2],
    torque: [f64; 2],
    contact: [ContactForce; 2],
) -> Vector5<f64> {
    let (sin, cos) = beta.sin_cos();
    let [t1, t2] = contact;
    // eq. (10)
    Vector5::new(
        (t1.along + t2.along) * cos - (t1.across + t2.across) * sin,
        (t1.along + t2.along) * sin + (t1.across + t2.across) * cos,
        (t1.along - t2.along) * c.l1_m,
        torque[0] - c.n1_n * c.f1_m * sgn(omega[0]) - t1.along * c.r_m,
        torque[1] - c.n2_n * c.f2_m * sgn(omega[1]) - t2.along * c.r_m,
    )
}

/// Coefficients C_ij of eq. (12): row i for wheel i, column j for coordinate q_j; all G_j are 0.
fn maggi_coefficients(c: &Construction, beta: f64) -> Matrix2x5<f64> {
    let (sin, cos) = beta.sin_cos();
    let (half, turn) = (c.r_m / 2.0, c.r_m / (2.0 * c.l1_m));
    // eq. (12)
    matrix![
        half * cos, half * sin, turn,  1.0, 0.0;
        half * cos, half * sin, -turn, 0.0, 1.0
    ]
}

/// Rate of the coefficients C_ij along a motion with a turn rate [rad/s].
fn maggi_coefficients_rate(c: &Construction, beta: f64, beta_dot: f64) -> Matrix2x5<f64> {
    let (sin, cos) = beta.sin_cos();
    let half = c.r_m / 2.0 * beta_dot;
    matrix![
        -half * sin, half * cos, 0.0, 0.0, 0.0;
        -half * sin, half * cos, 0.0, 0.0, 0.0
    ]
}

/// A motion that rolls without slip: coordinates, velocities and accelerations.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Motion {
    /// Coordinates [x_A (m), y_A (m), beta (rad), alpha1 (rad), alpha2 (rad)].
    q: [f64; 5],
    /// Velocities q' [m/s, m/s, rad/s, rad/s, rad/s].
    q_dot: [f64; 5],
    /// Accelerations q'' [m/s², m/s², rad/s², rad/s², rad/s²].
    q_ddot: [f64; 5],
}

impl Motion {
    /// The motion of eq. (2) and (11) for a state and wheel accelerations [rad/s²], at x = y = 0.
    ///
    /// ```text
    /// q' = C^T e',  q'' = C^T e'' + (dC/dt)^T e'
    /// ```
    ///
    /// `heading_offset` \[rad\] is added to the heading that the wheel angles give.
    fn rolling(
        c: &Construction,
        state: &State,
        acceleration: [f64; 2],
        heading_offset: f64,
    ) -> Self {
        let turned = c.r_m / (2.0 * c.l1_m) * (state.alpha[0] - state.alpha[1]);
        let beta = heading_offset + turned;
        let coefficients = maggi_coefficients(c, beta);
        let e_dot = Vector2::from(state.omega);
        let q_dot = coefficients.transpose() * e_dot;
        let q_ddot = coefficients.transpose() * Vector2::from(acceleration)
            + maggi_coefficients_rate(c, beta, q_dot[2]).transpose() * e_dot;
        Self {
            q: [0.0, 0.0, beta, state.alpha[0], state.alpha[1]],
            q_dot: q_dot.into(),
            q_ddot: q_ddot.into(),
        }
    }
}

/// Input torques [M1, M2] [N m] from the Maggi equations (4), independent of
/// [`BaseParameters::inverse`](super::BaseParameters::inverse).
///
/// ```text
/// sum_j C_ij L_j - sum_j C_ij Q_j(M = 0) = M_i
/// ```
///
/// The result does not depend on the contact forces, which do no work in rolling without slip, nor on the
/// heading.
fn inverse(
    c: &Construction,
    state: &State,
    acceleration: [f64; 2],
    heading_offset: f64,
    contact: [ContactForce; 2],
) -> [f64; 2] {
    let motion = Motion::rolling(c, state, acceleration, heading_offset);
    let beta = motion.q[2];
    let l = lagrange_terms(c, motion.q, motion.q_dot, motion.q_ddot);
    let q_without_input = generalised_forces(c, beta, state.omega, [0.0; 2], contact);
    (maggi_coefficients(c, beta) * (l - q_without_input)).into()
}

#[cfg(test)]
mod tests;
