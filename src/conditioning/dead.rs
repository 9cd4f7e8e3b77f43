//! Stretches in which the sensors of a wheel give no new value although its input must have moved it: a dead encoder,
//! or a wheel that is blocked or not powered.
//!
//! The motion that the input would have caused is computed with a simple model, fitted to windows outside such
//! stretches:
//!
//! ```text
//! c1 dw/dt = M' - friction - c3 w,   M' = M - c4 dw'/dt - c5 w'      (w': speed of the other wheel)
//! friction <= F = max(2 c2 + 3 s, S)                                  (at rest)
//! ```
//! c2: Coulomb friction, of which static friction is at most about twice; s: residual of the fit; S: input at which the
//! wheel started from its other rests (lower quartile). If a speed other than zero is repeated, M' is taken relative to
//! its mean in the stretch, and F = 3 s. The rows are left out if that motion is well above the resolution for longer
//! than dead time explains. Motion in both directions excludes a wall. So are they if the wheel stops and starts again
//! at speed within three rows, with three times the change of speed of any other three rows, whatever the input.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::cells::keep;
use super::error::ConditioningError;
use super::finding::{Channel, Finding, Kind, WHEELS};
use super::input::speeds;
use super::signal::{column, median_step, pieces, quantile};
use super::thresholds::SAMPLES;
use super::{Conditioned, Settings};
use crate::math::noise::smallest_change;
use crate::math::{fit, mean, runs, sgn};
use crate::recording::{SHORT, View, Window, windows_of};

/// Shortest stretch, and shortest motion computed for it \[s\]; the reason is in the list of all thresholds
/// (`diagnose/thresholds.rs`).
pub(crate) const DEAD_S: f64 = 1.0;
/// Rows to either side of a stretch at which speeds do not contain its samples.
const BESIDE: usize = 3;

/// A stretch without a new value.
struct Stretch {
    rows: Range<usize>,
    /// Whether a blocked wheel is possible too: the input drives it in one direction only.
    or_blocked: bool,
}

/// Leaves out the rows in which the sensors of a wheel are constant although it is driven; refuses them if too few are
/// left.
pub(super) fn stretches(
    work: &mut Conditioned,
    settings: &Settings,
) -> Result<(), ConditioningError> {
    let Some(omega) = speeds(work) else { return Ok(()) };
    let log = Log::new(work, &omega);
    let found = [log.dead(0), log.dead(1)];
    let t = &work.channels.t;
    let mut kept = vec![true; t.len()];
    found.iter().flatten().for_each(|one| kept[one.rows.clone()].fill(false));
    let left_s = log.step * kept.iter().filter(|k| **k).count() as f64;
    let mut reported = vec![];
    for (i, all) in found.iter().enumerate() {
        let Some(first) = all.first() else { continue };
        let (rows, from_s) = (first.rows.clone(), t[first.rows.start]);
        let to_s = t[rows.end - 1];
        if rows.len() == t.len() {
            let channels = &work.channels;
            let value =
                channels.alpha.as_ref().or(channels.omega.as_ref()).map_or(0.0, |v| v[0][i]);
            let error = ConditioningError::Dead { wheel: WHEELS[i], value, rows: t.len() };
            return if settings.refuse { Err(error) } else { Ok(()) };
        }
        if settings.refuse && settings.rows && left_s < SHORT {
            let (wheel, rows) = (WHEELS[i], [rows.start + 1, rows.end]);
            return Err(ConditioningError::DeadFor { wheel, rows, times: [from_s, to_s], left_s });
        }
        let kind = Kind::Dead {
            stretches: all.len(),
            rows: all.iter().map(|one| one.rows.len()).sum(),
            from_s,
            to_s,
            or_blocked: all.iter().any(|one| one.or_blocked),
        };
        let channel = match work.channels.alpha {
            Some(_) => Channel::Angle(i),
            None => Channel::Speed(i),
        };
        reported.push(Finding::corrected(channel, kind, "rows", settings.rows));
    }
    work.findings.extend(reported);
    if settings.rows && kept.contains(&false) {
        keep(&mut work.channels, &kept);
    }
    Ok(())
}

/// The channels with the rests of each wheel.
struct Log<'a> {
    work: &'a Conditioned,
    omega: &'a [[f64; 2]],
    step: f64,
    pieces: Vec<Range<usize>>,
    /// Stretches in which all sensors of a wheel are constant.
    rests: [Vec<Range<usize>>; 2],
}

impl<'a> Log<'a> {
    fn new(work: &'a Conditioned, omega: &'a [[f64; 2]]) -> Self {
        let t = &work.channels.t;
        let step = median_step(t);
        let pieces = pieces(t);
        let rests = [0, 1].map(|i| constant(work, i, step, &pieces));
        Self { work, omega, step, pieces, rests }
    }

    fn windows(&self, pieces: &[Range<usize>]) -> Vec<Window> {
        let c = &self.work.channels;
        windows_of(&View {
            t: &c.t,
            alpha: c.alpha.as_deref().unwrap_or(self.omega),
            omega: self.omega,
            torque: &c.torque,
            pieces,
            step: self.step,
            refresh: 1,
        })
    }

    fn is_long(&self, rows: &Range<usize>) -> bool {
        self.step * rows.len() as f64 >= DEAD_S
    }

    /// The stretches of a wheel in which it must have moved.
    fn dead(&self, i: usize) -> Vec<Stretch> {
        let rests = &self.rests[i];
        if !rests.iter().any(|rows| self.is_long(rows)) {
            return vec![];
        }
        let long = self.rests.iter().flatten().filter(|rows| self.is_long(rows));
        let mut outside = vec![true; self.omega.len()];
        long.for_each(|rows| outside[rows.clone()].fill(false));
        let moving = self.windows(&runs(outside.len(), |k| outside[k]));
        let Some(load) = Load::of(&moving, i) else {
            return self.most_of_it(i).into_iter().collect();
        };
        let inputs: Vec<Option<f64>> =
            rests.iter().map(|rows| self.start(&load, i, rows)).collect();
        let judged = rests.iter().enumerate().filter(|(_, rows)| self.is_long(rows));
        let stretch = |(k, rows): (usize, &Range<usize>)| {
            let others = inputs.iter().enumerate().filter(|(j, _)| *j != k);
            let starts = quantile(others.filter_map(|(_, input)| *input), 0.25);
            let at_once = self.stops_and_starts_at_once(i, rows, SAMPLES.dead_slow * load.top);
            let or_blocked = if at_once { false } else { self.moves(&load, i, rows, starts)? };
            Some(Stretch { rows: rows.clone(), or_blocked })
        };
        judged.filter_map(stretch).collect()
    }

    /// Whether the speed of a wheel, faster than `slow` on both sides of a stretch, falls to zero and returns within a
    /// few rows, by more than in as many rows anywhere else: no torque of the log does this, but a sensor that fails
    /// and returns.
    fn stops_and_starts_at_once(&self, i: usize, rows: &Range<usize>, slow: f64) -> bool {
        let Some(piece) = self.pieces.iter().find(|p| p.contains(&rows.start)) else {
            return false;
        };
        // one that repeats another speed does not fall to zero
        if self.omega[(rows.start + rows.end) / 2][i].abs() > slow {
            return false;
        }
        let sides = [rows.start.checked_sub(BESIDE), Some(rows.end - 1 + BESIDE)];
        let beside =
            |k: Option<usize>| k.filter(|k| piece.contains(k)).map(|k| self.omega[k][i].abs());
        let [Some(before), Some(after)] = sides.map(beside) else { return false };
        let inside = |k: &usize| {
            !self.rests[i].iter().any(|rest| {
                self.is_long(rest) && k + BESIDE > rest.start && *k <= rest.end + BESIDE
            })
        };
        let changes = (piece.start..piece.end.saturating_sub(BESIDE)).filter(inside);
        let changes = changes.map(|k| (self.omega[k + BESIDE][i] - self.omega[k][i]).abs());
        let usual = quantile(changes, 0.999);
        let sudden = |speed: f64| speed > slow && speed > SAMPLES.dead_errors * usual;
        usual > 0.0 && sudden(before) && sudden(after)
    }

    /// The input of a wheel as it starts from a rest, if it does.
    fn start(&self, load: &Load, i: usize, rows: &Range<usize>) -> Option<f64> {
        let ends = self.pieces.iter().any(|p| p.end == rows.end);
        let windows = self.windows(std::slice::from_ref(rows));
        let last = windows.last().filter(|_| windows.len() >= SAMPLES.rest_windows && !ends)?;
        Some(load.acting(last, i).abs())
    }

    /// Whether the input would have moved the wheel in a stretch; `Some(true)` if in one direction only.
    fn moves(&self, load: &Load, i: usize, rows: &Range<usize>, starts: f64) -> Option<bool> {
        let c = &self.work.channels;
        let windows = self.windows(std::slice::from_ref(rows));
        let h = self.step * rows.len() as f64 / windows.len().max(1) as f64;
        let speed = self.omega[rows.start][i];
        // an angle that stands still is a rest, whatever the speed
        let rests = c.alpha.is_some() || speed.abs() < SAMPLES.dead_slow * load.top;
        let acting: Vec<f64> = windows.iter().map(|w| load.acting(w, i)).collect();
        let noise = SAMPLES.dead_errors * load.residual;
        let (mean, level) = match rests {
            true => (0.0, starts.max(SAMPLES.static_friction * load.friction + noise)),
            false => (mean(acting.iter().copied()), noise),
        };
        let motion = load.motion(acting.iter().map(|m| m - mean), level, h);
        let resolution =
            |v: &[[f64; 2]]| SAMPLES.dead_steps * smallest_change(&column(v, i)).unwrap_or(0.0);
        let slow = (SAMPLES.dead_slow * load.top).max(match &c.alpha {
            Some(_) => 0.0,
            None => resolution(self.omega),
        });
        let path: f64 = motion.iter().map(|w| h * w.abs()).sum();
        let time = |sign: f64| h * motion.iter().filter(|w| sign * **w > slow).count() as f64;
        let (forward, backward) = (time(1.0), time(-1.0));
        let turns = c.alpha.as_ref().is_none_or(|alpha| path > resolution(alpha));
        let one_way = forward.min(backward) < 0.5 * DEAD_S;
        (turns && forward + backward >= DEAD_S).then_some(one_way && rests)
    }

    /// A rest of more than half of the log, of a wheel that hardly moves in the remainder, while the other one moves by
    /// an input of the same size.
    fn most_of_it(&self, i: usize) -> Option<Stretch> {
        let torque = &self.work.channels.torque;
        let rows = self.rests[i].iter().find(|rows| 2 * rows.len() > self.omega.len())?;
        let size = |j: usize| quantile(torque[rows.clone()].iter().map(|m| m[j].abs()), 0.9);
        let top = quantile(self.omega[rows.clone()].iter().map(|w| w[1 - i].abs()), 0.9);
        let driven = size(i) > SAMPLES.also_driven * size(1 - i) && size(i) > 0.0;
        (driven && top > 0.0).then(|| Stretch { rows: rows.clone(), or_blocked: true })
    }
}

/// The simple model of a wheel.
struct Load {
    /// 1, or -1 where the input has the opposite sign of the acceleration, which a later step corrects.
    sign: f64,
    inertia: f64,
    friction: f64,
    damping: f64,
    /// Input per acceleration and speed of the other wheel.
    other: [f64; 2],
    residual: f64,
    /// Top speed.
    top: f64,
}

impl Load {
    fn of(windows: &[Window], i: usize) -> Option<Self> {
        let top = quantile(windows.iter().map(|w| w.speed[i].abs()), 0.99);
        let used: Vec<&Window> =
            windows.iter().filter(|w| w.speed[i].abs() > 0.5 * SAMPLES.dead_slow * top).collect();
        if used.len() < SAMPLES.fit_windows {
            return None;
        }
        let value = |w: &Window, j: usize| match j {
            0 => w.acceleration[i],
            1 => sgn(w.speed[i]),
            2 => w.speed[i],
            3 => w.acceleration[1 - i],
            _ => w.speed[1 - i],
        };
        let y = DVector::from_fn(used.len(), |k, _| used[k].torque[i]);
        let with = |n: usize| {
            let x = DMatrix::from_fn(used.len(), n, |k, j| value(used[k], j));
            fit(&x, &y, None).ok().filter(|fit| fit.rank == n)
        };
        // one axis may have been recorded for both
        let fit = with(5).or_else(|| with(3))?;
        let at = |j: usize| fit.coefficients.get(j).copied().unwrap_or(0.0);
        let sign = sgn(at(0));
        let inertia = at(0).abs();
        (inertia > SAMPLES.dead_errors * fit.std_errors[0]).then(|| Self {
            sign,
            inertia,
            friction: (sign * at(1)).max(0.0),
            damping: (sign * at(2)).max(0.0),
            other: [at(3), at(4)],
            residual: fit.residual_variance.sqrt(),
            top,
        })
    }

    /// M', what acts on the wheel beside its own resistance.
    fn acting(&self, w: &Window, i: usize) -> f64 {
        let other = self.other[0] * w.acceleration[1 - i] + self.other[1] * w.speed[1 - i];
        self.sign * (w.torque[i] - other)
    }

    /// Speed after each window of `h` seconds, from rest, with a friction of that level.
    fn motion(&self, acting: impl Iterator<Item = f64>, level: f64, h: f64) -> Vec<f64> {
        let rate = self.damping / self.inertia;
        let decay = (-rate * h).exp();
        let gain = if rate * h > 1e-6 { (1.0 - decay) / rate } else { h } / self.inertia;
        let step = |w: &mut f64, m: f64| {
            let drive = match *w {
                0.0 => m - m.clamp(-level, level),
                w => m - level * sgn(w),
            };
            let next = decay * *w + gain * drive;
            *w = if next * *w < 0.0 { 0.0 } else { next };
            Some(*w)
        };
        acting.scan(0.0, step).collect()
    }
}

/// Stretches without a gap in which all sensors of a wheel are constant, from the last new angle on.
fn constant(work: &Conditioned, i: usize, step: f64, pieces: &[Range<usize>]) -> Vec<Range<usize>> {
    let c = &work.channels;
    let same = |rows: Option<&Vec<[f64; 2]>>, k: usize| rows.is_none_or(|v| v[k][i] == v[k - 1][i]);
    let mut out = vec![];
    for piece in pieces {
        let mut start = piece.start;
        for k in piece.start + 1..=piece.end {
            if k < piece.end && same(c.alpha.as_ref(), k) && same(c.omega.as_ref(), k) {
                continue;
            }
            // a filtered speed decays behind an angle that has stopped
            let from = (piece.start + 1..=start).rev();
            let held = from.take_while(|&k| c.alpha.is_some() && same(c.alpha.as_ref(), k)).count();
            if step * (k - start) as f64 > SAMPLES.rest_windows as f64 * 0.1 {
                out.push(start - held..k);
            }
            start = k;
        }
    }
    out
}

#[cfg(test)]
mod tests;
