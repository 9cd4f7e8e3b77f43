//! The sentences of the notes of a fit.

use std::fmt;

use crate::identify::{Contradiction, Note, PhysicalBound, SingleAxis, Unknown};
use crate::math::round_significant;
use crate::report::format::digits;
use crate::simulate::Structure;

/// As an inequality.
impl fmt::Display for PhysicalBound {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Range { symbol, low } => write!(f, "{symbol} >= {low}"),
            Self::Construction { symbol, value, is_lower } => {
                let sign = if *is_lower { ">=" } else { "<=" };
                write!(f, "{symbol} {sign} {} (construction)", digits(*value, 4))
            }
            Self::PositiveMass => f.write_str("a1 > |a2|"),
        }
    }
}

/// The motion that shows the parameters of an effect.
fn to_record(effect: &str) -> String {
    crate::effects::find(effect)
        .map_or_else(|| "richer motion".into(), |e| e.description().excitation)
}

/// In a sentence, with the usual reason.
impl fmt::Display for Contradiction {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { subject, values: [own, other], method, errors: [error, others], held_out } =
            self;
        let value = |v: &(f64, f64)| format!("{} ± {}", digits(v.0, 4), digits(v.1, 2));
        let apart = (own.0 - other.0).abs() / own.1.hypot(other.1);
        let on = if *held_out { "the validation recordings" } else { "the training recordings" };
        let better = if error <= others { "this method" } else { method };
        write!(
            f,
            "{subject} = {} contradicts {} by {method}: {apart:.0} standard errors. On {on} {better} simulates better (2 s \
             simulation error {} rad/s, {method} {}). The usual reason: noise of the speeds, or an input that acts at \
             another time than recorded, biases the inertias of regressions towards zero.",
            value(own),
            value(other),
            digits(*error, 3),
            if others.is_finite() { digits(*others, 3) } else { "infinite".into() }
        )
    }
}

/// The note on the prediction horizon.
fn horizon(
    f: &mut fmt::Formatter,
    seconds: f64,
    chosen: bool,
    (error, unit): (f64, &str),
) -> fmt::Result {
    let meaning = if seconds == 0.0 { " (maximum likelihood)" } else { "" };
    let how = if chosen {
        "chosen by the 2 s simulation error of held-out pieces"
    } else {
        "as given; 2 s simulation error of held-out pieces"
    };
    if error.is_finite() {
        let error = digits(error, 3);
        write!(f, "Prediction horizon: {seconds} s{meaning}, {how}: {error} {unit}.")
    } else {
        write!(
            f,
            "Prediction horizon: {seconds} s{meaning}; simulations of held-out pieces diverge, so that \
             horizons could not be compared."
        )
    }
}

/// The note on the error of an emulator.
fn emulator(
    f: &mut fmt::Formatter,
    fed: Option<(Structure, f64)>,
    ise: Option<f64>,
    floor: f64,
) -> fmt::Result {
    match fed {
        Some((Structure::Parallel, gain)) => {
            write!(f, "parallel structure, K = {gain} s⁻¹ on the wheel speeds")?
        }
        Some((Structure::SerialParallel, gain)) => {
            write!(f, "serial-parallel structure, K = {gain} s⁻¹ on the wheel speeds")?;
        }
        None => f.write_str("the same rules simulated freely (K = 0)")?,
    }
    match ise {
        None => f.write_str(": the in-sample ISE diverges"),
        Some(ise) if floor > 0.0 => write!(
            f,
            ": the in-sample ISE is {ise:.4} rad²/s, {:.2} times that of the noise of the measured speeds",
            ise / floor
        ),
        Some(ise) => write!(f, ": the in-sample ISE is {ise:.4} rad²/s"),
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::ActiveBound { bound, unbounded } => {
                let values: Vec<_> = unbounded.iter().map(|(s, v)| format!("{s} = {}", digits(*v, 4))).collect();
                let values = values.join(", ");
                write!(f, "The bound {bound} is active; the unbounded estimates are {values}.")
            }
            Self::NotDiagnosed(reason) => write!(
                f,
                "Missing effects were not searched for ({reason}); the fits are not affected."
            ),
            Self::MassNotPositive => f.write_str(
                "The estimates of a1 and a2 do not give a positive definite mass matrix (a1 must exceed \
                 |a2|). The larger of a1 + a2 and a1 - a2 was kept, and neither a1 nor a2 is identifiable; \
                 record: speeding up and braking, straight and in pivots.",
            ),
            Self::CutOff(hz) => {
                let hz: Vec<_> = hz.iter().map(|hz| format!("{hz:.2}")).collect();
                match &hz[..] {
                    [one, rest @ ..] if rest.iter().all(|other| other == one) => {
                        write!(f, "Cut-off of the filter: {one} Hz.")
                    }
                    all => {
                        write!(f, "Cut-off of the filter, by training recording: {} Hz.", all.join(", "))
                    }
                }
            }
            Self::Biased(by) => {
                let by: Vec<_> = by.iter().map(|(s, v)| format!("{s} by about {v:+.2e}")).collect();
                write!(
                    f,
                    "Noise of the speeds biases {}, which the standard errors do not include: use \
                     prediction_error, or a lower cut-off.",
                    by.join(", ")
                )
            }
            Self::Unknown { unknown, effect } => {
                write!(f, "{unknown}; record: {}.", to_record(effect))
            }
            Self::SingleAxis(counted) => {
                f.write_str(
                    "Both wheels have identical data (a single axis), so only sums over the two wheels are \
                     identifiable",
                )?;
                f.write_str(match counted {
                    SingleAxis::CountedOnce => ".",
                    SingleAxis::CountedTwice => {
                        ", and their standard errors count the same data twice (multiply by 1.41)."
                    }
                })
            }
            Self::Descents { agreeing, of } => {
                write!(f, "{agreeing} of {of} descents end in the lowest minimum that was found.")
            }
            Self::Misses(ratio) => write!(
                f,
                "The error of its free simulation is {} times the noise of the sensors: it drifts, by noise of the torques or by \
                 a missing effect, and these intervals are too narrow.",
                round_significant(*ratio, 2)
            ),
            Self::Horizon { seconds, chosen, error, unit } => {
                horizon(f, *seconds, *chosen, (*error, unit))
            }
            Self::InputShift(late, error) => {
                let way = if *late > 0.0 { "after" } else { "before" };
                let (late, error) = (1e3 * late.abs(), 1e3 * error);
                write!(
                    f,
                    "In the recordings as used, the input acts {late:.2} ± {error:.2} ms {way} it is recorded; this fit \
                     estimates that time with its parameters."
                )
            }
            Self::Late { time, error, fitted } => {
                let rest = match fitted {
                    true => "This fit represents it as an input delay; an actuator lag would have the same effect.",
                    false => "This fit contains no delay.",
                };
                let (time, error) = (1e3 * time, 1e3 * error);
                write!(f, "The motion starts {time:.1} ± {error:.1} ms after the recorded input. {rest}")
            }
            Self::OneSize { symbols, size } => write!(
                f,
                "{} not identifiable: while the wheels turn, the input has the one size {}, of which friction may \
                 take any part. Record inputs of several sizes.",
                symbols.join(", "),
                digits(*size, 3)
            ),
            Self::DrivingFriction(negative) => {
                let values: Vec<_> = negative.iter().map(|(s, v)| format!("{s} = {v:.3e}")).collect();
                write!(
                    f,
                    "{}: the 95 % interval is entirely negative, i.e. this friction would accelerate the \
                     robot. Check the sign, the offset and the timing of the input; otherwise an effect is \
                     missing from the model and this parameter compensates for it.",
                    values.join(", ")
                )
            }
            Self::BetweenRows { symbols, share, step_s, rate } => write!(
                f,
                "{} not identifiable: between two rows of {step_s:.3} s the input may act by {:.0} % of the torque \
                 that accelerates the robot. Record the input about ten times faster, at {rate} rows per second.",
                match &symbols[..] {
                    [one] => format!("{one} is"),
                    several => format!("{} are", several.join(", ")),
                },
                100.0 * share
            ),
            Self::BetterMethod { method, held_out, other, filter, unit } => {
                let on = if *held_out { "held-out pieces" } else { "the training recordings" };
                write!(
                    f,
                    "These are the values of {method}: its 2 s simulation error on {on} is \
                     {} {unit}, that of the filter {}.",
                    digits(*other, 3),
                    if filter.is_finite() { digits(*filter, 3) } else { "infinite".into() }
                )
            }
            Self::Disagreement(values) => {
                let values: Vec<_> = values.iter().map(|(s, v)| format!("{s} = {}", digits(*v, 4))).collect();
                write!(
                    f,
                    "The error of the filter is above the noise of the channels, and torque_regression gives {}: the \
                     intervals are wide enough for both. A missing effect can cause this, and so can noise of the input \
                     that is correlated from row to row.",
                    values.join(", ")
                )
            }
            Self::Contradiction(one) => one.fmt(f),
            Self::NoProfile(symbol) => {
                write!(f, "No profile likelihood for {symbol}: it is fixed, or not identifiable from these data.")
            }
            Self::Profile { symbol, unit, interval: (low, high), by_std_error } => write!(
                f,
                "Profile likelihood of {symbol}: 95 % interval {} to {} {unit} (by the standard error {} to {}).",
                digits(*low, 5),
                digits(*high, 5),
                digits(by_std_error.0, 5),
                digits(by_std_error.1, 5)
            ),
            Self::Proportions { symbols, robot, assumed: false } => write!(
                f,
                "{}: in the ratio that the construction data of {robot} give, not by these data.",
                symbols.join(", ")
            ),
            Self::Proportions { symbols, .. } => write!(
                f,
                "{}: held at zero, because the construction of this robot is unknown and these data do not determine them. \
                 Use only the identifiable combination, or write the construction data under [robot].",
                symbols.join(", ")
            ),
            Self::BiasedByInput => f.write_str(
                "The input is so noisy, or so rough, that it biases the inertias by more than can be \
                 corrected; their intervals are too narrow.",
            ),
            Self::InputNoise { white, slow, time_constant, unit } => write!(
                f,
                "Noise of the input: {} white, {} slow with a time constant of {time_constant:.2} s (standard \
                 deviations, {unit}).",
                digits(*white, 3),
                digits(*slow, 3)
            ),
            Self::Emulator { fed, ise, floor } => emulator(f, *fed, *ise, *floor),
            Self::ExcitedRules { count, of } => write!(
                f,
                "{count} of {of} rules were excited by the training recordings; speeds at which no excited \
                 rule fires with at least 0.2 are extrapolation, where the output is unreliable."
            ),
            Self::ForwardOnly => f.write_str(
                "Negative speeds are clamped to zero: driving backward is treated as standstill.",
            ),
            Self::ReadInBlocks(rows) => write!(
                f,
                "All {rows} rows were read block by block; cut-off and rest threshold are determined from \
                 the windows kept in memory."
            ),
            Self::FittedToWindows(windows) => write!(
                f,
                "Fitted to {windows} windows, because the recordings are too long to keep in memory and \
                 this method needs all rows at once. Raise hold_rows under [recordings], or use \
                 torque_regression, which reads every row."
            ),
        }
    }
}

impl fmt::Display for Unknown {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::One(symbol) => write!(f, "{symbol} is not identifiable from these data"),
            Self::Held(symbol, value) => {
                write!(f, "{symbol} is not identifiable from these data and was held at ")?;
                f.write_str(&digits(*value, 4))
            }
            Self::Two { first, second, weight, value, std_error } => {
                let other = if (weight - 1.0).abs() < 1e-3 {
                    format!("+ {second}")
                } else if (weight + 1.0).abs() < 1e-3 {
                    format!("- {second}")
                } else {
                    format!("{weight:+.4} {second}")
                };
                write!(
                    f,
                    "{first} and {second} cannot be identified separately from these data; identifiable is \
                     {first} {other} = {}",
                    digits(*value, 4)
                )?;
                match std_error.is_finite() {
                    true => write!(f, " ± {}", digits(*std_error, 2)),
                    false => Ok(()),
                }
            }
            Self::Several(symbols) => write!(
                f,
                "Only combinations of {} are identifiable from these data, not the individual parameters",
                symbols.join(", ")
            ),
        }
    }
}
