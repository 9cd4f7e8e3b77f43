//! The input between its rows: held or interpolated.

use super::as_recorded::AsRecorded;
use super::evidence::{evidence, noiseless};
use super::thresholds::THRESHOLDS;
use super::timing::{Timed, timed};
use crate::model::Model;
use crate::simulate::Hold;

/// Whether the input is held through a row, as by a controller at the rate of the log, or varies linearly to
/// the next row: the model is fitted with both, each with its own time of the input. Linear interpolation is kept
/// unless the windows contradict it with odds of twenty to one. If the error of the model is larger than noise, an
/// input must also act at its rows to be held; or the two are compared again with the effect of the catalogue in the
/// model, other than a second body or a delay, that explains most of the error.
///
/// Linear interpolation reduces the noise of the recorded input; therefore the contribution of noise to the
/// errors is subtracted in both cases.
///
/// Returns the parameters of the model fitted with the held input, if it is held: those from a torque balance may be
/// far from them as long as the input has the wrong time.
#[must_use]
pub fn held_input(given: &AsRecorded) -> Option<Vec<f64>> {
    let AsRecorded { model, p, recordings, scale, .. } = given;
    let line = given.fit()?;
    let found = Holds::of(given, (model, p), line)?;
    if found.is_held() || found.is_right() {
        return found.is_held().then(|| found.parameters(p.len()));
    }
    let best = given.rivals().iter().min_by(|a, b| a.fit.cost.total_cmp(&b.fit.cost))?;
    if best.fit.cost >= THRESHOLDS.most_left * line.fit.cost {
        return None;
    }
    let line = timed(&best.model, best.p(), 0.0, recordings, Hold::Linear, scale)?;
    let found = Holds::of(given, (&best.model, best.p()), &line)?;
    found.is_held().then(|| found.parameters(p.len()))
}

/// A model fitted with the input on the line between its rows, and with it held.
struct Holds {
    /// Squared innovations of every window on the line and held.
    squares: [Vec<f64>; 2],
    /// Ratio of the error of the windows to noise, if held.
    error: f64,
    /// Time of the held input and its standard error, in rows.
    time: (f64, f64),
    /// Parameters with the held input.
    p: Vec<f64>,
}

impl Holds {
    /// A model near `p`, of which `line` is the fit with the input on the line.
    fn of(given: &AsRecorded, (model, p): (&Model, &[f64]), line: &Timed) -> Option<Self> {
        let AsRecorded { recordings, scale, .. } = given;
        let held = timed(model, p, 0.0, recordings, Hold::Constant, scale)?;
        let squares = |timed: &Timed| noiseless(&timed.windows, &timed.fit);
        let squares = [squares(line)?, squares(&held)?];
        let time = (held.time_s() / scale.step, held.std_error_s() / scale.step);
        Some(Self { squares, error: held.error(), time, p: held.fit.p })
    }

    /// Whether the error with the held input is that of noise.
    fn is_right(&self) -> bool {
        self.error <= THRESHOLDS.above_floor
    }

    /// Both by the likelihood of the rows and by what the windows scatter about. The likelihood of an incomplete model
    /// counts by as much less as its squared errors are larger than noise.
    fn is_held(&self) -> bool {
        let [line, held] = &self.squares;
        let gain = line.iter().sum::<f64>() - held.iter().sum::<f64>();
        let likely = gain > THRESHOLDS.alike * self.error.powi(2).max(1.0);
        let sure = evidence(line, held) > THRESHOLDS.alike;
        likely && sure && (self.is_right() || self.acts_at_rows())
    }

    /// Whether its time is zero within an uncertainty of less than what a line between rows is late by.
    fn acts_at_rows(&self) -> bool {
        let (time, error) = self.time;
        let uncertain = THRESHOLDS.uncertain * error;
        time.abs() <= uncertain && uncertain < THRESHOLDS.logging
    }

    /// The first `count` parameters, those of the model as given.
    fn parameters(&self, count: usize) -> Vec<f64> {
        self.p[..count].to_vec()
    }
}
