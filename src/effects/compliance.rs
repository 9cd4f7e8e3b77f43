//! A torsional spring between motor and wheel.

use super::effect::SURELY;
use super::{
    Change, Coupling, Description, Energy, Motion, ParameterSpec, Physics, Scale, geometric,
};
use crate::math::Real;
use crate::robot::Robot;

/// An elastic shaft, belt or tyre between the measured motor side and the rest of the robot.
///
/// ```text
/// jr dw_i + friction = M_i - kt φ_i - dt (w_i - u_i),   dφ_i/dt = w_i - u_i
/// body (a1 - jr, a2, a3) at u = kt φ + dt (w - u)
/// ```
/// w is measured, u is the wheel speed behind the spring, φ its twist, jr the inertia on the measured
/// side of the spring (rotor, gear, hub), which no data sheet of the robot gives.
///
/// Source: two-inertia drivetrain with elastic shaft (Voigt element). Undamped frequency straight
/// ahead: sqrt(kt (1/jr + 1/(a1 + a2 - jr))) rad/s.
#[derive(Clone, Debug, Default)]
pub struct Compliance;

/// Damping ratio at which the search for the damping starts.
const DAMPING: f64 = 0.2;

impl Physics for Compliance {
    fn description(&self) -> Description {
        Description {
            id: "compliance".into(),
            title: "Compliant drivetrain".into(),
            equation: "kt phi + dt (w - u) between motor side and body, dphi/dt = w - u".into(),
            cause: "elastic shaft, belt or tyre between the encoder and the floor".into(),
            signature: "wheel speed oscillates after steps of the torque".into(),
            excitation: "steps of the torque, a sampling rate well above the oscillation".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let (spring, damper, rotor) = ((1e-6, 1e6), (1e-9, 1e4), (1e-9, 1e4));
        vec![
            ParameterSpec::shape("kt", "torsional stiffness", "N m/rad", spring, 5.0),
            ParameterSpec::shape("dt", "torsional damping", "N m s/rad", damper, 0.03),
            ParameterSpec::shape("jr", "inertia on the measured side", "kg m^2", rotor, 0.025),
        ]
    }

    fn change(&self) -> Change {
        Change::TwoMass
    }

    /// Undamped frequencies around the bandwidth of the sensors, for three divisions of the inertia.
    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let mut out = Vec::new();
        for share in [0.06, 0.2, 0.45, 0.7] {
            let rotor = share * scale.inertia;
            let reduced = rotor * (1.0 - share);
            for ratio in geometric(0.6, 25.0, 6) {
                let frequency = ratio * scale.bandwidth;
                let damping = 2.0 * DAMPING * frequency * reduced;
                out.push(vec![frequency * frequency * reduced, damping, rotor]);
            }
        }
        out
    }

    /// Frequencies up to half the sampling rate, damping up to critical damping of the stiffest spring, and
    /// divisions of the inertia in which the rotors, gears and wheels have a fiftieth of it at least (hubs of a heavy robot
    /// have a tenth and less) and the body a seventh: beyond these limits the wheels move like those of the rigid robot.
    fn limits(&self, scale: &Scale) -> Vec<(f64, f64)> {
        let reduced = 0.25 * scale.inertia;
        let nyquist = std::f64::consts::PI / scale.step;
        let spring = (1e-6 * reduced * nyquist * nyquist, reduced * nyquist * nyquist);
        let damper = (1e-4 * reduced / scale.step, 2.0 * reduced * nyquist);
        vec![spring, damper, (0.02 * scale.inertia, 0.85 * scale.inertia)]
    }

    /// Without a significant stiffness only a damper remains, which is wheel slip.
    fn is_itself(&self, p: &[f64], errors: &[f64], _robot: &Robot) -> bool {
        p[0] > SURELY * errors[0]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn coupling<T: Real>(&self, _x: &Motion<T>, p: &[T]) -> Option<Coupling<T>> {
        Some(Coupling { rotor: p[2], stiffness: p[0], damping: p[1] })
    }
}

#[cfg(test)]
mod tests {
    use crate::model::Model;
    use crate::model::base::{A4, A5, COUNT};
    use crate::robot::{Robot, State};
    use crate::simulate::{Hold, Input, simulate};

    #[test]
    fn a_pushed_robot_oscillates_as_the_exact_two_inertia_solution() {
        let robot = Robot::amigobot();
        let a = robot.construction.parameters();
        let model = Model::base(robot).add("compliance").unwrap();
        let mut p = model.initial();
        (p[A4], p[A5], p[COUNT + 1]) = (0.0, 0.0, 0.0); // no friction, no damping
        let (motor, push, spring) = (0.025, 0.2, p[COUNT]);
        let body = a.a1 + a.a2 - motor;
        let t: Vec<f64> = (0..51).map(|k| 0.01 * f64::from(k)).collect();
        let torque = vec![[push; 2]; 51];
        let input = Input { t: &t, torque: &torque, hold: Hold::Constant };
        let motion = simulate(&model, &p, &input, State::default()).unwrap();
        let frequency = (spring * (1.0 / motor + 1.0 / body)).sqrt();
        for (t, state) in t.iter().zip(&motion) {
            // rigid motion plus an oscillation of w - u from rest
            let twist_rate = push / motor / frequency * (frequency * t).sin();
            let w = (push * t + body * twist_rate) / (motor + body);
            // Runge-Kutta at frequency times step 0.5 or less: phase error 0.5^5/120 a step
            assert!((state.omega[0] - w).abs() < 2e-3, "{t}: {} {w}", state.omega[0]);
        }
    }
}
