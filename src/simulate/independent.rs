//! Simulation against an independent integrator: the equations typed from the paper, Dormand-Prince with
//! events on its continuous extension, and the contact state found by enumeration of all nine.

use super::*;
use crate::math::dormand_prince::DormandPrince;
use crate::model::Model;
use crate::model::base::{A1, A2, A3, A4, A5};
use crate::robot::{Robot, State};

/// a1 .. a5 and a viscous friction [N m s/rad].
struct Typed {
    a: [f64; 5],
    b: f64,
}

/// Motion of a wheel: forward (1), backward (-1), or rest (0).
type Mode = [f64; 2];

impl Typed {
    /// Torques without inertia and dry friction, eq. (14).
    fn driving(&self, w: &[f64; 2], m: [f64; 2]) -> [f64; 2] {
        let [_, _, a3, _, _] = self.a;
        [
            m[0] - a3 * w[1] * (w[1] - w[0]) - self.b * w[0],
            m[1] - a3 * w[0] * (w[0] - w[1]) - self.b * w[1],
        ]
    }

    /// Accelerations with resting wheels held, and the torque that holds each wheel.
    fn motion(&self, mode: &Mode, w: &[f64; 2], m: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let [a1, a2, _, a4, a5] = self.a;
        let q = self.driving(w, m);
        let f = [q[0] - a4 * mode[0], q[1] - a5 * mode[1]];
        let dw = match (mode[0] != 0.0, mode[1] != 0.0) {
            (true, true) => {
                let d = a1 * a1 - a2 * a2;
                [(a1 * f[0] - a2 * f[1]) / d, (a1 * f[1] - a2 * f[0]) / d]
            }
            (true, false) => [f[0] / a1, 0.0],
            (false, true) => [0.0, f[1] / a1],
            (false, false) => [0.0, 0.0],
        };
        (dw, [q[0] - a2 * dw[1], q[1] - a2 * dw[0]])
    }

    /// The one contact state that is consistent with friction and motion.
    fn mode(&self, w: &[f64; 2], m: [f64; 2]) -> Mode {
        let choices =
            |i: usize| if w[i] == 0.0 { vec![0.0, 1.0, -1.0] } else { vec![w[i].signum()] };
        for first in choices(0) {
            for second in choices(1) {
                let mode = [first, second];
                let (dw, held) = self.motion(&mode, w, m);
                let sound = |i: usize| match (w[i] == 0.0, mode[i] == 0.0) {
                    (false, _) => true,
                    (true, true) => held[i].abs() <= self.a[3 + i],
                    (true, false) => dw[i] * mode[i] > 0.0,
                };
                if sound(0) && sound(1) {
                    return mode;
                }
            }
        }
        panic!("no contact state fits speeds {w:?} and torques {m:?}");
    }

    /// Speeds at the ends of intervals with linearly varying torques.
    fn run(&self, knots: &[f64], torques: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let solver = DormandPrince { relative: 1e-12, absolute: 1e-13, max_steps: 100_000 };
        let mut w = [0.0; 2];
        let mut out = vec![w];
        for k in 1..knots.len() {
            let (mut t, end) = (knots[k - 1], knots[k]);
            let at = |t: f64| {
                let c = (t - knots[k - 1]) / (knots[k] - knots[k - 1]);
                [0, 1].map(|i| torques[k - 1][i] + c * (torques[k][i] - torques[k - 1][i]))
            };
            while t < end {
                // shortly after the instant at which a limit is reached, to determine the direction of the
                // motion
                let mode = self.mode(&w, at(t + 1e-9));
                let path = solver.solve(|t, w| self.motion(&mode, w, at(t)).0, t, end, w).unwrap();
                let events = [0, 1].map(|i| {
                    path.first_crossing(|t, w| match mode[i] {
                        0.0 => self.motion(&mode, w, at(t)).1[i].abs() - self.a[3 + i],
                        _ => w[i],
                    })
                });
                let first = if events[1].unwrap_or(end) < events[0].unwrap_or(end) { 1 } else { 0 };
                let next = events[first].unwrap_or(end);
                w = path.at(next);
                if events[first].is_some() && mode[first] != 0.0 {
                    w[first] = 0.0;
                }
                t = next;
            }
            out.push(w);
        }
        out
    }
}

/// Largest difference of speeds at the knots, the simulation stepping `split` times per knot.
fn difference(split: usize) -> (f64, usize) {
    let model = Model::base(Robot::amigobot()).add("viscous_friction").unwrap();
    let mut p = model.initial();
    let b = p.len() - 1;
    p[b] = 0.01;
    let step = 0.04;
    let knots: Vec<f64> = (0..501).map(|k| step * k as f64).collect();
    let input = |t: f64| {
        [0.35 * (2.1 * t).sin() + 0.05, 0.3 * (1.7 * t + 0.4).sin() * (0.3 * t).cos() - 0.02]
    };
    let torques: Vec<[f64; 2]> = knots.iter().map(|&t| input(t)).collect();
    let typed = Typed { a: [p[A1], p[A2], p[A3], p[A4], p[A5]], b: p[b] };
    let truth = typed.run(&knots, &torques);

    let count = 500 * split + 1;
    let t: Vec<f64> = (0..count).map(|n| step * n as f64 / split as f64).collect();
    let torque: Vec<[f64; 2]> = (0..count)
        .map(|n| {
            let (k, c) = ((n / split).min(499), n as f64 / split as f64);
            [0, 1].map(|i| torques[k][i] + (c - k as f64) * (torques[k + 1][i] - torques[k][i]))
        })
        .collect();
    let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
    let motion = simulate(&model, &p, &input, State::default()).unwrap();
    let worst = (0..501)
        .flat_map(|k| (0..2).map(move |i| (k, i)))
        .map(|(k, i)| (motion[k * split].omega[i] - truth[k][i]).abs())
        .fold(0.0, f64::max);
    let still = truth.iter().filter(|w| w.contains(&0.0)).count();
    (worst, still)
}

#[test]
fn stick_and_slip_agree_with_dormand_prince_and_event_location_at_the_order_of_the_method() {
    let (coarse, still) = difference(2);
    let (middle, _) = difference(4);
    let (fine, _) = difference(8);
    assert!((20..480).contains(&still), "wheels stand and turn, {still} of 501 knots standing");
    // steps of 20, 10 and 5 ms; order 4 gains 16 per halving, 12 leaves room for the events
    assert!(coarse < 1e-8, "{coarse:e}");
    assert!(middle < coarse / 12.0 && fine < middle / 12.0, "{coarse:e} {middle:e} {fine:e}");
}
