//! The kinds of findings, with their numbers.

use super::Sampled;

/// A finding with counts of type `C` and other numbers of type `R`. Rows are counted from 1, the first row of
/// data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind<C = usize, R = f64> {
    /// Rows in which a column has no number; left out.
    MissingValues {
        /// How many rows.
        rows: C,
        /// The first of them.
        first: C,
    },
    /// A column that has its own, slower rows; read between them.
    SparseColumn {
        /// Part of the rows that have a value \[1\].
        share: R,
    },
    /// A command with separate rows; held in between.
    HeldColumn {
        /// Part of the rows that have a value \[1\].
        share: R,
    },
    /// A column whose cells are written only when the value changes; the last value is held.
    OnChange {
        /// Part of the rows without a value \[1\].
        share: R,
    },
    /// Angles or speeds with fewer samples than the other; left out.
    SlowPair {
        /// Part of the rows that have a new value \[1\].
        share: R,
    },
    /// A column whose rows are those of the recording; rows of other messages only fill their own
    /// columns.
    OwnRows {
        /// Part of the rows that have a value of it \[1\].
        share: R,
    },
    /// A sensor with a new value in other rows than the slowest one; read in the rows of that one, and held between
    /// them.
    ReadTogether {
        /// Part of the rows that have a new value of it \[1\].
        share: R,
    },
    /// Rows whose time repeats or precedes that of others; left out.
    TimeRows {
        /// How many rows.
        rows: C,
        /// The first of them.
        first: C,
    },
    /// Time stamps with jitter; the motion is smoother at equidistant times, which are used.
    Jitter {
        /// Root mean square of the scatter, as a share of a row.
        share: R,
    },
    /// Rows with the newest first; turned round.
    NewestFirst {
        /// How many rows.
        rows: C,
    },
    /// A timer of so many seconds began again.
    ClockWrap {
        /// How often.
        count: C,
        /// The first row behind it.
        row: C,
        /// Time after which the timer begins again \[s\].
        period_s: R,
    },
    /// The clock was set back by this time \[s\]; the rows continue after a gap.
    ClockRestart {
        /// How often.
        count: C,
        /// The first row behind it.
        row: C,
        /// By how much \[s\].
        back_s: R,
    },
    /// A clock that is constant for a number of rows and then advances by a number of seconds.
    CoarseClock {
        /// Step by which it advances \[s\].
        tick_s: R,
        /// Rows within a tick.
        rows: R,
    },
    /// Rows that a receiver stamped in batches; they are moved to equidistant times.
    Batches {
        /// Rows of a batch, on average.
        rows: R,
    },
    /// A speed whose sensor kept its last value while the wheel stood still; its rows are left out.
    Frozen {
        /// How many rows.
        rows: C,
        /// The first of them.
        first: C,
    },
    /// Stretches in which the sensors of a wheel are constant although its input must have moved it; left out.
    Dead {
        /// How many stretches.
        stretches: C,
        /// How many rows.
        rows: C,
        /// Begin of the first one \[s\].
        from_s: R,
        /// End of the first one \[s\].
        to_s: R,
        /// Whether the wheel may have been blocked: the input drives it in one direction only.
        or_blocked: bool,
    },
    /// Rows that repeat the sensors' last sample although the wheels move; late samples are moved to their
    /// rows.
    Stale {
        /// How many rows.
        rows: C,
        /// The first of them.
        first: C,
    },
    /// Rows in which both speeds are half of those around them; left out.
    HalfInterval {
        /// How many rows.
        rows: C,
        /// The first of them.
        first: C,
    },
    /// An angle that wraps at so many radians.
    Wrapped {
        /// Angle after which it begins again \[rad\].
        period_rad: R,
        /// How often.
        turns: C,
    },
    /// An angle whose counter was reset by so many radians.
    Reset {
        /// First row behind the jump, from 0.
        row: C,
        /// Size of the jump \[rad\].
        step_rad: R,
    },
    /// Speeds without angles after a low-pass of their sensor, as determined from the motion.
    LowPass {
        /// Whether it is computed once a row, as an exponential moving average.
        at_rows: bool,
        /// Its time constant \[s\].
        time_s: R,
        /// Standard error of that \[s\].
        std_error_s: R,
        /// Whether a late actuator explains them hardly worse.
        or_late: bool,
    },
    /// An input that is held until the next row, as determined from the motion.
    HeldInput,
    /// An input whose recorded values are means over a row of one that varies within it, as determined from the
    /// motion.
    RowMeans {
        /// From the time of a value to the middle of its row \[s\].
        middle_s: R,
    },
    /// A torque or current with one sample a row that changes at the rows, as determined from the motion: its course
    /// between them is not recorded.
    OneSampleARow {
        /// Half a row, by which the motion follows the samples later or earlier \[s\].
        half_row_s: R,
        /// Where in its row a sample is taken.
        sampled: Sampled,
    },
    /// An input that the experiment file describes as held from row to row and that changes between the rows, as
    /// determined from the motion.
    StepsBetweenRows,
    /// Rows that are missing, lost by the logger or left out, during which an input is held at values that are not used.
    LostRows {
        /// How many.
        rows: C,
    },
    /// Shift of the input relative to the mean of the recordings, as determined from the motion.
    Phase {
        /// Time \[s\].
        shift_s: R,
        /// Standard error of that \[s\].
        std_error_s: R,
    },
    /// Shift of the initial heading relative to the other recordings, as determined from the motion.
    StartHeading {
        /// Angle \[rad\].
        angle_rad: R,
        /// Standard error of that \[rad\].
        std_error_rad: R,
    },
    /// The same of the angle of a wheel.
    StartAngle {
        /// Angle \[rad\].
        angle_rad: R,
        /// Standard error of that \[rad\].
        std_error_rad: R,
    },
    /// Isolated wrong samples.
    Spikes {
        /// How many.
        count: C,
        /// The first of them.
        first: C,
        /// The largest one, from the line between its neighbours.
        largest: R,
    },
    /// Wrong speeds in the first rows of a start; left out.
    Onset {
        /// How many.
        count: C,
        /// The first of them.
        first: C,
        /// The largest one, from the line between its neighbours.
        largest: R,
    },
    /// Ratio of a channel to the corresponding one.
    Unit {
        /// Ratio of speed to slope of the angle.
        factor: R,
        /// Unit whose factor that ratio is.
        unit: &'static str,
    },
    /// Speeds that are this many times the slope of the angles, which is the factor of no unit: a gear between them.
    Gear {
        /// Ratio of speed to slope of the angle.
        ratio: R,
    },
    /// A speed that is this many times the slope of its angle, which is neither a unit nor a gear: one of the two is
    /// calibrated wrongly.
    Gain {
        /// Ratio of speed to slope of the angle.
        ratio: R,
        /// Its standard error.
        std_error: R,
    },
    /// A channel whose sign contradicts the others.
    Sign,
    /// An input whose work is negative, although friction and inertia absorb energy.
    Opposing,
    /// Columns of the other wheel.
    Exchanged,
    /// Speeds that are recorded so much later than the angles \[s\].
    Lag {
        /// Lag \[s\].
        lag_s: R,
        /// Its standard error \[s\].
        std_error_s: R,
    },
    /// Speeds that lag the angles by another time than those of other recordings of the log; not corrected.
    LagsDiffer {
        /// Lag in this recording \[s\].
        lag_s: R,
        /// Its standard error \[s\].
        std_error_s: R,
    },
    /// Speeds delayed by a filter; only the angles are used.
    Filtered {
        /// Lag \[s\].
        lag_s: R,
        /// Its standard error \[s\].
        std_error_s: R,
    },
    /// Speeds that are differences of the angles over so many samples; the angles alone are used.
    Differences {
        /// Over how many samples.
        samples: C,
        /// Lag \[s\].
        lag_s: R,
    },
    /// Speeds that were computed from the angles by a filter; only the angles are used.
    OfAngle {
        /// Residual over the noise of the angle that passes the filter, as a ratio of standard
        /// deviations \[1\].
        share: R,
    },
    /// A speed or angle that stays at one value while its counterpart shows motion; the channels of this kind are not used.
    DeadSensor,
    /// Torques between the wheels as if one of them were counted backwards, sensors and input alike.
    Mirrored,
    /// Speeds without angles that are encoder counts; the accumulated angle is used.
    Counts {
        /// One count \[rad\].
        step_rad: R,
        /// Rows over which each speed is the mean.
        rows: C,
    },
    /// An input of a few levels: commands without noise.
    FewLevels {
        /// How many.
        levels: C,
    },
    /// An input without sign, though the wheel turns both ways.
    Magnitude,
    /// An input that takes the sign of the speed because the experiment file says so.
    SpeedSign {
        /// Part of the rows in which it had another sign \[1\].
        share: R,
    },
    /// A non-zero input while the robot is at rest before it starts.
    RestOffset {
        /// Mean at rest, in the unit of the input.
        mean: R,
        /// Its standard error.
        std_error: R,
    },
    /// An input that fluctuates more slowly than white noise while the robot is at rest.
    RestNoise {
        /// Standard deviation, in the unit of the input.
        sigma: R,
        /// Correlation time \[s\].
        time_s: R,
    },
    /// Sensors that give a new value only every so often \[s\].
    Refresh {
        /// Time between new values \[s\].
        period_s: R,
    },
    /// A quantised channel.
    Quantum {
        /// The step, in the unit of the channel.
        step: R,
    },
}

impl Kind {
    /// Wrong samples by row and deviation, if there are any.
    pub(in crate::conditioning) fn spikes(
        mut found: impl ExactSizeIterator<Item = (usize, f64)>,
    ) -> Option<Self> {
        let count = found.len();
        let (row, out) = found.next()?;
        let largest = found.fold(out, |a, (_, x)| if x.abs() > a.abs() { x } else { a });
        Some(Self::Spikes { count, first: row + 1, largest })
    }

    /// Name, value and unit in `results.json`.
    pub(crate) fn parts(&self) -> (&'static str, f64, &'static str) {
        match *self {
            Self::MissingValues { rows, .. } => ("missing_values", rows as f64, "rows"),
            Self::SparseColumn { share } => ("sparse_column", share, "1"),
            Self::HeldColumn { share } => ("held_column", share, "1"),
            Self::OnChange { share } => ("on_change", share, "1"),
            Self::SlowPair { share } => ("slow_pair", share, "1"),
            Self::OwnRows { share } => ("own_rows", share, "1"),
            Self::ReadTogether { share } => ("read_together", share, "1"),
            Self::TimeRows { rows, .. } => ("time_not_increasing", rows as f64, "rows"),
            Self::NewestFirst { rows } => ("newest_first", rows as f64, "rows"),
            Self::Jitter { share } => ("jitter", share, "rows"),
            Self::ClockWrap { period_s, .. } => ("clock_wrap", period_s, "s"),
            Self::ClockRestart { back_s, .. } => ("clock_restart", back_s, "s"),
            Self::CoarseClock { tick_s, .. } => ("coarse_clock", tick_s, "s"),
            Self::Batches { rows } => ("batches", rows, "rows"),
            Self::Frozen { rows, .. } => ("frozen", rows as f64, "rows"),
            Self::Dead { rows, .. } => ("dead", rows as f64, "rows"),
            Self::Stale { rows, .. } => ("stale", rows as f64, "rows"),
            Self::HalfInterval { rows, .. } => ("half_interval", rows as f64, "rows"),
            Self::Wrapped { period_rad, .. } => ("wrapped", period_rad, "rad"),
            Self::Reset { step_rad, .. } => ("reset", step_rad, "rad"),
            Self::Spikes { count, .. } => ("spikes", count as f64, "samples"),
            Self::Onset { count, .. } => ("onset", count as f64, "samples"),
            Self::Unit { factor, .. } => ("unit", factor, "1"),
            Self::Gear { ratio } => ("gear", ratio, "1"),
            Self::Gain { ratio, .. } => ("gain", ratio, "1"),
            Self::Sign => ("sign", -1.0, "1"),
            Self::Opposing => ("opposing", -1.0, "1"),
            Self::Exchanged => ("exchanged", 1.0, "1"),
            Self::Lag { lag_s, .. } => ("lag", lag_s, "s"),
            Self::LagsDiffer { lag_s, .. } => ("lags_differ", lag_s, "s"),
            Self::Filtered { lag_s, .. } => ("filtered", lag_s, "s"),
            Self::LowPass { time_s, .. } => ("low_pass", time_s, "s"),
            Self::HeldInput => ("held_input", 1.0, "rows"),
            Self::RowMeans { middle_s } => ("row_means", middle_s, "s"),
            Self::OneSampleARow { half_row_s, .. } => ("one_sample_a_row", half_row_s, "s"),
            Self::StepsBetweenRows => ("steps_between_rows", 1.0, "rows"),
            Self::LostRows { rows } => ("lost_rows", rows as f64, "rows"),
            Self::Phase { shift_s, .. } => ("phase", shift_s, "s"),
            Self::StartHeading { angle_rad, .. } => ("start_heading", angle_rad, "rad"),
            Self::StartAngle { angle_rad, .. } => ("start_angle", angle_rad, "rad"),
            Self::Differences { lag_s, .. } => ("differences_of_angle", lag_s, "s"),
            Self::OfAngle { share } => ("computed_from_angle", share, "1"),
            Self::DeadSensor => ("dead_sensor", 1.0, "1"),
            Self::Mirrored => ("mirrored", -1.0, "1"),
            Self::Counts { step_rad, .. } => ("counts", step_rad, "rad"),
            Self::FewLevels { levels } => ("few_levels", levels as f64, "levels"),
            Self::Magnitude => ("magnitude", 1.0, "1"),
            Self::SpeedSign { share } => ("speed_sign", share, "1"),
            Self::RestOffset { mean, .. } => ("rest_offset", mean, "input"),
            Self::RestNoise { sigma, .. } => ("rest_noise", sigma, "input"),
            Self::Refresh { period_s } => ("refresh", period_s, "s"),
            Self::Quantum { step } => ("quantum", step, "SI"),
        }
    }
}
