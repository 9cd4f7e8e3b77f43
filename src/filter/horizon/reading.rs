//! Ways to read the recorded input.

/// How a pass reads the recorded input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reading {
    /// As recorded; derivatives by inertias along the smoothed input.
    Whole,
    /// Every second row from its neighbours, the even ones or the odd ones, to see what the sampling of the input
    /// does.
    HalfRate(usize),
    /// As recorded, derivatives too, to see what its noise does.
    Noisy,
}
