//! A dummy method, by the recipe of CONTRIBUTING.md; `.ci/extension` adds it to a scratch copy.

use serde::{Deserialize, Serialize};

use super::{
    Fit, Identifier, IdentifyError, MethodDescription, OptionError, Task, WeakForm, from_options,
    options_schema,
};

/// The weak form under another name, with one option of its own.
#[derive(Clone, Debug, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ExtensionProbe {
    /// Half width of the test functions [s]; without it as the weak form chooses.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub width_s: Option<f64>,
}

impl Default for ExtensionProbe {
    fn default() -> Self {
        Self { width_s: WeakForm::default().half_width_s }
    }
}

/// Name in experiment files.
const NAME: &str = "extension_probe";

impl Identifier for ExtensionProbe {
    fn describe(&self) -> MethodDescription {
        let weak = WeakForm::default().describe();
        MethodDescription { name: NAME.into(), title: "Test of the recipe".into(), ..weak }
    }

    fn schema(&self) -> schemars::Schema {
        options_schema::<Self>()
    }

    fn configure(&self, options: &toml::Table) -> Result<Box<dyn Identifier>, OptionError> {
        Ok(Box::new(from_options::<Self>(NAME, options)?))
    }

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        let weak = WeakForm { half_width_s: self.width_s, ..WeakForm::default() };
        Ok(Fit { method: NAME.into(), ..weak.identify(task)? })
    }
}
