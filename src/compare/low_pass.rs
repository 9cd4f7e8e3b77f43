//! Signals of a recording behind a low-pass without phase shift.

use nalgebra::Vector2;

use crate::math::filter::{Extension, butterworth, filter_both_ways, reflected};
use crate::recording::{LocalMotion, Recording};

/// Order of the low-pass; it is applied forwards and backwards.
const ORDER: usize = 2;

/// A signal of both wheels behind a low-pass of that cut-off \[Hz\], piece by piece; pieces that are too short
/// stay as they are.
#[must_use]
pub fn filtered(r: &Recording, cutoff: f64, signal: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut out = signal.to_vec();
    let Ok(sections) = butterworth(ORDER, cutoff, 1.0 / r.step()) else { return out };
    let edge = reflected(&sections);
    for piece in r.pieces() {
        let both: Vec<Vector2<f64>> =
            signal[piece.clone()].iter().map(|v| Vector2::from(*v)).collect();
        if both.len() > edge && both.iter().all(|v| v.iter().all(|v| v.is_finite())) {
            let passed = filter_both_ways(&sections, &both, edge, Extension::Odd);
            out[piece.clone()].iter_mut().zip(passed).for_each(|(v, p)| *v = p.into());
        }
    }
    out
}

/// The motion behind the low-pass: angles and speeds filtered, accelerations by differences.
#[must_use]
pub fn smooth_motion(r: &Recording, cutoff: f64) -> Vec<LocalMotion> {
    let alpha = filtered(r, cutoff, r.alpha());
    let omega = filtered(r, cutoff, r.omega());
    let t = r.t();
    let mut out = vec![LocalMotion::default(); r.len()];
    for piece in r.pieces() {
        for k in piece.clone() {
            let (a, b) = (k.saturating_sub(1).max(piece.start), (k + 1).min(piece.end - 1));
            let acceleration = [0, 1]
                .map(|i| if b > a { (omega[b][i] - omega[a][i]) / (t[b] - t[a]) } else { 0.0 });
            out[k] = LocalMotion { alpha: alpha[k], omega: omega[k], acceleration, ..out[k] };
        }
    }
    out
}
