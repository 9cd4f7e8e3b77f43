//! What is kept of a recorded input when it is interpolated.

use std::ops::Range;
use std::sync::Arc;

/// What is kept of the recorded input of a recording with an interpolated one.
#[derive(Clone, Debug)]
pub(super) struct Interpolated {
    /// Noise of the recorded input [unit of the input].
    pub(super) noise: [f64; 2],
    /// The even and the odd recorded rows, interpolated likewise; `None` after a change of the input.
    pub(super) half_rate: Option<[Arc<[[f64; 2]]>; 2]>,
}

impl Interpolated {
    /// What remains if the input is replaced by another one.
    pub(super) fn of_other_input(&self) -> Self {
        Self { noise: self.noise, half_rate: None }
    }

    /// Of a range of the rows.
    pub(super) fn cut(&self, range: Range<usize>) -> Self {
        let cut = |rows: &Arc<[[f64; 2]]>| rows[range.clone()].into();
        let half_rate = self.half_rate.as_ref().map(|both| both.each_ref().map(cut));
        Self { noise: self.noise, half_rate }
    }
}
