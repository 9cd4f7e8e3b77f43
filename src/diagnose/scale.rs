//! The scale of recordings: the unit of every grid of shapes.

use super::cutoff::cutoff;
use super::thresholds::THRESHOLDS;
use super::windows::mobility;
use crate::effects::{FAST, Motion, Scale, smallest_inertia};
use crate::model::Model;
use crate::recording::{DriveUnit, Recording};

/// Scales of the signals of `recordings` for a model at `p`, and the bandwidth that their noise allows.
#[must_use]
pub fn scale_of(model: &Model, p: &[f64], recordings: &[&Recording]) -> Scale {
    let mut torque: Vec<f64> =
        recordings.iter().flat_map(|r| r.torque().iter().flatten()).map(|m| m.abs()).collect();
    torque.sort_unstable_by(f64::total_cmp);
    let mut speeds: Vec<f64> =
        recordings.iter().flat_map(|r| r.omega().iter().flatten()).map(|w| w.abs()).collect();
    let place = ((speeds.len() - 1) as f64 * FAST) as usize;
    let speed = speeds.select_nth_unstable_by(place, f64::total_cmp).1.max(f64::MIN_POSITIVE);
    let span = |r: &Recording, i: usize| {
        let angles = || r.alpha().iter().map(|a| a[i]);
        angles().fold(f64::MIN, f64::max) - angles().fold(f64::MAX, f64::min)
    };
    let largest =
        |value: &dyn Fn(&Recording) -> f64| recordings.iter().map(|r| value(r)).fold(0.0, f64::max);
    let x = Motion::at(0.0, [0.0; 2], [0.0; 2], model.robot());
    let wheels = |r: &&Recording| r.drive_unit() != DriveUnit::Volt && !r.is_single_axis();
    let held = |e: usize| {
        let own = &model.parameters()[model.slots(e)];
        model.effects()[e].energy().of_the_body() && own.iter().any(|p| p.fixed.is_some())
    };
    Scale {
        speed,
        step: largest(&|r| r.step()),
        logging: largest(&logging),
        duration: largest(&|r| r.duration()),
        angle: largest(&|r| span(r, 0).max(span(r, 1))),
        backward: backward(recordings, speed),
        torque,
        inertia: smallest_inertia(&model.terms(&x, p).mass),
        bandwidth: cutoff(recordings, mobility(model, p)),
        inertia_held: (0..model.effects().len()).any(held),
        two_bodies: recordings.iter().all(wheels),
    }
}

/// Shift of the input that logging explains \[s\]: where the input is held through the rows, and where speeds were
/// recorded alone, which may be differences of angles. Beside angles a difference shows itself, and is corrected.
pub(super) fn logging(recording: &Recording) -> f64 {
    let causes = if recording.measured().alpha { 1.0 } else { 2.0 };
    causes * THRESHOLDS.logging * recording.step()
}

/// Share of the moving rows in which a wheel runs against its main direction; below [`super::Thresholds::backward`]
/// times the top `speed` noise gives a wheel at rest both.
fn backward(recordings: &[&Recording], speed: f64) -> f64 {
    let rows = || recordings.iter().flat_map(|r| r.omega().iter().flatten());
    let ahead = rows().filter(|w| **w > THRESHOLDS.backward * speed).count() as f64;
    let behind = rows().filter(|w| **w < -THRESHOLDS.backward * speed).count() as f64;
    ahead.min(behind) / (ahead + behind).max(1.0)
}
