//! The latest dead time that the onset of motion after steps of the input from rest allows.

use std::ops::Range;

use crate::math::{median, quantile};
use crate::recording::Recording;

/// Rows of rest before a step.
const REST: usize = 5;
/// Input that counts as none, and smallest step, as shares of the range of the input.
const NONE: f64 = 0.02;
const STEP: f64 = 0.25;
/// Standard deviations of the noise, and share of the top speed, above which a wheel moves.
const SURE: f64 = 5.0;
const MOVES: f64 = 0.02;

/// Upper limit of the dead time \[s\]: the shortest time from the last row without input to the first of two rows in
/// which a wheel clearly moves in the direction of the input. Friction and sensors delay the onset, so the dead time is not
/// longer. `None` without a step from rest.
pub(super) fn latest_dead_time(recordings: &[&Recording]) -> Option<f64> {
    let all = recordings.iter().flat_map(|r| [0, 1].map(|i| (*r, i)));
    let of = |(r, i): (&Recording, usize)| {
        let pieces = r.pieces().iter();
        let each = pieces.flat_map(|piece| onsets(r, piece, i)).collect::<Vec<_>>();
        each.into_iter().min_by(f64::total_cmp)
    };
    all.filter_map(of).min_by(f64::total_cmp)
}

/// Times from the last row without input of wheel `i` to its onset \[s\].
fn onsets(r: &Recording, piece: &Range<usize>, i: usize) -> Vec<f64> {
    let (t, torque) = (r.t(), r.torque());
    let range = range(r, i);
    let none = |k: usize| torque[k].iter().all(|m| m.abs() <= NONE * range);
    let starts = (piece.start + REST..piece.end)
        .filter(|&k| torque[k][i].abs() > STEP * range && (k - REST..k).all(none));
    let limit = smallest_motion(r, i);
    let moved = |from: usize, k: usize| Some(motion(r, i, from, k)).filter(|m| m.abs() > limit);
    let onset = |k: usize| {
        let way = torque[k][i].signum();
        let moves = |j: &usize| moved(k - 1, *j).is_some_and(|moved| way * moved > 0.0);
        if (k - REST..k).any(|j| moved(k - REST, j).is_some()) {
            return None;
        }
        let first = (k..piece.end - 1).find(|j| moves(j) && moves(&(j + 1)))?;
        Some(t[first] - t[k - 1])
    };
    starts.filter_map(onset).collect()
}

/// The speed of a wheel in row `k`, or its angle since row `from` if only angles are measured.
fn motion(r: &Recording, i: usize, from: usize, k: usize) -> f64 {
    if r.measured().omega { r.omega()[k][i] } else { r.alpha()[k][i] - r.alpha()[from][i] }
}

/// The smallest [`motion`] that is not noise.
fn smallest_motion(r: &Recording, i: usize) -> f64 {
    match r.measured().omega {
        true => smallest_speed(r, i),
        false => SURE * 2.0_f64.sqrt() * r.motion_noise().alpha[i],
    }
}

/// The rows of a recording without those in which a wheel rests under an input of its own: what is needed to break away is
/// not the friction of a moving wheel. Parts of a piece; those too short for a window are left to the caller.
pub(super) fn in_motion(r: &Recording) -> Vec<Range<usize>> {
    let limits = [0, 1].map(|i| (NONE * range(r, i), smallest_speed(r, i)));
    let speed =
        |k: usize| if r.measured().omega { r.omega()[k] } else { r.local_motion()[k].omega };
    let held = |k: &usize| {
        let speed = speed(*k);
        (0..2).any(|i| speed[i].abs() <= limits[i].1 && r.torque()[*k][i].abs() > limits[i].0)
    };
    let parts = |piece: &Range<usize>| {
        let rows: Vec<usize> = piece.clone().collect();
        let runs = rows.chunk_by(|a, b| held(a) == held(b)).filter(|run| !held(&run[0]));
        runs.map(|run| run[0]..run[run.len() - 1] + 1).collect::<Vec<_>>()
    };
    r.pieces().iter().flat_map(parts).collect()
}

/// Range of the input of wheel `i`, without its largest values.
fn range(r: &Recording, i: usize) -> f64 {
    quantile(r.torque().iter().map(|m| m[i].abs()), 0.99)
}

/// The smallest speed of wheel `i` that is not noise \[rad/s\].
fn smallest_speed(r: &Recording, i: usize) -> f64 {
    let noise = match r.measured().omega {
        true => r.motion_noise().omega[i],
        false => median(r.local_motion().iter().map(|m| m.omega_variance[i])).sqrt(),
    };
    (SURE * noise).max(MOVES * r.top_speed())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::recording::{Channels, DriveUnit};
    use crate::robot::{Robot, State};
    use crate::simulate::{Hold, Input, simulate};

    /// An AmigoBot at rest, then with a step of the torque that acts `late` rows after it is recorded.
    fn stepped(late: usize, measured_speed: bool) -> Recording {
        let model = Model::base(Robot::amigobot());
        let t: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        let step = |k: usize, at: usize| if k >= at { [0.4; 2] } else { [0.0; 2] };
        let acting: Vec<[f64; 2]> = (0..200).map(|k| step(k, 50 + late)).collect();
        let input = Input { t: &t, torque: &acting, hold: Hold::Constant };
        let states = simulate(&model, &model.initial(), &input, State::default()).unwrap();
        let omega = states.iter().map(|s| s.omega).collect();
        let channels = Channels {
            t,
            alpha: Some(states.iter().map(|s| s.alpha).collect()),
            omega: measured_speed.then_some(omega),
            torque: (0..200).map(|k| step(k, 50)).collect(),
        };
        Recording::new("step", channels, DriveUnit::NewtonMetre).unwrap()
    }

    #[test]
    fn the_onset_after_a_step_limits_the_dead_time_from_above() {
        for late in [0, 3] {
            for measured_speed in [true, false] {
                let limit = latest_dead_time(&[&stepped(late, measured_speed)]).unwrap();
                let truth = 0.01 * late as f64;
                // the row before the step, the row of the onset, and up to three rows to a clear angle
                assert!((truth..truth + 0.045).contains(&limit), "{late}: {limit}");
            }
        }
    }

    #[test]
    fn rows_of_a_wheel_that_rests_under_its_input_are_not_in_motion() {
        let plain = stepped(3, true);
        // the wheels move from row 53 on, clearly after a few more; before row 50 there is no input that they could resist
        let [rest, moving] = &in_motion(&plain)[..] else { panic!("{:?}", in_motion(&plain)) };
        assert_eq!(*rest, 0..50);
        assert!((53..60).contains(&moving.start) && moving.end == 200, "{moving:?}");
    }
}
