//! Findings that differ in their numbers alone, and what they become together.

use super::Kind;
use crate::math::{Span, Statement};

impl<C: Copy, R: Copy> Statement<C, R> for Kind<C, R> {
    type With<D: Copy, S: Copy> = Kind<D, S>;

    fn map<D: Copy, S: Copy>(
        self,
        mut whole: impl FnMut(C) -> D,
        mut real: impl FnMut(R) -> S,
    ) -> Kind<D, S> {
        match self {
            Self::MissingValues { rows, first } => {
                Kind::MissingValues { rows: whole(rows), first: whole(first) }
            }
            Self::SparseColumn { share } => Kind::SparseColumn { share: real(share) },
            Self::HeldColumn { share } => Kind::HeldColumn { share: real(share) },
            Self::OnChange { share } => Kind::OnChange { share: real(share) },
            Self::SlowPair { share } => Kind::SlowPair { share: real(share) },
            Self::OwnRows { share } => Kind::OwnRows { share: real(share) },
            Self::ReadTogether { share } => Kind::ReadTogether { share: real(share) },
            Self::TimeRows { rows, first } => {
                Kind::TimeRows { rows: whole(rows), first: whole(first) }
            }
            Self::Jitter { share } => Kind::Jitter { share: real(share) },
            Self::NewestFirst { rows } => Kind::NewestFirst { rows: whole(rows) },
            Self::ClockWrap { count, row, period_s } => {
                Kind::ClockWrap { count: whole(count), row: whole(row), period_s: real(period_s) }
            }
            Self::ClockRestart { count, row, back_s } => {
                Kind::ClockRestart { count: whole(count), row: whole(row), back_s: real(back_s) }
            }
            Self::CoarseClock { tick_s, rows } => {
                Kind::CoarseClock { tick_s: real(tick_s), rows: real(rows) }
            }
            Self::Batches { rows } => Kind::Batches { rows: real(rows) },
            Self::Frozen { rows, first } => Kind::Frozen { rows: whole(rows), first: whole(first) },
            Self::Dead { stretches, rows, from_s, to_s, or_blocked } => Kind::Dead {
                stretches: whole(stretches),
                rows: whole(rows),
                from_s: real(from_s),
                to_s: real(to_s),
                or_blocked,
            },
            Self::Stale { rows, first } => Kind::Stale { rows: whole(rows), first: whole(first) },
            Self::HalfInterval { rows, first } => {
                Kind::HalfInterval { rows: whole(rows), first: whole(first) }
            }
            Self::Wrapped { period_rad, turns } => {
                Kind::Wrapped { period_rad: real(period_rad), turns: whole(turns) }
            }
            Self::Reset { row, step_rad } => {
                Kind::Reset { row: whole(row), step_rad: real(step_rad) }
            }
            Self::LowPass { at_rows, time_s, std_error_s, or_late } => Kind::LowPass {
                at_rows,
                time_s: real(time_s),
                std_error_s: real(std_error_s),
                or_late,
            },
            Self::HeldInput => Kind::HeldInput,
            Self::RowMeans { middle_s } => Kind::RowMeans { middle_s: real(middle_s) },
            Self::OneSampleARow { half_row_s, sampled } => {
                Kind::OneSampleARow { half_row_s: real(half_row_s), sampled }
            }
            Self::StepsBetweenRows => Kind::StepsBetweenRows,
            Self::LostRows { rows } => Kind::LostRows { rows: whole(rows) },
            Self::Phase { shift_s, std_error_s } => {
                Kind::Phase { shift_s: real(shift_s), std_error_s: real(std_error_s) }
            }
            Self::StartHeading { angle_rad, std_error_rad } => Kind::StartHeading {
                angle_rad: real(angle_rad),
                std_error_rad: real(std_error_rad),
            },
            Self::StartAngle { angle_rad, std_error_rad } => {
                Kind::StartAngle { angle_rad: real(angle_rad), std_error_rad: real(std_error_rad) }
            }
            Self::Spikes { count, first, largest } => {
                Kind::Spikes { count: whole(count), first: whole(first), largest: real(largest) }
            }
            Self::Onset { count, first, largest } => {
                Kind::Onset { count: whole(count), first: whole(first), largest: real(largest) }
            }
            Self::Unit { factor, unit } => Kind::Unit { factor: real(factor), unit },
            Self::Gear { ratio } => Kind::Gear { ratio: real(ratio) },
            Self::Gain { ratio, std_error } => {
                Kind::Gain { ratio: real(ratio), std_error: real(std_error) }
            }
            Self::Sign => Kind::Sign,
            Self::Opposing => Kind::Opposing,
            Self::DeadSensor => Kind::DeadSensor,
            Self::Mirrored => Kind::Mirrored,
            Self::Exchanged => Kind::Exchanged,
            Self::Lag { lag_s, std_error_s } => {
                Kind::Lag { lag_s: real(lag_s), std_error_s: real(std_error_s) }
            }
            Self::LagsDiffer { lag_s, std_error_s } => {
                Kind::LagsDiffer { lag_s: real(lag_s), std_error_s: real(std_error_s) }
            }
            Self::Filtered { lag_s, std_error_s } => {
                Kind::Filtered { lag_s: real(lag_s), std_error_s: real(std_error_s) }
            }
            Self::Differences { samples, lag_s } => {
                Kind::Differences { samples: whole(samples), lag_s: real(lag_s) }
            }
            Self::OfAngle { share } => Kind::OfAngle { share: real(share) },
            Self::Counts { step_rad, rows } => {
                Kind::Counts { step_rad: real(step_rad), rows: whole(rows) }
            }
            Self::FewLevels { levels } => Kind::FewLevels { levels: whole(levels) },
            Self::Magnitude => Kind::Magnitude,
            Self::SpeedSign { share } => Kind::SpeedSign { share: real(share) },
            Self::RestOffset { mean, std_error } => {
                Kind::RestOffset { mean: real(mean), std_error: real(std_error) }
            }
            Self::RestNoise { sigma, time_s } => {
                Kind::RestNoise { sigma: real(sigma), time_s: real(time_s) }
            }
            Self::Refresh { period_s } => Kind::Refresh { period_s: real(period_s) },
            Self::Quantum { step } => Kind::Quantum { step: real(step) },
        }
    }
}

impl Kind<Span<usize>, Span<f64>> {
    /// Whether the other one is the same but for the size of its numbers.
    pub(super) fn is_like(self, other: Self) -> bool {
        let rest = |kind: Self| (kind.map(|_| (), |_| ()), kind.is_above());
        rest(self) == rest(other)
    }

    /// Whether a ratio is above one, or a shift above zero: a smaller one means something else.
    fn is_above(self) -> bool {
        match self {
            Self::Unit { factor: ratio, .. } | Self::Gear { ratio } | Self::Gain { ratio, .. } => {
                ratio.low() > 1.0
            }
            Self::Phase { shift_s, .. } => shift_s.low() > 0.0,
            _ => false,
        }
    }
}
