//! Why recordings do not determine a model.

/// Why recordings do not determine a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Undetermined {
    /// The columns do not: they are others than those of wheels and of their input.
    Columns,
    /// The speeds hardly change, and of the change the model explains less than half.
    Steady {
        /// Root mean square change of a speed within 2 s [rad/s].
        change: f64,
    },
    /// Noise of the channels alone would change the simulated speeds by more than the measured ones change.
    Noisy {
        /// Noise floor [rad/s].
        floor: f64,
        /// Root mean square change of a speed within 2 s [rad/s].
        change: f64,
    },
    /// The model explains less than half of the change of the speeds, and as much of it with the input of other times.
    Unrelated {
        /// Share of the mean square change of a speed within 2 s that the model explains.
        explained: f64,
    },
    /// They are shorter than a window of the simulation error.
    Short {
        /// How long they are together \[s\].
        seconds: f64,
    },
    /// No parameter is determined by more than one window of the fit of the diagnosis.
    Windows {
        /// Number of windows of 1 s.
        windows: usize,
    },
    /// The recordings on which effects are tested have too few windows.
    Untested {
        /// Number of windows of 1 s.
        windows: usize,
        /// Whether they are validation recordings; else the training recordings.
        validated: bool,
        /// Error over noise floor of the training recordings, if something is missing according to them.
        fails: Option<f64>,
    },
    /// The larger part of the inertias may be due to the unknown input between the rows.
    BetweenRows {
        /// Largest share of them.
        share: f64,
        /// From row to row \[s\].
        step_s: f64,
        /// Rows a second that would do.
        rate: usize,
    },
}

impl Undetermined {
    /// Whether only the diagnosis is concerned: the parameters and the error of the model are those of all rows, with
    /// intervals of their own.
    #[must_use]
    pub fn is_of_tests(self) -> bool {
        matches!(self, Self::Short { .. } | Self::Windows { .. } | Self::Untested { .. })
    }
}
