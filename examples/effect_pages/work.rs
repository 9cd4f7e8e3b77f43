//! Recordings with an effect hidden in them, fits without and with it, and the diagnosis.

use amigo_ident::compare::{
    Asked, Dependence, Variable, noise_floor, simulate_recording, unexplained_torque, window_rms,
};
use amigo_ident::diagnose::{Data, Diagnosis, Settings, diagnose};
use amigo_ident::effects::BASE;
use amigo_ident::filter::{Likelihood, prepare};
use amigo_ident::identify::{Fit, Task, find, start};
use amigo_ident::model::Model;
use amigo_ident::recording::Recording;
use amigo_ident::robot::{Robot, State};
use amigo_ident::simulate::{Hold, Movement, NoiseLevel, Recorder, SimulateError, record};

use crate::Failure;
use crate::cases::Case;

/// Method of the fits whose errors are compared.
pub(crate) const METHOD: &str = "prediction_error";
/// Noise of the recordings, N2 of the benchmark.
pub(crate) const NOISE: NoiseLevel = NoiseLevel { alpha: 1e-3, dalpha: 0.05, torque: 0.005 };
/// Recordings to fit, and one held out.
const TRAIN: u64 = 4;
/// Length of a recording [s].
const DURATION: f64 = 25.0;
/// Hard movements reach their speeds in this share of the time of ordinary ones.
const HARD: f64 = 0.3;

/// What was found with an effect hidden.
pub(crate) struct Outcome {
    /// The truth's values of the effect's parameters, in their order.
    pub(crate) hidden: Vec<f64>,
    /// Dependences of the residual torque, the strongest first.
    pub(crate) dependences: Vec<Dependence>,
    /// What the diagnosis of the model without the effect says.
    pub(crate) diagnosis: Diagnosis,
    /// Fit with the effect.
    pub(crate) fit: Fit,
    /// 2 s simulation error on the recording held out, without and with the effect [rad/s].
    pub(crate) error: [f64; 2],
    /// Its noise floor [rad/s].
    pub(crate) floor: f64,
    /// The recording held out.
    pub(crate) held_out: Recording,
    /// Its windows simulated without and with the effect.
    pub(crate) windows: [Vec<State>; 2],
}

/// The whole story of one effect.
pub(crate) fn run(case: &Case) -> Result<Outcome, Failure> {
    let base = Model::base(Robot::amigobot());
    let truth = if is_base(case.id) { base.clone() } else { base.add(case.id)? };
    let p = values(&truth, case)?;
    let mut recordings = recordings(&truth, &p, case.hard)?;
    let held_out = recordings.pop().ok_or("no recording")?;
    let without = case.model_without()?;
    let with = if is_base(case.id) { base } else { without.add(case.id)? };
    // an order of ripple is a whole number: no estimate
    let with =
        if case.id == "torque_ripple" { with.fix("n", p[with.index_of("n")?])? } else { with };

    let task = Task { model: &without, train: &recordings, hold: Hold::Linear, seed: 0 };
    let likelihood = Likelihood {
        prepared: recordings.iter().map(prepare).collect(),
        hold: Hold::Linear,
        slow_moment: true,
        timing: false,
        step_scatter: 1.0,
    };
    let settings = Settings { max_effects: 1, ..Settings::default() };
    let starts = [start::start(&task, "effect_pages")?, without.initial()];
    let held = [held_out];
    let data = Data { train: &recordings, validation: &held, hold: Hold::Linear, corrected_s: 0.0 };
    let diagnosis = diagnose(&without, &starts, &data, &settings)?;
    let [held_out] = held;
    let base = &diagnosis.base;
    let (noise, _) = likelihood.noise(&base.model, &base.p, &likelihood.initial_noise());
    let missing = unexplained_torque(&base.model, &base.p, &noise, &likelihood, Asked::Curves)?;
    let strongest = missing.dependences[0].variable;
    // a variable that follows the one of the picture may show as much
    let first: Vec<Variable> = missing.dependences.iter().take(3).map(|d| d.variable).collect();
    if case.against.is_some_and(|expected| !first.contains(&expected)) {
        let words = strongest.words();
        return Err(format!("depends on the {words} now: look and say what it shows").into());
    }

    let identifier = find(METHOD).ok_or("the method is registered")?;
    let fits = [identifier.identify(&task)?, identifier.identify(&Task { model: &with, ..task })?];
    let windows = |fit: &Fit| -> Result<Vec<State>, SimulateError> {
        let simulated = simulate_recording(&*fit.dynamics, &held_out, Hold::Linear)?;
        Ok(simulated.windows)
    };
    let windows = [windows(&fits[0])?, windows(&fits[1])?];
    let error = [0, 1].map(|i| window_rms(&held_out, &windows[i]));
    let [_, fit] = fits;
    let floor = noise_floor(&*fit.dynamics, &held_out, Hold::Linear, 0)?.window_rms;
    let own = truth.parameters().iter().zip(&p).filter(|(q, _)| q.effect == case.id);
    let hidden = own.map(|(_, value)| *value).collect();
    let dependences = missing.dependences;
    Ok(Outcome { hidden, dependences, diagnosis, fit, error, floor, held_out, windows })
}

/// Whether every model has the effect.
pub(crate) fn is_base(id: &str) -> bool {
    BASE.contains(&id)
}

/// Parameters of the true value: the case's values, else construction and typical ones.
fn values(truth: &Model, case: &Case) -> Result<Vec<f64>, Failure> {
    let mut p = truth.initial();
    for (symbol, value) in case.hidden {
        p[truth.index_of(symbol)?] = *value;
    }
    Ok(p)
}

/// Recordings for the fit and, last, the one that is held out.
fn recordings(truth: &Model, p: &[f64], hard: bool) -> Result<Vec<Recording>, SimulateError> {
    (0..=TRAIN)
        .map(|seed| {
            let mut movement = Movement::rich(truth.robot(), seed, DURATION, 12.0);
            if hard {
                movement.segments.iter_mut().for_each(|segment| segment.blend_s *= HARD);
            }
            let recorder =
                Recorder { rate: 100.0, control_rate: 1000.0, noise: NOISE, ticks: None, seed };
            record("made", truth, p, &movement, &recorder)
        })
        .collect()
}
