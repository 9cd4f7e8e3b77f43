//! A two-mass drivetrain as a change of the input, for the score scan.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use super::signals::smoothed_input;
use crate::effects::{Coupling, Effect, Motion, along};
use crate::math::sgn;
use crate::model::Model;
use crate::recording::{LocalMotion, Recording};
use crate::robot::Robot;

/// The model that a candidate would be added to, with its parameters.
pub(super) struct Around {
    pub(super) model: Model,
    pub(super) p: Vec<f64>,
}

/// The coupling of an effect at its parameters `p`, if it has one.
pub(super) fn coupling(
    effect: &Arc<dyn Effect>,
    p: &[f64],
    robot: &Robot,
) -> Option<Coupling<f64>> {
    let (alpha, omega) = ([0.0; 2], [0.0; 2]);
    effect.coupling(&Motion::at(0.0, alpha, omega, robot), p)
}

/// Torques on the wheels of a recording that do not depend on the parameters of the coupling.
pub(super) struct Forces {
    /// Input minus resistance, of the common and the opposite motion [N m].
    modes: Vec<[f64; 2]>,
    /// Mass matrix of the rigid robot [kg m^2].
    mass: [f64; 3],
}

impl Forces {
    pub(super) fn of(around: &Around, recording: &Recording) -> Self {
        let (t, motion) = (recording.t(), recording.local_motion());
        let at = |k: usize| instant(around, t[k] - t[0], &motion[k]);
        // smoothed, because noise of the input would otherwise be in the regressor and in the
        // regressand
        let input = smoothed_input(recording);
        let mode = |k: usize| {
            let [a, b] = acting(around, input[k], &at(k));
            [0.5 * (a + b), 0.5 * (a - b)]
        };
        let mass = around.model.terms(&at(0), &around.p).mass;
        Self { modes: (0..recording.len()).map(mode).collect(), mass }
    }
}

/// The effect of a two-mass drivetrain expressed as a torque on the rigid robot: the torque that would give
/// the rigid robot the acceleration of the wheels, minus the acting torque [N m].
///
/// ```text
/// J_r dw/dt = F - k φ - c (w - u),  (J - J_r) du/dt = k φ + c (w - u),  dφ/dt = w - u
/// signal = J dw/dt - F,   F = M - friction
/// ```
/// for the common and the opposite motion of the wheels (J = m ± m12 of the mass matrix). The centrifugal
/// part is neglected: this is used only to find candidates; their refit is exact.
pub(super) fn joint_signal(
    coupling: Coupling<f64>,
    forces: &Forces,
    recording: &Recording,
) -> Vec<[f64; 2]> {
    let mut out = vec![[0.0; 2]; recording.len()];
    let (t, mass) = (recording.t(), &forces.mass);
    let rotor = coupling.rotor_within(mass);
    let mean = 0.5 * (mass[0] + mass[2]);
    let modes = [mean + mass[1], mean - mass[1]].map(|inertia| Mode { inertia, rotor, coupling });
    for piece in recording.pieces() {
        for (mode, motion) in modes.iter().enumerate() {
            let of_mode = |k: usize| forces.modes[k][mode];
            for (k, change) in piece.clone().zip(motion.changes(t, piece.clone(), of_mode)) {
                out[k][0] += change;
                out[k][1] += if mode == 0 { change } else { -change };
            }
        }
    }
    out
}

/// Torques minus resistance, at a smooth motion [N m].
fn acting(around: &Around, torque: [f64; 2], x: &Motion<f64>) -> [f64; 2] {
    let terms = around.model.terms(x, &around.p);
    let sign = [0, 1, 2, 3].map(|j| sgn(along(j, &x.omega)));
    let resisting = terms.total_torque(&[0.0; 2], &sign);
    [0, 1].map(|i| if x.omega[i] == 0.0 { 0.0 } else { torque[i] - resisting[i] })
}

fn instant<'a>(around: &'a Around, t: f64, m: &LocalMotion) -> Motion<'a, f64> {
    let (alpha, omega, robot) = (m.alpha, m.omega, around.model.robot());
    Motion::at(t, alpha, omega, robot)
}

/// Two inertias on one axis.
struct Mode {
    /// Of both together [kg m^2].
    inertia: f64,
    rotor: f64,
    coupling: Coupling<f64>,
}

impl Mode {
    /// `J dw/dt - F` at every sample of a piece, from no slip and no twist; the force held over each
    /// sample at its mean, which is exact for the slip.
    fn changes(
        &self,
        t: &[f64],
        piece: std::ops::Range<usize>,
        force: impl Fn(usize) -> f64,
    ) -> Vec<f64> {
        let Coupling { stiffness: k, damping: c, .. } = self.coupling;
        let (rotor, body) = (self.rotor, self.inertia - self.rotor);
        let mut x = Vector3::zeros(); // w, u, twist
        let mut known: Option<(f64, Matrix3<f64>, Vector3<f64>)> = None;
        let mut out = Vec::with_capacity(piece.len());
        for j in piece.clone() {
            let passed = k * x[2] + c * (x[0] - x[1]);
            out.push(self.inertia * (force(j) - passed) / rotor - force(j));
            if j + 1 == piece.end {
                break;
            }
            let h = t[j + 1] - t[j];
            let (step, map, push) =
                known.filter(|(step, ..)| (step - h).abs() < 1e-9 * h).unwrap_or_else(|| {
                    let a = Matrix3::new(
                        -c / rotor,
                        c / rotor,
                        -k / rotor,
                        c / body,
                        -c / body,
                        k / body,
                        1.0,
                        -1.0,
                        0.0,
                    );
                    let b = Vector3::new(1.0 / rotor, 0.0, 0.0);
                    // exp of [[a, b], [0, 0]] h gives the map of the state and of a held force
                    let mut whole = nalgebra::Matrix4::zeros();
                    whole.fixed_view_mut::<3, 3>(0, 0).copy_from(&(a * h));
                    whole.fixed_view_mut::<3, 1>(0, 3).copy_from(&(b * h));
                    let e = whole.exp();
                    (
                        h,
                        e.fixed_view::<3, 3>(0, 0).into_owned(),
                        e.fixed_view::<3, 1>(0, 3).into_owned(),
                    )
                });
            known = Some((step, map, push));
            x = map * x + push * (0.5 * (force(j) + force(j + 1)));
        }
        out
    }
}
