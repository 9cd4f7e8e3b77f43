//! Options of an experiment.

use crate::conditioning;
use crate::diagnose::Settings;
use crate::identify::{self, Identifier};
use crate::simulate::{Gain, Hold};
use crate::verdict::Basis;

/// A method with its options.
pub struct MethodPlan {
    /// Name in its `[[method]]` block.
    pub name: String,
    /// Title of the method.
    pub title: String,
    /// Options as written, for reports, where they distinguish methods with the same name.
    pub options: String,
    /// The configured method.
    pub method: Box<dyn Identifier>,
}

impl MethodPlan {
    /// A method with the given options.
    #[must_use]
    pub fn new(method: impl Identifier + 'static) -> Self {
        Self::boxed(Box::new(method), String::new())
    }

    /// The same for a method found by its name, with its `options` as written.
    pub(in crate::experiment) fn boxed(method: Box<dyn Identifier>, options: String) -> Self {
        let description = method.describe();
        Self { name: description.name, title: description.title, options, method }
    }

    /// The default methods, with default options.
    #[must_use]
    pub fn defaults() -> Vec<Self> {
        let mut found = identify::all();
        found.retain(|method| method.is_default());
        found.sort_by_key(|method| method.rank());
        found.into_iter().map(|method| Self::boxed(method, String::new())).collect()
    }
}

/// Settings of the diagnosis.
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

/// Options of an experiment in addition to its model and its recordings; the typed tables of an experiment
/// file.
pub struct PlanOptions {
    /// Title of the report; default: the name of the experiment.
    pub title: Option<String>,
    /// Methods to compare, at least one.
    pub methods: Vec<MethodPlan>,
    /// Diagnosis, if requested.
    pub diagnosis: Option<DiagnosisPlan>,
    /// The input between the rows; default: linear, or held if the motion indicates this.
    pub hold: Option<Hold>,
    /// Gain of the emulator, if requested.
    pub gain: Option<Gain>,
    /// Corrections that use all recordings together: speeds after a low-pass, inputs with different phases
    /// relative to the rows.
    pub conditioning: conditioning::Settings,
    /// Whether masses and inertias of the model's robot are its own. Otherwise effects whose equations
    /// contain them use values estimated from the training recordings.
    pub robot_is_built: bool,
    /// Seed of all random numbers.
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
