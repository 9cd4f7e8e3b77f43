//! Products of a candidate's columns over the rows of the regression.

use std::ops::Range;

use nalgebra::DMatrix;

use super::Regression;
use crate::compare::{FilterRoom, filter_together};
use crate::diagnose::candidate::{Candidate, still_instant};
use crate::math::{FILLED, add_products};

/// Room for the columns of a candidate, to be used again for the next one.
#[derive(Default)]
pub struct ColumnRoom {
    signals: Vec<Vec<[f64; 2]>>,
    filter: FilterRoom,
    rows: Vec<f64>,
}

/// Products of a candidate's columns with each other, and with the basis and, in the last column, the residual torque.
pub(in crate::diagnose) struct Products {
    pub(in crate::diagnose) among: DMatrix<f64>,
    pub(in crate::diagnose) beside: DMatrix<f64>,
}

/// Numbers a row of so many columns.
pub(super) fn own_width(count: usize) -> usize {
    count.next_multiple_of(FILLED)
}

impl Regression<'_> {
    /// The products of a candidate's columns over all rows.
    pub(super) fn products(&self, candidate: &Candidate, room: &mut ColumnRoom) -> Products {
        let (count, base) = (candidate.columns(), self.basis.ncols());
        let none = Products {
            among: DMatrix::zeros(count, count),
            beside: DMatrix::zeros(count, base + 1),
        };
        self.products_by_recording(candidate, room).into_iter().fold(none, |sum, one| Products {
            among: sum.among + one.among,
            beside: sum.beside + one.beside,
        })
    }

    /// The same over the rows of each recording.
    pub(in crate::diagnose) fn products_by_recording(
        &self,
        candidate: &Candidate,
        room: &mut ColumnRoom,
    ) -> Vec<Products> {
        let (count, base, beside) = (candidate.columns(), self.basis.ncols(), self.width);
        let own = own_width(count);
        let mut out = Vec::with_capacity(self.smoothed.recordings.len());
        self.each_recording(candidate, room, |numbers, width, rows| {
            let (mut by_own, mut by_beside) = (vec![0.0; count * own], vec![0.0; count * beside]);
            let others = &self.beside[numbers.start * beside..numbers.end * beside];
            add_products((rows, width), (others, beside), &mut by_beside);
            add_products((rows, width), (rows, width), &mut by_own);
            out.push(Products {
                among: DMatrix::from_fn(count, count, |n, m| by_own[n * own + m]),
                beside: DMatrix::from_fn(count, base + 1, |n, b| by_beside[n * beside + b]),
            });
        });
        out
    }

    /// Calls `see` for every recording with the numbers of its rows and the columns of a candidate at them, low-passed:
    /// so many numbers a row, filled up with zeros.
    pub(super) fn each_recording(
        &self,
        candidate: &Candidate,
        room: &mut ColumnRoom,
        mut see: impl FnMut(Range<usize>, usize, &[f64]),
    ) {
        let count = candidate.columns();
        let width = own_width(count);
        let ColumnRoom { signals, filter, rows } = room;
        signals.resize_with(count.max(signals.len()), Vec::new);
        let signals = &mut signals[..count];
        for smooth in self.smoothed.recordings.iter() {
            let r = smooth.recording;
            signals.iter_mut().for_each(Vec::clear);
            let at = |k: usize| still_instant(self.model, r, k, &smooth.motion[k]);
            candidate.torque_at_rows(smooth.index, (0..r.len()).map(at), |torque| {
                signals.iter_mut().zip(torque).for_each(|(signal, value)| signal.push(*value));
            });
            filter_together(r, self.smoothed.cutoff, signals, filter);
            let numbers = self.numbers_of(smooth);
            rows.clear();
            rows.resize(numbers.len() * width, 0.0);
            for (row, (_, k, i)) in rows.chunks_exact_mut(width).zip(self.rows_of(smooth)) {
                row.iter_mut().zip(&*signals).for_each(|(out, signal)| *out = signal[k][i]);
            }
            see(numbers, width, rows);
        }
    }
}
