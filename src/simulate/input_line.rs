//! The input between two samples.

/// A straight line of the input over one sample.
#[derive(Clone, Copy)]
pub(super) struct InputLine {
    from: f64,
    per_second: f64,
    start: [f64; 2],
    change: [f64; 2],
}

impl InputLine {
    pub(super) fn new(from: f64, to: f64, start: &[f64; 2], end: &[f64; 2]) -> Self {
        let change = [end[0] - start[0], end[1] - start[1]];
        Self { from, per_second: 1.0 / (to - from), start: *start, change }
    }
    #[inline]
    pub(super) fn share(&self, t: f64) -> f64 {
        (t - self.from) * self.per_second
    }
    #[inline]
    pub(super) fn at(&self, t: f64) -> [f64; 2] {
        let c = self.share(t);
        [self.start[0] + c * self.change[0], self.start[1] + c * self.change[1]]
    }
}
