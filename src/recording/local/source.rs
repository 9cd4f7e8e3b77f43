//! Angles and speeds to which parabolas are fitted.

use std::borrow::Cow;
use std::ops::Range;

use crate::recording::Recording;

/// Angles and speeds around some rows of a recording: those measured, or those beside a part that is known.
pub(super) struct Source<'a> {
    pub(super) recording: &'a Recording,
    /// Row of the first value.
    first: usize,
    alpha: Cow<'a, [[f64; 2]]>,
    omega: Cow<'a, [[f64; 2]]>,
}

impl<'a> Source<'a> {
    /// The measured ones, of all rows.
    pub(super) fn measured(recording: &'a Recording) -> Self {
        let (alpha, omega) = (Cow::Borrowed(recording.alpha()), Cow::Borrowed(recording.omega()));
        Self { recording, first: 0, alpha, omega }
    }

    /// Other ones for the rows from `first` on.
    pub(super) fn other(
        recording: &'a Recording,
        first: usize,
        alpha: Vec<[f64; 2]>,
        omega: Vec<[f64; 2]>,
    ) -> Self {
        Self { recording, first, alpha: Cow::Owned(alpha), omega: Cow::Owned(omega) }
    }

    pub(super) fn alpha(&self, k: usize) -> [f64; 2] {
        self.alpha[k - self.first]
    }

    pub(super) fn omega(&self, k: usize) -> [f64; 2] {
        self.omega[k - self.first]
    }

    /// Angles and speeds of some rows.
    pub(super) fn channels(
        &self,
        rows: Range<usize>,
    ) -> impl Iterator<Item = (&[f64; 2], &[f64; 2])> {
        let own = rows.start.saturating_sub(self.first)..rows.end.saturating_sub(self.first);
        let own = own.start..own.end.max(own.start);
        self.alpha[own.clone()].iter().zip(&self.omega[own])
    }
}
