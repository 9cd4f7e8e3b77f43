//! What is asked of an experiment.

use crate::conditioning;
use crate::diagnose::Settings;
use crate::identify::{self, Identifier};
use crate::simulate::{Gain, Hold};
use crate::verdict::Basis;

/// Methods that are compared where none is named.
const DEFAULT_METHODS: [&str; 3] = ["prediction_error", "output_error", "torque_regression"];

/// A method with its options.
pub struct MethodPlan {
    /// As in its `[[method]]` block.
    pub name: String,
    /// In words.
    pub title: String,
    /// Options as written, for reports: they stand behind the name where it occurs twice.
    pub options: String,
    /// The configured method.
    pub method: Box<dyn Identifier>,
}

impl MethodPlan {
    /// A method with the options that it has.
    #[must_use]
    pub fn new(method: impl Identifier + 'static) -> Self {
        Self::boxed(Box::new(method), String::new())
    }

    /// The same of a method that was looked up, with its `options` as written.
    pub(in crate::experiment) fn boxed(method: Box<dyn Identifier>, options: String) -> Self {
        let description = method.describe();
        Self { name: description.name, title: description.title, options, method }
    }

    /// The methods that are compared where none is named, with their default options.
    #[must_use]
    pub fn defaults() -> Vec<Self> {
        let found = DEFAULT_METHODS.iter().filter_map(|name| identify::find(name));
        found.map(|method| Self::boxed(method, String::new())).collect()
    }
}

/// What the diagnosis is asked.
pub struct DiagnosisPlan {
    /// Candidates, false-alarm rate and number of effects.
    pub settings: Settings,
    /// Whether a slow unknown torque is part of the noise model.
    pub slow_moment: bool,
}

impl From<Settings> for DiagnosisPlan {
    /// With a slow unknown torque, as by default.
    fn from(settings: Settings) -> Self {
        let Basis { slow_moment, .. } = Basis::new(&[], &[], Hold::default());
        Self { settings, slow_moment }
    }
}

impl Default for DiagnosisPlan {
    fn default() -> Self {
        Settings::default().into()
    }
}

/// What is asked of an experiment beside its model and its recordings; the tables of an experiment file, typed.
pub struct PlanOptions {
    /// Heading of the report; the name of the experiment unless given.
    pub title: Option<String>,
    /// Methods to compare, at least one.
    pub methods: Vec<MethodPlan>,
    /// Diagnosis, if asked for.
    pub diagnosis: Option<DiagnosisPlan>,
    /// The input between the rows; without it a line, or held where the motion shows that.
    pub hold: Option<Hold>,
    /// Gain of the emulator, if asked for.
    pub gain: Option<Gain>,
    /// What logger and sensors did to the recordings that is corrected together: speeds behind a low-pass, inputs at
    /// different phases of a row.
    pub conditioning: conditioning::Settings,
    /// Whether masses and inertias of the model's robot are its own. Where they only stand in, effects whose equations
    /// hold them take those that the training recordings show.
    pub robot_is_built: bool,
    /// Seed of everything random.
    pub seed: u64,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            title: None,
            methods: MethodPlan::defaults(),
            diagnosis: None,
            hold: None,
            gain: None,
            conditioning: conditioning::Settings::default(),
            robot_is_built: true,
            seed: 1,
        }
    }
}
