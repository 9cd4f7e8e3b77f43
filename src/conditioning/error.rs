//! Channels that cannot be used as they are.

/// Why channels are refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConditioningError {
    /// A sensor that never moves while its wheel is driven and the other moves.
    #[error(
        "the {wheel} wheel never moves (its angle and speed stay at {value} in all {rows} rows) although its input is as large as that of the other wheel: its encoder is defective, or the wrong column is assigned. Name another column for it; on runs straight ahead the columns of the other wheel may be used for both, then a1 + a2 and the friction are identifiable; [conditioning] refuse = false keeps it"
    )]
    Dead {
        /// Right or left.
        wheel: &'static str,
        /// Its constant value.
        value: f64,
        /// Number of rows with it.
        rows: usize,
    },
    /// Sensors that give no new value in so long a stretch that too few rows are left.
    #[error(
        "the {wheel} wheel has no new value in rows {} to {} (t = {:.3} to {:.3} s) although its input is large enough to move it, and the other rows last {left_s:.2} s: too short. Its encoder is dead, or the wheel was blocked or not powered; record again, or name another column for it; [conditioning] refuse = false leaves the rows out all the same", rows[0], rows[1], times[0], times[1]
    )]
    DeadFor {
        /// Right or left.
        wheel: &'static str,
        /// First and last row, counted from 1.
        rows: [usize; 2],
        /// Their times \[s\].
        times: [f64; 2],
        /// Duration of the other rows \[s\].
        left_s: f64,
    },
    /// An input without sign.
    #[error(
        "M{wheel} never changes its sign (row {row}: {value} while dalpha{wheel} = {speed:.3} rad/s), although the wheel is driven both ways: a magnitude without sign. Record the signed value, or name the column of the commanded voltage; [conditioning] sign_from_speed = true gives it the sign of the speed (wrong while braking), refuse = false keeps it"
    )]
    Magnitude {
        /// 1 (right) or 2 (left).
        wheel: usize,
        /// First row of backward motion.
        row: usize,
        /// Input there.
        value: f64,
        /// Speed there [rad/s].
        speed: f64,
    },
}
