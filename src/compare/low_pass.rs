//! Zero-phase low-pass filtering of the signals of a recording.

use nalgebra::{SVector, Vector2};

use crate::math::filter::{Extension, butterworth, filter_both_ways, filter_within, reflected};
use crate::recording::{LocalMotion, Recording, differentiate};

/// Order of the low-pass; it is applied forwards and backwards.
const ORDER: usize = 2;

/// Signals of both wheels after a low-pass with this cut-off \[Hz\], filtered piece by piece; pieces that are
/// too short are not filtered.
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

/// Number of signals that are filtered simultaneously: each sample depends on the previous one, so that
/// several signals use the processor better.
const TOGETHER: usize = 4;

/// Reusable memory for signals in the filter. It is so large that the operating system would otherwise
/// release and clear it in every call.
#[derive(Default)]
pub struct FilterBuffer {
    four: Vec<SVector<f64, 4>>,
    eight: Vec<SVector<f64, 8>>,
}

/// Replaces signals by the results of [`filtered`], identical to the last bit.
pub fn filter_together(
    r: &Recording,
    cutoff: f64,
    signals: &mut [Vec<[f64; 2]>],
    buffer: &mut FilterBuffer,
) {
    let finite = signals.iter().flatten().flatten().all(|v| v.is_finite());
    for some in signals.chunks_mut(TOGETHER) {
        match some {
            _ if !finite => some.iter_mut().for_each(|s| *s = filtered(r, cutoff, s)),
            [_] | [_, _] => filter_some(r, cutoff, some, &mut buffer.four),
            _ => filter_some(r, cutoff, some, &mut buffer.eight),
        }
    }
}

/// Filters at most `N`/2 finite signals piece by piece.
fn filter_some<const N: usize>(
    r: &Recording,
    cutoff: f64,
    signals: &mut [Vec<[f64; 2]>],
    rows: &mut Vec<SVector<f64, N>>,
) {
    let Ok(sections) = butterworth(ORDER, cutoff, 1.0 / r.step()) else { return };
    let edge = reflected(&sections);
    for piece in r.pieces().iter().filter(|piece| piece.len() > edge) {
        rows.clear();
        rows.resize(piece.len() + 2 * edge, SVector::zeros());
        for (n, signal) in signals.iter().enumerate() {
            for (row, v) in rows[edge..].iter_mut().zip(&signal[piece.clone()]) {
                (row[2 * n], row[2 * n + 1]) = (v[0], v[1]);
            }
        }
        filter_within(&sections, rows, edge, Extension::Odd);
        for (n, signal) in signals.iter_mut().enumerate() {
            for (v, row) in signal[piece.clone()].iter_mut().zip(&rows[edge..]) {
                *v = [row[2 * n], row[2 * n + 1]];
            }
        }
    }
}

/// The low-passed motion: angles and speeds filtered, accelerations by differences.
#[must_use]
pub fn smooth_motion(r: &Recording, cutoff: f64) -> Vec<LocalMotion> {
    let alpha = filtered(r, cutoff, &r.on_lines(r.alpha()));
    let omega = filtered(r, cutoff, &r.on_lines(r.omega()));
    let acceleration = differentiate(r.t(), &omega, r.pieces(), 1);
    let rows = alpha.into_iter().zip(omega).zip(acceleration);
    rows.map(|((alpha, omega), acceleration)| LocalMotion {
        alpha,
        omega,
        acceleration,
        ..LocalMotion::default()
    })
    .collect()
}

#[cfg(test)]
mod together {
    use super::*;
    use crate::recording::{Channels, DriveUnit};

    #[test]
    fn signals_that_pass_together_are_those_that_pass_alone() {
        // a gap in the middle, and a piece that is too short for the filter
        let t: Vec<f64> =
            (0..400).map(|k| 0.01 * f64::from(k + 50 * (k / 200) + 50 * (k / 395))).collect();
        let wave =
            |n: f64| t.iter().map(|t| [(n * t).sin(), (3.0 * n * t).cos()]).collect::<Vec<_>>();
        let channels =
            Channels { alpha: None, omega: Some(wave(1.0)), torque: wave(2.0), t: t.clone() };
        let r = Recording::new("waves", channels, DriveUnit::NewtonMetre).unwrap();
        let mut buffer = FilterBuffer::default();
        for count in 1..=7 {
            let signals: Vec<_> = (0..count).map(|n| wave(2.0 + f64::from(n))).collect();
            let mut together = signals.clone();
            filter_together(&r, 8.0, &mut together, &mut buffer);
            for (signal, found) in signals.iter().zip(&together) {
                assert_eq!(*found, filtered(&r, 8.0, signal));
            }
        }
    }
}
