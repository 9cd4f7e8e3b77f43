//! Interface of a method: a name, options, and the fit of a task.

use std::fmt::Write as _;

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::{Fit, IdentifyError};
use crate::model::Model;
use crate::recording::{LongRecording, Recording};
use crate::simulate::Hold;

/// The model to be identified, and the data.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// The model; its fixed parameters stay.
    pub model: &'a Model,
    /// Training recordings; at least one, all with the same input unit.
    pub train: &'a [Recording],
    /// The input between samples.
    pub hold: Hold,
    /// Seed of everything random in the method.
    pub seed: u64,
}

/// Catalogue entry of a method.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct MethodDescription {
    /// Name in experiment files.
    pub name: String,
    /// In words.
    pub title: String,
    /// What it computes, with its equation, in plain text.
    pub equation: String,
    /// Where it comes from.
    pub source: String,
    /// Data and purposes for which it is the right choice.
    pub use_when: String,
    /// When not to.
    pub avoid_when: String,
}

/// One option of a method, read off the JSON schema of the type that reads it.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct MethodOption {
    /// Key in the `[[method]]` block.
    pub key: String,
    /// Default, as written in an experiment file; `unset` without one.
    pub default: String,
    /// Meaning, with the values allowed.
    pub meaning: String,
}

/// An option of a `[[method]]` block that is not understood.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("method `{method}`: {message}")]
pub struct OptionError {
    /// Name of the method, as in experiment files.
    pub method: String,
    /// The error, and the expected value.
    pub message: String,
}

/// An identification method.
pub trait Identifier: std::fmt::Debug + Send + Sync {
    /// Names, equation, source, when to use.
    fn describe(&self) -> MethodDescription;

    /// The JSON schema of the options of its `[[method]]` block, from the type that reads them.
    fn schema(&self) -> Schema;

    /// The options of its `[[method]]` block, as text: from [`Self::schema`].
    fn options(&self) -> Vec<MethodOption> {
        options_of(&self.schema())
    }

    /// Whether its 95 % intervals cover the true value at ordinary noise, to which the contract tests hold it;
    /// [`MethodDescription::avoid_when`] says why not.
    fn intervals_cover(&self) -> bool {
        !self.fits_emulator()
    }

    /// Place in the order in which the fit of a method is preferred for detailed figures, the first with zero.
    fn rank(&self) -> Option<usize> {
        None
    }

    /// Whether it runs if an experiment names no method.
    fn is_default(&self) -> bool {
        false
    }

    /// Whether its variances are those of efficient estimates under a correct model: a proxy of the Cramér-Rao bound.
    fn is_efficient(&self) -> bool {
        false
    }

    /// Whether it fits the rules of the state emulator, eq. (19), in place of the parameters of the
    /// model; its gain is then an option.
    fn fits_emulator(&self) -> bool {
        false
    }

    /// The same method with the options of a `[[method]]` block (without its `name`).
    ///
    /// # Errors
    /// Unknown keys and wrong types, in words.
    fn configure(&self, options: &toml::Table) -> Result<Box<dyn Identifier>, OptionError>;

    /// Identifies the model of the task from its recordings.
    ///
    /// # Errors
    /// Only where there is no fit at all; see [`IdentifyError`].
    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError>;

    /// As [`Self::identify`] from every row of recordings that are too long for memory: `task` has
    /// windows of them, and `long` a way to read them for each training recording that is one.
    /// `None` if the method, so configured, needs all rows at once.
    ///
    /// # Errors
    /// As [`Self::identify`], and if the rows cannot be read any more.
    fn identify_long(
        &self,
        _task: &Task,
        _long: &[Option<&LongRecording>],
    ) -> Option<Result<Fit, IdentifyError>> {
        None
    }
}

/// [`Identifier::schema`] and [`Identifier::configure`] of a method whose options are its fields.
macro_rules! fields_as_options {
    ($name:expr) => {
        fn schema(&self) -> schemars::Schema {
            $crate::identify::options_schema::<Self>()
        }

        fn configure(
            &self,
            options: &toml::Table,
        ) -> Result<Box<dyn $crate::identify::Identifier>, $crate::identify::OptionError> {
            Ok(Box::new($crate::identify::from_options::<Self>($name, options)?))
        }
    };
}
pub(crate) use fields_as_options;

/// Reads a method with `#[serde(default, deny_unknown_fields)]` from its options, and holds its
/// numbers to the ranges of its schema.
///
/// # Errors
/// [`OptionError`] with serde's words, or with the range.
pub fn from_options<M: DeserializeOwned + JsonSchema>(
    method: &str,
    options: &toml::Table,
) -> Result<M, OptionError> {
    let refuse = |message: String| OptionError { method: method.into(), message };
    let read = toml::Value::Table(options.clone())
        .try_into()
        .map_err(|e: toml::de::Error| refuse(e.message().to_string()))?;
    let schema = options_schema::<M>();
    for (key, value) in options {
        let number = value.as_float().or(value.as_integer().map(|i| i as f64));
        if let Some(x) = number
            && !(x.is_finite() && allowed(&schema.as_value()["properties"][key], x))
        {
            let expected = range_in_words(&schema.as_value()["properties"][key]);
            let expected = expected.unwrap_or_else(|| "a finite number".into());
            return Err(refuse(format!("`{key}` = {value}; expected {expected}")));
        }
    }
    Ok(read)
}

fn allowed(option: &Value, x: f64) -> bool {
    let bound = |name: &str| option[name].as_f64();
    bound("minimum").is_none_or(|low| x >= low)
        && bound("exclusiveMinimum").is_none_or(|low| x > low)
        && bound("maximum").is_none_or(|high| x <= high)
}

/// The range of a number, as in "above 0, at most 1"; `None` where the schema states none.
fn range_in_words(option: &Value) -> Option<String> {
    let bound = |name: &str, word: &str| option[name].as_f64().map(|x| format!("{word} {x}"));
    let parts: Vec<String> =
        [("minimum", "at least"), ("exclusiveMinimum", "above"), ("maximum", "at most")]
            .into_iter()
            .filter_map(|(name, word)| bound(name, word))
            .collect();
    // schemars gives every unsigned integer the minimum 0, which is not a limit
    let trivial = option["type"] == "integer" && option["minimum"] == 0 && parts.len() == 1;
    (!parts.is_empty() && !trivial).then(|| parts.join(", "))
}

/// The options that a schema describes, in its order.
#[must_use]
fn options_of(schema: &Schema) -> Vec<MethodOption> {
    let properties = schema.get("properties").and_then(Value::as_object);
    properties.into_iter().flatten().map(|(key, option)| described(key, option)).collect()
}

fn described(key: &str, option: &Value) -> MethodOption {
    let default = match &option["default"] {
        Value::Null => "unset".to_owned(),
        value => value.to_string(),
    };
    let text = option["description"].as_str().unwrap_or_default().replace('\n', " ");
    let mut meaning = text.trim_end_matches('.').to_owned();
    let choices = choices(option);
    if !choices.is_empty() {
        let _ = write!(meaning, "; one of {}", choices.join(", "));
    }
    if let Some(range) = range_in_words(option) {
        let _ = write!(meaning, "; {range}");
    }
    MethodOption { key: key.into(), default, meaning }
}

/// The words an option may be.
fn choices(option: &Value) -> Vec<String> {
    let listed = option["enum"].as_array().into_iter().flatten().cloned();
    let one_of = option["oneOf"].as_array().into_iter().flatten().flat_map(|o| {
        let listed = o["enum"].as_array().cloned().unwrap_or_default();
        listed.into_iter().chain(o.get("const").cloned())
    });
    listed.chain(one_of).map(|word| word.to_string()).collect()
}

/// The JSON schema of what [`from_options`] reads.
#[must_use]
pub fn options_schema<M: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft07().with(|s| s.inline_subschemas = true);
    let mut schema = settings.into_generator().into_root_schema_for::<M>();
    if let Some(options) = schema.get_mut("properties").and_then(Value::as_object_mut) {
        for option in options.values_mut() {
            if let Some(text) = option["description"].as_str().map(doc_text) {
                option["description"] = text.into();
            }
        }
    }
    schema
}

/// The text of a doc comment in one line, without the escapes that keep rustdoc from taking units for links.
#[must_use]
pub fn doc_text(comment: &str) -> String {
    comment.replace('\n', " ").replace(r"\[", "[").replace(r"\]", "]")
}
