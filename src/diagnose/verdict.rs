//! The verdict: what is missing, what is likely, what is unknown, or nothing.

use super::acceptance::Fall;
use super::outcome::{Diagnosis, Ranked};
use super::thresholds::THRESHOLDS;
use crate::compare::{Acting, Curve, Dependence, UnexplainedTorque, Variable};

/// Conclusion of the diagnosis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conclusion {
    /// The error is at the noise floor, or negligible above it.
    Sufficient,
    /// The effects found explain most of what was missing.
    Missing,
    /// No effect is proven; one explains most of the missing part.
    Likely,
    /// Something is missing that no candidate explains.
    Unknown,
}

/// Errors of the models on the judged recordings, as squares of the error over windows of 2 s
/// [rad^2/s^2].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Of the model as given.
    pub before: f64,
    /// Of the model with all effects found.
    pub after: f64,
    /// Of the noise floor.
    pub floor: f64,
    /// Of the noise floor with the most that the input may have done between its rows.
    pub most: f64,
    /// What the uncertainty of the parameters may add to it on held-out recordings: of two standard errors.
    pub uncertain: f64,
    /// Whether slow noise of the input determines the noise floor ([`crate::compare::WindowFloor::is_slow`]).
    pub slow_floor: bool,
    /// Square of the top speed of the wheels.
    pub speed: f64,
}

/// Share of a squared error above the floor that remains after a reduction: 0 at the floor, 1 without any reduction.
///
/// ```text
/// x = (V_after - V_floor) / (V_before - V_floor)
/// ```
/// Zero where the error before it is within 2 % of the floor: there is nothing to explain.
#[must_use]
pub(super) fn unexplained(before: f64, after: f64, floor: f64) -> f64 {
    explainable(before, floor).map_or(0.0, |whole| ((after - floor) / whole).clamp(0.0, 1.0))
}

impl Errors {
    /// Remaining share of the error above the floor: 0 at the floor, 1 without any reduction, 0 where the model as given is
    /// within 2 % of the floor.
    #[must_use]
    pub fn unexplained(&self) -> f64 {
        unexplained(self.before, self.after, self.floor)
    }

    /// Whether the recordings are too steady for any conclusion: a model of constant speeds, of squared error `change`,
    /// would be called useful, and of its error above the floor the last model removes less than half. A flywheel,
    /// which keeps its speed whatever acts on it, simulates such recordings as well as any robot.
    #[must_use]
    pub fn are_of_steady_speeds(&self, change: f64) -> bool {
        let steady = change <= THRESHOLDS.useful.powi(2) * self.speed;
        let explains = self.after - self.floor <= THRESHOLDS.unexplained * (change - self.floor);
        steady && !explains
    }

    /// Error of the last model over the noise floor.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        (self.after / self.floor).sqrt()
    }

    /// Whether nothing that matters is left above the floor after the error of the last model has fallen to that `share`.
    #[must_use]
    pub fn falls_to_floor(&self, share: f64) -> bool {
        share * self.ratio() <= THRESHOLDS.above_floor
    }

    /// Whether the model as given is at the floor.
    #[must_use]
    pub fn was_at_floor(&self) -> bool {
        (self.before / self.floor).sqrt() <= THRESHOLDS.at_floor
    }

    /// Reduction of the RMS error by the effects found, as a share.
    #[must_use]
    pub fn fall(&self) -> f64 {
        1.0 - (self.after / self.before).sqrt()
    }

    /// Root mean square error of the last model beyond the noise floor, as a share of the top speed of the wheels.
    #[must_use]
    pub fn excess(&self) -> f64 {
        // NaN is kept
        let beyond = self.after - self.floor;
        if beyond < 0.0 { 0.0 } else { (beyond / self.speed).sqrt() }
    }

    /// Whether the last model is so far above the floor that noise which the floor leaves out (coloured noise
    /// of the input) is no explanation. An error that is not a number is.
    #[must_use]
    pub fn far_above_floor(&self) -> bool {
        !(self.ratio() <= THRESHOLDS.far_above_floor)
    }

    /// Whether the last model is above the floor by something that matters. An error that is not a number is.
    #[must_use]
    pub fn above_floor(&self) -> bool {
        // NaN fails every comparison
        let small = self.ratio() <= THRESHOLDS.above_floor || self.excess() <= THRESHOLDS.excess;
        !small
    }

    /// Whether the last model is above all that the input may have done between its rows and that the uncertainty of
    /// the parameters may add. An error that is not a number is.
    #[must_use]
    pub fn above_all(&self) -> bool {
        !((self.after / (self.most + self.uncertain)).sqrt() <= THRESHOLDS.at_floor)
    }

    /// Whether the last model is far above the floor, and [`Errors::above_all`].
    #[must_use]
    pub fn far_above_all(&self) -> bool {
        self.far_above_floor() && self.above_all()
    }

    /// Whether the error beyond the floor is that of a useful model.
    #[must_use]
    pub fn useful(&self) -> bool {
        self.excess() <= THRESHOLDS.useful
    }

    /// Whether the last model is above all that the input may have done between its rows. An error that is not a
    /// number is.
    #[must_use]
    pub fn above_input(&self) -> bool {
        !((self.after / self.most).sqrt() <= THRESHOLDS.at_floor)
    }
}

/// Squared error above the square of the noise floor; `None` where the error is within 2 % of the floor: there is
/// nothing to explain.
#[must_use]
pub fn explainable(square: f64, floor: f64) -> Option<f64> {
    let above = square - floor;
    // NaN is kept
    (!(above <= THRESHOLDS.nothing_left * floor)).then_some(above)
}

/// The strongest significant dependence that counts as structure; the error decides whether it matters. Noise of the
/// recorded input is part of the input itself, and feedback control makes inputs and accelerations respond to every
/// disturbance; a dependence on them is none.
#[must_use]
pub fn structure(left: &UnexplainedTorque) -> Option<&Dependence> {
    let counts =
        |d: &&Dependence| d.log_significance > THRESHOLDS.structure && !d.variable.answers();
    left.dependences.iter().find(counts)
}

/// Whether the binned residual torque depends as significantly on a variable too: on one that feedback control does not
/// make respond to every disturbance, and not on time alone, as a disturbance or coloured noise of the input would. The
/// score test assumes the spectrum of the noise that the likelihood finds; with another one its statistic is too large.
#[must_use]
pub fn structured(curves: &[Curve]) -> bool {
    curves.iter().filter(is_of_robot).any(|curve| curve.log_significance > THRESHOLDS.structure)
}

/// The variable of [`structured`] on which the binned residual torque depends most significantly, if more than coloured
/// noise of the input can: its values are correlated within a block of 1 s, and those of the blocks are not.
#[must_use]
pub fn structured_by_blocks(curves: &[Curve]) -> Option<Variable> {
    let significant = curves.iter().filter(is_of_robot).map(|c| (c.clustered_significance(), c));
    let most = significant.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (most.0 > THRESHOLDS.structure_of_blocks).then_some(most.1.variable)
}

/// Whether a curve is over a variable that feedback control does not make respond to every disturbance, and not a
/// torque over time alone, as a disturbance or coloured noise of the input would be.
fn is_of_robot(curve: &&Curve) -> bool {
    let disturbance = curve.variable == Variable::Time && curve.acting == Acting::Torque;
    !curve.variable.answers() && !disturbance
}

/// The candidate that lowers the held-out error after the last accepted step without being proven.
#[must_use]
pub fn likely<'a>(diagnosis: &'a Diagnosis, errors: &Errors) -> Option<&'a Ranked> {
    let best = diagnosis.rest.first()?;
    let fall = best.fall?;
    let lowers = fall.share >= THRESHOLDS.likely_fall && fall.ratio <= 1.0 - THRESHOLDS.likely_fall;
    let strong = best.bic < -THRESHOLDS.strong;
    (lowers && strong && errors.ratio() > THRESHOLDS.likely_above_floor).then_some(best)
}

/// The candidate that comes first after the last accepted step and lowers the held-out error significantly at `rate`,
/// but is not accepted, although no other effect is likely: its size is within its uncertainty, it does not act in the
/// held-out recordings, or, of a second body, the input between its rows could do as much.
#[must_use]
pub fn withheld(diagnosis: &Diagnosis, rate: f64) -> Option<&Ranked> {
    let best = diagnosis.rest.first()?;
    let strong = best.bic < -THRESHOLDS.strong;
    let falls = |fall: &Fall| fall.passes(rate, THRESHOLDS.least_fall);
    (diagnosis.validated && strong && best.fall.as_ref().is_some_and(falls)).then_some(best)
}

/// Concludes from the number of effects found, the errors, and the share of the squared error that would
/// remain with a likely effect (1 without one).
///
/// If the error is above the floor, the effects found or likely must explain the larger part of it, and the model with
/// the effects found must be useful. Otherwise something unknown is missing, if the residual torque shows `structure`
/// or the error is far above the floor, which is itself an estimate, and if neither the unknown input between the rows
/// nor the uncertainty of the parameters can cause it. If slow noise of the input dominates the floor, structure is no
/// evidence, because its test treats rows as independent.
#[must_use]
pub fn conclude(found: usize, errors: &Errors, likely: Option<f64>, structure: bool) -> Conclusion {
    let explained =
        |after: f64| unexplained(errors.before, after, errors.floor) <= THRESHOLDS.unexplained;
    match likely {
        _ if found > 0 && !(errors.above_floor() && errors.above_all()) => Conclusion::Missing,
        _ if found > 0 && explained(errors.after) && errors.useful() => Conclusion::Missing,
        _ if found > 0 => Conclusion::Unknown,
        Some(ratio) if explained(errors.after * ratio * ratio) => Conclusion::Likely,
        _ if errors.above_floor()
            && errors.above_all()
            && (structure && !errors.slow_floor || errors.far_above_floor()) =>
        {
            Conclusion::Unknown
        }
        _ => Conclusion::Sufficient,
    }
}

/// Whether simulation is no better with a candidate: over the windows that were fitted, by their criterion, or by the
/// reported error, which it `raises`.
#[must_use]
pub fn is_refuted(candidate: &Ranked, raises: bool) -> bool {
    raises || !(candidate.bic_windows < 0.0)
}

/// Posterior probabilities of the candidates of one step from their criteria, "none of them" included; one
/// per candidate, in order.
///
/// ```text
/// P_j = exp(-BIC_j/2) / (1 + Σ exp(-BIC_k/2))
/// ```
/// `refuted`: those that simulation [refutes](is_refuted). They are not more probable than none, whatever the torque
/// balance indicates.
///
/// Source: Kass and Raftery, J. Am. Stat. Assoc. 90 (1995).
#[must_use]
pub fn probabilities(ranking: &[Ranked], refuted: &[bool]) -> Vec<f64> {
    let bic = |(r, refuted): (&Ranked, &bool)| if *refuted { r.bic.max(0.0) } else { r.bic };
    let ranks: Vec<f64> = ranking.iter().zip(refuted).map(|pair| -0.5 * bic(pair)).collect();
    let largest = ranks.iter().copied().fold(0.0, f64::max);
    let weights: Vec<f64> = ranks.iter().map(|r| (r - largest).exp()).collect();
    let sum = weights.iter().sum::<f64>() + (-largest).exp();
    weights.iter().map(|w| w / sum).collect()
}

#[cfg(test)]
mod tests;
