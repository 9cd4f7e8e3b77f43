//! The verdict: nothing is missing, these effects are, or something unknown is.

use super::outcome::Ranked;
use crate::compare::{Dependence, MissingMoment};

/// What the diagnosis concludes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conclusion {
    /// Nothing is missing at the stated false-alarm rate.
    Sufficient,
    /// The effects found explain what was missing.
    Missing,
    /// Something is missing that no candidate explains.
    Unknown,
}

/// Errors of the models on the judged recordings, as variances of the window error
/// [rad^2/s^2].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Of the model as given.
    pub before: f64,
    /// Of the model with all effects found.
    pub after: f64,
    /// Of the noise floor.
    pub floor: f64,
    /// Mean square speed of the wheels.
    pub speed: f64,
}

/// Least -ln p of the strongest dependence of the missing moment that counts as structure: the
/// largest of twelve tests on recordings with nothing hidden stayed below it.
const STRUCTURE: f64 = 16.0;
/// Least size of a dependence, as a share of the rms drive.
const WORTH: f64 = 0.05;
/// Error above the floor, as a ratio of standard deviations, that is worth a word.
const ABOVE_FLOOR: f64 = 1.1;
/// Effects that leave more than this share of the explainable error do not explain it.
const UNEXPLAINED: f64 = 0.5;
/// The same where the model is left far above the floor.
const FAR_UNEXPLAINED: f64 = 0.1;
/// Far above the floor, as a ratio of standard deviations.
const FAR: f64 = 3.0;
/// Error, as a share of the speed, that is far from right whatever the floor: no model of a real
/// robot reaches the noise of good sensors.
const FAR_FROM_RIGHT: f64 = 0.02;

impl Errors {
    /// Share of what can be explained that is left: 0 at the floor, 1 where nothing was gained.
    ///
    /// ```text
    /// x = (V_after - V_floor) / (V_before - V_floor)
    /// ```
    /// Zero where the model as given is within 2 % of the floor: there is nothing to explain.
    #[must_use]
    pub fn unexplained(&self) -> f64 {
        let explainable = self.before - self.floor;
        if explainable <= 0.04 * self.floor {
            return 0.0;
        }
        ((self.after - self.floor) / explainable).clamp(0.0, 1.0)
    }

    /// Whether the last model is visibly above the floor.
    #[must_use]
    pub fn above_floor(&self) -> bool {
        self.after > ABOVE_FLOOR * ABOVE_FLOOR * self.floor
    }

    /// Whether the last model is so far above the floor that something is missing, whether it
    /// shows against one of the variables or not.
    #[must_use]
    pub fn far_above_floor(&self) -> bool {
        self.after > FAR * FAR * self.floor
            && self.after > FAR_FROM_RIGHT * FAR_FROM_RIGHT * self.speed
    }
}

/// The strongest dependence that counts as structure: significant, and larger than 5 % of the
/// root mean square drive `rms` [N m].
#[must_use]
pub fn structure(left: &MissingMoment, rms: f64) -> Option<&Dependence> {
    left.dependences.iter().find(|d| d.log_significance > STRUCTURE && d.size > WORTH * rms)
}

/// Concludes from what was found, the errors, and whether the last model leaves structure.
///
/// Something unknown is missing where nothing was found, or where what was found leaves more than
/// half of the explainable error, and the error shows against a variable; or, far above the floor,
/// where it leaves more than a tenth, whether it shows or not.
#[must_use]
pub fn conclude(found: usize, errors: &Errors, structure: bool) -> Conclusion {
    let left = if errors.far_above_floor() {
        Some(FAR_UNEXPLAINED)
    } else {
        (structure && errors.above_floor()).then_some(UNEXPLAINED)
    };
    if left.is_some_and(|share| found == 0 || errors.unexplained() > share) {
        Conclusion::Unknown
    } else if found == 0 {
        Conclusion::Sufficient
    } else {
        Conclusion::Missing
    }
}

/// Posterior probabilities of the candidates of one step, "none of them" included with
/// log-evidence zero; one per candidate, in order.
#[must_use]
pub fn probabilities(ranking: &[Ranked]) -> Vec<f64> {
    let ranks: Vec<f64> = ranking.iter().map(Ranked::rank).collect();
    let largest = ranks.iter().copied().fold(0.0, f64::max);
    let weights: Vec<f64> = ranks.iter().map(|r| (r - largest).exp()).collect();
    let sum = weights.iter().sum::<f64>() + (-largest).exp();
    weights.iter().map(|w| w / sum).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::Variable;

    fn left(log_significance: f64, size: f64) -> MissingMoment {
        MissingMoment {
            dependences: vec![Dependence {
                variable: Variable::Heading,
                bins: vec![],
                statistic: 0.0,
                rank: 1,
                log_significance,
                size,
            }],
        }
    }

    #[test]
    fn a_model_at_the_floor_is_sufficient_whatever_was_tried() {
        let errors = Errors { before: 1.01, after: 1.01, floor: 1.0, speed: 1e4 };
        assert_eq!(conclude(0, &errors, true), Conclusion::Sufficient);
        assert_eq!(errors.unexplained(), 0.0);
    }

    #[test]
    fn structure_is_significant_and_worth_a_word() {
        assert!(structure(&left(40.0, 0.02), 0.2).is_some());
        assert!(structure(&left(40.0, 0.001), 0.2).is_none());
        assert!(structure(&left(5.0, 0.02), 0.2).is_none());
    }

    #[test]
    fn structure_above_the_floor_that_nothing_explains_is_unknown() {
        let errors = Errors { before: 4.0, after: 4.0, floor: 1.0, speed: 1e4 };
        assert_eq!(conclude(0, &errors, true), Conclusion::Unknown);
        let errors = Errors { before: 4.0, after: 3.0, floor: 1.0, speed: 1e4 };
        assert_eq!(conclude(1, &errors, true), Conclusion::Unknown);
        let errors = Errors { before: 4.0, after: 1.1, floor: 1.0, speed: 1e4 };
        assert_eq!(conclude(1, &errors, false), Conclusion::Missing);
        assert!((errors.unexplained() - 0.1 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn far_above_the_floor_something_is_missing_even_where_no_variable_shows_it() {
        let slow = Errors { before: 60.0, after: 60.0, floor: 1.0, speed: 1e4 };
        assert_eq!(conclude(0, &slow, false), Conclusion::Unknown);
        assert_eq!(conclude(1, &slow, false), Conclusion::Unknown);
        // within 2 % of the speed a model is right for all that matters
        let fast = Errors { speed: 1e6, ..slow };
        assert_eq!(conclude(0, &fast, false), Conclusion::Sufficient);
        let most = Errors { before: 200.0, after: 15.0, ..slow };
        assert_eq!(conclude(1, &most, false), Conclusion::Missing);
        let part = Errors { after: 30.0, ..most };
        assert_eq!(conclude(1, &part, false), Conclusion::Unknown);
    }
}
