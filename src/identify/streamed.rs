//! The regression of [`super::inverse_dynamics`] from rows that are read block by block, in memory
//! that does not grow with them.
//!
//! Every row passes the same filter and the same choice as in memory. A stretch of rows is filtered
//! with margins on either side that are long enough for the end transients of the filter to decay; of
//! the rows that are used only the triangular factor of their QR decomposition is kept, one per block
//! of 5 s and wheel:
//!
//! ```text
//! [x y] = Q R,   R'R = [x y]'[x y]
//! ```
//! Estimates, residual sums of squares and sums of scores over blocks, and therefore covariances,
//! are the same from R as from the rows. The contribution of noise to the sums, which is a random draw in any case, is
//! measured in stretches distributed over the whole recording.
//!
//! Source: Lawson and Hanson, Solving Least Squares Problems, ch. 27 (sequential accumulation).

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::inverse_dynamics::{Regression, block_length};
use super::regressor::input_along;
use super::stretch::{Signals, Source, Stretch, Treatment};
use super::{IdentifyError, Task};
use crate::recording::{Channels, LongRecording, Noise, Recording, Rows, differentiate, is_gap};

/// Time after which the response of the filter, applied twice, has decayed to 1e-9 [s Hz]: the
/// slowest pole decays as exp(-2.4 fc t), one pass needs 8.6.
const SETTLED: f64 = 20.0;
/// Smallest number of rows that are filtered at a time, without the margins.
const CORE: usize = 1 << 16;
/// Stretches of a recording in which the contribution of noise is measured: a million rows. A variance from 1000
/// independent rows of each has a relative error of √(2/16000), one in a hundred.
const NOISE_STRETCHES: usize = 16;

/// The regression from every row: long recordings are read again, the others are in memory.
/// `settings` are cut-off \[Hz\] and speed near rest [rad/s] if they are given; otherwise they are
/// determined from the windows in memory.
///
/// # Errors
/// As [`Regression::with_rest`], and if rows cannot be read.
pub(super) fn regression<'a>(
    task: &'a Task<'a>,
    long: &[Option<&LongRecording>],
    settings: (Option<f64>, Option<f64>),
    noise_share: f64,
    method: &str,
) -> Result<Regression<'a>, IdentifyError> {
    let mut out = Regression::empty(task, settings.0, settings.1, noise_share, method)?;
    let of = |r: usize| long.get(r).copied().flatten();
    let total = |(r, held): (usize, &Recording)| of(r).map_or(held.duration(), |l| l.duration);
    let length = block_length(task.train.iter().enumerate().map(total).sum());
    let mut rows = Triangles::new(out.regressor.width(), length);
    let mut samples = 0;
    for (r, held) in task.train.iter().enumerate() {
        let source: &dyn Rows = of(r).map_or(held, |long| &*long.rows);
        let samples_of = of(r).map_or(held.len(), |long| long.samples);
        let mut reader = Reader::new(&out, r, samples_of, &mut rows);
        for block in source.blocks() {
            let wrong = |reason| IdentifyError::Rows { method: method.into(), reason };
            let block = block.map_err(wrong)?;
            samples += block.t.len();
            reader.take(block);
        }
        reader.end_piece();
        reader.end();
    }
    rows.into_regression(&mut out);
    out.check_count(samples, method)?;
    out.project();
    Ok(out)
}

/// Reads one recording: cuts it at gaps, filters stretches, hands on the rows that are used.
struct Reader<'a, 'b> {
    regression: &'b Regression<'a>,
    treatment: Treatment,
    noise: Noise,
    same: bool,
    rng: ChaCha8Rng,
    rows: &'b mut Triangles,
    /// Time of the first row \[s\].
    start: Option<f64>,
    /// Last time, speed and angle, to integrate on from.
    last: Option<(f64, [f64; 2], [f64; 2])>,
    /// Rows of the piece that are still needed; `omega` may be empty, then they are differenced.
    t: Vec<f64>,
    alpha: Vec<[f64; 2]>,
    omega: Vec<[f64; 2]>,
    torque: Vec<[f64; 2]>,
    /// Rows of the piece before those, and rows of the piece that are done.
    dropped: usize,
    done: usize,
    /// Time of the first row of the piece \[s\].
    piece: f64,
    /// Every how many stretches noise is measured, and how many there were.
    every: usize,
    stretches: usize,
    /// Contribution of noise to `[x y]'[x y]` in the rows in which it is measured, their number, and that of all.
    change: DMatrix<f64>,
    measured: usize,
    used: usize,
}

impl<'a, 'b> Reader<'a, 'b> {
    fn new(
        regression: &'b Regression<'a>,
        r: usize,
        samples: usize,
        rows: &'b mut Triangles,
    ) -> Self {
        let held = &regression.task.train[r];
        let seed = regression.task.seed.wrapping_add(r as u64);
        let columns = rows.width + 1;
        Self {
            regression,
            treatment: regression.treatments[r],
            noise: held.noise(),
            same: held.is_single_axis(),
            rng: ChaCha8Rng::seed_from_u64(seed),
            rows,
            start: None,
            last: None,
            t: vec![],
            alpha: vec![],
            omega: vec![],
            torque: vec![],
            dropped: 0,
            done: 0,
            piece: 0.0,
            every: (samples / (CORE * NOISE_STRETCHES)).max(1),
            stretches: 0,
            change: DMatrix::zeros(columns, columns),
            measured: 0,
            used: 0,
        }
    }

    fn margin(&self) -> usize {
        let settled = SETTLED / self.treatment.cutoff / self.treatment.step;
        settled.ceil() as usize + self.treatment.reach()
    }

    fn take(&mut self, block: Channels) {
        let alpha = block.alpha.or_else(|| Some(self.integrated(&block.t, block.omega.as_ref()?)));
        let Some(alpha) = alpha else { return };
        let enough = CORE.max(2 * self.margin()) + self.margin();
        let step = self.treatment.step;
        let (t, mut from) = (&block.t[..], 0);
        while from < t.len() {
            if self.t.last().is_some_and(|before| is_gap(*before, t[from], step)) {
                self.end_piece();
            }
            if self.t.is_empty() {
                self.piece = t[from];
                self.start.get_or_insert(t[from]);
            }
            // up to the next gap, and no more than a pass takes
            let most = (from + self.done + enough - self.dropped - self.t.len()).min(t.len());
            let to = (from + 1..most).find(|&k| is_gap(t[k - 1], t[k], step)).unwrap_or(most);
            self.t.extend_from_slice(&t[from..to]);
            self.alpha.extend_from_slice(&alpha[from..to]);
            if let Some(omega) = &block.omega {
                self.omega.extend_from_slice(&omega[from..to]);
            }
            self.torque.extend_from_slice(&block.torque[from..to]);
            if self.dropped + self.t.len() >= self.done + enough {
                self.pass(self.dropped + self.t.len() - self.margin());
            }
            from = to;
        }
    }

    /// Angles by the trapezoidal rule, on from the block before.
    fn integrated(&mut self, t: &[f64], omega: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let Some((&first, &speed)) = t.first().zip(omega.first()) else { return vec![] };
        let (mut before, mut slower, mut alpha) = self.last.unwrap_or((first, speed, [0.0; 2]));
        let mut out = Vec::with_capacity(t.len());
        for (&t, &omega) in t.iter().zip(omega) {
            let half = 0.5 * (t - before);
            alpha = [0, 1].map(|i| alpha[i] + half * (omega[i] + slower[i]));
            (before, slower) = (t, omega);
            out.push(alpha);
        }
        self.last = Some((before, slower, alpha));
        out
    }

    fn end_piece(&mut self) {
        let rows = self.dropped + self.t.len();
        if !self.treatment.is_too_short(rows) {
            self.pass(rows);
        }
        self.rows.end_piece();
        (self.dropped, self.done) = (0, 0);
        self.t.clear();
        self.alpha.clear();
        self.omega.clear();
        self.torque.clear();
    }

    /// Filters what is held and hands on the rows of the piece from `done` to `until`.
    fn pass(&mut self, until: usize) {
        if self.omega.is_empty() {
            let all = 0..self.t.len();
            let omega = differentiate(&self.t, &self.alpha, std::slice::from_ref(&all), 1);
            self.hand_on(&omega, until);
        } else {
            let omega = std::mem::take(&mut self.omega);
            self.hand_on(&omega, until);
            self.omega = omega;
        }
        self.done = until;
        let drop = until.saturating_sub(self.margin()).saturating_sub(self.dropped);
        self.t.drain(..drop);
        self.alpha.drain(..drop);
        self.omega.drain(..drop.min(self.omega.len()));
        self.torque.drain(..drop);
        self.dropped += drop;
    }

    fn hand_on(&mut self, omega: &[[f64; 2]], until: usize) {
        let movements = self.treatment.movements(omega);
        let usable = self.treatment.usable(&movements, omega.len());
        let every = self.treatment.every;
        let grid = (self.done.next_multiple_of(every)..until).step_by(every);
        let kept: Vec<usize> =
            grid.map(|place| place - self.dropped).filter(|&k| usable[k]).collect();
        if kept.is_empty() {
            return;
        }
        self.used += kept.len();
        self.stretches += 1;
        let is_measured = (self.stretches - 1).is_multiple_of(self.every);
        let noisy = is_measured.then(|| self.with_noise(omega));
        let plain = || self.signals(&self.alpha, omega, &self.torque, &movements);
        let plain = match &noisy {
            Some(Source { alpha, omega, input }) => {
                let noisy = || self.signals(alpha, omega, input, &movements);
                let (plain, noisy) = rayon::join(plain, noisy);
                self.measure_noise(&plain, &noisy, &kept);
                plain
            }
            None => plain(),
        };
        for k in kept {
            self.rows.add(self.t[k] - self.piece, &plain, k);
        }
    }

    /// The rows that are held, with noise added.
    fn with_noise(&mut self, omega: &[[f64; 2]]) -> Source {
        let (alpha, input) = (self.alpha.clone(), self.torque.clone());
        let source = Source { alpha, omega: omega.to_vec(), input };
        source.with_noise(&self.noise, self.same, &mut self.rng)
    }

    /// Adds the contribution of noise in the rows `kept`.
    fn measure_noise(&mut self, plain: &Signals, noisy: &Signals, kept: &[usize]) {
        let columns = self.rows.width + 1;
        for &k in kept {
            for wheel in 0..2 {
                let change = |c: usize, _| noisy.at(wheel, c, k) - plain.at(wheel, c, k);
                let change = DVector::from_fn(columns, change);
                self.change.ger(1.0, &change, &change, 1.0);
            }
        }
        self.measured += kept.len();
    }

    /// Hands on the contribution of noise, as that of all rows.
    fn end(self) {
        if self.measured > 0 {
            self.rows.noise += self.change * (self.used as f64 / self.measured as f64);
        }
    }

    /// Filtered columns and right-hand side of the rows that are held, from this motion and input.
    fn signals(
        &self,
        alpha: &[[f64; 2]],
        omega: &[[f64; 2]],
        input: &[[f64; 2]],
        movements: &[Range<usize>],
    ) -> Signals {
        let Regression { task, regressor, .. } = self.regression;
        let all = 0..self.t.len();
        let input = &input_along(task, &self.t, std::slice::from_ref(&all), input);
        let start = self.start.unwrap_or(0.0);
        let stretch = Stretch { t: &self.t, start, alpha, omega, input };
        stretch.signals(regressor, task.model, &self.treatment, movements)
    }
}

/// Triangles of the rows so far.
struct Triangles {
    width: usize,
    /// Length of a block \[s\].
    length: f64,
    /// Rows of the block that is being filled, per wheel.
    open: [Vec<f64>; 2],
    /// Its number, the number of the first block of the piece, and the next one that is free.
    number: usize,
    first: usize,
    free: usize,
    /// Triangles row after row, with wheel and block of each row.
    closed: Vec<f64>,
    wheel: Vec<usize>,
    block: Vec<usize>,
    /// Contribution of noise to `[x y]'[x y]`.
    noise: DMatrix<f64>,
    /// Rows so far.
    count: usize,
}

impl Triangles {
    fn new(width: usize, length: f64) -> Self {
        Self {
            width,
            length,
            open: [vec![], vec![]],
            number: 0,
            first: 0,
            free: 0,
            closed: vec![],
            wheel: vec![],
            block: vec![],
            noise: DMatrix::zeros(width + 1, width + 1),
            count: 0,
        }
    }

    /// Adds both rows of one sample, so many seconds after the start of its piece.
    fn add(&mut self, since: f64, plain: &Signals, k: usize) {
        let number = self.first + (since / self.length) as usize;
        if number != self.number {
            self.close();
            self.number = number;
        }
        self.free = number + 1;
        let columns = self.width + 1;
        for wheel in 0..2 {
            self.open[wheel].extend((0..columns).map(|c| plain.at(wheel, c, k)));
            self.count += 1;
        }
    }

    fn end_piece(&mut self) {
        self.close();
        (self.first, self.number) = (self.free, self.free);
    }

    /// Keeps the triangles of the block in place of its rows.
    fn close(&mut self) {
        let columns = self.width + 1;
        for wheel in 0..2 {
            let rows = self.open[wheel].len() / columns;
            let mut triangle = DMatrix::from_row_slice(rows, columns, &self.open[wheel]);
            if rows > columns {
                triangle = triangle.qr().r();
            }
            for row in triangle.row_iter() {
                self.closed.extend(row.iter());
                self.wheel.push(wheel);
                self.block.push(self.number);
            }
            self.open[wheel].clear();
        }
    }

    fn into_regression(mut self, out: &mut Regression) {
        self.close();
        let all = DMatrix::from_row_slice(self.wheel.len(), self.width + 1, &self.closed);
        out.x = all.columns(0, self.width).into_owned();
        out.y = all.column(self.width).into_owned();
        (out.wheel, out.block) = (self.wheel, self.block);
        (out.noise, out.count) = (self.noise, self.count);
    }
}

#[cfg(test)]
mod tests;
