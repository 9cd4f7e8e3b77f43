//! Limits for time stamps, rows and empty cells.

/// Time stamps, rows and empty cells.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Times {
    /// Smallest number of rows of a log that is conditioned; a shorter one is left as it is (judgement).
    pub fewest_rows: usize,
    /// Share of the steps of time that are negative, from which on the newest row is first (judgement: a log in its
    /// order has few, one that was written backward has hardly any others).
    pub falling: f64,
    /// Number of rows after a backward step that must all lie before it, for a restarted clock. One row that is late,
    /// or a few that came in another order, do not repeat that often (judgement).
    pub restarted_rows: usize,
    /// Largest deviation of a backward step from the period of a timer that wraps, in steps of the rows (judgement:
    /// the row after it may be late).
    pub after_wrap: f64,
    /// Mean number of rows within a tick from which on a clock is coarse, half way between one and two; repeated
    /// stamps that are fewer are those of single rows.
    pub rows_a_tick: f64,
    /// Share by which the number of rows of a tick may differ from the usual one, and at least one row (judgement).
    pub tick_rows: f64,
    /// Share of a tick by which its multiples are rounded: those of a timer of 1/64 s in milliseconds.
    pub tick_rounded: f64,
    /// Number of ticks to the next stamp above which rows are missing, half way between one and two.
    pub next_tick: f64,
    /// Share of the repeated stamps whose row repeats the row before as a whole, above which a logger writes rows
    /// twice: most of them.
    pub written_twice: f64,
    /// Scatter of the stamps, in rows, up to which they are left alone (judgement).
    pub scattered: f64,
    /// Scatter of a stamp, in rows, beyond which its row is not distinguishable from the next.
    pub row_unknown: f64,
    /// Share of the rows with such a scatter above which rows are not counted by their stamps (judgement).
    pub rows_unknown: f64,
    /// Number of standard errors by which the motion must be smoother on even times: one log in a million by chance.
    pub even_times_errors: f64,
    /// Largest difference of the steps of an even logger from whole rows, in rows, where rows are lost (judgement).
    pub whole_rows: f64,
    /// Share of empty cells above which a column is slower than the rows, not damaged (judgement): lost messages leave
    /// a few gaps, a slow sensor leaves most rows empty.
    pub slow_column: f64,
    /// Share of empty cells up to which they are lost messages, and no test of whether the column is written on change
    /// is made (judgement).
    pub lost_cells: f64,
    /// Smallest number of steps between values for this test (judgement: fewer show no rule).
    pub fewest_changes: usize,
    /// Share of the largest speed up to which a wheel is at rest in such a column (judgement).
    pub rests_below: f64,
    /// Smallest number of steps between values, of the smallest size of their column, by which a table is recognised in
    /// which values that stay are not written: of values read at any time half as many stay, and ten or more are two or
    /// fewer by chance in three of a thousand logs.
    pub fewest_one_step: usize,
    /// Largest number of values that stay in such a table, as a part of those steps (judgement: an entry that was
    /// written twice).
    pub stays: f64,
    /// Share of the samples of the fastest sensor below which another one is slow: of lines between its samples the
    /// noise is less than that of the sensor, and one row in five moves what the rows show of it by a tenth.
    pub fewer_samples: f64,
    /// Smallest ratio of the samples of two sensors that are read at the same rate (judgement).
    pub same_rate: f64,
}

pub(in crate::conditioning) const TIMES: Times = Times {
    fewest_rows: 50,
    falling: 0.95,
    restarted_rows: 10,
    after_wrap: 2.0,
    rows_a_tick: 1.5,
    tick_rows: 0.1,
    tick_rounded: 0.1,
    next_tick: 1.5,
    written_twice: 0.5,
    scattered: 0.01,
    row_unknown: 0.5,
    rows_unknown: 0.05,
    even_times_errors: 5.0,
    whole_rows: 0.1,
    slow_column: 0.05,
    lost_cells: 0.05,
    fewest_changes: 10,
    rests_below: 0.05,
    fewest_one_step: 20,
    stays: 0.1,
    fewer_samples: 0.8,
    same_rate: 0.5,
};
