//! Limits for speeds.

/// Speeds: counts of an encoder, rests and delays.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Speeds {
    /// Smallest number of rows in motion for counts of an encoder: fewer may lie on a grid by chance or by rounding of
    /// the file.
    pub counted_rows: usize,
    /// Smallest number of different counts per row (judgement: fewer show no variance).
    pub counted_levels: usize,
    /// Largest root mean square distance from whole counts, in counts: 0.29 for other speeds, 0.01 for counts written
    /// with four digits.
    pub off_counts: f64,
    /// Variance of the second differences above that is nearer to that of counts, 20/12, than to that of rounded
    /// speeds, 6/12, by their logarithms.
    pub counted: f64,
    /// Ratio of the variances of sums over two rows and of single ones up to which it is nearer to that of counts, 1,
    /// than to that of rounded speeds, 2, by their logarithms.
    pub taken_back: f64,
    /// Variance of the second differences from which on the motion hides that of counts: 20/12 by rounding, and as
    /// much by the motion.
    pub hidden_by_motion: f64,
    /// Largest number of counts of the smallest speed of a recording (judgement).
    pub least_counts: u32,
    /// Largest number of rows over which a driver takes means (judgement).
    pub mean_rows: usize,
    /// Largest relative difference of the step of a grid from a described count: that of a factor stated with three
    /// digits (judgement: another encoder differs by more).
    pub same_count: f64,
    /// Ratio of the angle of a value kept at rest to that of nine in ten others (judgement).
    pub kept_angle: f64,
    /// Smallest number of rows of a value kept at rest: with fewer the angle of one value is known to less than a
    /// third.
    pub kept_rows: usize,
    /// Share of the usual input below which it drives no more, and of a speed by which no wheel changes in a row after
    /// it has not changed at all (judgement).
    pub kept_half: f64,
    /// Smallest number of changes of an angle for which rows that repeat both angle and speed are left out before a
    /// delay is estimated (judgement).
    pub fewest_moves: usize,
    /// Smallest number of windows from which a delay is estimated (judgement).
    pub lag_windows: usize,
    /// Number of standard errors from which on a delay of a speed is one: one in two million by chance.
    pub lag_errors: f64,
    /// Delay in samples below which it is not significant: 1/√12, the standard deviation of an unknown sampling
    /// instant within a row.
    pub lag_rows: f64,
    /// Largest delay in samples of one sensor that is read after the other; a longer one is that of a filter or a late
    /// message (judgement).
    pub skew: f64,
    /// Number of standard errors by which a low-pass must explain the angles better than a delay of about a row: a delay is
    /// taken for a low-pass by chance in one of forty logs, whose speeds are then not used.
    pub smoothed_errors: f64,
    /// Share of the changes of the speed that must agree with a delay: with less, it is not that of the motion.
    pub informed: f64,
    /// Number of robust deviations beyond which a window is left out: jumps of the angle (judgement).
    pub jumps: f64,
    /// Share of the noise of the speeds that differences of the angles may leave if they are the same sensor: an own
    /// sensor leaves at least all of it.
    pub shared_noise: f64,
    /// Ratio of the noise of the slope of an angle to that of the speed up to which it is as accurate (judgement).
    pub as_accurate: f64,
    /// Largest ratio of the residual of speeds that are computed from the angles to the noise that the filter passes,
    /// as standard deviations: for an independent sensor it is at least one.
    pub of_angle: f64,
    /// Correlation of neighbouring fourth differences of the angle up to which they show its noise: -0.8 for white
    /// noise, up to 1 for motion or a filter, which here make a ninth of them at most.
    pub white: f64,
    /// Smallest number of rows per coefficient of this filter (judgement).
    pub rows_a_coefficient: usize,
}

pub(in crate::conditioning) const SPEEDS: Speeds = Speeds {
    counted_rows: 100,
    counted_levels: 4,
    off_counts: 0.05,
    counted: 0.913,
    taken_back: 1.414,
    hidden_by_motion: 2.0 * 20.0 / 12.0,
    least_counts: 8,
    mean_rows: 8,
    same_count: 1e-3,
    kept_angle: 3.0,
    kept_rows: 4,
    kept_half: 0.5,
    fewest_moves: 50,
    lag_windows: 20,
    lag_errors: 5.0,
    lag_rows: 0.289,
    skew: 1.5,
    smoothed_errors: 2.0,
    informed: 0.5,
    jumps: 8.0,
    shared_noise: 0.25,
    as_accurate: 3.0,
    of_angle: 0.25,
    white: -0.6,
    rows_a_coefficient: 20,
};
