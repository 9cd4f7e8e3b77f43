//! Simulations of one parameter vector with several inputs and initial states in the lanes of the processor.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::super::input_line::InputLine;
use super::super::stepper::{edge, pieces_between};
use super::super::{Hold, SimulateError};
use super::base_model::{Batch, LARGEST, Part, Wheels, has_lanes, stored};
use crate::math::{Lanes, in_lanes};
use crate::model::Model;
use crate::robot::State;

/// Simulated speeds [rad/s] of several realisations, row by row.
pub(crate) type Speeds = Vec<Vec<[f64; 2]>>;

/// One of several simulations over the same windows.
pub(crate) struct Realisation<'a> {
    /// Acting input in every row of the recording [N m].
    pub(crate) torque: &'a [[f64; 2]],
    /// Initial state of every window.
    pub(crate) starts: &'a [State],
}

/// Simulated speeds [rad/s] in the rows of all `windows`, one window after the other, of every realisation; NaN in
/// windows that diverge. `None` if the model is not simulated in lanes.
///
/// Each realisation equals a simulation of its own to rounding.
///
/// # Errors
/// The mass matrix is not positive definite.
pub(crate) fn speeds_of_realisations(
    model: &Model,
    p: &[f64],
    (t, hold): (&[f64], Hold),
    windows: &[Range<usize>],
    realisations: &[Realisation],
) -> Option<Result<Speeds, SimulateError>> {
    let simulated = SideBySide { model, p, t, hold, windows, realisations };
    has_lanes(model).then(|| in_lanes(simulated))
}

/// Realisations over the same windows.
#[derive(Clone, Copy)]
pub(super) struct SideBySide<'a> {
    pub(super) model: &'a Model,
    pub(super) p: &'a [f64],
    pub(super) t: &'a [f64],
    pub(super) hold: Hold,
    pub(super) windows: &'a [Range<usize>],
    pub(super) realisations: &'a [Realisation<'a>],
}

impl WithSimd for SideBySide<'_> {
    type Output = Result<Speeds, SimulateError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let rows: usize = self.windows.iter().map(Range::len).sum();
        let mut out: Speeds = self.realisations.iter().map(|_| Vec::with_capacity(rows)).collect();
        let width = Lanes::<S>::COUNT;
        for (some, out) in self.realisations.chunks(width).zip(out.chunks_mut(width)) {
            for (n, window) in self.windows.iter().enumerate() {
                self.window(simd, some, (n, window), out)?;
            }
        }
        Ok(out)
    }
}

impl SideBySide<'_> {
    /// Adds the speeds in one window of the realisations of a register.
    #[inline(always)]
    fn window<S: Simd>(
        &self,
        simd: S,
        some: &[Realisation],
        (n, rows): (usize, &Range<usize>),
        out: &mut [Vec<[f64; 2]>],
    ) -> Result<(), SimulateError> {
        let simulations: Vec<_> = some.iter().map(|one| (self.p, one.starts[n])).collect();
        let mut batch = Batch::<S>::new(simd, self.model, self.t[0], &simulations);
        let torques: Vec<Stored> = rows.clone().map(|k| torques(some, k)).collect();
        let mut speeds: Vec<Stored> = Vec::with_capacity(rows.len());
        speeds.push([stored(batch.omega[0]), stored(batch.omega[1])]);
        for k in rows.start + 1..rows.end {
            let (from, to) = (self.t[k - 1], self.t[k]);
            let last = if self.hold == Hold::Linear { k } else { k - 1 };
            let ends = (
                loaded(simd, &torques[k - 1 - rows.start]),
                loaded(simd, &torques[last - rows.start]),
            );
            // the times of all lanes are alike
            let times = InputLine::new(from, to, &[0.0; 2], &[0.0; 2]);
            let pieces = pieces_between(from, to);
            for piece in 0..pieces {
                let from = edge(self.t[k - 1], to, (piece, pieces));
                let to = edge(self.t[k - 1], to, (piece + 1, pieces));
                let middle = from + 0.5 * (to - from);
                let torque = [
                    on_line(&ends, times.share(from)),
                    on_line(&ends, times.share(middle)),
                    on_line(&ends, times.share(to)),
                ];
                batch.advance(&Part { from, to, torque }, |lane| {
                    let torque = some[lane].torque;
                    InputLine::new(self.t[k - 1], self.t[k], &torque[k - 1], &torque[last])
                });
            }
            batch.limit(to);
            speeds.push([stored(batch.omega[0]), stored(batch.omega[1])]);
        }
        for (lane, out) in out.iter_mut().enumerate() {
            out.extend(speeds.iter().map(|[first, second]| [first[lane], second[lane]]));
        }
        for (failed, out) in batch.failures().into_iter().zip(out) {
            match failed {
                None => {}
                Some(SimulateError::Diverged { .. }) => {
                    let first = out.len() - rows.len();
                    out[first..].fill([f64::NAN; 2]);
                }
                Some(other) => return Err(other),
            }
        }
        Ok(())
    }
}

/// A number of each wheel in one row in each lane. All rows of a window are stored before the first register is loaded:
/// one that is loaded from numbers just stored one by one waits until they are in memory.
type Stored = [[f64; LARGEST]; 2];

/// The inputs in a row; unused lanes repeat the last realisation.
fn torques(some: &[Realisation], k: usize) -> Stored {
    let last = some[some.len() - 1].torque[k];
    let mut wheels = [[last[0]; LARGEST], [last[1]; LARGEST]];
    for (lane, one) in some.iter().enumerate() {
        (wheels[0][lane], wheels[1][lane]) = (one.torque[k][0], one.torque[k][1]);
    }
    wheels
}

#[inline(always)]
fn loaded<S: Simd>(simd: S, wheels: &Stored) -> Wheels<S> {
    [Lanes::load(simd, &wheels[0]), Lanes::load(simd, &wheels[1])]
}

/// The inputs at a share of the time between two rows.
#[inline(always)]
fn on_line<S: Simd>((start, end): &(Wheels<S>, Wheels<S>), share: f64) -> Wheels<S> {
    [start[0] + (end[0] - start[0]) * share, start[1] + (end[1] - start[1]) * share]
}
