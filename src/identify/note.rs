//! Notes on a fit.

use super::IdentifyError;
use crate::simulate::Structure;

/// Treatment of a single axis mapped to both wheels: the filter measures it once, sums over the rows of both
/// wheels use it twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SingleAxis {
    /// The standard errors are those of one axis.
    CountedOnce,
    /// The standard errors count the same data twice.
    CountedTwice,
}

/// A note on a fit; its sentence is made in `report`.
#[derive(Clone, Debug)]
pub enum Note {
    /// An active bound of an estimate.
    ActiveBound {
        /// Which one.
        bound: PhysicalBound,
        /// Symbols and values without bounds.
        unbounded: Vec<(String, f64)>,
    },
    /// The estimates make a mass matrix that is not positive definite.
    MassNotPositive,
    /// Cut-offs of the filter of a regression, one per recording \[Hz\].
    CutOff(Vec<f64>),
    /// Symbols and how far noise in the columns biases their values.
    Biased(Vec<(String, f64)>),
    /// One or several parameters are not identifiable.
    Unknown {
        /// Which ones, and the identifiable combination.
        unknown: Unknown,
        /// Id of the effect of the first of them, which motion would show.
        effect: String,
    },
    /// Parameters that have the ratio to an identifiable combination that construction data give, not the recordings.
    Proportions {
        /// Their symbols.
        symbols: Vec<String>,
        /// Name of the robot with these construction data.
        robot: String,
        /// Whether it stands in for the robot of the recordings, whose construction is unknown.
        assumed: bool,
    },
    /// A single axis mapped to both wheels.
    SingleAxis(SingleAxis),
    /// The diagnosis could not start from the fit, with the reason.
    NotDiagnosed(IdentifyError),
    /// Descents from several starts.
    Descents {
        /// Those that end in the lowest minimum.
        agreeing: usize,
        /// All of them.
        of: usize,
    },
    /// Ratio of the error of a free simulation to the noise of the sensors.
    Misses(f64),
    /// The prediction horizon.
    Horizon {
        /// Its length; zero is maximum likelihood \[s\].
        seconds: f64,
        /// Whether held-out data chose it.
        chosen: bool,
        /// 2 s simulation error of held-out pieces, in `unit`.
        error: f64,
        /// "rad/s", or "rad" where only angles are measured.
        unit: &'static str,
    },
    /// Time by which the input acts later than recorded, and its standard error \[s\]; negative: earlier.
    InputShift(f64, f64),
    /// A dead time between input and motion that logging does not explain.
    Late {
        /// The measured time \[s\].
        time: f64,
        /// Its standard error \[s\].
        error: f64,
        /// Whether the fit has it as a delay of the input.
        fitted: bool,
    },
    /// Symbols and values of frictions that are negative with their whole intervals.
    DrivingFriction(Vec<(String, f64)>),
    /// Parameters of a balance in which dry friction may take any part of the input of its wheel, because that input
    /// has one size while the wheel turns.
    OneSize {
        /// Their symbols.
        symbols: Vec<String>,
        /// Size of the input.
        size: f64,
    },
    /// The larger part of the inertias may be due to the unknown input between the rows.
    BetweenRows {
        /// Their symbols.
        symbols: Vec<String>,
        /// Largest share of them.
        share: f64,
        /// From row to row \[s\].
        step_s: f64,
        /// Rows per second that would be sufficient.
        rate: usize,
    },
    /// Another method simulates better, and its values are used.
    BetterMethod {
        /// Name of that method.
        method: String,
        /// Whether on held-out pieces, or on the training recordings themselves.
        held_out: bool,
        /// Its 2 s simulation error, in `unit`.
        other: f64,
        /// That of the filter, in `unit`.
        filter: f64,
        /// "rad/s", or "rad" where only angles are measured.
        unit: &'static str,
    },
    /// Symbols and the values of `torque_regression`, from which the fit of a model with an error above noise
    /// differs by more than both standard errors.
    Disagreement(Vec<(String, f64)>),
    /// Another method contradicts an estimate.
    Contradiction(Contradiction),
    /// A profile was requested for an unknown parameter.
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
        /// Its structure; `None`: the same rules simulated freely.
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
    /// All rows of recordings too long for memory were read in blocks.
    ReadInBlocks(usize),
    /// Number of windows used for recordings too long for memory.
    FittedToWindows(usize),
}

/// An estimate that another method contradicts.
#[derive(Clone, Debug, PartialEq)]
pub struct Contradiction {
    /// Symbol of the parameter, or of the identifiable sum of two.
    pub subject: String,
    /// Values and standard errors, the own one first.
    pub values: [(f64, f64); 2],
    /// Name of the other method.
    pub method: String,
    /// 2 s simulation errors, the own one first [rad/s].
    pub errors: [f64; 2],
    /// Whether these are on held-out recordings, or on those of the fit.
    pub held_out: bool,
}

impl Contradiction {
    /// The same as seen from the other method; the own one is called `name`.
    #[must_use]
    pub fn seen_from(&self, name: &str) -> Self {
        let Self { values: [own, other], errors: [error, others], .. } = *self;
        let (values, errors) = ([other, own], [others, error]);
        Self { values, errors, method: name.into(), ..self.clone() }
    }
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

/// Parameters that are not identifiable.
#[derive(Clone, Debug, PartialEq)]
pub enum Unknown {
    /// One parameter.
    One(String),
    /// One parameter, which was held at a value.
    Held(String, f64),
    /// Two, of which `first + weight second` is identifiable.
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
