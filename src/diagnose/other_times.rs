//! Whether a recorded input explains the motion better than the input of other times does.

use rayon::prelude::*;

use super::fit::{WindowFit, fit};
use super::judge::Judge;
use super::scale::scale_of;
use super::windows::Windows;
use crate::recording::Recording;
use crate::simulate::Hold;

/// Number of other times: if the input has nothing to do with the motion, the error with it is smaller than with all of
/// them once in twenty.
const OTHER_TIMES: usize = 19;
/// Shifts to these times, as shares of a recording: beyond any delay, from both ends of the record.
const SHARES: (f64, f64) = (0.1, 0.9);

/// Number of 19 other times at which the input explains the motion as well as at its own time: the error over windows
/// of the judged recordings of a model fitted to the `train`ing recordings with it is not larger than that of `own`.
///
/// ```text
/// M_n(k) = M((k + n) mod N),   n = 0.1 N … 0.9 N
/// ```
/// Source: the permutation test, by circular shifts, which keep the spectrum of the input (Fisher 1935).
#[must_use]
pub fn other_times_as_good(
    own: &WindowFit,
    train: &[Recording],
    judge: &Judge,
    hold: Hold,
) -> usize {
    let WindowFit { model, p, .. } = own;
    let Ok(judged) = judge.judge(model, p) else { return OTHER_TIMES };
    let error = |n: usize| {
        let share = SHARES.0 + (SHARES.1 - SHARES.0) * n as f64 / (OTHER_TIMES - 1) as f64;
        let at = |recordings: &[Recording]| -> Vec<Recording> {
            recordings.iter().map(|r| with_input_from(r, share)).collect()
        };
        let there = at(train);
        let recordings: Vec<&Recording> = there.iter().collect();
        let scale = scale_of(model, p, &recordings);
        let windows = Windows::new(recordings, hold, model, p);
        let fitted = fit(&windows, model, p, &scale)?;
        Judge::new(at(&judge.recordings), hold).judge(&fitted.model, &fitted.p).ok()
    };
    let others = (0..OTHER_TIMES).into_par_iter().filter_map(error);
    others.filter(|there| there.window_rms <= judged.window_rms).count()
}

/// A recording with the input of a time later by a `share` of its rows, continued at its start.
fn with_input_from(recording: &Recording, share: f64) -> Recording {
    let mut torque = recording.torque().to_vec();
    let rows = torque.len();
    torque.rotate_left((share * rows as f64).round() as usize % rows);
    recording.with_torque(torque)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::recording::{Channels, DriveUnit};
    use crate::robot::{Robot, State};
    use crate::simulate::{Input, simulate};

    /// 20 s at 50 Hz of an AmigoBot, with the input that drove it or with `another` one.
    fn recording(another: bool) -> Recording {
        let model = Model::base(Robot::amigobot());
        let t: Vec<f64> = (0..1000).map(|k| 0.02 * f64::from(k)).collect();
        let torque = |phase: f64| -> Vec<[f64; 2]> {
            let of =
                |t: f64| [0.35 + 0.25 * (1.7 * t + phase).sin(), 0.35 + 0.25 * (1.1 * t).cos()];
            t.iter().map(|&t| of(t)).collect()
        };
        let drove = torque(0.0);
        let input = Input { t: &t, torque: &drove, hold: Hold::Linear };
        let states = simulate(&model, &model.initial(), &input, State::default()).unwrap();
        let omega = states.iter().map(|s| s.omega).collect();
        let recorded = match another {
            true => drove.iter().rev().copied().collect(),
            false => drove,
        };
        let channels = Channels { t, alpha: None, omega: Some(omega), torque: recorded };
        Recording::new("times", channels, DriveUnit::NewtonMetre).unwrap()
    }

    fn as_good(another: bool) -> usize {
        let r = recording(another);
        let model = Model::base(Robot::amigobot());
        let p = model.initial();
        let recordings = [&r];
        let windows = Windows::new(recordings.to_vec(), Hold::Linear, &model, &p);
        let base = fit(&windows, &model, &p, &scale_of(&model, &p, &recordings)).unwrap();
        let judge = Judge::new(vec![r.clone()], Hold::Linear);
        other_times_as_good(&base, std::slice::from_ref(&r), &judge, Hold::Linear)
    }

    #[test]
    fn the_input_of_no_other_time_drives_a_robot_and_one_of_another_drive_may_be_from_any_time() {
        assert_eq!(as_good(false), 0);
        assert!(as_good(true) > 0);
    }
}
