//! Columns that belong to the other wheel, and inputs of the wrong sign.
//!
//! Detected in windows of 0.1 s with the tests of the quality check: the speed of a wheel follows the angle of
//! the other; the input of a wheel explains the motion of the other and not its own,
//!
//! ```text
//! M = c1 dw/dt + c2 sgn(w) + c3 w
//! ```
//! or it acts against the acceleration (c1 five standard errors below zero) and its work is negative,
//! which friction and inertia cannot cause.

use super::finding::{Action, Channel, Finding, Kind};
use super::input::speeds;
use super::signal::{median_step, pieces};
use super::thresholds::ANGLES;
use super::{Conditioned, Settings};
use crate::recording::{
    View, Window, counts_backwards, exchanged_input, exchanged_speeds, is_mirrored, opposing_input,
    short_windows_of, windows_of,
};

/// Assigns speeds or angles to the wheel that they follow.
pub(super) fn exchanged_sensors(work: &mut Conditioned, settings: &Settings) {
    let c = &work.channels;
    if c.alpha.is_none() || c.omega.is_none() || !exchanged_speeds(&windows(work)) {
        return;
    }
    // the pair that is consistent with the inputs is unchanged
    let swapped = |rows: &Option<Vec<[f64; 2]>>| {
        rows.as_ref().map(|rows| rows.iter().map(|v| [v[1], v[0]]).collect::<Vec<_>>())
    };
    let by_speeds = exchanged_input(&windows(work));
    let channel = if by_speeds { Channel::Speed } else { Channel::Angle };
    // by the speeds the inputs are exchanged, so that the speeds are those of the other wheel
    let rows = if by_speeds { &mut work.channels.omega } else { &mut work.channels.alpha };
    let other = swapped(rows);
    for i in 0..2 {
        let finding =
            Finding::corrected(channel(i), Kind::Exchanged, "exchanged", settings.exchanged);
        work.findings.push(finding);
    }
    if settings.exchanged {
        *rows = other;
    }
}

/// Assigns inputs to the wheel that they move, and reverses those that act against it.
pub(super) fn inputs(work: &mut Conditioned, settings: &Settings) {
    if exchanged_input(&windows(work)) {
        for i in 0..2 {
            let channel = Channel::Input(i);
            let on = settings.exchanged;
            work.findings.push(Finding::corrected(channel, Kind::Exchanged, "exchanged", on));
        }
        if settings.exchanged {
            work.channels.torque.iter_mut().for_each(|m| m.swap(0, 1));
        }
        return;
    }
    let found = windows_by(work, short_windows_of);
    let opposing: Vec<usize> = (0..2).filter(|i| opposing_input(&found, *i)).collect();
    if opposing.is_empty() && is_mirrored(&found) {
        let (channel, kind) = (Channel::Sensors, Kind::Mirrored);
        work.findings.push(Finding { channel, kind, action: Action::Noted });
    }
    for &i in &opposing {
        // of one wheel that turns against the other nearly always, or answers to it as if it were mirrored, it is the
        // sensors that count backwards
        let backwards = opposing.len() == 1 && (are_opposed(&found) || counts_backwards(&found, i));
        let channels: &[Channel] =
            if backwards { &[Channel::Angle(i), Channel::Speed(i)] } else { &[Channel::Input(i)] };
        for &channel in channels {
            turn(work, settings, channel, i);
        }
    }
}

fn turn(work: &mut Conditioned, settings: &Settings, channel: Channel, i: usize) {
    let c = &mut work.channels;
    let rows = match channel {
        Channel::Angle(_) => c.alpha.as_mut(),
        Channel::Speed(_) => c.omega.as_mut(),
        _ => Some(&mut c.torque),
    };
    let Some(rows) = rows else { return };
    if settings.signs {
        rows.iter_mut().for_each(|v| v[i] = -v[i]);
    }
    let kind = Kind::Opposing;
    work.findings.push(Finding::corrected(channel, kind, "signs", settings.signs));
}

fn are_opposed(windows: &[Window]) -> bool {
    let moving = windows.iter().filter(|w| w.speed[0] * w.speed[1] != 0.0).count();
    let opposed = windows.iter().filter(|w| w.speed[0] * w.speed[1] < 0.0).count();
    opposed as f64 > ANGLES.mirrored * moving as f64
}

fn windows(work: &Conditioned) -> Vec<Window> {
    windows_by(work, windows_of)
}

fn windows_by(work: &Conditioned, windows_of: fn(&View) -> Vec<Window>) -> Vec<Window> {
    let c = &work.channels;
    let Some(omega) = speeds(work) else { return vec![] };
    let alpha = c.alpha.as_ref().unwrap_or(&omega);
    let step = median_step(&c.t);
    let pieces = pieces(&c.t);
    let (t, torque, refresh) = (&c.t, &c.torque, 1);
    windows_of(&View { t, alpha, omega: &omega, torque, pieces: &pieces, step, refresh })
}

#[cfg(test)]
mod tests {
    use super::super::{Context, condition};
    use super::*;
    use crate::recording::Channels;

    /// Two wheels with inertia 0.03, friction 0.1 and a motion of their own each.
    fn channels() -> Channels {
        let t: Vec<f64> = (0..3000).map(|k| 0.01 * f64::from(k)).collect();
        let rate = [1.3, 2.1];
        let of = |f: &dyn Fn(f64) -> f64| t.iter().map(|t| rate.map(|r| f(r * t))).collect();
        let alpha: Vec<[f64; 2]> =
            t.iter().map(|t| rate.map(|r| 5.0 * (1.0 - (r * t).cos()) / r)).collect();
        let torque = t
            .iter()
            .map(|t| rate.map(|r| 0.03 * 5.0 * r * (r * t).cos() + 0.1 * (r * t).sin().signum()));
        let omega: Vec<[f64; 2]> = of(&|x| 5.0 * x.sin());
        Channels { alpha: Some(alpha), omega: Some(omega), torque: torque.collect(), t }
    }

    fn done(change: impl Fn(&mut Channels)) -> Conditioned {
        let mut c = channels();
        change(&mut c);
        condition(c, &Settings::default(), &Context::default()).unwrap()
    }

    fn same(a: &Channels, b: &Channels) -> bool {
        a.alpha == b.alpha && a.omega == b.omega && a.torque == b.torque
    }

    #[test]
    fn exchanged_columns_are_given_back() {
        let swap = |rows: &mut Vec<[f64; 2]>| rows.iter_mut().for_each(|v| v.swap(0, 1));
        let changes: [&dyn Fn(&mut Channels); 3] = [
            &|c| c.omega.iter_mut().for_each(swap),
            &|c| c.alpha.iter_mut().for_each(swap),
            &|c| swap(&mut c.torque),
        ];
        for (k, change) in changes.into_iter().enumerate() {
            let done = done(change);
            assert!(same(&done.channels, &channels()), "{k}: {:?}", done.findings);
            assert_eq!(done.findings.len(), 2);
        }
        assert!(done(|_| ()).findings.is_empty());
    }

    #[test]
    fn an_input_against_the_motion_is_turned() {
        for i in 0..2 {
            let done = done(|c| c.torque.iter_mut().for_each(|m| m[i] = -m[i]));
            assert!(same(&done.channels, &channels()), "{:?}", done.findings);
            assert_eq!(done.findings[0].channel, Channel::Input(i));
        }
        let both = done(|c| c.torque.iter_mut().for_each(|m| *m = m.map(|x| -x)));
        assert!(same(&both.channels, &channels()), "{:?}", both.findings);
        let off = Settings { signs: false, ..Settings::default() };
        let mut c = channels();
        c.torque.iter_mut().for_each(|m| m[0] = -m[0]);
        let left = condition(c.clone(), &off, &Context::default()).unwrap();
        assert!(same(&left.channels, &c) && left.findings.len() == 1);
    }

    #[test]
    fn a_wheel_that_leaves_its_rest_against_a_step_of_its_input_has_a_wrong_sign() {
        // 0.3 s at rest, then a step; the regression of the constant input does not determine the inertia
        for (seconds, sign) in [(1.0, -1.0), (6.0, -1.0), (6.0, 1.0)] {
            let t: Vec<f64> = (0..(100.0 * seconds) as u32).map(|k| 0.01 * f64::from(k)).collect();
            let speed = |t: f64| 20.0 * (1.0 - (-(t - 0.3).max(0.0) / 0.05).exp());
            let omega: Vec<[f64; 2]> = t.iter().map(|&t| [sign * speed(t); 2]).collect();
            let torque: Vec<[f64; 2]> = t.iter().map(|&t| [f64::from(t > 0.3); 2]).collect();
            let channels = Channels { alpha: None, omega: Some(omega), torque, t };
            let done = condition(channels, &Settings::default(), &Context::default()).unwrap();
            let found = done.findings.iter().filter(|f| f.kind == Kind::Opposing).count();
            assert_eq!(
                found,
                if sign < 0.0 { 2 } else { 0 },
                "{seconds} {sign}: {:?}",
                done.findings
            );
        }
    }

    #[test]
    fn a_wheel_that_answers_to_the_other_as_if_mirrored_counts_backwards() {
        // the coupling of a robot whose centre of mass is ahead of its axle
        let coupled = |c: &mut Channels| {
            let omega = c.omega.clone().unwrap();
            for (m, w) in c.torque.iter_mut().zip(&omega) {
                *m = [0, 1].map(|i| m[i] + 2e-3 * w[1 - i] * (w[1 - i] - w[i]));
            }
        };
        let mut right = channels();
        coupled(&mut right);
        let turned = |sensors: bool, input: bool| {
            done(|c| {
                coupled(c);
                let motion = [c.alpha.as_mut(), c.omega.as_mut()].into_iter().flatten().flatten();
                let input_too = c.torque.iter_mut().filter(|_| input);
                motion.filter(|_| sensors).chain(input_too).for_each(|v| v[1] = -v[1]);
            })
        };
        assert!(turned(false, false).findings.is_empty());
        for sensors in [true, false] {
            let done = turned(sensors, !sensors);
            assert!(same(&done.channels, &right), "{sensors}: {:?}", done.findings);
        }
        // which wheel it is the data do not show
        let both = turned(true, true);
        let stated: Vec<_> = both.findings.iter().map(|f| (f.kind, f.action)).collect();
        assert_eq!(stated, [(Kind::Mirrored, Action::Noted)]);
    }

    #[test]
    fn of_a_wheel_that_counts_backwards_the_sensors_are_turned() {
        // both wheels ahead together, the left one counted backwards
        let together = |c: &mut Channels| {
            for rows in [c.alpha.as_mut(), c.omega.as_mut(), Some(&mut c.torque)] {
                rows.into_iter().flatten().for_each(|v| v[1] = 1.1 * v[0]);
            }
        };
        let mut right = channels();
        together(&mut right);
        let done = done(|c| {
            together(c);
            let motion = [c.alpha.as_mut(), c.omega.as_mut()];
            motion.into_iter().flatten().flatten().for_each(|v| v[1] = -v[1]);
        });
        assert!(same(&done.channels, &right), "{:?}", done.findings);
        assert_eq!(done.findings.len(), 2);
    }
}
