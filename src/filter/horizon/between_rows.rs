//! Noise due to the unknown input between the rows.

use crate::effects::{Motion, along};
use crate::filter::friction::input_variance;
use crate::filter::prepare::Prepared;
use crate::model::Model;
use crate::simulate::Hold;

/// Friction that may reverse within a row at an unknown time: the smoothed speed along it changes its sign,
/// or is smaller than its change; including one row to either side. Under a held input the time is known.
pub(super) fn crossing(prepared: &Prepared, hold: Hold, model: &Model, p: &[f64]) -> Vec<[f64; 4]> {
    let recording = prepared.recording;
    let motion = recording.local_motion();
    let mut out = vec![[0.0; 4]; recording.len()];
    if hold == Hold::Constant {
        return out;
    }
    for piece in recording.pieces() {
        for k in piece.start + 1..piece.end {
            let (before, after) = (&motion[k - 1].omega, &motion[k].omega);
            let x = Motion::at(
                recording.t()[k] - recording.t()[0],
                motion[k].alpha,
                *after,
                model.robot(),
            );
            let near = |j: usize| {
                let (v, w) = (along(j, before), along(j, after));
                v * w <= 0.0 || v.abs().min(w.abs()) < (w - v).abs()
            };
            if !(0..4).any(near) {
                continue;
            }
            let level = model.terms(&x, p).level;
            for j in (0..4).filter(|&j| near(j)) {
                for row in k.saturating_sub(1).max(piece.start + 1)..(k + 2).min(piece.end) {
                    out[row][j] = level[j].max(0.0).powi(2);
                }
            }
        }
    }
    out
}

/// Standard deviation of the input over a row, including its unknown values between rows [N m]: a step at an unknown
/// time in the row is recorded as a straight line. The mean over the rows of all recordings, so that a recording
/// with steps has the same weight as one with ramps.
///
/// ```text
/// s² = mean (s_M² + max(0, ΔM² - 6 s_M²)/12),   s² = mean s_M² of a held input
/// ```
pub(super) fn whole_noise(prepared: &[Prepared], hold: Hold) -> f64 {
    let unknown = match hold {
        Hold::Constant => 0.0,
        Hold::Linear => 1.0,
    };
    let (mut sum, mut count) = (0.0, 0.0);
    for one in prepared {
        let torque = one.recording.torque();
        for k in one.recording.pieces().iter().flat_map(|piece| piece.start + 1..piece.end) {
            for i in 0..2 {
                sum +=
                    input_variance(one.torque_noise, unknown * (torque[k][i] - torque[k - 1][i]));
                count += 1.0;
            }
        }
    }
    (sum / f64::max(count, 1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::whole_noise;
    use crate::filter::prepare;
    use crate::recording::{Channels, DriveUnit, Recording};
    use crate::simulate::Hold;

    #[test]
    fn steps_and_ramps_have_the_noise_of_their_mean() {
        let recorded = |input: &dyn Fn(usize) -> f64| {
            let t: Vec<f64> = (0..201).map(|k| 0.01 * k as f64).collect();
            let torque = (0..201).map(|k| [input(k); 2]).collect();
            let omega = t.iter().map(|t| [t.sin(), t.cos()]).collect();
            let channels = Channels { t, alpha: None, omega: Some(omega), torque };
            Recording::new("test", channels, DriveUnit::NewtonMetre).unwrap()
        };
        let step = recorded(&|k| if k > 100 { 6.0 } else { 0.0 });
        let ramp = recorded(&|k| 0.25 * k as f64);
        let both = [prepare(&step), prepare(&ramp)];
        // a step of 6 in one of 200 changes, and 0.25 in each of 200, as uniform errors
        let mean_square = 0.5 * (6.0_f64.powi(2) / 200.0 + 0.25_f64.powi(2)) / 12.0;
        let white = 0.5 * both.iter().map(|p| p.torque_noise.powi(2)).sum::<f64>();
        assert!(
            (whole_noise(&both, Hold::Linear).powi(2) / (mean_square + white) - 1.0).abs() < 0.05
        );
        assert!((whole_noise(&both, Hold::Constant).powi(2) - white).abs() < 1e-12 * mean_square);
    }
}
