//! What a fit says beside its numbers.

use super::IdentifyError;
use crate::simulate::Structure;

/// How a method counts one axis that is written down as two wheels: the filter measures it once, sums over
/// the rows of both wheels take it twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SingleAxis {
    /// The standard errors are those of one axis.
    CountedOnce,
    /// The standard errors count the same data twice.
    CountedTwice,
}

/// One thing that the reader of a fit must know; `report` makes the sentence of it.
#[derive(Clone, Debug)]
pub enum Note {
    /// A bound holds an estimate back.
    ActiveBound {
        /// Which one.
        bound: PhysicalBound,
        /// Symbols and values without bounds.
        unbounded: Vec<(String, f64)>,
    },
    /// The estimates make a mass matrix that is not positive definite.
    MassNotPositive,
    /// Cut-offs of the filter of a regression, one a recording \[Hz\].
    CutOff(Vec<f64>),
    /// Symbols and how far noise in the columns biases their values.
    Biased(Vec<(String, f64)>),
    /// The data do not give a parameter, or several one by one.
    Unknown {
        /// What is not known, and what is.
        unknown: Unknown,
        /// Id of the effect of the first of them, which motion would show.
        effect: String,
    },
    /// One axis written down twice.
    SingleAxis(SingleAxis),
    /// The diagnosis of what the model lacks could not start from the fit, and why.
    NotDiagnosed(IdentifyError),
    /// Descents from several starts.
    Descents {
        /// Those that end in the lowest minimum.
        agreeing: usize,
        /// All of them.
        of: usize,
    },
    /// A free simulation misses the data by this many times the noise of the sensors.
    Misses(f64),
    /// The prediction horizon.
    Horizon {
        /// Its length; zero is maximum likelihood \[s\].
        seconds: f64,
        /// Whether held-out data chose it.
        chosen: bool,
        /// 2 s simulation error of held-out pieces [rad/s].
        error: f64,
    },
    /// The input acts later than recorded by this and its standard error \[s\]; negative: earlier.
    InputShift(f64, f64),
    /// The motion is later than the recorded input by a time \[s\], with its standard error, that the model does not have.
    Late(f64, f64),
    /// Symbols and values of frictions that are negative with their whole intervals.
    DrivingFriction(Vec<(String, f64)>),
    /// The larger part of the inertias may be made of what the input does between its rows.
    BetweenRows {
        /// Their symbols.
        symbols: Vec<String>,
        /// Largest share of them.
        share: f64,
        /// From row to row \[s\].
        step_s: f64,
        /// Rows a second that would do.
        rate: usize,
    },
    /// `torque_regression` simulates better, and its values are taken.
    BetterRegression {
        /// Whether on held-out pieces, or on the training recordings themselves.
        held_out: bool,
        /// Its 2 s simulation error [rad/s].
        regression: f64,
        /// That of the filter [rad/s].
        filter: f64,
    },
    /// Symbols and the values of `torque_regression`, from which the fit of a model with an error above noise
    /// differs by more than both standard errors.
    Disagreement(Vec<(String, f64)>),
    /// A profile that was asked for does not exist.
    NoProfile(String),
    /// A profile likelihood.
    Profile {
        /// Of the parameter that was profiled.
        symbol: String,
        /// For the unit of the input.
        unit: String,
        /// 95 % interval by the likelihood.
        interval: (f64, f64),
        /// The same by the standard error.
        by_std_error: (f64, f64),
    },
    /// Noise of the input biases the inertias by more than can be corrected.
    BiasedByInput,
    /// Noise of the input as estimated.
    InputNoise {
        /// Standard deviation of its white part.
        white: f64,
        /// Of its slow part.
        slow: f64,
        /// Time constant of that \[s\].
        time_constant: f64,
        /// Unit of the deviations.
        unit: &'static str,
    },
    /// Error of an emulator on the training recordings.
    Emulator {
        /// How it is fed; `None`: the same rules simulated freely.
        fed: Option<(Structure, f64)>,
        /// ISE [rad^2/s]; `None` where it diverges.
        ise: Option<f64>,
        /// That of the noise [rad^2/s]; zero where there is none.
        floor: f64,
    },
    /// Rules that the training recordings excite.
    ExcitedRules {
        /// Excited.
        count: usize,
        /// All.
        of: usize,
    },
    /// The emulator has no rules for backward speeds.
    ForwardOnly,
    /// All rows of recordings too long to be held were read in blocks.
    ReadInBlocks(usize),
    /// So many windows stand for recordings too long to be held.
    FittedToWindows(usize),
}

/// A bound that physics or construction set.
#[derive(Clone, Debug, PartialEq)]
pub enum PhysicalBound {
    /// The lower end of the range of a parameter.
    Range {
        /// Of that parameter.
        symbol: String,
        /// The end.
        low: f64,
    },
    /// The distance that is allowed from the value of the construction data.
    Construction {
        /// Symbol of the parameter.
        symbol: String,
        /// The bound.
        value: f64,
        /// Whether the parameter is above it.
        is_lower: bool,
    },
    /// A positive definite mass matrix.
    PositiveMass,
}

/// What the data do not give.
#[derive(Clone, Debug, PartialEq)]
pub enum Unknown {
    /// One parameter.
    One(String),
    /// One parameter, which was held at a value.
    Held(String, f64),
    /// Two, of which `first + weight second` is known.
    Two {
        /// Symbol.
        first: String,
        /// Symbol.
        second: String,
        /// Weight of the second.
        weight: f64,
        /// The sum.
        value: f64,
        /// Its standard error.
        std_error: f64,
    },
    /// More, in combinations.
    Several(Vec<String>),
}
