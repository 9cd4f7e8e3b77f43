//! One part of a step: the acting torques, and the linearly implicit solution.

use nalgebra::{Matrix2, SMatrix, Vector2};

use super::robot::{BODY, Coupled, Part, STATES, Sides, TWIST};
use crate::effects::{Coupling, with_friction};
use crate::filter::correction::{Covariance, Mean};
use crate::filter::friction::Friction;
use crate::filter::sample::Sample;

/// The rows of (w1, w2, u1, u2) in a Jacobian by all states.
type FastRows = SMatrix<f64, 4, STATES>;

impl Sides {
    /// Torque that the couplings pass from the wheels to the body [N m].
    fn passed(&self, x: &Mean<STATES>) -> [f64; 2] {
        let Coupling { stiffness, damping, .. } = self.coupling;
        [0, 1].map(|i| stiffness * x[TWIST + i] + damping * (x[2 + i] - x[BODY + i]))
    }

    /// Inverse inertia of each wheel, none at rest.
    fn free(&self, still: [bool; 2]) -> [f64; 2] {
        still.map(|still| if still { 0.0 } else { 1.0 / self.rotor })
    }
}

impl Coupled<'_> {
    /// One part of length `h` from `x`, over which the slow torques decay by `decay`.
    pub(super) fn part(
        &self,
        sides: &Sides,
        friction: &Friction,
        x: &Mean<STATES>,
        sample: &Sample,
        (h, decay): (f64, f64),
    ) -> Option<Part> {
        let passed = sides.passed(x);
        let free = sides.free(sample.still);
        let resisting = with_friction(sides.wheel_torque, &friction.level, &friction.sign);
        let wheel_acceleration =
            [0, 1].map(|i| (sample.input[i] + x[4 + i] - passed[i] - resisting[i]) * free[i]);
        let on_body = [0, 1].map(|i| passed[i] - sides.body_torque[i]);
        let body_acceleration: [f64; 2] = (sides.mobility * Vector2::from(on_body)).into();
        let mut f = Mean::<STATES>::zeros();
        for i in 0..2 {
            f[i] = if sample.still[i] { 0.0 } else { x[2 + i] };
            f[2 + i] = wheel_acceleration[i];
            f[BODY + i] = body_acceleration[i];
            f[TWIST + i] = x[2 + i] - x[BODY + i];
        }
        let stiff = friction.stiffness();
        let dry =
            Matrix2::from_fn(|i, k| if sample.still[k] { 0.0 } else { stiff[(i, k)] * free[i] });
        let mut fast =
            self.fast_rows(sides, friction, free, &wheel_acceleration, &body_acceleration);
        // friction is implicit over the whole part, the rest over half of it
        let mut of_wheels = fast.fixed_view_mut::<2, 2>(0, 2);
        of_wheels -= dry * 2.0;
        let solve = solve(&fast, sample.still, 0.5 * h)?;
        // x' = x + h S f, S = (1 - h J/2)^-1, and h S J = 2 (S - 1); dry friction was taken twice
        let mut transition = solve * 2.0 - Covariance::<STATES>::identity();
        let columns = solve.fixed_view::<STATES, 2>(0, 2) * dry * h;
        let mut of_wheels = transition.fixed_view_mut::<STATES, 2>(0, 2);
        of_wheels += columns;
        let mut shift = solve * f * h;
        for i in 4..6 {
            transition.row_mut(i).fill(0.0);
            transition[(i, i)] = decay;
            shift[i] = (decay - 1.0) * x[i];
        }
        let mut gain = solve.fixed_view::<STATES, 2>(0, 2) * (h / sides.rotor);
        (0..2).filter(|&i| sample.still[i]).for_each(|i| gain.column_mut(i).fill(0.0));
        let body_gain = solve.fixed_view::<STATES, 2>(0, BODY) * sides.mobility * h;
        Some(Part { transition, gain, body_gain, shift, wheel_acceleration, body_acceleration })
    }

    /// Derivatives of the accelerations of wheels and body, without the slope of dry friction.
    fn fast_rows(
        &self,
        sides: &Sides,
        friction: &Friction,
        free: [f64; 2],
        wheel_acceleration: &[f64; 2],
        body_acceleration: &[f64; 2],
    ) -> FastRows {
        let Coupling { stiffness, damping, .. } = sides.coupling;
        let mut fast = FastRows::zeros();
        // derivatives of the torque on the body with respect to the state
        let mut felt = SMatrix::<f64, 2, STATES>::zeros();
        for i in 0..2 {
            fast[(i, 2 + i)] -= damping * free[i];
            fast[(i, BODY + i)] += damping * free[i];
            fast[(i, TWIST + i)] -= stiffness * free[i];
            fast[(i, 4 + i)] += free[i];
            felt[(i, TWIST + i)] += stiffness;
            felt[(i, 2 + i)] += damping;
            felt[(i, BODY + i)] -= damping;
        }
        self.add_slopes(false, wheel_acceleration, &friction.sign, |i, k, slope| {
            fast[(i, k)] -= slope * free[i];
        });
        self.add_slopes(true, body_acceleration, &[0.0; 4], |i, k, slope| {
            if k < 2 {
                felt[(i, k)] -= slope;
                felt[(i, TWIST + k)] += slope;
            } else {
                felt[(i, BODY + k - 2)] -= slope;
            }
        });
        fast.fixed_view_mut::<2, STATES>(2, 0).copy_from(&(sides.mobility * felt));
        fast
    }
}

/// `(1 - a J)⁻¹` where only the rows `fast` of J, those of (w1, w2, u1, u2), are full: angles and
/// twists integrate speeds, and the slow torques stand.
fn solve(fast: &FastRows, still: [bool; 2], a: f64) -> Option<Covariance<STATES>> {
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
    let mut out = Covariance::<STATES>::identity();
    for (row, [speed, place]) in
        [[2, 0], [3, 1], [BODY, TWIST], [BODY + 1, TWIST + 1]].into_iter().enumerate()
    {
        out.row_mut(speed).copy_from(&speeds.row(row));
        let mut at = out.row_mut(place);
        at += places.row(row);
    }
    Some(out)
}
