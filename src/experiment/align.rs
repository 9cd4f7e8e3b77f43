//! Preparation of the training recordings before identification: initial values of shape parameters, and the
//! time of the recorded input.

use super::between_rows::{apply_course, note_unknown_course};
use super::input_time::time_of_input;
use super::plan::{MeasuredRecording, Plan};
use crate::conditioning::{Action, Channel, Finding, Kind, Settings, held_over_lost_rows};
use crate::diagnose::{
    Accounts, AsRecorded, Computed, Course, Judge, LowPass, SpeedFilter, StartAngle, THRESHOLDS,
    Timing, course_of_input, more_likely_logging, phases, shapes_placed, speed_filter,
    start_angles, with_later_input,
};
use crate::effects::Cycle;
use crate::filter::{noise_of_jumps, rest_noise};
use crate::identify::{Task, start};
use crate::model::base::{A1, A2};
use crate::recording::{DriveUnit, Recording, SlowNoise};
use crate::simulate::Hold;
use crate::study::Role;

/// Sets the initial values of the model's shape parameters; for recordings that are read block by block they
/// keep their typical values.
pub(super) fn place(plan: &mut Plan) {
    if plan.recordings.iter().all(|m| m.long.is_none()) {
        plan.model = shapes_placed(&plan.model, &plan.of(Role::Train), plan.hold);
    }
}

/// For effects whose equations contain inertias of the robot, sets these to values estimated from the
/// training recordings without the effects, if the construction is not known in the unit of the input.
pub(super) fn weigh(plan: &mut Plan, is_built: bool) {
    let torques =
        plan.recordings.iter().all(|m| m.recording.drive_unit() == DriveUnit::NewtonMetre);
    let long = plan.recordings.iter().any(|m| m.long.is_some());
    if is_built && torques || long {
        return;
    }
    if let Some(p) = balanced(plan).filter(|p| p[A1] > p[A2].abs()) {
        plan.model = plan.model.with_inertia_of(&p);
    }
}

/// Settings that the file may leave to be determined from the data.
#[derive(Clone, Copy)]
pub(super) struct Asked {
    /// The input between the rows, if specified in the file.
    pub(super) hold: Option<Hold>,
    /// Enabled corrections.
    pub(super) settings: Settings,
}

/// Corrects the effects of the logger on the recordings as far as the motion reveals them: a low-pass of the
/// speeds, the time of the input, and the share of noise in its differences from row to row. The dead time
/// that is common to all recordings, and the low-pass, which resembles one, are left to a model that has a
/// time shift itself.
pub(super) fn align(plan: &mut Plan, asked: &Asked) {
    if plan.recordings.iter().any(|m| m.long.is_some()) {
        return;
    }
    let own = plan.model.shifts_input();
    let Some(mut start) = balanced(plan) else { return };
    let mut share = share_of_noise(plan, &start);
    // another input between the rows that explains the motion as well
    let mut other = None;
    if !own {
        if let Some(moved) = by_other_account(plan, &start, share, asked.settings) {
            start = moved;
            share = share_of_noise(plan, &start);
        }
        if asked.hold.is_none() {
            match course(plan, &start, share) {
                Course::Known(known) => {
                    if let Some(fitted) = apply_course(plan, known, asked.settings.rows) {
                        start = fitted;
                        // the share of noise that was assumed for linear interpolation
                        share = share_of_noise(plan, &start);
                    }
                }
                Course::LineOrHeld => other = plan.truth.is_empty().then_some(Hold::Constant),
                Course::Line => {}
            }
        }
    }
    if plan.hold == Hold::Constant {
        over_lost_rows(plan, asked.settings.rows);
    }
    if asked.settings.rows {
        in_phase(plan, &start, share);
    }
    if !own {
        plan.timing = time_of_input(plan, &start).map(|timing| {
            let is_held = plan.hold == Hold::Constant && timing.is_early();
            Timing { other: if is_held { Some(Hold::Linear) } else { other }, ..timing }
        });
        share = plan.timing.ok().and_then(|timing| share_in_time(plan, &timing)).unwrap_or(share);
    }
    note_unknown_course(plan);
    plan.recordings.iter_mut().for_each(|m| m.recording.set_noise_of_jumps(share));
    count_noise_at_rest(plan, &start);
    apply_timing(plan);
    if asked.settings.starts {
        start_alike(plan);
    }
}

/// Corrects what the logger did to the speeds and to the input between the rows. Returns the parameters for the changed
/// recordings, or `None` if they are unchanged.
fn by_other_account(
    plan: &mut Plan,
    start: &[f64],
    share: f64,
    settings: Settings,
) -> Option<Vec<f64>> {
    let train = train_with_noise(plan, share);
    let recordings: Vec<&Recording> = train.iter().collect();
    let given = AsRecorded::new(&plan.model, start, &recordings, plan.hold);
    as_logged(plan, &given, settings).or_else(|| unfiltered(plan, &given, start, settings.speeds))
}

/// The input between its rows, by the motion of the training recordings.
fn course(plan: &Plan, start: &[f64], share: f64) -> Course {
    let train = train_with_noise(plan, share);
    let recordings: Vec<&Recording> = train.iter().collect();
    course_of_input(&AsRecorded::new(&plan.model, start, &recordings, Hold::Linear))
}

/// Shifts the inputs by the part of their time that logging explains; the uncertainty of this time is part of the
/// noise.
fn apply_timing(plan: &mut Plan) {
    let Ok(timing) = plan.timing else { return };
    for MeasuredRecording { recording, .. } in &mut plan.recordings {
        recording.set_input_time_error(time_error(&timing, recording.step()));
        if timing.correction_s != 0.0 {
            *recording = with_later_input(recording, timing.correction_s, plan.hold);
        }
    }
}

/// Replaces held inputs by their mean until the next row where rows were lost, if `correct`, and reports this.
fn over_lost_rows(plan: &mut Plan, correct: bool) {
    for MeasuredRecording { recording, conditioning, .. } in &mut plan.recordings {
        let Some((mean, rows)) = held_over_lost_rows(recording.t(), recording.torque()) else {
            continue;
        };
        let lost =
            |i| Finding::corrected(Channel::Input(i), Kind::LostRows { rows }, "rows", correct);
        conditioning.extend([0, 1].map(lost));
        if correct {
            *recording = recording.with_torque(mean);
        }
    }
}

/// Standard error of the time of an input \[s\] from its measurement and from logging, by which it is anywhere in its
/// row of `step` seconds.
///
/// ```text
/// 1/s² = 1/se² + 12/h²
/// ```
fn time_error(timing: &Timing, step: f64) -> f64 {
    (timing.std_error_s.powi(-2) + 12.0 / (step * step)).sqrt().recip()
}

/// Ratio of the error that noise of the input would cause to the observed error above which the latter refutes it: the
/// noise is known to a third, and the observed error contains that of the model too.
const REFUTED: f64 = 2.0;

/// Treats fluctuations of the recorded inputs at rest as noise of their sensors, and reports this, unless they are a
/// command, which friction holds: the input is held between its rows, or the model at `start` simulates the motion better
/// than such noise would allow.
fn count_noise_at_rest(plan: &mut Plan, start: &[f64]) {
    if plan.hold == Hold::Constant {
        return;
    }
    let recordings: Vec<&Recording> = plan.recordings.iter().map(|m| &m.recording).collect();
    let noise = rest_noise(&recordings);
    if noise.iter().all(|n| n.sigma == 0.0) {
        return;
    }
    let mut train = plan.of(Role::Train);
    train.iter_mut().for_each(|r| r.set_slow_input_noise(noise));
    let judge = Judge::new(train, plan.hold);
    let expected = judge.floor(&plan.model, start).slow;
    if judge.judge(&plan.model, start).is_ok_and(|seen| REFUTED * seen.window_rms < expected) {
        return;
    }
    let found = [0, 1].into_iter().filter(|&i| noise[i].sigma > 0.0).map(|i| {
        let SlowNoise { sigma, time_s } = noise[i];
        let kind = Kind::RestNoise { sigma, time_s };
        Finding { channel: Channel::Input(i), kind, action: Action::Used }
    });
    let found: Vec<Finding> = found.collect();
    for MeasuredRecording { recording, conditioning, .. } in &mut plan.recordings {
        recording.set_slow_input_noise(noise);
        conditioning.extend(found.iter().copied());
    }
}

/// Matches the initial angles of all recordings to those of one of them, as far as torques periodic in the
/// angles determine them, and reports this. Without such torques in the model or in a diagnosis this would
/// have no effect.
fn start_alike(plan: &mut Plan) {
    if plan.diagnosis.is_none() && !plan.model.effects().iter().any(|e| e.has_waves()) {
        return;
    }
    let recordings: Vec<&Recording> = plan.recordings.iter().map(|m| &m.recording).collect();
    let Some(starts) = start_angles(&plan.model, &recordings, plan.hold) else { return };
    for (m, starts) in plan.recordings.iter_mut().zip(starts) {
        for start in starts {
            let StartAngle { of, angle_rad, std_error_rad } = start;
            let (channel, kind) = match of {
                Cycle::Heading => {
                    (Channel::Sensors, Kind::StartHeading { angle_rad, std_error_rad })
                }
                Cycle::Wheel(i) => {
                    (Channel::Angle(i), Kind::StartAngle { angle_rad, std_error_rad })
                }
            };
            m.conditioning.push(Finding::corrected(channel, kind, "starts", true));
            m.recording = m.recording.with_later_angles(start.of_wheels(plan.model.robot()));
        }
    }
    // the initial values of these torques were determined with inconsistent angles
    place(plan);
}

/// Parameters from the torque balance over the training recordings.
fn balanced(plan: &Plan) -> Option<Vec<f64>> {
    let train = plan.of(Role::Train);
    let task = Task { model: &plan.model, train: &train, hold: plan.hold, seed: plan.seed };
    start::start(&task, "timing").ok()
}

/// Share of noise in the differences of the input over the training recordings, for the model at `start`.
fn share_of_noise(plan: &Plan, start: &[f64]) -> f64 {
    let train = plan.of(Role::Train);
    let recordings: Vec<&Recording> = train.iter().collect();
    noise_of_jumps(&plan.model, start, &recordings, plan.hold)
}

/// The share of noise in the differences of an input that acts at its time, if that is far from its row: to a model that
/// answers to another row, every change of the input is noise. `None` within what logging explains.
fn share_in_time(plan: &Plan, timing: &Timing) -> Option<f64> {
    let certain = timing.dead_time_s.abs() - THRESHOLDS.uncertain * timing.std_error_s;
    let train = plan.of(Role::Train);
    let step = train.iter().map(Recording::step).fold(0.0, f64::max);
    if certain <= THRESHOLDS.logging * step {
        return None;
    }
    let later = |r: &Recording| with_later_input(r, timing.dead_time_s, plan.hold);
    let train: Vec<Recording> = train.iter().map(later).collect();
    let task = Task { model: &plan.model, train: &train, hold: plan.hold, seed: plan.seed };
    let p = start::start(&task, "timing").ok()?;
    let recordings: Vec<&Recording> = train.iter().collect();
    Some(noise_of_jumps(&plan.model, &p, &recordings, plan.hold))
}

/// The training recordings with this share, so that the effects of a low-pass and of interpolation on noise
/// can be compared.
fn train_with_noise(plan: &Plan, share: f64) -> Vec<Recording> {
    let mut train = plan.of(Role::Train);
    train.iter_mut().for_each(|r| r.set_noise_of_jumps(share));
    train
}

/// Simulates with the most likely account of what the logger did ([`more_likely_logging`]), and reports it. Returns the
/// parameters under this account, or `None` if there is no other.
fn as_logged(plan: &mut Plan, given: &AsRecorded, settings: Settings) -> Option<Vec<f64>> {
    // without a diagnosis the model need not be complete, and the file's `hold` stands
    let steps = settings.rows && plan.diagnosis.is_some();
    let allowed = Accounts { averages: settings.speeds, steps };
    let found = more_likely_logging(given, allowed)?;
    if found.hold != plan.hold {
        let between =
            |i| Finding::corrected(Channel::Input(i), Kind::StepsBetweenRows, "rows", true);
        plan.recordings.iter_mut().for_each(|m| m.conditioning.extend([0, 1].map(between)));
        plan.hold = found.hold;
    }
    if let Some(filter) = found.low_pass {
        filtered_by(plan, filter, true);
    }
    Some(found.p)
}

/// Replaces speeds after a low-pass of their sensor by those before it, if `correct`, and reports this.
/// Returns the parameters for the changed recordings, or `None` if they are unchanged.
fn unfiltered(
    plan: &mut Plan,
    given: &AsRecorded,
    start: &[f64],
    correct: bool,
) -> Option<Vec<f64>> {
    let filter = speed_filter(given)?;
    filtered_by(plan, filter, correct);
    correct.then(|| balanced(plan).unwrap_or_else(|| start.to_vec()))
}

/// Reports a low-pass of the speeds, and replaces them by those before it, if `correct`.
fn filtered_by(plan: &mut Plan, filter: SpeedFilter, correct: bool) {
    let SpeedFilter { low_pass, std_error_s, or_late } = filter;
    let LowPass { computed, time_s } = low_pass;
    let at_rows = computed == Computed::AtRows;
    let kind = Kind::LowPass { at_rows, time_s, std_error_s, or_late };
    for m in &mut plan.recordings {
        let found = [0, 1].map(|i| Finding::corrected(Channel::Speed(i), kind, "speeds", correct));
        m.conditioning.extend(found);
        if correct {
            m.recording = low_pass.before(&m.recording);
        }
    }
}

/// Shifts the inputs of recordings with different phases between controller and log to their mean, and
/// reports this.
fn in_phase(plan: &mut Plan, start: &[f64], share: f64) {
    let train = |m: &MeasuredRecording| m.role == Role::Train;
    let places: (Vec<usize>, Vec<usize>) =
        (0..plan.recordings.len()).partition(|&n| train(&plan.recordings[n]));
    let order: Vec<usize> = [&places.0[..], &places.1[..]].concat();
    let mut all: Vec<Recording> =
        order.iter().map(|&n| plan.recordings[n].recording.clone()).collect();
    all.iter_mut().for_each(|r| r.set_noise_of_jumps(share));
    let recordings: Vec<&Recording> = all.iter().collect();
    let found = phases(&plan.model, start, &recordings, places.0.len(), plan.hold);
    for (&n, phase) in
        order.iter().zip(found.into_iter().flatten()).filter(|(_, p)| p.shift_s != 0.0)
    {
        let m = &mut plan.recordings[n];
        let kind = Kind::Phase { shift_s: phase.shift_s, std_error_s: phase.std_error_s };
        let moved = [0, 1].map(|i| Finding::corrected(Channel::Input(i), kind, "rows", true));
        m.conditioning.extend(moved);
        m.recording = with_later_input(&m.recording, phase.shift_s, plan.hold);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{Reading, Unread, plan_of};
    use crate::model::Model;
    use crate::model::base::A4;
    use crate::robot::{Robot, State};
    use crate::simulate::{Input, simulate};

    #[test]
    fn a_command_that_friction_holds_is_no_noise_of_the_input() {
        let model = Model::base(Robot::amigobot());
        let (p, h) = (model.initial(), 0.01);
        // a second of motion, then two of rest, in which a controller moves its command up and down below the friction
        let phase = |k: usize| (k % 300) as f64 * h;
        let turns = |n: f64| (std::f64::consts::TAU * n).sin();
        let command = |k: usize| match phase(k) {
            t if t < 0.6 => 1.5 * p[A4],
            t if t < 1.0 => 0.0,
            _ => 0.4 * p[A4] * (turns(2.3 * h * k as f64) + turns(5.1 * h * k as f64)),
        };
        let noise = |k: usize| 0.002 * ((k * k) as f64).sin();
        let t: Vec<f64> = (0..3000).map(|k| h * f64::from(k)).collect();
        let torque: Vec<[f64; 2]> = (0..3000).map(|k| [command(k), 0.9 * command(k)]).collect();
        let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
        let states = simulate(&model, &p, &input, State::default()).unwrap();
        let column = |of: &dyn Fn(usize) -> f64| (0..t.len()).map(of).collect::<Vec<f64>>();
        let speeds = [0, 1].map(|i| column(&|k| states[k].omega[i] + noise(k + 5 * i)));
        let inputs = [0, 1].map(|i| column(&|k| torque[k][i] + noise(k + 11 + 7 * i)));
        let named = |name: &str, i: usize, v: &[f64]| (format!("{name}{}", i + 1), v.to_vec());
        let mut columns = vec![("t".to_owned(), t.clone())];
        columns.extend((0..2).map(|i| named("dalpha", i, &speeds[i])));
        columns.extend((0..2).map(|i| named("M", i, &inputs[i])));
        let reading = Reading::new(Robot::amigobot(), DriveUnit::NewtonMetre);
        let read = Unread::table(reading, "held", columns).read(Role::Train).unwrap();
        assert!(rest_noise(&[&read.recording])[0].sigma > 0.1 * p[A4]);
        let plan = plan_of("mine", &toml::Table::new(), vec![read], Some(Hold::Linear)).unwrap();
        assert_eq!(plan.recordings[0].recording.slow_input_noise()[0].sigma, 0.0);
    }
}
