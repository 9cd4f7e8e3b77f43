//! Fills the templates of the languages.

use super::language::{LANGUAGES, Language};
use super::print::{Printed, number, print};
use super::traced::{MOTION, TORQUES, Traced};
use crate::math::Formula;
use crate::simulate::Hold;

/// A constant of a function.
pub(super) struct Constant {
    /// Name in the formulas.
    pub(super) name: String,
    pub(super) value: f64,
    /// Unit, uncertainty and meaning.
    pub(super) remark: String,
}

/// Content of an exported function, independent of the language.
pub(super) struct Content<'a> {
    /// The formulas.
    pub(super) traced: &'a Traced,
    /// Lines of the header comment.
    pub(super) header: Vec<String>,
    /// The parameters of the formulas, in their order.
    pub(super) constants: Vec<Constant>,
    /// The input between two samples.
    pub(super) hold: Hold,
}

/// Results of formulas of the state: arrays and their sizes.
type Results = [(&'static str, usize)];
const TERMS: [(&str, usize); 3] = [("mass", 3), ("torque", 2), ("level", 4)];
const BODY: [(&str, usize); 1] = [("rate", 4)];
const FASTEST: [(&str, usize); 1] = [("fastest", 1)];

impl Content<'_> {
    /// The function in all languages, as name and text of a file.
    pub(super) fn files(&self) -> Vec<(String, String)> {
        LANGUAGES.iter().map(|language| (language.file.to_owned(), self.fill(language))).collect()
    }

    /// The function in one language.
    pub(super) fn fill(&self, language: &Language) -> String {
        let Self { traced, hold, constants, .. } = self;
        let terms = self.of_state(&traced.terms, &TERMS, language);
        let body = self.of_state(&traced.body, &BODY, language);
        let fastest = self.of_state(&traced.fastest, &FASTEST, language);
        let input = self.of_input(&traced.input, language);
        let behind = self.of_input(&traced.behind, language);
        let counts = [&terms, &body, &fastest, &input, &behind]
            .map(|printed| printed.temporaries.to_string());
        let states = (4 + traced.body.outputs.len()).to_string();
        let time = |parameter: Option<usize>| {
            parameter.map_or_else(|| number(0.0), |j| constants[j].name.clone())
        };
        // rows of the buffer for a delay, at steps of 1 ms
        let delay_rows =
            traced.delay.map_or(0, |j| (constants[j].value / 1e-3 + 1e-9) as usize) + 2;
        let inline = [
            ("{{linear}}", language.truth[usize::from(*hold == Hold::Linear)]),
            ("{{states}}", &states),
            ("{{terms_temporaries}}", &counts[0]),
            ("{{body_temporaries}}", &counts[1]),
            ("{{fastest_temporaries}}", &counts[2]),
            ("{{drive_temporaries}}", &counts[3]),
            ("{{behind_temporaries}}", &counts[4]),
            ("{{lag}}", &time(traced.lag)),
            ("{{delay}}", &time(traced.delay)),
            ("{{delay_rows}}", &delay_rows.to_string()),
        ];
        let blocks = [
            ("{{header}}", self.comments(language)),
            ("{{parameters}}", self.parameters(language)),
            ("{{terms}}", terms.statements),
            ("{{body}}", body.statements),
            ("{{fastest}}", fastest.statements),
            ("{{drive}}", input.statements),
            ("{{behind}}", behind.statements),
        ];
        filled(language.frame, &inline, &blocks)
    }

    fn comments(&self, language: &Language) -> Vec<String> {
        let comment = |line: &String| {
            format!("{} {}", language.comment, one_line(line)).trim_end().to_owned()
        };
        self.header.iter().map(comment).collect()
    }

    fn parameters(&self, language: &Language) -> Vec<String> {
        let constant =
            |c: &Constant| (language.constant)(&c.name, &number(c.value), &one_line(&c.remark));
        self.constants.iter().map(constant).collect()
    }

    /// Prints a formula of the state.
    fn of_state(&self, formula: &Formula, results: &Results, language: &Language) -> Printed {
        let place = language.syntax.place;
        let places = |of: &[(&'static str, usize)]| -> Vec<String> {
            of.iter().flat_map(|&(array, size)| (0..size).map(move |k| place(array, k))).collect()
        };
        let state = places(&[("alpha", 2), ("omega", 2), ("body", 4)]);
        let inputs: Vec<String> =
            std::iter::once("t".to_owned()).chain(state).chain(self.names()).collect();
        debug_assert_eq!(inputs.len(), MOTION + self.constants.len());
        print(formula, &inputs, &places(results), &language.syntax)
    }

    /// Prints a formula of the input.
    fn of_input(&self, formula: &Formula, language: &Language) -> Printed {
        let place = language.syntax.place;
        let now = [place("M", 0), place("M", 1)];
        let unused = [String::new(), String::new()]; // the sample before: no formula depends on it
        let inputs: Vec<String> = unused.into_iter().chain(now).chain(self.names()).collect();
        debug_assert_eq!(inputs.len(), TORQUES + self.constants.len());
        let targets = [place("acting", 0), place("acting", 1)];
        print(formula, &inputs, &targets, &language.syntax)
    }

    fn names(&self) -> impl Iterator<Item = String> + '_ {
        self.constants.iter().map(|c| c.name.clone())
    }
}

/// A template with its placeholders, within lines and for several lines, replaced.
fn filled(frame: &str, inline: &[(&str, &str)], blocks: &[(&str, Vec<String>)]) -> String {
    let mut out = String::new();
    for line in frame.lines() {
        let place = line.trim_start();
        let indent = &line[..line.len() - place.len()];
        match blocks.iter().find(|(mark, _)| *mark == place) {
            Some((_, lines)) => lines.iter().for_each(|l| out += &format!("{indent}{l}\n")),
            None => {
                let fill = |text: String, (mark, value): &(&str, &str)| text.replace(mark, value);
                out += &inline.iter().fold(line.to_owned(), fill);
                out.push('\n');
            }
        }
    }
    out
}

/// Text within a one-line comment; in C a backslash would continue the line.
fn one_line(text: &str) -> String {
    text.replace(['\n', '\r', '\\'], " ")
}
