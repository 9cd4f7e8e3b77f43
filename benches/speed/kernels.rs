//! Straight-line code for the same simulations, as a reference for the least work that they need.

use amigo_ident::model::base::{A1, A2, A3, A4, A5};
use amigo_ident::recording::Recording;
use nalgebra::{SMatrix, SVector};

use super::work::BASE;

/// Equation (14) as straight-line code, by the semi-implicit rule (speeds first, angles from the new
/// speeds), with friction by the sign of the speed. Returns the ISE.
pub(crate) fn kernel(p: &[f64], recording: &Recording) -> f64 {
    let [a1, a2, a3, a4, a5] = [p[A1], p[A2], p[A3], p[A4], p[A5]];
    let inverse = 1.0 / (a1 * a1 - a2 * a2);
    let (t, torque, measured) = (recording.t(), recording.torque(), recording.omega());
    let (mut alpha, mut w, mut sum) = ([0.0; 2], [0.0_f64; 2], 0.0);
    for k in 1..t.len() {
        let h = t[k] - t[k - 1];
        let turn = a3 * (w[1] - w[0]);
        let b1 = 0.5 * (torque[k - 1][0] + torque[k][0]) - turn * w[1] - a4 * sign(w[0]);
        let b2 = 0.5 * (torque[k - 1][1] + torque[k][1]) + turn * w[0] - a5 * sign(w[1]);
        w = [w[0] + h * inverse * (a1 * b1 - a2 * b2), w[1] + h * inverse * (a1 * b2 - a2 * b1)];
        alpha = [alpha[0] + h * w[0], alpha[1] + h * w[1]];
        sum += h * ((measured[k][0] - w[0]).powi(2) + (measured[k][1] - w[1]).powi(2));
    }
    sum + 1e-300 * (alpha[0] + alpha[1])
}

/// The same by Runge-Kutta 4 with the sign at the start of the step and no events.
pub(crate) fn kernel_of_fourth_order(p: &[f64], recording: &Recording) -> f64 {
    let mut sum = 0.0;
    by_fourth_order(p, recording, |_, h, e| sum += h * (e[0] * e[0] + e[1] * e[1]));
    sum
}

/// Calls `see` with every row, the step before it and the error of the speeds there.
#[inline]
fn by_fourth_order(p: &[f64], recording: &Recording, mut see: impl FnMut(usize, f64, [f64; 2])) {
    let [a1, a2, a3, a4, a5] = [p[A1], p[A2], p[A3], p[A4], p[A5]];
    let inverse = 1.0 / (a1 * a1 - a2 * a2);
    let (t, torque, measured) = (recording.t(), recording.torque(), recording.omega());
    let mut w = [0.0_f64; 2];
    for k in 1..t.len() {
        let h = t[k] - t[k - 1];
        let friction = [a4 * sign(w[0]), a5 * sign(w[1])];
        w = fourth_order(w, h, |c, w| {
            let turn = a3 * (w[1] - w[0]);
            let m = between(c, torque[k - 1], torque[k]);
            let b = [m[0] - turn * w[1] - friction[0], m[1] + turn * w[0] - friction[1]];
            [inverse * (a1 * b[0] - a2 * b[1]), inverse * (a1 * b[1] - a2 * b[0])]
        });
        see(k, h, [measured[k][0] - w[0], measured[k][1] - w[1]]);
    }
}

/// The same with the eight effects of [`super::ADDED`].
pub(crate) fn kernel_of_eight(p: &[f64], recording: &Recording) -> f64 {
    let [a1, a2, a3, a4, a5] = [p[A1], p[A2], p[A3], p[A4], p[A5]];
    let (viscous, offset, scrub, drag) = (p[5], [p[6], p[7]], p[8], p[9]);
    let (yaw, caster, lateral) = (p[10], p[11], p[12]);
    let (above, width) = ([p[13] + p[15], p[13] - p[15]], 1.0 / (p[14] * p[14]));
    let (m11, m22) = (a1 + lateral, a1 - lateral);
    let inverse = 1.0 / (m11 * m22 - a2 * a2);
    let (t, torque, measured) = (recording.t(), recording.torque(), recording.omega());
    let (mut w, mut sum) = ([0.0_f64; 2], 0.0);
    for k in 1..t.len() {
        let h = t[k] - t[k - 1];
        let (s1, s2) = (sign(w[0]), sign(w[1]));
        let (turning, forward) = (scrub * sign(w[0] - w[1]), caster * sign(w[0] + w[1]));
        w = fourth_order(w, h, |c, w| {
            let m = between(c, torque[k - 1], torque[k]);
            let (turn, across) = (a3 * (w[1] - w[0]), yaw * (w[0] - w[1]));
            let dry = |i: usize, level: f64| level + above[i] * (-width * w[i] * w[i]).exp();
            let rest = |i: usize| m[i] - offset[i] - viscous * w[i] - drag * w[i] * w[i].abs();
            let b1 = rest(0) - turn * w[1] - across - turning - forward - s1 * dry(0, a4);
            let b2 = rest(1) + turn * w[0] + across + turning - forward - s2 * dry(1, a5);
            [inverse * (m22 * b1 - a2 * b2), inverse * (m11 * b2 - a2 * b1)]
        });
        sum += h * ((measured[k][0] - w[0]).powi(2) + (measured[k][1] - w[1]).powi(2));
    }
    sum
}

/// One classical Runge-Kutta step of the speeds.
#[inline]
fn fourth_order(w: [f64; 2], h: f64, rate: impl Fn(f64, [f64; 2]) -> [f64; 2]) -> [f64; 2] {
    let plus = |h: f64, k: [f64; 2]| [w[0] + h * k[0], w[1] + h * k[1]];
    let k1 = rate(0.0, w);
    let k2 = rate(0.5, plus(0.5 * h, k1));
    let k3 = rate(0.5, plus(0.5 * h, k2));
    let k4 = rate(1.0, plus(h, k3));
    let next = |i: usize| w[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
    [next(0), next(1)]
}

#[inline]
fn between(c: f64, from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    [from[0] + c * (to[0] - from[0]), from[1] + c * (to[1] - from[1])]
}

/// Output error of the speeds as straight-line code: five Gauss-Newton steps with forward differences
/// of the Runge-Kutta kernel. Returns the sum of squares before the last step.
pub(crate) fn output_error_by_differences(recording: &Recording) -> f64 {
    let mut p = BASE.initial();
    p.iter_mut().for_each(|a| *a *= 1.02);
    let errors = |p: &[f64]| {
        let mut errors = vec![[0.0; 2]; recording.len()];
        by_fourth_order(p, recording, |k, _, e| errors[k] = e);
        errors
    };
    let mut sum = f64::NAN;
    for _ in 0..5 {
        let here = errors(&p);
        let columns: Vec<_> = (0..5)
            .map(|j| {
                let mut q = p.clone();
                let h = 1e-6 * p[j].abs();
                q[j] += h;
                let slope = |(a, b): (&[f64; 2], &[f64; 2])| [(a[0] - b[0]) / h, (a[1] - b[1]) / h];
                here.iter().zip(&errors(&q)).map(slope).collect::<Vec<[f64; 2]>>()
            })
            .collect();
        let product = |a: &[[f64; 2]], b: &[[f64; 2]]| {
            a.iter().zip(b).map(|(a, b)| a[0] * b[0] + a[1] * b[1]).sum::<f64>()
        };
        let normal = SMatrix::<f64, 5, 5>::from_fn(|i, j| product(&columns[i], &columns[j]));
        let right = SVector::<f64, 5>::from_fn(|i, _| product(&columns[i], &here));
        sum = product(&here, &here);
        let step = normal.lu().solve(&right).expect("five columns");
        p.iter_mut().zip(step.iter()).for_each(|(a, step)| *a += step);
    }
    sum
}

fn sign(x: f64) -> f64 {
    f64::from(i8::from(x > 0.0) - i8::from(x < 0.0))
}
