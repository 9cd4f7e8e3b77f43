//! The quantity compared in a row of a window: the speeds, or mean speeds between angles.

use super::window::Window;
use crate::recording::Recording;
use crate::robot::State;

/// Iterates over the rows of a window, measured and simulated.
///
/// Speeds that were computed from angles are means over the neighbouring rows, which differ from the speed in
/// the row if the robot responds within a row. Such recordings are compared by the mean speed between
/// successive new angles, which is also exact for the simulated angles:
///
/// ```text
/// e_k = ((α_k - α_j) - (α̂_k - α̂_j))/(t_k - t_j),   j: the row of the angle before
/// ```
/// Of rows over which the counts of an encoder would hide the speed only every [`every`]th is compared.
pub(super) struct Compared<'a> {
    recording: &'a Recording,
    first: usize,
    /// Time, measured and simulated angles of the last new row.
    last: (f64, [f64; 2], [f64; 2]),
}

/// A row as compared.
pub(super) struct Row {
    /// Measured less simulated speeds [rad/s].
    pub(super) error: [f64; 2],
    /// Time since the angle before \[s\], where mean speeds are compared; infinite in rows without information.
    pub(super) mean_over: Option<f64>,
}

impl<'a> Compared<'a> {
    pub(super) fn new(recording: &'a Recording, window: &Window) -> Self {
        let (first, alpha) = (window.rows.start, window.start.alpha);
        Self { recording, first, last: (recording.t()[first], alpha, alpha) }
    }

    /// The next row, number `k` of the window, at the simulated `state`.
    pub(super) fn row(&mut self, k: usize, state: &State) -> Row {
        let (r, n) = (self.recording, self.first + k);
        if r.measured().omega {
            let error = [0, 1].map(|i| r.omega()[n][i] - state.omega[i]);
            return Row { error, mean_over: None };
        }
        let (since, before, simulated) = self.last;
        let time = r.t()[n] - since;
        if k == 0 || !is_new(r, n, k) {
            return Row { error: [0.0; 2], mean_over: Some(f64::INFINITY) };
        }
        let measured = r.alpha()[n];
        self.last = (r.t()[n], measured, state.alpha);
        let moved = |i: usize| (measured[i] - before[i]) - (state.alpha[i] - simulated[i]);
        Row { error: [0, 1].map(|i| moved(i) / time), mean_over: Some(time) }
    }
}

/// Rows between two that are compared: the width of the difference by which the recording's speeds are computed.
pub(super) fn every(recording: &Recording) -> usize {
    match recording.reach() {
        1 => 1,
        reach => 2 * reach,
    }
}

/// Whether row `n` of the recording, number `k` of a window, is compared.
pub(super) fn is_new(recording: &Recording, n: usize, k: usize) -> bool {
    // in most recordings every row is compared, and a division is slow
    let every = every(recording);
    recording.is_reading(n) && (every == 1 || k.is_multiple_of(every))
}

/// Variance of the speeds that are compared [rad^2/s^2], of a wheel `i`: that of the speed channel, or of the
/// difference of two angles over an interval between new ones.
pub(super) fn variance(recording: &Recording, i: usize) -> f64 {
    let noise = recording.motion_noise();
    if recording.measured().omega {
        return noise.omega[i].powi(2);
    }
    let rows = (recording.len() * every(recording)) as f64;
    let refresh = recording.step() * rows / recording.readings() as f64;
    2.0 * (noise.alpha[i] / refresh).powi(2)
}
