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
//! At a constant period the fall is proportional to the acceleration, as is the torque of the inertia, so the motion
//! cannot distinguish the two; it only shows that the input changes at the rows.

use super::plan::{MeasuredRecording, Plan};
use crate::conditioning::{Action, Channel, Finding, Kind};
use crate::diagnose::{Acting, Known, THRESHOLDS, Timing, with_line_of_means};
use crate::recording::{DriveUnit, Recording};
use crate::simulate::Hold;
use crate::study::Role;

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

/// Reports measured torques and currents that change at the rows.
pub(super) fn note_unknown_course(plan: &mut Plan) {
    let is_made = !plan.truth.is_empty();
    if is_made || plan.drive_unit() == DriveUnit::Volt {
        return;
    }
    let (hold, timing) = (plan.hold, plan.timing.ok());
    for m in &mut plan.recordings {
        let step = m.recording.step();
        if !changes_at_rows(hold, timing, step) {
            continue;
        }
        let held = hold == Hold::Constant;
        let kind = Kind::OneSampleARow { half_row_s: 0.5 * step, held };
        let found = |i| Finding { channel: Channel::Input(i), kind, action: Action::Noted };
        m.conditioning.extend([0, 1].map(found));
    }
}

/// Whether the input is held from row to row, or the motion follows the line between its samples half a row late,
/// within an uncertainty that excludes the line itself. A time that a missing effect may cause, which is not corrected, does
/// not show it.
fn changes_at_rows(hold: Hold, timing: Option<Timing>, step: f64) -> bool {
    let half = |timing: Timing| {
        let late = timing.dead_time_s / step;
        let uncertain = THRESHOLDS.uncertain * timing.std_error_s / step;
        let is_shown = timing.correction_s != 0.0;
        is_shown && (late - THRESHOLDS.logging).abs() <= uncertain && late > uncertain
    };
    hold == Hold::Constant || timing.is_some_and(half)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn late(dead_time_s: f64, std_error_s: f64) -> Option<Timing> {
        let correction_s = dead_time_s;
        Some(Timing { dead_time_s, std_error_s, correction_s, ..Timing::default() })
    }

    #[test]
    fn half_a_row_tells_steps_at_the_rows_from_a_line_between_them() {
        let is = |timing| changes_at_rows(Hold::Linear, timing, 0.01);
        assert!(is(late(0.0050, 0.0002)));
        // on the line, later than logging explains, and not known well enough
        for timing in [late(0.0001, 0.0002), late(0.0080, 0.0002), late(0.0050, 0.0040), None] {
            assert!(!is(timing), "{timing:?}");
        }
        // an effect may be missing
        let kept = late(0.0050, 0.0002).map(|timing| Timing { correction_s: 0.0, ..timing });
        assert!(!is(kept));
        assert!(changes_at_rows(Hold::Constant, None, 0.01));
    }
}
