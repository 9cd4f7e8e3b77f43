//! Output error: maximum likelihood of the free simulation.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::identifiability::{among_all, held_value, identified, inverse_where_known, least_known};
use super::simulation_cost::{Problem, statistics};
use super::{
    Fit, Identifier, IdentifyError, MethodDescription, NoStart, Note, SingleAxis, Status, Task,
    Unknown, fields_as_options, start,
};
use crate::math::descent::{MinimiseOptions, Minimum, MinimumStatus, minimise};
use crate::math::{Information, clustered_covariance, eliminate, raise_errors};

/// Simulation-error maximum likelihood (output error).
///
/// ```text
/// minimise ½ Σ_k Σ_i (y_i(k) - x_i(k; θ, x0))² / σ_i²,   i = alpha1, alpha2, omega1, omega2
/// ```
/// The whole recording is simulated freely from its torques; the initial state of every piece is estimated too.
/// Levenberg-Marquardt with exact sensitivities through stops and reversals, from the weak form (from a guess with too
/// much friction the robot would never move). The parameters of a two-mass drivetrain, which the weak form does not
/// contain, start from the best of a grid. Parameters that are not identifiable at the start are fixed at their initial
/// values.
///
/// Source: Ljung, System Identification (1999), ch. 4; Janot et al. 2014.
#[derive(Clone, Debug, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct OutputError {
    /// Largest number of steps.
    pub iterations: usize,
    /// Number of descents, the first from the weak form, the others from the best of random values around it.
    #[schemars(range(min = 1))]
    pub starts: usize,
}

impl Default for OutputError {
    fn default() -> Self {
        Self { iterations: 60, starts: 1 }
    }
}

const NAME: &str = "output_error";
/// Negligible decrease of the cost, relative to the effect of noise: 0.045 standard errors, most of which the
/// last step removes.
const NEGLIGIBLE: f64 = 1e-3;
/// Mean square of the normalised residuals below which they are noise of the sensors, itself known
/// to a few percent.
const AT_NOISE: f64 = 1.1;
impl Identifier for OutputError {
    fn describe(&self) -> MethodDescription {
        MethodDescription {
            name: NAME.into(),
            title: "Output error (simulation-error maximum likelihood)".into(),
            equation: "minimise Σ (measured - simulated)²/σ² over angles and speeds of the free \
                       simulation"
                .into(),
            source: "Ljung, System Identification, 1999, ch. 4".into(),
            use_when: "the torques are exact (noise only in angles and speeds); models with a \
                       two-mass drivetrain"
                .into(),
            avoid_when: "the torques are noisy: the simulation drifts, estimates scatter, and \
                         the intervals are far too narrow"
                .into(),
        }
    }

    fn intervals_cover(&self) -> bool {
        false
    }

    fn rank(&self) -> Option<usize> {
        Some(2)
    }

    fn is_default(&self) -> bool {
        true
    }

    fields_as_options!(NAME);

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        let problem = Problem::new(task, start::start(task, NAME)?);
        let starts = problem.starts(self.starts);
        let Some(first) = starts.first().cloned() else { return Err(no_start()) };
        let at_first = problem.evaluate(&first, f64::INFINITY).ok_or_else(no_start)?;
        let information = problem.information(&at_first.0.gradient, &at_first.0.hessian);
        if let Some(j) = least_known(task.model, &problem.p, &information, task.train) {
            return self.with_fixed(task, j, problem.p[j]);
        }
        let [lower, upper] = problem.bounds(&first);
        let options = MinimiseOptions {
            max_iterations: self.iterations,
            relative_tolerance: 2.0 * NEGLIGIBLE / problem.degrees(),
            absolute_tolerance: NEGLIGIBLE,
            scatter_tolerance: NEGLIGIBLE,
            last_step: true,
            lower: Some(lower),
            upper: Some(upper),
            ..MinimiseOptions::default()
        };
        let descend = |x: DVector<f64>| {
            // every step that is taken lowers the cost, so the lowest is that of the minimum
            let (mut lowest, mut scores) = (f64::INFINITY, DMatrix::zeros(0, x.len()));
            let evaluate = |x: &DVector<f64>| {
                let known = (*x == first).then(|| at_first.clone());
                let (quadratic, z) = known.or_else(|| problem.evaluate(x, lowest))?;
                if quadratic.cost < lowest && quadratic.is_finite() {
                    (lowest, scores) = (quadratic.cost, z);
                }
                Some(quadratic)
            };
            let minimum = minimise(&x, evaluate, |x| problem.cost(x), &options);
            (minimum, scores)
        };
        let found: Vec<_> = starts.into_par_iter().map(descend).collect();
        let minima = || found.iter().filter(|(m, _)| m.status != MinimumStatus::NoStart);
        let lowest = minima().min_by(|(a, _), (b, _)| a.cost.total_cmp(&b.cost));
        let Some((best, scores)) = lowest else {
            return Err(no_start());
        };
        let mut fit = problem.fit(best, scores);
        fit.work.evaluations = found.iter().map(|(m, _)| m.evaluations).sum();
        if found.len() > 1 {
            let agreeing = minima().filter(|(m, _)| m.cost < best.cost + 0.5).count();
            fit.notes.push(Note::Descents { agreeing, of: found.len() });
        }
        Ok(fit)
    }
}

impl OutputError {
    /// The fit with parameter `j`, which is not identifiable, fixed at its [`held_value`], with an `estimate` of it.
    fn with_fixed(&self, task: &Task, j: usize, estimate: f64) -> Result<Fit, IdentifyError> {
        let (parameter, value) = (&task.model.parameters()[j], held_value(task, j, estimate));
        let (symbol, effect) = (parameter.spec.symbol.clone(), parameter.effect.clone());
        let model = task.model.fix(&symbol, value).map_err(|_| no_start())?;
        let mut fit = self.identify(&Task { model: &model, ..*task })?;
        fit.notes.push(Note::Unknown { unknown: Unknown::Held(symbol, value), effect });
        fit.set_unidentifiable(j);
        Ok(fit)
    }
}

/// Whether the gradient at a minimum is not larger than sampling makes it, by the gradients of blocks: g' H⁻¹ g <= Σ
/// s_b' H⁻¹ s_b.
fn is_sampling(minimum: &Minimum, scores: &DMatrix<f64>) -> bool {
    let information = Information::new(&minimum.hessian);
    information.statistic(&minimum.gradient) <= statistics(&information, scores)
}

fn no_start() -> IdentifyError {
    IdentifyError::NoStart { method: NAME.into(), reason: NoStart::Simulation }
}

impl Problem<'_> {
    /// Information of all parameters about themselves: the initial states are eliminated.
    fn information(&self, gradient: &DVector<f64>, hessian: &DMatrix<f64>) -> DMatrix<f64> {
        let count = self.free.len();
        let states: Vec<usize> = (count..gradient.len()).collect();
        let own: Vec<usize> = (0..count).collect();
        among_all(self.model(), &eliminate(hessian, gradient, &states, &own).0)
    }

    fn fit(&self, minimum: &Minimum, scores: &DMatrix<f64>) -> Fit {
        let p = self.parameters(&minimum.x);
        let excess = (2.0 * minimum.cost / self.degrees()).max(1.0);
        let count = self.free.len();
        let information = self.information(&minimum.gradient, &minimum.hessian) / excess;
        let of_free = information.select_rows(&self.free).select_columns(&self.free);
        let covariance = self.covariance(minimum, scores, &of_free);
        let known = identified(
            self.model(),
            &p,
            &information,
            Some(&covariance),
            SingleAxis::CountedTwice,
            self.task.train,
        );
        let unit = self.task.train[0].drive_unit();
        let mut fit = Fit::physical(NAME, self.model(), p, known.covariance, unit);
        fit.notes = known.notes;
        if excess > 2.0 {
            fit.notes.push(Note::Misses(excess.sqrt()));
        }
        let blocks = scores.nrows() as f64 - count as f64;
        if blocks >= 1.0 {
            fit = fit.with_degrees(blocks);
        }
        fit.status = match minimum.status {
            // the cost has an edge where a wheel begins to move; with nothing but noise left in
            // the residuals, or a gradient that sampling explains, no lower cost is worth finding
            MinimumStatus::Stalled if excess < AT_NOISE || is_sampling(minimum, scores) => {
                Status::Converged
            }
            other => other.into(),
        };
        fit.work.iterations = minimum.iterations;
        fit.work.evaluations = minimum.evaluations;
        fit
    }

    /// Covariance of all parameters: the larger of the inverse information and what blocks of
    /// residuals of 5 s show, since a simulation that drifts misses whole stretches alike.
    fn covariance(
        &self,
        minimum: &Minimum,
        z: &DMatrix<f64>,
        information: &DMatrix<f64>,
    ) -> DMatrix<f64> {
        let mut covariance = inverse_where_known(information);
        if z.nrows() > self.free.len() {
            let all = inverse_where_known(&minimum.hessian);
            let block: Vec<usize> = (0..z.nrows()).collect();
            let ones = DVector::repeat(z.nrows(), 1.0);
            let robust = clustered_covariance(&all, z, &ones, &block, z.nrows());
            // behind the parameters stand the initial states
            let own = robust.diagonal().rows(0, self.free.len()).map(f64::sqrt);
            raise_errors(&mut covariance, &own);
        }
        among_all(self.model(), &covariance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::model::base::A1;
    use crate::recording::{Channels, Recording};
    use crate::robot::Robot;
    use crate::simulate::{Hold, Movement, NoiseLevel, Recorder, record};

    #[test]
    fn rows_that_repeat_a_slow_sensor_add_nothing() {
        let model = Model::base(Robot::amigobot());
        let noise = NoiseLevel { dalpha: 0.04, alpha: 2e-3, torque: 0.0 };
        let movement = Movement::rich(model.robot(), 5, 20.0, 12.0);
        let recorder = Recorder { rate: 20.0, control_rate: 1000.0, noise, ticks: None, seed: 5 };
        let slow = record("slow", &model, &model.initial(), &movement, &recorder).unwrap();
        // the same readings and the same lines of the torque in rows ten times as fast
        let (rows, t) = (10 * (slow.len() - 1), slow.t());
        let within = |n: usize| 0.1 * (n % 10) as f64;
        let between = |n: usize, a: f64, b: f64| a + within(n) * (b - a);
        let torque = |n: usize| {
            let (a, b) = (slow.torque()[n / 10], slow.torque()[n / 10 + 1]);
            [0, 1].map(|i| between(n, a[i], b[i]))
        };
        let channels = Channels {
            t: (0..rows).map(|n| between(n, t[n / 10], t[n / 10 + 1])).collect(),
            alpha: Some((0..rows).map(|n| slow.alpha()[n / 10]).collect()),
            omega: Some((0..rows).map(|n| slow.omega()[n / 10]).collect()),
            torque: (0..rows).map(torque).collect(),
        };
        let fast = Recording::new("fast", channels, slow.drive_unit()).unwrap();
        let fits = [slow, fast].map(|recording| {
            let train = [recording];
            let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 0 };
            OutputError::default().identify(&task).unwrap()
        });
        for (a, b) in fits[0].estimates.iter().zip(&fits[1].estimates) {
            // the levels of noise are estimated from other rows
            let ratio = b.std_error / a.std_error;
            assert!((0.7..1.4).contains(&ratio), "{}: {ratio}", a.symbol);
            assert!((b.value - a.value).abs() < a.std_error, "{}", a.symbol);
        }
    }

    #[test]
    fn a_robot_that_starts_at_rest_is_fitted_in_a_few_steps_whatever_the_noise_of_its_first_row() {
        let model = Model::base(Robot::amigobot());
        let truth = model.initial();
        let noise = NoiseLevel { dalpha: 0.04, alpha: 2e-3, torque: 0.0 };
        for seed in 0..6 {
            let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed };
            let recording = record("rest", &model, &truth, &Movement::paper(), &recorder).unwrap();
            let train = [recording];
            let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 0 };
            let fit = OutputError::default().identify(&task).unwrap();
            assert_eq!(fit.status, Status::Converged);
            // four to eight steps, seventeen for one of these; with an initial speed that friction holds, but whose
            // derivatives go on, a third of them ended at the limit of sixty
            assert!(fit.work.iterations <= 25, "{seed}: {}", fit.work.iterations);
            // ten times what the input between the rows changes
            assert!((fit.estimates[A1].value / truth[A1] - 1.0).abs() < 1e-3, "{seed}");
        }
    }
}
