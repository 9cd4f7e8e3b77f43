//! Why no time of the input is reported.

/// Why recordings give no time between input and motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Untimed {
    /// It was not estimated: the model shifts the input itself, a recording is read in windows, or there are no initial
    /// parameters.
    #[default]
    NotSought,
    /// The motion does not determine the coefficients of the balance of torques.
    NotExcited,
    /// Neither the balance of torques nor a simulation has a minimum within the range.
    NoMinimum,
    /// The model is above the floor of noise, and its simulation has no minimum within the range: the balance of torques
    /// may attribute what the model lacks to a time.
    AboveFloor,
    /// The time exceeds that from a step of the input from rest to the onset of motion.
    Later {
        /// The time \[s\].
        time_s: f64,
        /// That to the onset \[s\].
        onset_s: f64,
    },
}
