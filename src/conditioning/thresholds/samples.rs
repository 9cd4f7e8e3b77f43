//! Limits for wrong samples, and sensors without a new value.

/// Wrong samples, and sensors without a new value.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Samples {
    /// Ratio of the deviation of a sample to the usual ones around it above which it is wrong: normal noise
    /// practically never reaches it, noise with exponential tails once in 10⁸ samples.
    pub spike: f64,
    /// Largest share of wrong samples; more of them are a property of the channel (judgement).
    pub isolated: f64,
    /// Share of a wrong sample by which its neighbours may differ from what it alone explains (judgement).
    pub spike_alone: f64,
    /// Number of standard errors for a significant response of a wheel to a wrong sample of its input, or its absence:
    /// one in 30 000 by chance.
    pub spike_errors: f64,
    /// Share of the fast motion (95 % quantile) up to which a wheel may be stopping, so that its friction absorbs a
    /// pulse of the input (judgement).
    pub stopping: f64,
    /// Largest delay of the response of a wheel in rows (judgement).
    pub response_rows: usize,
    /// Ratio to the largest of the other values above which a sample marks a missing value (judgement: a signal passes
    /// through the values below its largest ones; a mark leaves all between them out).
    pub mark: f64,
    /// Largest share of such samples (judgement: they are the exception).
    pub marks: f64,
    /// Largest number of them in a row (judgement).
    pub marks_in_a_row: usize,
    /// Ratio of the change of speed behind such a sample of an input to any other, above which the wheel responded to
    /// it (judgement: a torque that is twenty times larger for one row changes the speed by far more, noise by no
    /// more).
    pub mark_felt: f64,
    /// Length of a rest, in windows of 0.1 s, from which on a start is counted, and above which constant sensors are
    /// examined (judgement).
    pub rest_windows: usize,
    /// Smallest number of windows in motion for a fit that shows whether the input must have moved a wheel: ten per
    /// coefficient that matters (inertia, Coulomb and viscous friction).
    pub fit_windows: usize,
    /// Ratio of static to Coulomb friction, at most (Armstrong-Hélouvry et al., Automatica 30, 1994: below two).
    pub static_friction: f64,
    /// Number of standard deviations of this fit from which no motion is inferred: one window in 400 exceeds it by
    /// chance. A speed that falls to zero, and returns, by as many times the changes elsewhere does so in the sensor
    /// (judgement).
    pub dead_errors: f64,
    /// Share of the top speed up to which a wheel is slow (judgement).
    pub dead_slow: f64,
    /// Number of steps of a sensor that the motion must exceed (judgement).
    pub dead_steps: f64,
    /// Share of the input of the other wheel above which a wheel is driven as well (judgement).
    pub also_driven: f64,
    /// Share of the usual battery voltage by which a sample is wrong: a controller does not run on half of it, nor on
    /// one and a half.
    pub lost_voltage: f64,
    /// Number of rows of rest before a start (judgement).
    pub onset_rest: usize,
    /// Share of an input by which it may change while it stays (judgement: of a battery voltage under load).
    pub onset_input: f64,
    /// Ratio of the first speeds of a start to all later ones under the same input, above which they are wrong (judgement:
    /// a motor without its load is faster by less).
    pub onset_above: f64,
    /// Ratio of a speed to those of the rows around it below which it dips for a single row (judgement).
    pub dip: f64,
    /// Ratios that are nearer to a half than to a third or two thirds: the speed of half an interval of a counter.
    pub half: [f64; 2],
    /// Relative difference of the speeds before and after such a row, at most (judgement).
    pub around_alike: f64,
    /// Smallest number of rows with half the speed of both wheels: by chance, dips of any ratio below three quarters are
    /// all near a half once in a thousand recordings.
    pub fewest_half: usize,
    /// Share of the dips of both wheels that must be by a half (judgement).
    pub half_of_dips: f64,
}

pub(in crate::conditioning) const SAMPLES: Samples = Samples {
    spike: 18.0,
    isolated: 0.01,
    spike_alone: 0.25,
    spike_errors: 4.0,
    stopping: 0.05,
    response_rows: 10,
    mark: 20.0,
    marks: 0.05,
    marks_in_a_row: 2,
    mark_felt: 2.0,
    rest_windows: 3,
    fit_windows: 30,
    static_friction: 2.0,
    dead_errors: 3.0,
    dead_slow: 0.1,
    dead_steps: 3.0,
    also_driven: 0.5,
    lost_voltage: 0.5,
    onset_rest: 5,
    onset_input: 0.1,
    onset_above: 1.25,
    dip: 0.75,
    half: [5.0 / 12.0, 7.0 / 12.0],
    around_alike: 0.25,
    fewest_half: 5,
    half_of_dips: 0.75,
};
