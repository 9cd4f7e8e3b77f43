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

/// Whether the input is held through a row, as by a controller at the rate of the log, is recorded as its mean over a
/// row, as by a logger that averages, or varies linearly to the next row: the model is fitted with each, and with its
/// own time of the input. Linear interpolation is kept unless the windows contradict it with odds of twenty to one. If
/// the error of the model is larger than noise, an input must also act at its rows to be held; or they are compared
/// again with the effect of the catalogue in the model, other than a second body or a delay, that explains most of the
/// error. With means the error must be that of noise: otherwise the input varies within its rows in yet another way.
///
/// Interpolation reduces the noise of the recorded input; therefore the contribution of noise to the
/// errors is subtracted in all cases.
///
/// Returns `None` for an input on the line.
#[must_use]
pub fn acting_input(given: &AsRecorded) -> Option<Known> {
    let AsRecorded { model, p, recordings, scale, .. } = given;
    let line = given.fit()?;
    let found = Accounts::of(given, (model, p), line)?;
    if let Some(better) = found.better() {
        return Some(better.known(p.len()));
    }
    if found.others.iter().any(Account::is_right) {
        return None;
    }
    let best = given.rivals().iter().min_by(|a, b| a.fit.cost.total_cmp(&b.fit.cost))?;
    if best.fit.cost >= THRESHOLDS.most_left * line.fit.cost {
        return None;
    }
    let line = timed(&best.model, best.p(), 0.0, recordings, Hold::Linear, scale)?;
    let found = Accounts::of(given, (&best.model, best.p()), &line)?;
    found.better().map(|account| account.known(p.len()))
}

/// A model fitted with the input on the line between its rows, and under the other accounts.
struct Accounts {
    /// Squared innovations of every window on the line.
    line: Vec<f64>,
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

impl Accounts {
    /// A model near `p`, of which `line` is the fit with the input on the line.
    fn of(given: &AsRecorded, (model, p): (&Model, &[f64]), line: &Timed) -> Option<Self> {
        let AsRecorded { recordings, scale, .. } = given;
        let squares = |timed: &Timed| noiseless(&timed.windows, &timed.fit);
        let account = |between: Between, start: f64| {
            let timed = timed(model, p, start, recordings, between, scale)?;
            let squares = squares(&timed)?;
            let (error, time) = (timed.error(), (timed.time_s(), timed.std_error_s()));
            Some(Account { between, squares, error, time, p: timed.fit.p })
        };
        // the middle of a row that begins at its time is half a row later
        let means = account(Between::Means, line.time_s() - 0.5 * scale.step);
        let others = account(Between::Held, 0.0).into_iter().chain(means).collect();
        Some(Self { line: squares(line)?, others, step: scale.step })
    }

    /// The account that leaves least of those that the windows prefer to the line. Where they do not distinguish a held
    /// input from means of a row that has ended when they are recorded, the values are means: those of a held input are
    /// the input itself, so that less is claimed. A command acts from its row on.
    fn better(&self) -> Option<&Account> {
        let better = || self.others.iter().filter(|account| self.is_better(account));
        let least = better().min_by(|a, b| a.sum().total_cmp(&b.sum()))?;
        let alike = |means: &&Account| {
            means.between == Between::Means
                && means.time.0 < -THRESHOLDS.logging * self.step
                && evidence(&means.squares, &least.squares) < THRESHOLDS.alike
        };
        Some(better().find(alike).unwrap_or(least))
    }

    /// Both by the likelihood of the rows and by what the windows scatter about. The likelihood of an incomplete model
    /// counts by as much less as its squared errors are larger than noise.
    fn is_better(&self, account: &Account) -> bool {
        let gain = self.line.iter().sum::<f64>() - account.sum();
        let likely = gain > THRESHOLDS.alike * account.error.powi(2).max(1.0);
        let sure = evidence(&self.line, &account.squares) > THRESHOLDS.alike;
        let possible = match account.between {
            Between::Means => account.is_right() && account.is_of_a_row(self.step),
            _ => account.is_right() || account.acts_at_rows(self.step),
        };
        likely && sure && possible
    }
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

    /// Whether the time of means is, within its uncertainty, that of the row that ends when they are recorded, of the one
    /// that begins, or between the two. Means from later rows are not known yet: a motion that follows these has a delay
    /// of the actuator; means from longer ago are those of no logger.
    fn is_of_a_row(&self, step: f64) -> bool {
        let uncertain = THRESHOLDS.uncertain * self.time.1;
        (-step - uncertain..=uncertain).contains(&self.time.0)
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
        assert!(of_a_row(-step) && of_a_row(-0.5 * step) && of_a_row(0.0));
        // within two standard errors of the ends, not beyond
        assert!(of_a_row(3e-4) && of_a_row(-step - 3e-4));
        assert!(!of_a_row(3.8e-3) && !of_a_row(-2.26 * step));
    }
}
