//! Corrections of the effects of sensors and loggers, separated from the dynamics of the robot: a pure
//! function from the channels of a file to consistent channels and a list of findings.
//!
//! ```text
//! rows       newest first | without a value | of a repeated or backward time | of a restarted clock
//!            | of a coarse clock | stamped in batches | whose stamps scatter
//! columns    written on change | slower than the rows | at rates of their own | read in turn
//! angles     wrapped at a turn or a power of two of counts | reset
//! samples    late in a row that repeats the last one | of half an interval
//! channels   wrong samples at a start | isolated wrong samples
//! speeds     kept at rest | counts of an encoder | in another unit | of another sign | late | computed from the angles
//! input      sampled more slowly than the sensors | against the motion | of a few levels
//!            | a magnitude without sign | not zero at rest
//! sensors    that never move, give no new value while driven, refresh more slowly than the rows, or are coarse
//! ```
//! Each finding states its treatment: corrected (with the key of `[conditioning]` that disables this),
//! treated as noise or timing, only reported, or refused. Channels without faults are unchanged, bit by bit.

mod align;
mod angles;
mod cells;
mod clock;
mod counterpart;
mod counts;
mod dead;
mod dead_sensor;
mod error;
mod factor;
mod far_out;
mod finding;
mod frozen;
mod half_interval;
mod held_input;
mod input;
mod jitter;
mod lost;
mod magnitude;
mod on_change;
mod onset;
mod rates;
mod rows;
mod sensors;
mod settings;
mod signal;
mod speeds;
mod spikes;
mod stale;
mod thresholds;
mod wheels;

pub use align::{SlowPair, common_slow_pair};
pub use counts::{Encoder, Encoders, common_encoders};
pub(crate) use dead::DEAD_S;
pub use error::ConditioningError;
pub use factor::repair_factors;
pub use finding::{Action, Channel, Finding, Kind, Sampled, Stated, stated};
pub use lost::held_over_lost_rows;
pub use settings::Settings;
pub use speeds::{Lag, SpeedLag, common_lag, common_share, lags_differ};
pub use thresholds::{CONDITIONING, ConditioningThresholds, IMPORT, ImportThresholds};

use self::thresholds::TIMES;
use crate::recording::Channels;

/// Consistent channels, with the findings.
#[derive(Clone, Debug)]
pub struct Conditioned {
    /// The channels, corrected where the findings say so.
    pub channels: Channels,
    /// The findings, in the order of the steps.
    pub findings: Vec<Finding>,
}

/// Information in addition to the channels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Context {
    /// Radius of the wheels \[m\], which distinguishes metres from radians.
    pub wheel_radius: Option<f64>,
    /// Whether the input is a command (a voltage) and not measured.
    pub commanded: bool,
    /// Delay of the speeds in the recordings of the same log.
    pub speed_lag: SpeedLag,
    /// Residual share of speeds that were computed from the angles in other recordings of the same log
    /// ([`common_share`]); `None` if there are none.
    pub speeds_of_angles: Option<f64>,
    /// The encoder of speeds without angles, from all recordings of the same log.
    pub encoders: Encoders,
    /// One count of the encoder of each wheel \[rad\], if the speeds are described as counts.
    pub counts: [Option<f64>; 2],
    /// The sensors that other recordings of the same log show to be slower.
    pub slow_pair: Option<SlowPair>,
    /// Whether another recording of the same log shows that its rows are even and the stamps those of a receiver.
    pub even_times: bool,
}

/// Conditions the channels of a recording.
///
/// # Errors
/// [`ConditioningError`] where a channel cannot be used as it is and cannot be corrected: with
/// channel, row, value and remedy.
///
/// # Examples
/// ```
/// use amigo_ident::conditioning::{Context, Kind, Settings, condition};
/// use amigo_ident::recording::Channels;
/// use std::f64::consts::TAU;
/// let t: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
/// let angle: Vec<[f64; 2]> = t.iter().map(|t| [3.0 * t, 2.0 * t]).collect();
/// let wrapped = angle.iter().map(|a| a.map(|x| x.rem_euclid(TAU))).collect();
/// let channels =
///     Channels { alpha: Some(wrapped), omega: None, torque: vec![[0.1; 2]; 1000], t };
/// let done = condition(channels, &Settings::default(), &Context::default()).unwrap();
/// assert!(matches!(done.findings[0].kind, Kind::Wrapped { turns: 4, .. }));
/// let last = done.channels.alpha.unwrap()[999];
/// assert!((last[0] - angle[999][0]).abs() < 1e-9);
/// ```
pub fn condition(
    channels: Channels,
    settings: &Settings,
    context: &Context,
) -> Result<Conditioned, ConditioningError> {
    let mut work = Conditioned { channels, findings: vec![] };
    rows::newest_first(&mut work, settings);
    on_change::hold(&mut work, settings);
    rows::values(&mut work, settings, context);
    rows::times(&mut work, settings, context);
    let t = &work.channels.t;
    if t.len() < TIMES.fewest_rows || !signal::is_increasing(t) {
        // the check of the recording reports one that is too short, or a time that does not increase
        return Ok(work);
    }
    counts::angles(&mut work, settings, context);
    jitter::even_times(&mut work, settings, context);
    rates::alike(&mut work, settings, context);
    angles::unwrap(&mut work, settings);
    dead_sensor::channels(&mut work, settings);
    stale::rows(&mut work, settings);
    half_interval::rows(&mut work, settings);
    // the first value after a rest may look like an outlier among faster ones
    frozen::rows(&mut work, settings);
    onset::rows(&mut work, settings);
    spikes::sensors(&mut work, settings);
    wheels::exchanged_sensors(&mut work, settings);
    counterpart::units_and_signs(&mut work, settings, context);
    dead::stretches(&mut work, settings)?;
    speeds::timing(&mut work, settings, context);
    held_input::sampled(&mut work, settings, context);
    spikes::inputs(&mut work, settings, context);
    input::few_levels(&mut work);
    magnitude::sign(&mut work, settings)?;
    wheels::inputs(&mut work, settings);
    input::at_rest(&mut work, context);
    sensors::refresh(&mut work);
    Ok(work)
}
