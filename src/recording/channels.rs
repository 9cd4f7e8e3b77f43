//! The channels of a recording and their noise levels.

/// The columns of a recording before they are checked; row k of each belongs to `t[k]`.
#[derive(Clone, Debug, Default)]
pub struct Channels {
    /// Time \[s\], strictly increasing.
    pub t: Vec<f64>,
    /// Wheel angles \[rad\], right wheel first; `None` where not measured.
    pub alpha: Option<Vec<[f64; 2]>>,
    /// Wheel speeds [rad/s]; `None` where not measured.
    pub omega: Option<Vec<[f64; 2]>>,
    /// Input of each wheel, in the unit of [`super::DriveUnit`].
    pub torque: Vec<[f64; 2]>,
}

/// The column by which an input is multiplied (a battery voltage), and the input without it (a duty cycle), by rows.
#[derive(Clone, Debug)]
pub struct Factor {
    /// The column, with its last value where it has none.
    pub values: Vec<f64>,
    /// The input without it.
    pub input: Vec<f64>,
}

/// Which channels were measured and which were computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Measured {
    /// Angles were measured (else integrated from the speeds).
    pub alpha: bool,
    /// Speeds were measured (else differenced from the angles).
    pub omega: bool,
}

/// Autocorrelated noise of a channel: first-order autoregressive.
///
/// ```text
/// E n(t) n(t + s) = σ² exp(-|s|/τ)
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct SlowNoise {
    /// Standard deviation σ [unit of the channel].
    pub sigma: f64,
    /// Correlation time τ \[s\].
    pub time_s: f64,
}

/// Standard deviations of the white noise of the motion sensors, right wheel first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionNoise {
    /// Angles \[rad\].
    pub alpha: [f64; 2],
    /// Speeds [rad/s].
    pub omega: [f64; 2],
}

/// Upper limits of standard deviations of noise, right wheel first.
#[derive(Clone, Copy, Debug)]
pub(super) struct MostNoise {
    /// Of the speeds [rad/s].
    pub(super) omega: [f64; 2],
    /// Of the input [unit of the input].
    pub(super) input: [f64; 2],
}

/// Standard deviations of white noise, right wheel first.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Noise {
    /// Angles \[rad\].
    pub alpha: [f64; 2],
    /// Speeds [rad/s].
    pub omega: [f64; 2],
    /// Input [unit of the input].
    pub torque: [f64; 2],
}

/// Properties of a recording's motion that do not depend on a model. Angles before speeds, right
/// wheel first.
#[derive(Clone, Debug)]
pub struct Sensing {
    /// One flag per sample and wheel: the wheel is at rest.
    pub still: Vec<[bool; 2]>,
    /// Variances of (alpha1, alpha2, omega1, omega2) [rad^2, rad^2/s^2].
    pub variance: [f64; 4],
    /// Channels that are measurements of their own.
    pub used: [bool; 4],
    /// Variance of w1 - w2, and of w1 + w2, in the local motion due to noise [rad^2/s^2].
    pub speed_variance: f64,
}
