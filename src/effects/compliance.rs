//! A torsional spring between motor and wheel.

use super::{Coupling, Description, Energy, Motion, ParameterSpec, Physics};
use crate::math::Real;

/// An elastic shaft, belt or tyre between the measured motor side and the rest of the robot.
///
/// ```text
/// Iz1 dw_i + friction = M_i - kt φ_i - dt (w_i - u_i),   dφ_i/dt = w_i - u_i
/// body (a1 - Iz1, a2, a3) at u = kt φ + dt (w - u)
/// ```
/// w is measured, u is the wheel speed behind the spring, φ its twist. Iz1 is the construction's
/// inertia of the wheel with all that turns behind the gear, nearly all of which is on the
/// motor's side.
///
/// Source: two-inertia drive with elastic shaft (Voigt element). Undamped frequency straight
/// ahead: sqrt(kt (1/Iz1 + 1/(a1 + a2 - Iz1))) rad/s.
#[derive(Clone, Debug, Default)]
pub struct Compliance;

impl Physics for Compliance {
    fn description(&self) -> Description {
        Description {
            id: "compliance".into(),
            title: "Compliant drive".into(),
            equation: "kt phi + dt (w - u) between motor side and body, dphi/dt = w - u".into(),
            cause: "elastic shaft, belt or tyre between the encoder and the floor".into(),
            signature: "wheel speed oscillates after steps of the moment".into(),
            excitation: "steps of the moment, a sampling rate well above the oscillation".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let (spring, damper) = ((0.1, 1e3), (1e-4, 20.0));
        vec![
            ParameterSpec::shape("kt", "torsional stiffness", "N m/rad", spring, 5.0),
            ParameterSpec::shape("dt", "torsional damping", "N m s/rad", damper, 0.03),
        ]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn coupling<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Option<Coupling<T>> {
        let rotor = T::from(x.robot.construction.iz1_kg_m2);
        Some(Coupling { rotor, stiffness: p[0], damping: p[1] })
    }
}

#[cfg(test)]
mod tests {
    use crate::model::Model;
    use crate::robot::{Robot, State};
    use crate::simulate::{Hold, Input, simulate};

    #[test]
    fn a_pushed_robot_oscillates_as_the_exact_two_inertia_solution() {
        let robot = Robot::amigobot();
        let a = robot.construction.parameters();
        let model = Model::base(robot).add("compliance").unwrap();
        let mut p = model.initial();
        (p[3], p[4], p[6]) = (0.0, 0.0, 0.0); // no friction, no damping
        let (motor, push, spring) = (0.025, 0.2, p[5]);
        let body = a.a1 + a.a2 - motor;
        let t: Vec<f64> = (0..51).map(|k| 0.01 * f64::from(k)).collect();
        let moment = vec![[push; 2]; 51];
        let input = Input { t: &t, moment: &moment, hold: Hold::Constant };
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
