//! A fitted model on the recordings of an experiment in detail, and its grade.

use serde::{Deserialize, Serialize};

use super::Performance;
use crate::compare::{Failure, Horizon, Whiteness};
use crate::diagnose::{THRESHOLDS, WindowFit};
use crate::identify::Estimate;
use crate::recording::DriveUnit;

/// A parameter of a fitted model.
#[derive(Clone, Debug)]
pub struct ParameterStudy {
    /// Id of the effect that it belongs to.
    pub effect: String,
    /// What it means.
    pub meaning: String,
    /// Value, standard error and interval.
    pub estimate: Estimate,
}

/// The parameters of a fit of the diagnosis, in the units for this unit of the input.
#[must_use]
pub fn parameters_of(fit: &WindowFit, unit: DriveUnit) -> Vec<ParameterStudy> {
    let parameter = |(j, parameter): (usize, &crate::model::Parameter)| {
        let fixed = parameter.fixed.is_some();
        let spec = &parameter.spec;
        let std_error = match fit.covariance[(j, j)].sqrt() {
            _ if fixed => 0.0,
            // uncertain by more than all admissible values: the data do not determine it
            error if error > spec.range.1 - spec.range.0 => f64::INFINITY,
            error => error,
        };
        let estimate = Estimate::new(&spec.symbol, unit.of(&spec.unit), fit.p[j], std_error)
            .with_degrees(fit.degrees());
        ParameterStudy {
            effect: parameter.effect.clone(),
            meaning: spec.meaning.clone(),
            estimate: Estimate { fixed, ..estimate },
        }
    };
    fit.model.parameters().iter().enumerate().map(parameter).collect()
}

/// A fitted model on the recordings of an experiment.
#[derive(Clone, Debug, Default)]
pub struct ModelStudy {
    /// Effects beyond the base.
    pub effects: Vec<String>,
    /// Parameters of the base and of all effects, including fixed ones.
    pub parameters: Vec<ParameterStudy>,
    /// Performance on each recording of the experiment, without emulators.
    pub performance: Vec<Performance>,
    /// Residual torque for every row of every recording [N m]; NaN near rest. Empty if the model is not
    /// physical.
    pub residual_torque: Vec<Vec<[f64; 2]>>,
    /// Regimes of driving, sorted by the ratio of the error of the judged recordings to noise.
    pub failures: Vec<Failure>,
    /// Error of the judged recordings over simulations of several lengths.
    pub horizons: Vec<Horizon>,
    /// Residual analysis on the judged recordings.
    pub whiteness: Option<Whiteness>,
}

impl ModelStudy {
    /// The estimate of a parameter.
    #[must_use]
    pub fn parameter(&self, symbol: &str) -> Option<&ParameterStudy> {
        self.parameters.iter().find(|p| p.estimate.symbol == symbol)
    }
}

/// An effect that the diagnosis accepted.
#[derive(Clone, Debug, Serialize)]
pub struct FoundEffect {
    /// Id in the catalogue.
    pub id: String,
    /// Its name in words.
    pub title: String,
    /// Physical cause.
    pub cause: String,
    /// Ids of the effects that these data do not distinguish from it.
    pub indistinguishable: Vec<String>,
}

/// An effect that lowers the held-out error without being proven.
#[derive(Clone, Debug, PartialEq)]
pub struct UnprovenEffect {
    /// Id in the catalogue.
    pub id: String,
    /// Reduction of the error of held-out windows of 1 s with it (RMS over all of them), as a share.
    pub lowers: f64,
    /// Whether no recording is held out, and parts of the training recordings were in turn.
    pub crossed: bool,
}

/// Ratio of error to floor below which the floor is an upper bound of the effects of noise and of the input between its
/// rows, not an estimate: it is higher than the error by more than its own uncertainty, as an error is at the floor up
/// to 1.2 times the floor.
pub const FAR_BELOW_FLOOR: f64 = 1.0 / THRESHOLDS.at_floor;

/// Grade of a model.
///
/// The first that applies, with the 2 s simulation error e on recordings that were not fitted, the noise floor
/// and the top speed of a wheel:
///
/// | grade | condition |
/// |---|---|
/// | at the floor | e ≤ 1.2 floor |
/// | near the floor | e ≤ 1.5 floor, or sqrt(e² - floor²) ≤ 0.2 % of the top speed |
/// | useful | e ≤ 5 % of the top speed |
/// | poor | e ≤ 20 % of the top speed |
/// | not usable | otherwise, or the simulation diverges |
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Grade {
    /// These recordings cannot reveal a better model.
    AtFloor,
    /// The remaining error is small compared with noise or speed.
    Near,
    /// Predicts the motion to a few per cent.
    Useful,
    /// Predicts the motion only qualitatively.
    Poor,
    /// No useful prediction.
    NotUsable,
}

impl Grade {
    /// The grade of an error over windows of 2 s, beside its floor and the top speed [rad/s].
    ///
    /// ```
    /// use amigo_ident::study::Grade;
    /// assert_eq!(Grade::of(0.055, 0.05, 10.0), Grade::AtFloor);
    /// assert_eq!(Grade::of(0.3, 0.05, 10.0), Grade::Useful);
    /// assert_eq!(Grade::of(f64::NAN, 0.05, 10.0), Grade::NotUsable);
    /// ```
    #[must_use]
    pub fn of(error: f64, floor: f64, top_speed: f64) -> Self {
        let excess = (error * error - floor * floor).max(0.0).sqrt();
        let is_small = excess <= THRESHOLDS.excess * top_speed;
        match error {
            e if !e.is_finite() => Self::NotUsable,
            e if e <= THRESHOLDS.at_floor * floor => Self::AtFloor,
            e if e <= THRESHOLDS.above_floor * floor || is_small => Self::Near,
            e if e <= THRESHOLDS.useful * top_speed => Self::Useful,
            e if e <= THRESHOLDS.poor * top_speed => Self::Poor,
            _ => Self::NotUsable,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grades_change_at_their_limits_and_only_get_worse() {
        use Grade::{AtFloor, Near, NotUsable, Poor, Useful};
        // floor 0.1, top speed 10: limits at 0.12, 0.15, 0.5 and 2
        let at = |e| Grade::of(e, 0.1, 10.0);
        let seen = [0.119, 0.121, 0.149, 0.151, 0.499, 0.501, 1.99, 2.01].map(at);
        assert_eq!(seen, [AtFloor, Near, Near, Useful, Useful, Poor, Poor, NotUsable]);
        // a very low floor: 0.2 % of the top speed is 0.02
        assert_eq!([0.0199, 0.0202].map(|e| Grade::of(e, 0.001, 10.0)), [Near, Useful]);
    }
}
