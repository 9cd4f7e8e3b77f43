//! The input between its rows: on the line, held, or with the recorded values as its means.

use super::as_recorded::AsRecorded;
use super::evidence::{evidence, noiseless};
use super::input_timing::Between;
use super::thresholds::THRESHOLDS;
use super::timing::{Timed, timed};
use crate::model::Model;
use crate::simulate::Hold;

/// How an input acts that is not on the line between its rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Acting {
    /// Every value is held until the next row.
    Held,
    /// Every value is the mean over a row, from `shift_s` after its own row on \[s\]: -h for the row before.
    Mean {
        /// Time \[s\].
        shift_s: f64,
    },
}

/// An input that is known between its rows.
#[derive(Clone, Debug)]
pub struct Known {
    /// How it acts.
    pub acting: Acting,
    /// Parameters of the model fitted with this input: those from a torque balance may be far from them as long as
    /// the input has the wrong time.
    pub p: Vec<f64>,
}

/// The input between its rows, as the motion shows it.
#[derive(Clone, Debug)]
pub enum Course {
    /// On the line between its rows, or on a smooth curve through them: a held input contradicts the motion.
    Line,
    /// On that line or held: the motion does not distinguish the two, which differ by half a row in time.
    LineOrHeld,
    /// Another one.
    Known(Known),
}

/// Whether the input is held through a row, as by a controller at the rate of the log, is recorded as its mean over a
/// row, as by a logger that averages, or varies linearly to the next row: the model is fitted with each, and with its
/// own time of the input. Linear interpolation is kept unless the windows contradict it with odds of twenty to one, and a
/// smooth curve through the rows, which a line that is shifted by a part of a row is not, with the same odds. If
/// the error of the model is larger than noise, an input must also act at its rows to be held; or they are compared
/// again with the effect of the catalogue in the model, other than a second body or a delay, that explains most of the
/// error. With means the error must be that of noise: otherwise the input varies within its rows in yet another way.
///
/// Interpolation reduces the noise of the recorded input; therefore the contribution of noise to the
/// errors is subtracted in all cases.
#[must_use]
pub fn course_of_input(given: &AsRecorded) -> Course {
    let AsRecorded { model, p, recordings, scale, .. } = given;
    let Some(line) = given.fit() else { return Course::LineOrHeld };
    let Some(found) = Accounts::of(given, (model, p), line) else { return Course::LineOrHeld };
    let course = found.course(p.len());
    if matches!(course, Course::Known(_)) || found.others.iter().any(Account::is_right) {
        return course;
    }
    let with_effect = || {
        let best = given.rivals().iter().min_by(|a, b| a.fit.cost.total_cmp(&b.fit.cost))?;
        if best.fit.cost >= THRESHOLDS.most_left * line.fit.cost {
            return None;
        }
        let line = timed(&best.model, best.p(), 0.0, recordings, Hold::Linear, scale)?;
        Some(Accounts::of(given, (&best.model, best.p()), &line)?.course(p.len()))
    };
    with_effect().unwrap_or(course)
}

/// A model fitted with the input on the line between its rows, and under the other accounts.
struct Accounts<'a, 'b> {
    given: &'b AsRecorded<'a>,
    /// The model and parameters near its fits.
    near: (&'b Model, &'b [f64]),
    /// Squared innovations of every window on the line.
    line: Vec<f64>,
    /// Time of the input on the line \[s\].
    line_s: f64,
    others: Vec<Account>,
    /// Time from one row to the next \[s\].
    step: f64,
}

/// A model fitted with its input under one account.
struct Account {
    between: Between,
    /// Squared innovations of every window.
    squares: Vec<f64>,
    /// Ratio of the error of the windows to noise.
    error: f64,
    /// Time of the input and its standard error \[s\].
    time: (f64, f64),
    p: Vec<f64>,
}

impl<'a, 'b> Accounts<'a, 'b> {
    /// A model near `p`, of which `line` is the fit with the input on the line.
    fn of(given: &'b AsRecorded<'a>, near: (&'b Model, &'b [f64]), line: &Timed) -> Option<Self> {
        let (step, line_s) = (given.scale.step, line.time_s());
        let line = noiseless(&line.windows, &line.fit)?;
        let mut found = Self { given, near, line, line_s, others: vec![], step };
        // the middle of a row that begins at its time is half a row later
        let starts = [(Between::Held, 0.0), (Between::Means, line_s - 0.5 * step)];
        let others =
            starts.into_iter().filter_map(|(between, start)| found.account(between, start));
        found.others = others.collect();
        Some(found)
    }

    /// The fit under one account, with the time of the input from `start` \[s\].
    fn account(&self, between: Between, start: f64) -> Option<Account> {
        let AsRecorded { recordings, scale, .. } = self.given;
        let timed = timed(self.near.0, self.near.1, start, recordings, between, scale)?;
        let squares = noiseless(&timed.windows, &timed.fit)?;
        let (error, time) = (timed.error(), (timed.time_s(), timed.std_error_s()));
        Some(Account { between, squares, error, time, p: timed.fit.p })
    }

    /// What the windows show, with the first `count` parameters.
    fn course(&self, count: usize) -> Course {
        let held = self.others.iter().find(|account| account.between == Between::Held);
        let line_is_surer = |held: &Account| is_surer(&held.squares, &self.line, held.error);
        if held.is_some_and(line_is_surer) {
            // means are sought beside the line alone
            return self
                .better(None)
                .map_or(Course::Line, |better| Course::Known(better.known(count)));
        }
        let smooth = self.account(Between::Smooth, self.line_s);
        if let Some(better) = self.better(smooth.as_ref()) {
            return Course::Known(better.known(count));
        }
        let is_smooth = |held: &Account| {
            smooth
                .as_ref()
                .is_some_and(|smooth| is_surer(&held.squares, &smooth.squares, smooth.error))
        };
        if held.is_some_and(is_smooth) { Course::Line } else { Course::LineOrHeld }
    }

    /// The account that leaves least of those that the windows prefer to the line, and to a `smooth` input. Where they do
    /// not distinguish a held input from means of a row that has ended when they are recorded, the values are means: those
    /// of a held input are the input itself, so that less is claimed. A command acts from its row on.
    fn better(&self, smooth: Option<&Account>) -> Option<&Account> {
        let better = || self.others.iter().filter(|account| self.is_better(account, smooth));
        let least = better().min_by(|a, b| a.sum().total_cmp(&b.sum()))?;
        let alike = |means: &&Account| {
            means.between == Between::Means
                && means.time.0 < -THRESHOLDS.logging * self.step
                && evidence(&means.squares, &least.squares) < THRESHOLDS.alike
        };
        Some(better().find(alike).unwrap_or(least))
    }

    fn is_better(&self, account: &Account, smooth: Option<&Account>) -> bool {
        let surer = |than: &[f64]| is_surer(than, &account.squares, account.error);
        let possible = match account.between {
            Between::Means => account.is_right() && account.is_of_a_row(self.step),
            _ => account.is_right() || account.acts_at_rows(self.step),
        };
        possible && surer(&self.line) && smooth.is_none_or(|smooth| surer(&smooth.squares))
    }
}

/// Whether the second of two accounts is surer, by the squared innovations of every window: both by the likelihood of the
/// rows and by what the windows scatter about. The likelihood of an incomplete model, of which the `error` is so many times
/// noise, counts by as much less as its squared errors are larger than noise.
fn is_surer(one: &[f64], other: &[f64], error: f64) -> bool {
    let sum = |squares: &[f64]| squares.iter().sum::<f64>();
    let likely = sum(one) - sum(other) > THRESHOLDS.alike * error.powi(2).max(1.0);
    likely && evidence(one, other) > THRESHOLDS.alike
}

impl Account {
    fn sum(&self) -> f64 {
        self.squares.iter().sum()
    }

    /// Whether the error is that of noise.
    fn is_right(&self) -> bool {
        self.error <= THRESHOLDS.above_floor
    }

    /// Whether its time is zero within an uncertainty of less than what a line between rows is late by.
    fn acts_at_rows(&self, step: f64) -> bool {
        let (time, error) = (self.time.0 / step, self.time.1 / step);
        let uncertain = THRESHOLDS.uncertain * error;
        time.abs() <= uncertain && uncertain < THRESHOLDS.logging
    }

    /// Whether the time of means is, within its uncertainty, that of the row that ends when they are recorded, or of the one
    /// that begins. Half a row from both the middle of the means is their own time, where samples have it: these follow a
    /// swift input nearly as means do. Means from later rows are not known yet: a motion that follows these has a delay of
    /// the actuator; means from longer ago are those of no logger.
    fn is_of_a_row(&self, step: f64) -> bool {
        let uncertain = THRESHOLDS.uncertain * self.time.1;
        let is_sample = (self.time.0 + 0.5 * step).abs() < 0.5 * THRESHOLDS.logging * step;
        (-step - uncertain..=uncertain).contains(&self.time.0) && !is_sample
    }

    /// With the first `count` parameters, those of the model as given.
    fn known(&self, count: usize) -> Known {
        let acting = match self.between {
            Between::Means => Acting::Mean { shift_s: self.time.0 },
            _ => Acting::Held,
        };
        Known { acting, p: self.p[..count].to_vec() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_those_of_the_row_before_or_of_the_one_that_begins() {
        let step = 0.01;
        let of_a_row = |time_s: f64| {
            let (squares, p) = (vec![], vec![]);
            let time = (time_s, 2e-4);
            Account { between: Between::Means, squares, error: 1.0, time, p }.is_of_a_row(step)
        };
        assert!(of_a_row(-step) && of_a_row(-0.9 * step) && of_a_row(0.0));
        assert!(!of_a_row(-0.5 * step) && !of_a_row(-0.3 * step));
        // within two standard errors of the ends, not beyond
        assert!(of_a_row(3e-4) && of_a_row(-step - 3e-4));
        assert!(!of_a_row(3.8e-3) && !of_a_row(-2.26 * step));
    }
}
