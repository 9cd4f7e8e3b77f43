//! Speeds and angles of a wheel of which one stays at one value while the other shows motion: its sensor is dead.
//!
//! A wheel whose angle is not on a straight line in time changes its speed, in whatever unit; one whose speed adds up to
//! half a turn changes its angle.

use std::f64::consts::PI;

use super::finding::{Channel, Finding, Kind};
use super::signal::column;
use super::{Conditioned, Settings};
use crate::math::Line;

/// Leaves out the speeds, or else the angles, of both wheels if those of one are from a dead sensor; the others determine
/// them.
pub(super) fn channels(work: &mut Conditioned, settings: &Settings) {
    let c = &work.channels;
    let (Some(alpha), Some(omega)) = (&c.alpha, &c.omega) else { return };
    let dead = |i: &usize| stays(omega, *i) && bends(&c.t, &column(alpha, *i));
    let dead_speeds: Vec<usize> = (0..2).filter(dead).collect();
    if !dead_speeds.is_empty() {
        report(work, settings, dead_speeds.into_iter().map(Channel::Speed));
        if settings.speeds {
            work.channels.omega = None;
        }
        return;
    }
    let dead = |i: &usize| stays(alpha, *i) && turned(&c.t, &column(omega, *i)) > PI;
    let dead_angles: Vec<usize> = (0..2).filter(dead).collect();
    if !dead_angles.is_empty() {
        report(work, settings, dead_angles.into_iter().map(Channel::Angle));
        if settings.speeds {
            work.channels.alpha = None;
        }
    }
}

fn report(work: &mut Conditioned, settings: &Settings, of: impl Iterator<Item = Channel>) {
    let finding =
        |channel| Finding::corrected(channel, Kind::DeadSensor, "speeds", settings.speeds);
    work.findings.extend(of.map(finding));
}

fn stays(rows: &[[f64; 2]], i: usize) -> bool {
    rows.iter().all(|row| row[i] == rows[0][i])
}

/// Whether an angle differs from a straight line by half a turn.
fn bends(t: &[f64], angle: &[f64]) -> bool {
    let line = Line::through(t.iter().copied().zip(angle.iter().copied()));
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for (t, angle) in t.iter().zip(angle) {
        let left = angle - line.slope * t;
        (least, most) = (least.min(left), most.max(left));
    }
    most - least > PI
}

/// Angle turned in either direction.
fn turned(t: &[f64], speed: &[f64]) -> f64 {
    t.windows(2).zip(speed).map(|(t, w)| (t[1] - t[0]) * w.abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::super::{Context, condition};
    use super::*;
    use crate::recording::Channels;

    /// 20 s at 100 Hz, with the sensors as `change` leaves them.
    fn done(change: impl Fn(&mut Channels)) -> Conditioned {
        let t: Vec<f64> = (0..2000).map(|k| 0.01 * f64::from(k)).collect();
        let rate = [1.3, 2.1];
        let of = |f: &dyn Fn(f64, f64) -> f64| t.iter().map(|&t| rate.map(|r| f(r, t))).collect();
        let alpha = of(&|r, t| 9.0 * (1.0 - (r * t).cos()) / r + 1e-3 * (977.0 * t * t).sin());
        let omega = of(&|r, t| 9.0 * (r * t).sin() + 0.02 * (1009.0 * t * t * r).sin());
        let torque = of(&|r, t| 0.27 * r * (r * t).cos() + 0.1 * (r * t).sin().signum());
        let mut channels = Channels { alpha: Some(alpha), omega: Some(omega), torque, t };
        change(&mut channels);
        condition(channels, &Settings::default(), &Context::default()).unwrap()
    }

    fn dead(done: &Conditioned) -> Vec<Channel> {
        let dead = done.findings.iter().filter(|f| f.kind == Kind::DeadSensor);
        dead.map(|f| f.channel).collect()
    }

    #[test]
    fn a_sensor_that_stays_beside_one_that_moves_is_not_used() {
        for value in [0.0, 0.3] {
            let found = done(|c| c.omega.iter_mut().flatten().for_each(|w| w[1] = value));
            assert_eq!(dead(&found), [Channel::Speed(1)], "{:?}", found.findings);
            assert!(found.channels.omega.is_none() && found.channels.t.len() == 2000);
        }
        let found = done(|c| c.alpha.iter_mut().flatten().for_each(|a| a[0] = 0.0));
        assert_eq!(dead(&found), [Channel::Angle(0)], "{:?}", found.findings);
        assert!(found.channels.alpha.is_none());
        assert!(dead(&done(|_| ())).is_empty());
    }

    #[test]
    fn a_wheel_at_rest_and_a_steady_one_have_no_dead_sensor() {
        let of = |speed: f64| {
            done(|c| {
                c.omega.iter_mut().flatten().for_each(|w| w[0] = speed);
                let t = c.t.clone();
                let turned = c.alpha.iter_mut().flatten().zip(t);
                turned.for_each(|(a, t)| a[0] = speed * t + 1e-3 * (977.0 * t).sin());
            })
        };
        assert!(dead(&of(0.0)).is_empty() && dead(&of(7.0)).is_empty());
    }
}
