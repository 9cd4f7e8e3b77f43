//! Detected properties of the columns of a log.

use super::names::Named;
use crate::io::PreviewColumn;
use crate::recording::DriveUnit;

/// A column of the log as a quantity of the program.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::experiment) struct Guessed {
    /// Quantity.
    pub(in crate::experiment) key: &'static str,
    /// Name in the file.
    pub(in crate::experiment) name: String,
    /// Unit, where it is not that of the program.
    pub(in crate::experiment) unit: Option<String>,
    /// Column that holds the nanoseconds of the time.
    pub(in crate::experiment) nanoseconds: Option<String>,
    /// Counts per turn of the wheel.
    pub(in crate::experiment) per_turn: Option<f64>,
    /// Factor on the value.
    pub(in crate::experiment) scale: Option<f64>,
    /// Whether the unit must be asked for.
    pub(in crate::experiment) unit_open: bool,
    /// Whether the factor must be asked for: the time between two rows, of a column that counts rows; the sign of a
    /// wheel that may be mirrored; the gear of a speed of the motor's field.
    pub(in crate::experiment) scale_open: bool,
    /// Whether it is a command that is a share of the battery's voltage.
    pub(in crate::experiment) is_share: bool,
    /// Whether it is a number of counts per row, of which the time is not known yet.
    pub(in crate::experiment) per_row: bool,
    /// Whether the values are increments that must be summed.
    pub(in crate::experiment) sum: bool,
    /// Added after the factor.
    pub(in crate::experiment) offset: Option<f64>,
    /// Columns that are added to the value.
    pub(in crate::experiment) plus: Vec<String>,
    /// Column that multiplies the value.
    pub(in crate::experiment) times: Option<String>,
    /// Column with the direction, and its content for negative values.
    pub(in crate::experiment) sign: Option<String>,
    pub(in crate::experiment) backward: Option<String>,
    /// Whether the column of the direction must be asked for.
    pub(in crate::experiment) sign_open: bool,
    /// Whether the value for backward must be asked for.
    pub(in crate::experiment) backward_open: bool,
    /// Whether the name does not determine the wheel.
    pub(in crate::experiment) side_unsure: bool,
    /// Evidence in addition to the name.
    pub(in crate::experiment) evidence: Vec<String>,
}

/// What a question is about, if its answer may be found later.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::experiment) enum About {
    /// The unit of the column with this name.
    Unit(String),
    /// The time between the rows.
    Period,
    /// Columns of an input that never change.
    StillInput,
    /// Which of several columns are those of the two wheels, by the key of the right one.
    Which(&'static str),
    /// Anything else.
    Other,
}

/// A question that only the user can answer.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::experiment) struct Question {
    pub(in crate::experiment) about: About,
    pub(in crate::experiment) text: String,
}

impl<T: Into<String>> From<T> for Question {
    fn from(text: T) -> Self {
        Self { about: About::Other, text: text.into() }
    }
}

impl Guess {
    /// Adds a question.
    pub(in crate::experiment) fn ask(&mut self, question: impl Into<Question>) {
        self.questions.push(question.into());
    }

    /// Adds questions.
    pub(in crate::experiment) fn ask_all(
        &mut self,
        questions: impl IntoIterator<Item = impl Into<Question>>,
    ) {
        self.questions.extend(questions.into_iter().map(Into::into));
    }

    /// Whether it is asked which of several columns are the motion of the wheels: by this key of the right one.
    pub(in crate::experiment) fn asks_which(&self, key: &'static str) -> bool {
        self.questions.iter().any(|question| question.about == About::Which(key))
    }

    /// Removes the questions about this.
    pub(in crate::experiment) fn answer(&mut self, about: &About) {
        self.questions.retain(|question| question.about != *about);
    }

    /// The text of all questions, one per line.
    #[cfg(test)]
    pub(super) fn asked(&self) -> String {
        self.questions.iter().map(|q| q.text.as_str()).collect::<Vec<_>>().join("\n")
    }
}

/// The detected columns of a log.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::experiment) struct Guess {
    /// The columns that were found.
    pub(in crate::experiment) columns: Vec<Guessed>,
    /// Unit of the input.
    pub(in crate::experiment) drive_unit: DriveUnit,
    /// Questions that only the user can answer.
    pub(in crate::experiment) questions: Vec<Question>,
    /// Whether one axis is used for both wheels.
    pub(in crate::experiment) one_axis: bool,
    /// Whether no column can be the time, so that the period is asked for.
    pub(in crate::experiment) period_open: bool,
    /// Time between two rows \[s\] that the file states outside its columns.
    pub(in crate::experiment) period: Option<f64>,
    /// Voltages beside currents, or currents beside voltages, that may be used in place of the input.
    pub(in crate::experiment) other_input: Option<([Guessed; 2], DriveUnit)>,
}

/// A column with the interpretation of its name.
pub(super) struct Candidate<'a> {
    pub(super) column: &'a PreviewColumn,
    pub(super) named: Named,
}
