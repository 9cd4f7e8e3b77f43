//! Comparison of measurement and simulation: the error, the noise floor, and where the error exceeds it.

mod acting;
mod binning;
mod circle;
mod curve;
mod curves;
mod error;
mod floor;
mod horizon;
mod input_noise;
mod intervals;
mod low_pass;
mod mean;
mod persistence;
mod regime;
mod residual_torque;
mod runs;
mod split_noise;
mod unexplained_torque;
mod whiteness;

pub use acting::Acting;
pub use curve::{Curve, CurveBin};
pub use curves::{Unexplained, curves};
pub use error::{Simulated, angle_rms, ise, simulate_recording, window_rms};
pub use floor::{
    Floor, WindowFloor, noise_floor, pooled_floor, sensor_floor, unresolved, window_floor,
};
pub use horizon::{Horizon, fit_percent, horizons};
pub use input_noise::noisier_input;
pub use intervals::{Interval, Residual, intervals};
pub use low_pass::{FilterBuffer, filter_together, filtered, smooth_motion};
pub use mean::Mean;
pub use persistence::persistence_rms;
pub(crate) use regime::{AT_FLOOR, REGIME_RATE};
pub use regime::{Failure, failures};
pub use residual_torque::residual_torque;
pub(crate) use residual_torque::{REST, WIDTH};
pub use unexplained_torque::{
    Asked, Bin, Dependence, UnexplainedTorque, Variable, log_significance, unexplained_torque,
};
pub use whiteness::{Innovations, Whiteness, analysed, whiteness};
