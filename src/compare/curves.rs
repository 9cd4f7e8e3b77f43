//! The residual torque as a function of speeds, angles, accelerations, inputs and time.

use super::binning::{Row, as_it_acts};
use super::curve::Curve;
use super::low_pass::smooth_motion;
use super::residual_torque::{motion_of, residual_torque};
use super::split_noise::with_split_noise;
use super::unexplained_torque::Variable;
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::Hold;

/// Length of the blocks whose sums are treated as independent \[s\].
const BLOCK: f64 = 1.0;

/// A model with its [`residual_torque()`] for every recording.
#[derive(Clone, Copy)]
pub struct Unexplained<'a> {
    /// The fitted model.
    pub model: &'a Model,
    /// Values of its parameters.
    pub p: &'a [f64],
    /// The input between the rows.
    pub hold: Hold,
    /// Residual torque, one list per recording [N m].
    pub torque: &'a [Vec<[f64; 2]>],
}

/// The residual torque over every variable, sorted by the share that the variable explains.
///
/// Bins contain equal numbers of rows.
///
/// ```text
/// share = 1 - (RSS₁/(n - k))/(RSS₀/n),   T = n ln(RSS₀/RSS₁) ~ χ²_k,   n = 2 fc T, k means
/// ```
/// n is the number of independent values after a low-pass with cut-off fc over the time T during which the wheels move.
///
/// Over the heading, the wheel angles and time the residual torque r may also act as a resistance or a gain;
/// for each variable the curve that explains most is returned ([`Acting`](super::Acting)):
///
/// ```text
/// r_i = c(x) φ_i,   φ_i = 1, sgn ω_i or M_i;   RSS₀ of the last two with one c for all x
/// ```
///
/// Noise of the speeds enters a measured acceleration and, multiplied by the inertia, the residual torque
/// with the opposite sign. Over its own acceleration the residual torque of a correct model would therefore
/// fall. For the accelerations the speeds are split into two copies with independent noise; one gives the
/// acceleration, the other the residual torque.
#[must_use]
pub fn curves(
    recordings: &[&Recording],
    cutoff: f64,
    before: Unexplained<'_>,
    after: Option<Unexplained<'_>>,
) -> Vec<Curve> {
    let measured = rows(recordings, cutoff, before, after);
    let split: Vec<[Recording; 2]> =
        recordings.iter().enumerate().map(|(n, r)| with_split_noise(r, n as u64)).collect();
    let [of_motion, of_torque] =
        [0, 1].map(|i| split.iter().map(|pair| &pair[i]).collect::<Vec<_>>());
    let again = |u: Unexplained<'_>| -> Vec<Vec<[f64; 2]>> {
        of_torque.iter().map(|r| residual_torque(u.model, u.p, r, u.hold, cutoff)).collect()
    };
    let (torque, torque_after) = (again(before), after.map(again));
    let after_split = after.zip(torque_after.as_deref());
    let independent_noise = rows(
        &of_motion,
        cutoff,
        Unexplained { torque: &torque, ..before },
        after_split.map(|(u, torque)| Unexplained { torque, ..u }),
    );
    let step = recordings.iter().map(|r| r.step()).fold(f64::INFINITY, f64::min);
    let independent = (2.0 * cutoff * step).min(1.0);
    let of = |v: usize| {
        let rows = if Variable::ALL[v].is_acceleration() { &independent_noise } else { &measured };
        as_it_acts(rows, v, independent, after.is_some())
    };
    let mut out: Vec<Curve> = (0..Variable::ALL.len()).filter_map(of).collect();
    out.sort_by(|a, b| b.share_before.total_cmp(&a.share_before));
    out
}

fn rows(
    recordings: &[&Recording],
    cutoff: f64,
    before: Unexplained<'_>,
    after: Option<Unexplained<'_>>,
) -> Vec<Row> {
    let (mut out, mut first_block) = (Vec::new(), 0);
    for (n, recording) in recordings.iter().enumerate() {
        let (t, wheels) = (recording.t(), recording.wheels());
        let block = |k: usize| first_block + ((t[k] - t[0]) / BLOCK) as usize;
        for (k, m) in smooth_motion(recording, cutoff).iter().enumerate() {
            let x = motion_of(before.model, t[k] - t[0], m);
            let value = |v: &Variable| v.at(&x, &m.acceleration, &recording.torque()[k]);
            // both models on the same rows
            let after = after.map(|a| a.torque[n][k]);
            let known = |i: usize| wheels.contains(&i) && after.is_none_or(|a| a[i].is_finite());
            let before = [0, 1].map(|i| if known(i) { before.torque[n][k][i] } else { f64::NAN });
            out.push(Row {
                block: block(k),
                values: std::array::from_fn(|v| value(&Variable::ALL[v])),
                before,
                after: after.unwrap_or([f64::NAN; 2]),
            });
        }
        first_block = block(recording.len() - 1) + 1;
    }
    out
}
