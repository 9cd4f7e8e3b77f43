//! The latest dead time that the onset of motion after steps of the input from rest allows.

use std::ops::Range;

use super::thresholds::THRESHOLDS;
use crate::math::{median, quantile};
use crate::recording::Recording;

/// Upper limit of the dead time \[s\]: the shortest time from the last row without input to the first of two rows in
/// which a wheel clearly moves in the direction of the input, by its speed or by its angle. Friction and sensors delay
/// the onset, so the dead time is not longer. `None` without a step from rest.
pub(super) fn latest_dead_time(recordings: &[&Recording]) -> Option<f64> {
    let all = recordings.iter().flat_map(|r| [0, 1].map(|i| (*r, i)));
    let of = |(r, i): (&Recording, usize)| {
        let by: Vec<Motion> =
            [Motion::Speed, Motion::Angle].into_iter().filter(|m| m.is_measured(r)).collect();
        let pieces = r.pieces().iter();
        let each = pieces.flat_map(|piece| by.iter().flat_map(|by| onsets(r, piece, i, *by)));
        each.min_by(f64::total_cmp)
    };
    all.filter_map(of).min_by(f64::total_cmp)
}

/// Times from the last row without input of wheel `i` to its onset \[s\]. A recording may begin with a single row of
/// rest: its logger was started with the step.
fn onsets(r: &Recording, piece: &Range<usize>, i: usize, by: Motion) -> Vec<f64> {
    let (t, torque) = (r.t(), r.torque());
    let range = range(r, i);
    let none = |k: usize| torque[k].iter().all(|m| m.abs() <= THRESHOLDS.no_input * range);
    let rest = |k: usize| k.saturating_sub(THRESHOLDS.rest_rows).max(piece.start)..k;
    let first = if piece.start == 0 { 1 } else { piece.start + THRESHOLDS.rest_rows };
    let starts = (first..piece.end)
        .filter(|&k| torque[k][i].abs() > THRESHOLDS.least_step * range && rest(k).all(none));
    let limit = by.smallest(r, i);
    let moved = |from: usize, k: usize| Some(by.of(r, i, from, k)).filter(|m| m.abs() > limit);
    let onset = |k: usize| {
        let way = torque[k][i].signum();
        let moves = |j: &usize| moved(k - 1, *j).is_some_and(|moved| way * moved > 0.0);
        if rest(k).any(|j| moved(rest(k).start, j).is_some()) {
            return None;
        }
        let first = (k..piece.end - 1).find(|j| moves(j) && moves(&(j + 1)))?;
        Some(t[first] - t[k - 1])
    };
    starts.filter_map(onset).collect()
}

/// A channel that shows the motion of a wheel.
#[derive(Clone, Copy)]
enum Motion {
    Speed,
    Angle,
}

impl Motion {
    fn is_measured(self, r: &Recording) -> bool {
        match self {
            Self::Speed => r.measured().omega,
            Self::Angle => r.measured().alpha,
        }
    }

    /// The speed of a wheel in row `k`, or its angle since row `from`.
    fn of(self, r: &Recording, i: usize, from: usize, k: usize) -> f64 {
        match self {
            Self::Speed => r.omega()[k][i],
            Self::Angle => r.alpha()[k][i] - r.alpha()[from][i],
        }
    }

    /// The smallest motion that is not noise.
    fn smallest(self, r: &Recording, i: usize) -> f64 {
        match self {
            Self::Speed => smallest_speed(r, i),
            Self::Angle => THRESHOLDS.moves_errors * 2.0_f64.sqrt() * r.motion_noise().alpha[i],
        }
    }
}

/// The rows of a recording without those in which a wheel rests under an input of its own: what is needed to break away
/// is not the friction of a moving wheel. Parts of a piece; those too short for a window are left to the caller.
pub(super) fn in_motion(r: &Recording) -> Vec<Range<usize>> {
    let limits = [0, 1].map(|i| (THRESHOLDS.no_input * range(r, i), smallest_speed(r, i)));
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
    (THRESHOLDS.moves_errors * noise).max(THRESHOLDS.moves_share * r.top_speed())
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
    fn a_logger_that_starts_with_the_step_limits_the_dead_time_too() {
        let whole = stepped(3, true);
        // one row of rest
        let limit = latest_dead_time(&[&whole.cut(49..200).unwrap()]).unwrap();
        assert!((0.03..0.075).contains(&limit), "{limit}");
        // none: when the input began is not recorded
        assert_eq!(latest_dead_time(&[&whole.cut(50..200).unwrap()]), None);
    }

    #[test]
    fn angles_limit_the_dead_time_beside_speeds_that_are_late() {
        let plain = stepped(0, true);
        // a moving average of a quarter of a second
        let omega = plain.omega();
        let mean = |k: usize| {
            let rows = k.saturating_sub(25)..k + 1;
            let sum = |i: usize| rows.clone().map(|n| omega[n][i]).sum::<f64>() / 26.0;
            [sum(0), sum(1)]
        };
        let late = Channels {
            t: plain.t().to_vec(),
            alpha: Some(plain.alpha().to_vec()),
            omega: Some((0..200).map(mean).collect()),
            torque: plain.torque().to_vec(),
        };
        let late = Recording::new("late", late, DriveUnit::NewtonMetre).unwrap();
        let limit = latest_dead_time(&[&late]).unwrap();
        assert!(limit < 0.045, "{limit}");
    }

    #[test]
    fn rows_of_a_wheel_that_rests_under_its_input_are_not_in_motion() {
        let plain = stepped(3, true);
        // the wheels move from row 53 on, clearly after a few more; before row 50 there is no input that they could
        // resist
        let [rest, moving] = &in_motion(&plain)[..] else { panic!("{:?}", in_motion(&plain)) };
        assert_eq!(*rest, 0..50);
        assert!((53..60).contains(&moving.start) && moving.end == 200, "{moving:?}");
    }
}
