//! Gains for the identified robot: feedforward as defined by WPILib, and initial PI and LQR gains for speed
//! control with their margins.

use serde::Serialize;

use super::loop_margins::{Margins, Plant, margins};
use super::mechanics::{LeftOut, Mechanics};
use crate::effects::{Motion, along};
use crate::math::{Line, sgn};
use crate::model::Model;

/// Feedforward `u = kS sgn(v) + kV v + kA dv/dt`; units of the input per m/s (rad/s for turning and wheels).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Feedforward {
    /// Static friction \[input\].
    #[serde(rename = "kS")]
    pub ks: f64,
    /// Per speed.
    #[serde(rename = "kV")]
    pub kv: f64,
    /// Per acceleration.
    #[serde(rename = "kA")]
    pub ka: f64,
}

/// Operating conditions that determine the gains of controllers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Operation {
    /// Top speed of the wheels [rad/s].
    pub top_speed: f64,
    /// Largest input \[input\].
    pub largest_input: f64,
    /// Time at which time-dependent effects are evaluated, the end of the recordings \[s\].
    pub time: f64,
    /// Sampling period of the controller \[s\].
    pub period: f64,
}

/// A PI speed controller, and LQR state feedback, with the margins of the loops.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Control {
    /// Proportional gain [input per speed].
    pub kp: f64,
    /// Integral gain [input per speed and second].
    pub ki: f64,
    /// Margins of the PI loop.
    pub pi_margins: Margins,
    /// State feedback of a discrete LQR, compensated for the dead time [input per speed].
    pub lqr: f64,
    /// Margins of the LQR loop.
    pub lqr_margins: Margins,
}

/// Gains and data for controllers of the identified model.
#[derive(Clone, Debug, PartialEq)]
pub struct Gains {
    /// Of a wheel, driving straight, per rad/s of the wheel.
    pub wheel: Feedforward,
    /// Of a wheel, turning on the spot, per rad/s of the wheel.
    pub wheel_turning: Feedforward,
    /// Driving straight, per m/s.
    pub linear: Feedforward,
    /// Turning on the spot, per rad/s of the robot.
    pub angular: Feedforward,
    /// Largest deviation of the torque curve from the line kS + kV w, straight and turning \[input\].
    pub line_error: [f64; 2],
    /// Dead time of the loop: identified lag and delay, and one period of the controller \[s\].
    pub dead_time: f64,
    /// Control of the forward speed, per m/s.
    pub forward: Control,
    /// Control of the turn rate, per rad/s.
    pub turning: Control,
    /// Effects that the gains do not include.
    pub left_out: Vec<LeftOut>,
}

/// Allowed error for LQR as a share of the top speed (Bryson's rule, judgement).
const ALLOWED: f64 = 0.1;
/// Number of speeds for the line kS + kV w, from a tenth of the top speed.
const SPEEDS: u32 = 19;
/// Number of headings and wheel angles over which torques are averaged.
const ANGLES: u32 = 16;

impl Gains {
    /// Gains of a model with parameter values `p`.
    ///
    /// ```text
    /// kA (straight) = (m11 + 2 m12 + m22)/2,  kA (turning) = (m11 - 2 m12 + m22)/2       [per wheel]
    /// kS + kV w     = line through the mean torque of both wheels, forward less backward, over speed
    /// forward: v = r w;  turning: Ω = r w / l1
    /// PI:  kp = kA/(2 θ), ki = kp / min(kA/kV, 8 θ)
    /// ```
    /// Source: WPILib, "Introduction to Feedforward" and "Drivetrain System Identification"; SIMC rules with
    /// τc = θ (Skogestad, J. Process Control 13 (2003) 291-309).
    #[must_use]
    pub fn of(model: &Model, p: &[f64], operation: &Operation) -> Self {
        let mechanics = Mechanics::of(model, p, operation.time);
        let (r, l1) = (model.robot().r(), model.robot().l1());
        let [m11, m12, m22] = mechanics.mass;
        let dead_time = mechanics.lag_s + mechanics.delay_s + operation.period;
        let mode = |direction: [f64; 2]| {
            let curve = curve(model, p, direction, operation);
            let (ks, kv) = line(&curve);
            let error = |(w, u): &(f64, f64)| (u - ks - kv * w).abs();
            let worst = curve.iter().map(error).fold(0.0, f64::max);
            let ka = 0.5 * (m11 + m22) + direction[0] * direction[1] * m12;
            (Feedforward { ks, kv, ka }, worst)
        };
        let (wheel, straight_error) = mode([1.0, 1.0]);
        let (wheel_turning, turning_error) = mode([1.0, -1.0]);
        let per =
            |f: Feedforward, speed: f64| Feedforward { kv: f.kv / speed, ka: f.ka / speed, ..f };
        let (linear, angular) = (per(wheel, r), per(wheel_turning, r / l1));
        let control = |f: &Feedforward, top: f64| control(f, top, operation, dead_time);
        Self {
            wheel,
            wheel_turning,
            linear,
            angular,
            line_error: [straight_error, turning_error],
            dead_time,
            forward: control(&linear, operation.top_speed * r),
            turning: control(&angular, operation.top_speed * r / l1),
            left_out: not_in_gains(mechanics.left_out, model),
        }
    }
}

/// Effects that the line does not include: those on the input and second masses. Torques of any shape are
/// included.
fn not_in_gains(left_out: Vec<LeftOut>, model: &Model) -> Vec<LeftOut> {
    let acts = |id: &str| {
        let effect = model.effects().iter().find(|e| e.id() == id);
        effect.is_some_and(|e| e.acts_on_input()) || id == coupled(model)
    };
    left_out.into_iter().filter(|l| acts(&l.effect)).collect()
}

fn coupled(model: &Model) -> String {
    model.coupling_effect().map_or(String::new(), |e| model.effects()[e].id())
}

/// Torque at constant speed w along `direction`, the mean of both wheels, forward minus backward, averaged
/// over headings and wheel angles: (w, u), w > 0.
fn curve(model: &Model, p: &[f64], direction: [f64; 2], operation: &Operation) -> Vec<(f64, f64)> {
    let robot = model.robot();
    let holds = |w: f64| -> f64 {
        let omega = direction.map(|d| d * w);
        let mut sum = 0.0;
        for k in 0..ANGLES * ANGLES {
            let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(ANGLES);
            let (turn, roll) = (robot.l1() / robot.r() * angle(k / ANGLES), angle(k % ANGLES));
            let alpha = [roll + turn, roll - turn];
            let x = Motion::at(operation.time, alpha, omega, robot);
            let terms = model.terms(&x, p);
            let sign = std::array::from_fn(|j| sgn(along(j, &omega)));
            let torque = terms.total_torque(&[0.0; 2], &sign);
            sum += 0.5 * (direction[0] * torque[0] + direction[1] * torque[1]);
        }
        sum / f64::from(ANGLES * ANGLES)
    };
    let speed = |k: u32| operation.top_speed * (0.1 + 0.9 * f64::from(k) / f64::from(SPEEDS - 1));
    (0..SPEEDS).map(|k| (speed(k), 0.5 * (holds(speed(k)) - holds(-speed(k))))).collect()
}

/// Least-squares line kS + kV w through points (w, u).
fn line(points: &[(f64, f64)]) -> (f64, f64) {
    let line = Line::through(points.iter().copied());
    (line.at(0.0), line.slope)
}

/// PI by the SIMC rules and LQR by Bryson's rule for `kA dv/dt + kV v = u(t - θ)`.
fn control(f: &Feedforward, top: f64, operation: &Operation, theta: f64) -> Control {
    let plant = Plant { ka: f.ka, kv: f.kv.max(0.0), dead_time: theta };
    let kp = f.ka / (2.0 * theta);
    let integral_time =
        if plant.kv > 0.0 { (f.ka / plant.kv).min(8.0 * theta) } else { 8.0 * theta };
    let ki = kp / integral_time;
    let lqr = lqr(&plant, ALLOWED * top, operation);
    Control {
        kp,
        ki,
        pi_margins: margins(&plant, kp, ki),
        lqr,
        lqr_margins: margins(&plant, lqr, 0.0),
    }
}

/// State feedback of the discrete regulator, compensated for the dead time beyond half a period.
///
/// ```text
/// x+ = a x + b u,   P = q + a² P ρ/(ρ + b² P),   K = a b P/(ρ + b² P),   K (a - b K)^(θ/T)
/// ```
/// q = 1/(allowed error)², ρ = 1/(largest input)². Source: scalar Riccati equation; WPILib,
/// `LinearQuadraticRegulator.latencyCompensate`.
fn lqr(plant: &Plant, allowed: f64, operation: &Operation) -> f64 {
    let t = operation.period;
    let (a, b) = if plant.kv * t < 1e-9 * plant.ka {
        (1.0, t / plant.ka)
    } else {
        let a = (-plant.kv / plant.ka * t).exp();
        (a, (1.0 - a) / plant.kv)
    };
    let (q, rho) = (allowed.powi(-2), operation.largest_input.powi(-2));
    // b² P² + (ρ - q b² - a² ρ) P - q ρ = 0
    let (square, linear) = (b * b, rho - q * b * b - a * a * rho);
    let p = (-linear + (linear * linear + 4.0 * square * q * rho).sqrt()) / (2.0 * square);
    let k = a * b * p / (rho + b * b * p);
    k * (a - b * k).max(0.0).powf(plant.dead_time / t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{Robot, State};
    use crate::simulate::{Hold, Input, simulate};

    const OPERATION: Operation =
        Operation { top_speed: 12.0, largest_input: 1.0, time: 0.0, period: 0.02 };

    fn robot(effects: &[&str]) -> (Model, Vec<f64>) {
        let model = Model::with_effects(Robot::amigobot(), effects).unwrap();
        let p = model.initial();
        (model, p)
    }

    #[test]
    fn gains_of_a_linear_model_are_its_parameters() {
        let (model, p) = robot(&["viscous_friction", "turning_scrub", "slope"]);
        let value = |symbol: &str| p[model.index_of(symbol).unwrap()];
        let gains = Gains::of(&model, &p, &OPERATION);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        let (r, l1) = (0.05, 0.12);
        near(gains.wheel.ks, value("a4"));
        near(gains.wheel_turning.ks, value("a4") + value("f_t"));
        near(gains.linear.kv, value("b") / r);
        near(gains.linear.ka, (value("a1") + value("a2")) / r);
        near(gains.angular.kv, value("b") * l1 / r);
        near(gains.angular.ka, (value("a1") - value("a2")) * l1 / r);
        assert!(gains.line_error.iter().all(|e| *e < 1e-12) && gains.left_out.is_empty());
    }

    #[test]
    fn a_curved_friction_is_a_line_with_its_error_stated() {
        let (model, p) = robot(&["quadratic_drag"]);
        let gains = Gains::of(&model, &p, &OPERATION);
        let drag = p[model.index_of("c").unwrap()];
        // least squares through c w² over [0.1, 1] top: the residual at the ends is that of a parabola
        assert!(
            gains.line_error[0] > 0.05 * drag * 144.0 && gains.line_error[0] < 0.2 * drag * 144.0
        );
        assert!(gains.wheel.kv > drag * 12.0);
    }

    /// Speeds [rad/s] of both wheels under a PI controller with friction feedforward, whose commands are
    /// delayed by `dead_time`.
    fn closed_loop(
        model: &Model,
        p: &[f64],
        control: &Control,
        dead_time: f64,
        goal: f64,
    ) -> Vec<f64> {
        let (step, period) = (1e-3, OPERATION.period);
        let late = (dead_time / step).round() as usize;
        let r = model.robot().r();
        let mut queue = std::collections::VecDeque::from(vec![0.0; late + 1]);
        let (mut state, mut integral, mut command) = (State::default(), 0.0, 0.0);
        let mut out = Vec::new();
        for k in 0..10_000_u32 {
            if k % (period / step).round() as u32 == 0 {
                let error = r * (goal - 0.5 * (state.omega[0] + state.omega[1]));
                integral += control.ki * error * period;
                command = control.kp * error + integral + 0.125;
            }
            queue.push_back(command);
            let u = queue.pop_front().unwrap();
            let (t, torque) = ([0.0, step], [[u; 2]; 2]);
            let input = Input { t: &t, torque: &torque, hold: Hold::Constant };
            let Ok(states) = simulate(model, p, &input, state) else {
                out.push(f64::INFINITY); // the loop has run away
                break;
            };
            state = states[1];
            out.push(state.omega[0]);
        }
        out
    }

    #[test]
    fn the_closed_loop_is_stable_up_to_the_delay_that_the_margin_allows_and_not_beyond() {
        let (model, p) = robot(&["viscous_friction"]);
        let gains = Gains::of(&model, &p, &OPERATION);
        let control = gains.forward;
        // SIMC with τc = θ: gain margin 3.1, phase margin 61 degrees if the integral time is kA/kV
        assert!(
            control.pi_margins.gain > 2.5 && control.pi_margins.phase_deg > 45.0,
            "{control:?}"
        );
        let goal = 6.0;
        let deviation = |extra: f64| {
            // half a period of the dead time is due to the hold of the command itself
            let speeds = closed_loop(&model, &p, &control, 0.5 * OPERATION.period + extra, goal);
            speeds.iter().skip(6000).map(|w| (w - goal).abs()).fold(0.0, f64::max)
        };
        assert!(deviation(0.0) < 1e-3 * goal, "{}", deviation(0.0));
        // the hold is half a period to first order in frequency, so within 10 % of the margin
        let allowed = control.pi_margins.delay_s;
        assert!(deviation(0.85 * allowed) < 0.2 * goal, "{}", deviation(0.85 * allowed));
        assert!(deviation(1.15 * allowed) > 0.5 * goal, "{}", deviation(1.15 * allowed));
    }

    #[test]
    fn the_regulator_solves_the_riccati_equation() {
        let plant = Plant { ka: 0.6, kv: 0.2, dead_time: 1e-12 };
        let k = lqr(&plant, 0.06, &OPERATION);
        // value iteration as an independent computation of the same gain
        let a = (-plant.kv / plant.ka * OPERATION.period).exp();
        let b = (1.0 - a) / plant.kv;
        let (q, rho) = (1.0 / 0.06_f64.powi(2), 1.0);
        let (mut value, mut gain) = (q, 0.0);
        for _ in 0..10_000 {
            gain = a * b * value / (rho + b * b * value);
            value = q + a * a * value - a * b * value * gain;
        }
        assert!((k - gain).abs() < 1e-9 * gain, "{k} {gain}");
    }
}
