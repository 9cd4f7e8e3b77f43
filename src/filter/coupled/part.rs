//! One part of a step: the acting torques, and the linearly implicit solution.

use nalgebra::{Matrix2, SMatrix, SVector};

use super::robot::{BODY, Coupled, STATES, TWIST};
use crate::effects::{Coupling, with_friction};
use crate::filter::correction::Mean;
use crate::filter::friction::Friction;

/// Torques and masses at one instant.
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
    pub(super) transition: SMatrix<f64, STATES, STATES>,
    /// Map of a torque on the wheels.
    pub(super) gain: SMatrix<f64, STATES, 2>,
    /// Map of a torque on the body.
    pub(super) body_gain: SMatrix<f64, STATES, 2>,
    pub(super) shift: SVector<f64, STATES>,
    pub(super) wheel_acceleration: [f64; 2],
    pub(super) body_acceleration: [f64; 2],
}

impl Coupled<'_> {
    /// One part of length `h` from `x`, `input` acting on the wheels.
    pub(super) fn part(
        &self,
        sides: &Sides,
        friction: &Friction,
        x: &Mean<STATES>,
        input: &[f64; 2],
        still: [bool; 2],
        h: f64,
    ) -> Option<Part> {
        let Coupling { stiffness, damping, .. } = sides.coupling;
        let mut f = SVector::<f64, STATES>::zeros();
        let passed = [0, 1].map(|i| stiffness * x[TWIST + i] + damping * (x[2 + i] - x[BODY + i]));
        let on_body = [0, 1].map(|i| passed[i] - sides.body_torque[i]);
        let body_acceleration = sides.mobility * SVector::<f64, 2>::from(on_body);
        let body_acceleration = [body_acceleration[0], body_acceleration[1]];
        let resisting = with_friction(sides.wheel_torque, &friction.level, &friction.sign);
        let stiff = friction.stiffness();
        let mut wheel_acceleration = [0.0; 2];
        // the fast rows, those of (w1, w2, u1, u2), by all states
        let mut fast = SMatrix::<f64, 4, STATES>::zeros();
        let free = |i: usize| if still[i] { 0.0 } else { 1.0 / sides.rotor };
        for i in (0..2).filter(|&i| !still[i]) {
            wheel_acceleration[i] = (input[i] + x[4 + i] - passed[i] - resisting[i]) / sides.rotor;
            f[i] = x[2 + i];
            f[2 + i] = wheel_acceleration[i];
            fast[(i, 2 + i)] -= damping / sides.rotor;
            fast[(i, BODY + i)] += damping / sides.rotor;
            fast[(i, TWIST + i)] -= stiffness / sides.rotor;
            fast[(i, 4 + i)] += 1.0 / sides.rotor;
        }
        self.add_slopes(false, &wheel_acceleration, &friction.sign, |i, k, slope| {
            fast[(i, k)] -= slope * free(i);
        });
        // derivatives of the torque on the body with respect to the state
        let mut felt = SMatrix::<f64, 2, STATES>::zeros();
        for i in 0..2 {
            f[BODY + i] = body_acceleration[i];
            f[TWIST + i] = x[2 + i] - x[BODY + i];
            felt[(i, TWIST + i)] += stiffness;
            felt[(i, 2 + i)] += damping;
            felt[(i, BODY + i)] -= damping;
        }
        self.add_slopes(true, &body_acceleration, &[0.0; 4], |i, k, slope| {
            if k < 2 {
                felt[(i, k)] -= slope;
                felt[(i, TWIST + k)] += slope;
            } else {
                felt[(i, BODY + k - 2)] -= slope;
            }
        });
        fast.fixed_view_mut::<2, STATES>(2, 0).copy_from(&(sides.mobility * felt));
        let mut dry = Matrix2::zeros();
        for i in 0..2 {
            for k in (0..2).filter(|&k| !still[k]) {
                dry[(i, k)] = stiff[(i, k)] * free(i);
                // friction is implicit over the whole part, the rest over half of it
                fast[(i, 2 + k)] -= 2.0 * dry[(i, k)];
            }
        }
        let solve = solve(&fast, still, 0.5 * h)?;
        // x' = x + h S f, S = (1 - h J/2)^-1, and h S J = 2 (S - 1); dry friction was taken twice
        let mut transition = solve * 2.0 - SMatrix::<f64, STATES, STATES>::identity();
        let columns = solve.fixed_view::<STATES, 2>(0, 2) * dry * h;
        let mut of_wheels = transition.fixed_view_mut::<STATES, 2>(0, 2);
        of_wheels += columns;
        let mut gain = solve.fixed_view::<STATES, 2>(0, 2) * (h / sides.rotor);
        (0..2).filter(|&i| still[i]).for_each(|i| gain.column_mut(i).fill(0.0));
        Some(Part {
            transition,
            gain,
            body_gain: solve.fixed_view::<STATES, 2>(0, BODY) * sides.mobility * h,
            shift: solve * f * h,
            wheel_acceleration,
            body_acceleration,
        })
    }
}

/// `(1 - a J)⁻¹` where only the rows `fast` of J, those of (w1, w2, u1, u2), are full: angles and
/// twists integrate speeds, and the slow torques stand.
fn solve(
    fast: &SMatrix<f64, 4, STATES>,
    still: [bool; 2],
    a: f64,
) -> Option<SMatrix<f64, STATES, STATES>> {
    // rows of angles and twists by speeds (w1, w2, u1, u2)
    let mut slow = SMatrix::<f64, 4, 4>::zeros();
    for i in 0..2 {
        slow[(i, i)] = if still[i] { 0.0 } else { a };
        (slow[(2 + i, i)], slow[(2 + i, 2 + i)]) = (a, -a);
    }
    let pick =
        |columns: [usize; 4]| SMatrix::<f64, 4, 4>::from_fn(|i, k| a * fast[(i, columns[k])]);
    let by_speed = pick([2, 3, BODY, BODY + 1]);
    let by_place = pick([0, 1, TWIST, TWIST + 1]);
    let inverse = (SMatrix::<f64, 4, 4>::identity() - by_speed - by_place * slow).try_inverse()?;
    let mut right = fast * a;
    for (row, k) in [2, 3, BODY, BODY + 1].into_iter().enumerate() {
        right.column_mut(k).fill(0.0);
        right[(row, k)] = 1.0;
    }
    let speeds = inverse * right;
    let places = slow * speeds;
    let mut out = SMatrix::<f64, STATES, STATES>::identity();
    for (row, [speed, place]) in
        [[2, 0], [3, 1], [BODY, TWIST], [BODY + 1, TWIST + 1]].into_iter().enumerate()
    {
        out.row_mut(speed).copy_from(&speeds.row(row));
        let mut at = out.row_mut(place);
        at += places.row(row);
    }
    Some(out)
}
