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
