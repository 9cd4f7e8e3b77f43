//! The input between the rows, as far as the motion shows it, and torques and currents of which the log has one sample a
//! row while they change at the rows.
//!
//! A motor under a voltage that is held from row to row has a current that falls in between, as the motor gains speed:
//!
//! ```text
//! i(t) = (V_k - k_e w(t))/R
//! mean over the row = i_k - k_e (w_(k+1) - w_k)/(2 R)
//! a1 = a1_true (1 + h/(2 tau)),     tau = a1_true R/(k_t k_e)
//! ```
//!
//! A sample at the end of its row, which is read before the next voltage is written, is below the mean by as much: a1 is then
//! too small.
//!
//! At a constant period the fall is proportional to the acceleration, as is the torque of the inertia, so the motion
//! cannot distinguish the two; it only shows that the input changes at the rows.

use super::plan::{MeasuredRecording, Plan};
use crate::conditioning::{Action, Channel, Finding, Kind, Sampled};
use crate::diagnose::{Acting, Known, THRESHOLDS, Timing, with_line_of_means};
use crate::recording::{DriveUnit, Recording};
use crate::simulate::Hold;
use crate::study::{RecordingStudy, Role};

/// Holds the input until the next row, or, if `correct`, replaces its means by the line with these means, and reports it.
/// Returns the parameters for such an input, or `None` if it is unchanged.
pub(super) fn apply_course(
    plan: &mut Plan,
    Known { acting, p }: Known,
    correct: bool,
) -> Option<Vec<f64>> {
    let step = plan.of(Role::Train).iter().map(Recording::step).fold(0.0, f64::max);
    let of = |channel| match acting {
        Acting::Held => Finding { channel, kind: Kind::HeldInput, action: Action::Used },
        Acting::Mean { shift_s } => {
            let kind = Kind::RowMeans { middle_s: shift_s + 0.5 * step };
            Finding::corrected(channel, kind, "rows", correct)
        }
    };
    for MeasuredRecording { recording, conditioning, .. } in &mut plan.recordings {
        conditioning.extend([0, 1].map(|i| of(Channel::Input(i))));
        if let (Acting::Mean { shift_s }, true) = (acting, correct) {
            *recording = with_line_of_means(recording, shift_s);
        }
    }
    match acting {
        Acting::Held => plan.hold = Hold::Constant,
        Acting::Mean { .. } if !correct => return None,
        Acting::Mean { .. } => {}
    }
    Some(p)
}

/// Reports measured torques and currents that change at the rows. A time that a missing effect may cause, which is not
/// corrected, does not show it.
pub(super) fn note_unknown_course(plan: &mut Plan) {
    let timing = plan.timing.ok().filter(|timing| timing.correction_s != 0.0);
    let found_in = |m: &MeasuredRecording| one_sample_a_row(plan, timing, m.recording.step());
    let found: Vec<_> = plan.recordings.iter().map(found_in).collect();
    for (m, found) in plan.recordings.iter_mut().zip(found) {
        m.conditioning.extend(found.into_iter().flatten());
    }
}

/// The same for the results of a diagnosis, by the time that the model with the effects found gives, which is at the noise
/// floor; `recordings` are those of the plan.
pub(super) fn add_unknown_course(plan: &Plan, recordings: &mut [RecordingStudy], timing: Timing) {
    for (m, study) in plan.recordings.iter().zip(recordings) {
        let is_stated = |f: &Finding| matches!(f.kind, Kind::OneSampleARow { .. });
        if !study.conditioning.iter().any(is_stated) {
            let found = one_sample_a_row(plan, Some(timing), m.recording.step());
            study.conditioning.extend(found.into_iter().flatten());
        }
    }
}

/// The finding on both inputs of a recording with this time from row to row.
fn one_sample_a_row(plan: &Plan, timing: Option<Timing>, step: f64) -> Option<[Finding; 2]> {
    let is_made = !plan.truth.is_empty();
    if is_made || plan.drive_unit() == DriveUnit::Volt {
        return None;
    }
    let sampled = sampled(plan.hold, timing, step)?;
    let kind = Kind::OneSampleARow { half_row_s: 0.5 * step, sampled };
    Some([0, 1].map(|i| Finding { channel: Channel::Input(i), kind, action: Action::Noted }))
}

/// Where in its row a sample of the input is taken that changes at the rows: it is held from row to row, or the motion
/// follows the line between the samples half a row late or early, within an uncertainty that excludes the line itself.
fn sampled(hold: Hold, timing: Option<Timing>, step: f64) -> Option<Sampled> {
    if hold == Hold::Constant {
        return Some(Sampled::Held);
    }
    let Timing { dead_time_s, std_error_s, .. } = timing?;
    let (late, uncertain) = (dead_time_s / step, THRESHOLDS.uncertain * std_error_s / step);
    let is_half = (late.abs() - THRESHOLDS.logging).abs() <= uncertain && late.abs() > uncertain;
    is_half.then_some(if late > 0.0 { Sampled::First } else { Sampled::Last })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn late(dead_time_s: f64, std_error_s: f64) -> Option<Timing> {
        Some(Timing { dead_time_s, std_error_s, ..Timing::default() })
    }

    #[test]
    fn half_a_row_tells_steps_at_the_rows_from_a_line_between_them() {
        let of = |timing| sampled(Hold::Linear, timing, 0.01);
        assert_eq!(of(late(0.0050, 0.0002)), Some(Sampled::First));
        assert_eq!(of(late(-0.0052, 0.0002)), Some(Sampled::Last));
        // on the line, later than logging explains, and not known well enough
        for timing in [late(0.0001, 0.0002), late(0.0080, 0.0002), late(0.0050, 0.0040), None] {
            assert_eq!(of(timing), None, "{timing:?}");
        }
        assert_eq!(sampled(Hold::Constant, None, 0.01), Some(Sampled::Held));
    }
}
