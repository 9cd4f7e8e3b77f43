//! Ways to read the recorded input.

/// How a pass reads the recorded input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reading {
    /// As recorded; derivatives by inertias along the smoothed input.
    Whole,
    /// Every second row interpolated from its neighbours, the even or the odd ones, to determine the effect
    /// of the sampling of the input.
    HalfRate(usize),
    /// As recorded, also for the derivatives, to determine the effect of its noise.
    Noisy,
    /// Held between the rows and later by its standard error, to determine the effect of the time of the input.
    Later,
}
