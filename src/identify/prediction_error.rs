//! Prediction-error maximum likelihood: the default method.

use serde::Deserialize;

use super::identifiability::identified;
use super::kalman::{Likelihood, Maximum, prepare};
use super::profile::profile;
use super::{
    Fit, Identifier, IdentifyError, MethodDescription, OptionError, Task, from_options,
    options_schema, start,
};

/// Prediction-error maximum likelihood with an extended Kalman filter.
///
/// ```text
/// maximise  Σ_k Σ_i -½ (ln 2π S_i + e_i²/S_i)      e: innovation, S: its variance
/// δθ = H⁻¹ g,  g = Σ ψ e/S,  H = Σ ψ ψ'/S,  ψ: derivative of the prediction
/// ```
/// The filter's gain is the K of the paper's emulator, eq. (19), in its statistically best form.
/// Noise of the measured angles and speeds comes from differences of the recording; noise of the
/// drive and a slow unknown moment are estimated along with the parameters.
///
/// Source: Ljung, System Identification (1999), ch. 7; Kristensen, Madsen and Jørgensen,
/// Automatica 40 (2004) for the filter; statistical linearisation of the sign: Gelb (1974), ch. 6.
#[derive(Clone, Debug, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PredictionError {
    /// Whether a slow unknown moment is part of the noise model.
    pub slow_moment: bool,
    /// Symbols of the parameters whose profile likelihood is computed.
    pub profile: Vec<String>,
}

impl Default for PredictionError {
    fn default() -> Self {
        Self { slow_moment: true, profile: vec![] }
    }
}

/// Name in experiment files.
const NAME: &str = "prediction_error";

/// Largest share of a1 by which noise of the drive may pull it and still be corrected.
const MOST_PULL: f64 = 0.1;

impl Identifier for PredictionError {
    fn describe(&self) -> MethodDescription {
        MethodDescription {
            name: NAME.into(),
            title: "Prediction-error maximum likelihood (extended Kalman filter)".into(),
            equation: "maximise Σ -½ (ln 2π S + e²/S) over innovations e of an extended Kalman \
                       filter with variance S"
                .into(),
            source: "Ljung, System Identification, 1999, ch. 7; Kristensen et al. 2004".into(),
            use_when: "always, first: it reaches the Cramér-Rao bound with noisy moments and \
                       noisy speeds, and its intervals hold"
                .into(),
            avoid_when: "the robot hardly moves, or the sampling is slower than the motion".into(),
            options: vec![
                (
                    "slow_moment".into(),
                    "true".into(),
                    "whether a slow unknown moment is part of the noise model".into(),
                ),
                (
                    "profile".into(),
                    "[]".into(),
                    "parameters whose profile likelihood is computed and drawn".into(),
                ),
            ],
        }
    }

    fn schema(&self) -> schemars::Schema {
        options_schema::<Self>()
    }

    fn configure(&self, options: &toml::Table) -> Result<Box<dyn Identifier>, OptionError> {
        Ok(Box::new(from_options::<Self>(NAME, options)?))
    }

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        let mut first = start::start(task, NAME)?;
        let likelihood = Likelihood {
            prepared: task.train.iter().map(prepare).collect(),
            hold: task.hold,
            slow_moment: self.slow_moment,
            timing: true,
        };
        likelihood.place_joint(task.model, &mut first);
        let maximum = likelihood.maximise(task.model, &first, None, NAME)?;
        let pull = likelihood.pull_of_input_noise(task.model, &maximum)?;
        // the pull is known to first order, so a large one is not known
        let small = pull[0].abs() < MOST_PULL * maximum.p[0].abs();
        let pull = if small { pull } else { vec![0.0; maximum.p.len()] };
        let mut fit = fit(task, &maximum, &pull);
        if !small {
            fit.notes.push(
                "The drive is so noisy, or so rough, that it pulls the inertias by more than can \
                 be corrected; their intervals are too narrow."
                    .into(),
            );
        }
        for symbol in &self.profile {
            self.add_profile(task, &likelihood, &maximum, &pull, symbol, &mut fit)?;
        }
        Ok(fit)
    }
}

impl PredictionError {
    fn add_profile(
        &self,
        task: &Task,
        likelihood: &Likelihood,
        maximum: &Maximum,
        pull: &[f64],
        symbol: &str,
        fit: &mut Fit,
    ) -> Result<(), IdentifyError> {
        let j = task.model.index_of(symbol)?;
        let estimate = fit.estimates[j].clone();
        if !(estimate.std_error.is_finite() && estimate.std_error > 0.0) {
            fit.notes
                .push(format!("{symbol} has no profile: it is held, or the data do not give it."));
            return Ok(());
        }
        let (error, unit) = (estimate.std_error, &estimate.unit);
        let mut profile = profile(likelihood, task.model, maximum, j, error, unit)?;
        profile.trace.at.iter_mut().for_each(|v| *v -= pull[j]);
        let (low, high) = profile.interval;
        fit.notes.push(format!(
            "Profile likelihood of {symbol}: 95 % interval {:.6e} to {:.6e} {unit} (by the \
             standard error {:.6e} to {:.6e}).",
            low - pull[j],
            high - pull[j],
            estimate.interval.0,
            estimate.interval.1
        ));
        fit.traces.push(profile.trace);
        Ok(())
    }
}

/// The fit at a maximum, less what noise of the drive pulls.
fn fit(task: &Task, maximum: &Maximum, pull: &[f64]) -> Fit {
    let known = identified(task.model, &maximum.p, &maximum.information, None, task.train);
    let unit = task.train[0].drive_unit();
    let p = maximum.p.iter().zip(pull).map(|(p, pull)| p - pull).collect();
    let mut fit = Fit::physical(NAME, task.model, p, known.covariance, unit);
    fit.notes = known.notes;
    let noise = maximum.noise;
    fit.notes.push(format!(
        "Noise of the drive: {:.3e} white, {:.3e} slow with a time constant of {:.2} s \
         (standard deviations, {}).",
        noise.sigma_m,
        noise.sigma_d,
        noise.tau_d,
        unit.symbol()
    ));
    fit.status = maximum.status;
    fit.work.iterations = maximum.iterations;
    fit.work.evaluations = maximum.evaluations;
    fit
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::robot::Robot;
    use crate::simulate::{Hold, Movement, NoiseLevel, Recorder, record};

    /// Four recordings of 25 s at noise level N2 of a robot under a 1 kHz speed controller.
    fn recordings(model: &Model, truth: &[f64], seed: u64) -> Vec<crate::recording::Recording> {
        (0..4)
            .map(|r| {
                let movement = Movement::rich(model.robot(), seed * 10 + r, 25.0, 12.0);
                let noise = NoiseLevel { dalpha: 0.05, alpha: 1e-3, moment: 0.005 };
                let recorder = Recorder {
                    rate: 100.0,
                    control_rate: 1000.0,
                    noise,
                    ticks: None,
                    seed: seed * 100 + r,
                };
                record("made", model, truth, &movement, &recorder).unwrap()
            })
            .collect()
    }

    #[test]
    fn the_truth_is_found_within_the_standard_errors_that_are_claimed() {
        let model = Model::base(Robot::amigobot());
        let truth = model.initial();
        let (mut sum, mut count) = (0.0, 0.0);
        for seed in 0..3 {
            let train = recordings(&model, &truth, seed);
            let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 0 };
            let fit = PredictionError::default().identify(&task).unwrap();
            assert_eq!(fit.status, crate::identify::Status::Converged);
            for (e, t) in fit.estimates.iter().zip(&truth) {
                let z = (e.value - t) / e.std_error;
                assert!(z.abs() < 4.0, "{} {z}", e.symbol);
                sum += z * z;
                count += 1.0;
            }
            // the Cramér-Rao bound of this bench is 0.031 % of a1
            let a1 = fit.estimate("a1").unwrap();
            assert!(a1.std_error / a1.value < 4.5e-4);
        }
        // chi-square of 15 over 15: mean 1, standard deviation 0.37
        assert!(sum / count < 2.3, "{}", sum / count);
    }
}
