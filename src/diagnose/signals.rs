//! What an effect on the input does to the recorded input.

use std::sync::Arc;

use crate::effects::{Change, Effect};
use crate::recording::Recording;

/// The change of the input that an effect on it makes, per unit of its parameter where that is
/// small and smooth (lag, delay, gain), for the whole change otherwise.
pub(super) fn signals(
    effect: &Arc<dyn Effect>,
    p: &[f64],
    linear: &[usize],
    recordings: &[&Recording],
) -> Vec<Vec<[f64; 2]>> {
    recordings
        .iter()
        .map(|recording| {
            let smooth = smoothed_input(recording);
            let (mut q, size) = (p.to_vec(), 1e-3);
            let unit = match linear.first() {
                Some(&j) => {
                    q[j] = size;
                    size
                }
                None if effect.change() == Change::TimeShift => p[effect.time()],
                None => 1.0,
            };
            let changed = effect.input(recording.t(), &smooth, &q).unwrap_or(smooth.clone());
            changed
                .iter()
                .zip(&smooth)
                .map(|(c, s)| [(c[0] - s[0]) / unit, (c[1] - s[1]) / unit])
                .collect()
        })
        .collect()
}

/// The recorded input without its noise: the mean over five samples (two to either side).
pub(super) fn smoothed_input(recording: &Recording) -> Vec<[f64; 2]> {
    let m = recording.torque();
    let mut out = m.to_vec();
    for piece in recording.pieces() {
        for k in piece.clone() {
            let half = 2.min(k - piece.start).min(piece.end - 1 - k);
            let count = (2 * half + 1) as f64;
            out[k] =
                [0, 1].map(|i| m[k - half..=k + half].iter().map(|v| v[i]).sum::<f64>() / count);
        }
    }
    out
}
