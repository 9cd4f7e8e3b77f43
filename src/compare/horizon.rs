//! Growth of the simulation error with the time since the last correction.

use super::error::{Acting, windows_of};
use crate::recording::Recording;
use crate::simulate::{Dynamics, Hold, SimulateError};

/// Lengths of the simulations \[s\]; the free simulation follows.
const LENGTHS: [f64; 3] = [0.1, 0.5, 2.0];

/// The error of a model over simulations of one length.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Horizon {
    /// Time after which a simulation is restarted \[s\]; zero: one row (prediction by the filter); infinite:
    /// never.
    pub seconds: f64,
    /// Root mean square error of both wheel speeds [rad/s].
    pub rms: f64,
    /// Fit by wheel [%].
    pub fit_percent: [f64; 2],
}

/// The fit of a simulation in per cent.
///
/// ```text
/// fit = 100 (1 - ‖w - ŵ‖/‖w - mean(w)‖)
/// ```
/// Source: Ljung, System Identification, 1999 (MATLAB's `compare`). Negative if the mean would be a better simulation.
///
/// ```
/// use amigo_ident::compare::fit_percent;
/// // errors 1, 1 and deviations 1, 1: no better than the mean
/// assert_eq!(fit_percent([(1.0, 2.0), (3.0, 4.0)].into_iter()), 0.0);
/// assert_eq!(fit_percent([(1.0, 1.0), (3.0, 3.0)].into_iter()), 100.0);
/// ```
#[must_use]
pub fn fit_percent(measured_simulated: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let count = measured_simulated.clone().count() as f64;
    let mean = measured_simulated.clone().map(|v| v.0).sum::<f64>() / count;
    let (mut error, mut spread) = (0.0, 0.0);
    for (measured, simulated) in measured_simulated {
        error += (measured - simulated).powi(2);
        spread += (measured - mean).powi(2);
    }
    100.0 * (1.0 - (error / spread).sqrt())
}

/// Error and fit over 0.1, 0.5 and 2 s and of the free simulation, pooled over all recordings.
///
/// # Errors
/// The mass matrix is not positive definite. If the simulation diverges, the errors are NaN.
pub fn horizons(
    dynamics: &dyn Dynamics,
    recordings: &[Recording],
    hold: Hold,
) -> Result<Vec<Horizon>, SimulateError> {
    let lengths = LENGTHS.into_iter().chain([f64::INFINITY]);
    lengths.map(|length| horizon(dynamics, recordings, hold, length)).collect()
}

fn horizon(
    dynamics: &dyn Dynamics,
    recordings: &[Recording],
    hold: Hold,
    length: f64,
) -> Result<Horizon, SimulateError> {
    let mut pairs: [Vec<(f64, f64)>; 2] = [vec![], vec![]];
    for recording in recordings {
        let acting = Acting::new(dynamics, recording, recording.torque());
        let pieces = recording.pieces().iter();
        let windows: Vec<_> =
            pieces.flat_map(|piece| windows_of(recording, piece, length)).collect();
        let states = acting.simulate_measured(&windows, hold)?;
        for (k, state) in windows.into_iter().flatten().zip(&states) {
            for (i, pairs) in pairs.iter_mut().enumerate() {
                pairs.push((recording.omega()[k][i], state.omega[i]));
            }
        }
    }
    Ok(summary(length, &pairs))
}

/// The error of pairs of measured and simulated speeds of both wheels.
pub(super) fn summary(seconds: f64, pairs: &[Vec<(f64, f64)>; 2]) -> Horizon {
    let squares = pairs.iter().flatten().map(|(m, s)| (m - s).powi(2));
    let count = pairs.iter().map(Vec::len).sum::<usize>() as f64;
    Horizon {
        seconds,
        rms: (squares.sum::<f64>() / count).sqrt(),
        fit_percent: [0, 1].map(|i| fit_percent(pairs[i].iter().copied())),
    }
}
