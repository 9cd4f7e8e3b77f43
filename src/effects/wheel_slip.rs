//! Longitudinal slip of the wheels under traction.

use super::{
    Change, Coupling, Description, Energy, Motion, ParameterSpec, Physics, Scale, geometric,
};
use crate::math::Real;

/// Longitudinal slip proportional to traction.
///
/// ```text
/// jw dw_i + friction = M_i - cs (w_i - u_i)
/// body (a1 - jw, a2, a3) at u = cs (w - u)
/// ```
/// u_i is the speed that wheel i would have without slip, cs the slip stiffness at the wheel (force per slip
/// speed times r^2), jw the inertia of wheel and gear. jw is estimated because the remainder a1 - jw is a
/// small difference, for which construction data are not accurate enough.
///
/// Source: linear creep law of a rolling tyre (small slip at one speed); two-inertia form derived
/// here. The simulation limits jw to less than the smallest inertia of the robot.
#[derive(Clone, Debug, Default)]
pub struct WheelSlip;

impl Physics for WheelSlip {
    fn description(&self) -> Description {
        Description {
            id: "wheel_slip".into(),
            title: "Wheel slip".into(),
            equation: "traction cs (w - u), u the slip-free wheel speed of the body".into(),
            cause: "soft tyre or slippery floor: the contact creeps under traction".into(),
            signature: "the wheel runs ahead of the body when speeding up and lags in braking"
                .into(),
            excitation: "hard starts and brakes, 35 rad/s^2 and more".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let range = (1e-6, 1e6);
        vec![
            ParameterSpec::shape("cs", "slip stiffness at the wheel", "N m s/rad", range, 0.3),
            ParameterSpec::shape("jw", "inertia of wheel and gear", "kg m^2", (1e-9, 1e4), 0.025),
        ]
    }

    fn change(&self) -> Change {
        Change::TwoMass
    }

    /// Slip with time constants from a tenth of the resolution of the sensors to several times that.
    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let mut out = Vec::new();
        for share in [0.2, 0.5, 0.8] {
            let reduced = share * (1.0 - share) * scale.inertia;
            let times = geometric(0.1, 6.0, 6).into_iter();
            out.extend(times.map(|t| vec![reduced * scale.bandwidth / t, share * scale.inertia]));
        }
        out
    }

    /// Slip with a time constant below half a row cannot be distinguished from none. A wheel with its gear
    /// may have nearly all of the inertia, and more than a fit without slip estimates, because the robot
    /// behind the slip moves less.
    fn limits(&self, scale: &Scale) -> Vec<(f64, f64)> {
        let reduced = 0.25 * scale.inertia;
        let stiffness = (1e-2 * reduced / scale.duration, 2.0 * reduced / scale.step);
        vec![stiffness, (0.02 * scale.inertia, 1.5 * scale.inertia)]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn coupling<T: Real>(&self, _x: &Motion<T>, p: &[T]) -> Option<Coupling<T>> {
        Some(Coupling { rotor: p[1], stiffness: T::from(0.0), damping: p[0] })
    }
}

#[cfg(test)]
mod tests {
    use crate::model::Model;
    use crate::model::base::{A1, A2, A4, A5, COUNT};
    use crate::robot::{Robot, State};
    use crate::simulate::{Hold, Input, simulate};

    /// Straight ahead without friction, both wheels pushed with 0.2 N m for 1 s.
    fn pushed(stiffness: f64) -> Vec<State> {
        let model = Model::base(Robot::amigobot()).add("wheel_slip").unwrap();
        let mut p = model.initial();
        (p[A4], p[A5], p[COUNT]) = (0.0, 0.0, stiffness);
        let t: Vec<f64> = (0..101).map(|k| 0.01 * f64::from(k)).collect();
        let torque = vec![[0.2; 2]; 101];
        let input = Input { t: &t, torque: &torque, hold: Hold::Constant };
        simulate(&model, &p, &input, State::default()).unwrap()
    }

    #[test]
    fn a_pushed_robot_slips_as_the_exact_two_inertia_solution() {
        let a = Robot::amigobot().construction.parameters();
        let (wheel, stiffness, push) = (0.025, 0.3, 0.2);
        let body = a.a1 + a.a2 - wheel;
        let rate = stiffness * (1.0 / wheel + 1.0 / body);
        for (k, state) in pushed(stiffness).iter().enumerate() {
            let t = 0.01 * k as f64;
            // slip speed w - u relaxes to push/wheel/rate; momentum wheel w + body u = push t
            let slip = push / wheel / rate * (1.0 - (-rate * t).exp());
            let w = (push * t + body * slip) / (wheel + body);
            // Runge-Kutta, rate times step 0.5 or less: 0.5^5/120 of the slip, decaying
            assert!((state.omega[0] - w).abs() < 1e-4, "{k}: {} {w}", state.omega[0]);
            assert_eq!(state.omega[0], state.omega[1]);
        }
    }

    #[test]
    fn without_slip_the_robot_moves_as_the_rigid_one() {
        let a = Robot::amigobot().construction.parameters();
        let rigid = 0.2 / (a.a1 + a.a2); // w after 1 s
        let found = pushed(20.0)[100].omega[0];
        // slip speed of 0.2 N m body/(wheel + body)/20 N m s/rad = 1.5e-3 rad/s at the most
        assert!((found - rigid).abs() < 2e-3, "{found} {rigid}");
    }

    #[test]
    fn a_robot_lighter_than_its_wheels_of_construction_still_moves() {
        let model = Model::base(Robot::amigobot()).add("wheel_slip").unwrap();
        let mut p = model.initial();
        (p[A1], p[A4], p[A5]) = (0.02, 0.0, 0.0); // a1 below Iz1 = 0.025
        let t: Vec<f64> = (0..101).map(|k| 0.01 * f64::from(k)).collect();
        let torque = vec![[0.2; 2]; 101];
        let input = Input { t: &t, torque: &torque, hold: Hold::Constant };
        let found = simulate(&model, &p, &input, State::default()).unwrap()[100].omega[0];
        // momentum is kept: w exceeds push t/(a1 + a2) by the share of the slip speed, below 2 %
        let rigid = 0.2 / (p[A1] + p[A2]);
        assert!(found > rigid && found < 1.02 * rigid, "{found} {rigid}");
    }

    #[test]
    fn a_released_robot_comes_to_rest_and_stays() {
        for id in ["wheel_slip", "compliance"] {
            let model = Model::base(Robot::amigobot()).add(id).unwrap();
            let t: Vec<f64> = (0..401).map(|k| 0.01 * f64::from(k)).collect();
            let torque: Vec<_> =
                t.iter().map(|&t| if t < 1.0 { [0.3, 0.2] } else { [0.0; 2] }).collect();
            let input = Input { t: &t, torque: &torque, hold: Hold::Constant };
            let motion = simulate(&model, &model.initial(), &input, State::default()).unwrap();
            assert!(motion[100].omega[0] > 3.0, "{id}");
            // 0.125 N m over 0.03 kg m^2 stops 6 rad/s in 1.4 s
            assert!(motion[300..].iter().all(|state| state.omega == [0.0; 2]), "{id}");
        }
    }
}
