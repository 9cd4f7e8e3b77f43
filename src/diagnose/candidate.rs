//! Candidates: effects that may be missing, with their torque columns.

use std::cell::OnceCell;
use std::sync::Arc;

use rayon::prelude::*;

use super::joint::{Around, Forces, coupling, joint_signal};
use super::signals::signals;
use crate::effects::{
    Change, Coupling, DIFFERENTIATED, Effect, MOST_PARAMETERS, Motion, Own, ParameterKind, Wave,
    along,
};
use crate::filter::{Instant, clarity};
use crate::math::{Real, sgn};
use crate::model::Model;
use crate::recording::{LocalMotion, Recording};

/// Speeds below this share of the top speed are smoothed over where an effect brings a friction
/// direction of its own (the model has no filter variance for it).
pub(super) const REST: f64 = 0.004;

/// An effect at one value of its shape parameter, prepared as a column of a filter pass.
#[derive(Clone)]
pub struct Candidate {
    /// Id of the effect.
    pub id: String,
    /// The effect that is added to the model.
    pub effect: Arc<dyn Effect>,
    /// Its parameters: shapes at their grid value, linear ones at zero.
    pub p: Vec<f64>,
    /// Places of the linear parameters in `p`, one column each. An effect on the input has one column.
    pub linear: Vec<usize>,
    /// How a column is computed.
    pub form: Form,
    /// Speed below which a friction direction of its own is smoothed [rad/s].
    pub(super) rest: f64,
    /// Whether the effect adds neither mass nor dry friction.
    pub(super) torque_alone: bool,
    /// The model and its parameters, from which the signals are computed.
    pub(super) around: Arc<Around>,
}

/// How the column of a candidate is computed.
#[derive(Clone)]
pub enum Form {
    /// The torque of the effect at an instant, from the motion at that instant.
    Instant,
    /// A change of the recorded input, one signal a recording, per unit of the input parameter.
    Signal(Arc<Vec<Vec<[f64; 2]>>>),
}

impl Candidate {
    /// The candidate with its columns as `recordings` show them: with the signals of what changes the input or moves a
    /// second body, without columns that are zero on this robot.
    pub(super) fn seen_on(
        mut self,
        recordings: &[&Recording],
        forces: &OnceCell<Vec<Forces>>,
    ) -> Self {
        if self.effect.change() != Change::Torque {
            self.form = Form::Signal(Arc::new(self.signals(recordings, forces)));
        } else if let Some(first) = recordings.first() {
            self.drop_absent(first);
        }
        self
    }

    /// The same candidate with its signals for other recordings.
    #[must_use]
    pub fn for_recordings(&self, recordings: &[&Recording]) -> Self {
        let form = match self.form {
            Form::Instant => Form::Instant,
            Form::Signal(_) => Form::Signal(Arc::new(self.signals(recordings, &OnceCell::new()))),
        };
        Self { form, ..self.clone() }
    }

    /// Leaves out columns that are zero for this robot where others are not: a term times a3 if the centre of
    /// mass is on the axle. Evaluated at two motions in general position, one forward and one backward.
    fn drop_absent(&mut self, recording: &Recording) {
        let top = recording.top_speed();
        let around = self.around.clone();
        let mut present = vec![false; self.columns()];
        for (k, way) in [(0, 1.0), (recording.len() / 2, -1.0)] {
            let moving = LocalMotion {
                alpha: [1.0, 2.0],
                omega: [0.7 * top * way, 0.4 * top * way],
                acceleration: [top, -0.6 * top],
                omega_variance: [0.0; 2],
                alpha_variance: [0.0; 2],
            };
            let at = still_instant(&around.model, recording, k, &moving);
            let mut torque = vec![[0.0; 2]; self.columns()];
            self.of_terms(&self.variables(), &at, |_| way, &mut torque);
            present.iter_mut().zip(&torque).for_each(|(p, t)| *p |= *t != [0.0; 2]);
        }
        if present.contains(&true) {
            let mut present = present.into_iter();
            self.linear.retain(|_| present.next() == Some(true));
        }
    }

    /// Number of parameters to be estimated: shapes, and linear parameters that affect this robot.
    pub(super) fn parameters(&self) -> usize {
        let shape = |s: &&crate::effects::ParameterSpec| s.kind == ParameterKind::Shape;
        self.effect.parameters().iter().filter(shape).count() + self.linear.len()
    }

    fn coupling(&self) -> Option<Coupling<f64>> {
        coupling(&self.effect, &self.p, self.around.model.robot())
    }

    /// Whether all that shapes the effect are whole numbers.
    pub(super) fn is_of_orders(&self) -> bool {
        let specs = self.effect.parameters();
        specs.iter().filter(|s| s.kind == ParameterKind::Shape).all(|s| s.whole)
    }

    /// The waves of the columns, with column indices in the place of parameters; empty for torques that are
    /// not waves.
    pub(super) fn waves(&self) -> Vec<Wave> {
        let column = |j: usize| self.linear.iter().position(|&linear| linear == j);
        let of_columns = |wave: Wave| {
            Some(Wave { sine: column(wave.sine)?, cosine: column(wave.cosine)?, ..wave })
        };
        self.effect.waves(&self.p).into_iter().filter_map(of_columns).collect()
    }

    /// Whether the effect only delays the input.
    pub(super) fn is_shift(&self) -> bool {
        self.effect.change() == Change::TimeShift
    }

    /// Whether it changes the input or its time.
    #[must_use]
    pub fn is_of_input(&self) -> bool {
        matches!(self.effect.change(), Change::Input | Change::TimeShift)
    }

    /// Whether it limits the input or removes a part of it: a shape without a coefficient.
    #[must_use]
    pub fn clips(&self) -> bool {
        self.is_of_input() && self.linear.is_empty() && !self.is_shift()
    }

    fn signals(
        &self,
        recordings: &[&Recording],
        forces: &OnceCell<Vec<Forces>>,
    ) -> Vec<Vec<[f64; 2]>> {
        let Some(coupling) = self.coupling() else {
            return signals(&self.effect, &self.p, &self.linear, recordings);
        };
        let all = || recordings.par_iter().map(|r| Forces::of(&self.around, r)).collect();
        let forces = forces.get_or_init(all).iter();
        forces.zip(recordings).map(|(f, r)| joint_signal(coupling, f, r)).collect()
    }

    /// Whether the effect can act the same on both wheels of a single axis: one column that does,
    /// or a column a wheel.
    pub(super) fn treats_wheels_alike(&self, model: &Model, recording: &Recording) -> bool {
        if self.columns() != 1 {
            return true;
        }
        let mut row = [[0.0; 2]];
        recording.local_motion().iter().enumerate().step_by(11).all(|(k, m)| {
            self.torque(0, &still_instant(model, recording, k, m), &mut row);
            (row[0][0] - row[0][1]).abs() <= 1e-9 * row[0][0].abs()
        })
    }

    /// Number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        match self.form {
            Form::Instant => self.linear.len(),
            Form::Signal(_) => 1,
        }
    }

    /// Whether the estimate of column `c` may not be negative.
    #[must_use]
    pub fn not_negative(&self, c: usize) -> bool {
        match self.form {
            Form::Instant => self.effect.parameters()[self.linear[c]].range.0 >= 0.0,
            Form::Signal(_) => {
                self.linear.is_empty() || self.effect.parameters()[self.linear[c]].range.0 >= 0.0
            }
        }
    }

    /// Writes the torque of each column on the input side [N m].
    pub fn torque(&self, recording: usize, at: &Instant, out: &mut [[f64; 2]]) {
        match &self.form {
            Form::Signal(signals) => {
                let signal = &signals[recording];
                let (a, b) = (signal[at.sample], signal[(at.sample + 1).min(signal.len() - 1)]);
                out[0] = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
            }
            Form::Instant => {
                self.of_terms(&self.variables(), at, |j| sign(at, self.rest, j), out);
            }
        }
    }

    /// Calls `see` for every instant with the torque of each column on the side of the input at its row itself [N m].
    pub(super) fn torque_at_rows<'a>(
        &self,
        recording: usize,
        instants: impl Iterator<Item = Instant<'a>>,
        mut see: impl FnMut(&[[f64; 2]]),
    ) {
        let p = self.variables();
        let mut torque = [[0.0; 2]; DIFFERENTIATED];
        let torque = &mut torque[..self.columns()];
        for at in instants {
            match &self.form {
                Form::Signal(signals) => torque[0] = signals[recording][at.sample],
                Form::Instant => self.of_terms(&p, &at, |j| sign(&at, self.rest, j), torque),
            }
            see(torque);
        }
    }

    /// The parameters, of which the linear ones are variables at zero.
    fn variables(&self) -> [Own; MOST_PARAMETERS] {
        let mut p = [Own::constant(0.0); MOST_PARAMETERS];
        p.iter_mut().zip(&self.p).for_each(|(own, value)| own.value = *value);
        for (column, &j) in self.linear.iter().enumerate() {
            p[j] = Own::variable(0.0, column);
        }
        p
    }

    /// The columns from the derivatives of the effect by its variables `p`, with `sign` of the speed along each
    /// direction.
    fn of_terms(
        &self,
        p: &[Own; MOST_PARAMETERS],
        at: &Instant,
        sign: impl Fn(usize) -> f64,
        out: &mut [[f64; 2]],
    ) {
        let Motion { t, alpha, omega, variance, robot } = at.motion;
        let (alpha, omega) = (alpha.map(Own::constant), omega.map(Own::constant));
        let x = Motion { t: Own::constant(t), alpha, omega, variance, robot };
        let p = &p[..self.p.len()];
        let torque = if self.torque_alone {
            self.effect.torque_own(&x, p)
        } else {
            let terms = self.effect.terms_own(&x, p);
            let rough = |j: usize| terms.level[j] != Own::constant(0.0);
            let signs = std::array::from_fn(|j| if rough(j) { sign(j) } else { 0.0 });
            terms.total_torque(&at.acceleration, &signs)
        };
        for (n, column) in out.iter_mut().enumerate() {
            *column = [0, 1].map(|i| -torque[i].partial[n]);
        }
    }
}

/// The friction sign along a direction; one that the model has none of is smoothed by the spread of the filter's
/// speeds.
fn sign(at: &Instant, rest: f64, direction: usize) -> f64 {
    let v = along(direction, &at.motion.omega);
    let clear = clarity(direction, v, at.speed_variance);
    if at.sign[direction] != 0.0 || clear <= 0.0 {
        return at.sign[direction];
    }
    let spread = [at.motion.variance[2], at.motion.variance[3], at.spread[0], at.spread[1]];
    let width = (2.0 * spread[direction].max(0.0) + rest * rest).sqrt();
    clear * if width > 0.0 { Real::erf(v / width) } else { sgn(v) }
}

/// An instant of the smooth motion, where no filter has run.
pub(super) fn still_instant<'a>(
    model: &'a Model,
    recording: &Recording,
    k: usize,
    m: &LocalMotion,
) -> Instant<'a> {
    Instant {
        sample: k,
        motion: Motion {
            t: recording.t()[k] - recording.t()[0],
            alpha: m.alpha,
            omega: m.omega,
            variance: [0.0; 4],
            robot: model.robot(),
        },
        acceleration: m.acceleration,
        sign: [0.0; 4],
        spread: [0.0; 2],
        speed_variance: 0.0,
        input: recording.torque()[k],
    }
}

/// The effect of a candidate seen on the local motion of the recordings, for its size: root
/// mean square of each column over them [N m per unit].
#[must_use]
pub(super) fn column_size(
    candidate: &Candidate,
    model: &Model,
    recordings: &[&Recording],
) -> Vec<f64> {
    let mut sums = vec![0.0; candidate.columns()];
    let mut count = 0.0;
    let mut row = vec![[0.0; 2]; candidate.columns()];
    for (r, recording) in recordings.iter().enumerate() {
        for (k, m) in recording.local_motion().iter().enumerate().step_by(7) {
            let at = still_instant(model, recording, k, m);
            candidate.torque(r, &at, &mut row);
            for (sum, torque) in sums.iter_mut().zip(&row) {
                *sum += torque[0] * torque[0] + torque[1] * torque[1];
            }
            count += 2.0;
        }
    }
    sums.iter().map(|s| (s / f64::max(count, 1.0)).sqrt().max(1e-12)).collect()
}
