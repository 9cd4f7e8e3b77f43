//! Limits for wheel angles.

/// Wheel angles, alone and beside the speeds.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Angles {
    /// Share of its range beyond which an angle does not move between two samples, but wraps: the shorter way leads
    /// through the wrap.
    pub wraps: f64,
    /// Ratio of a step to the largest ordinary one around it from which on it is not motion: between two rows no wheel
    /// changes its increment by more than that increment itself, unless it is slower than the wrap can be
    /// distinguished from (half a period per row).
    pub beyond_motion: f64,
    /// Largest relative difference between the steps of a wrap, and of a step from the period (judgement: a step
    /// contains the motion of its row).
    pub same_step: f64,
    /// Smallest number of bits of a counter that wraps: none has fewer.
    pub counter_bits: f64,
    /// Motion of a row in quanta above which equal angles in two rows are not due to rounding (judgement).
    pub stale_quanta: f64,
    /// Smallest motion of the rows next to a stale one, in usual motions: half way between a wheel that keeps moving
    /// and one that comes to rest.
    pub stale_beside: f64,
    /// Motion of a row that skips a sample, in usual motions: nearer to two than to one or three.
    pub skipped: [f64; 2],
    /// Number of stale rows from which on a log has them: clocks that drift against each other meet more than once,
    /// while a single such row is due to a coarse encoder or slip.
    pub fewest_stale: usize,
    /// Share of stale rows above which the sensor is slower than the rows (judgement).
    pub most_stale: f64,
    /// Smallest number of windows of motion in which a speed is compared with its angle (judgement).
    pub compared_windows: usize,
    /// Share of the fast motion (95 % quantile) above which a window counts for this ratio (judgement: the steps of an
    /// encoder are small against it).
    pub turns: f64,
    /// Largest relative difference of the ratio from a known factor: rounding of a logger is smaller, and no two
    /// factors are as close.
    pub known_factor: f64,
    /// Largest median deviation of the windows from their ratio, in these differences (judgement: windows of other
    /// channels have no common ratio).
    pub scattered_ratio: f64,
    /// Smallest and largest ratio of a gear between a motor and a wheel (judgement: a smaller one is an error of the
    /// gain).
    pub gears: [f64; 2],
    /// Share of the windows in which the wheels turn against each other above which a wheel is mirrored: only a
    /// turning test is driven like that (judgement).
    pub mirrored: f64,
}

pub(in crate::conditioning) const ANGLES: Angles = Angles {
    wraps: 0.5,
    beyond_motion: 10.0,
    same_step: 0.02,
    counter_bits: 6.0,
    stale_quanta: 4.0,
    stale_beside: 0.5,
    skipped: [1.5, 2.5],
    fewest_stale: 3,
    most_stale: 0.1,
    compared_windows: 10,
    turns: 0.3,
    known_factor: 0.03,
    scattered_ratio: 5.0,
    gears: [1.25, 1000.0],
    mirrored: 2.0 / 3.0,
};
