//! Maximum likelihood with all noise levels estimated, including a slow unknown torque.

use super::{NAME, note_profile};
use crate::filter::{FilterError, Likelihood, Maximum, prepare};
use crate::identify::identifiability::identified;
use crate::identify::profile::profile;
use crate::identify::{Fit, IdentifyError, Note, SingleAxis, Task, start};
use crate::model::base::A1;

/// Largest share of a1 by which noise of the input may bias it and still be corrected.
const MOST_BIAS: f64 = 0.1;

/// ```text
/// maximise  Σ_k Σ_i -½ (ln 2π S_i + e_i²/S_i)
/// ```
/// Efficient if coloured noise of the input is the only deviation from the model; missing effects
/// are absorbed by the noise.
pub(super) fn identify(task: &Task, symbols: &[String]) -> Result<Fit, IdentifyError> {
    let first = start::start(task, NAME)?;
    let prepared = task.train.iter().map(prepare).collect();
    let likelihood = Likelihood {
        prepared,
        hold: task.hold,
        slow_moment: true,
        timing: true,
        step_scatter: 1.0,
    };
    let maximum = likelihood.maximise(task.model, &first, None).map_err(unusable)?;
    let bias = likelihood.bias_by_input_noise(task.model, &maximum)?;
    // the bias is computed to first order, which is not valid for a large one
    let small = bias[A1].abs() < MOST_BIAS * maximum.p[A1].abs();
    let bias = if small { bias } else { vec![0.0; maximum.p.len()] };
    let mut fit = fit(task, &maximum, &bias);
    if !small {
        fit.notes.push(Note::BiasedByInput);
    }
    for symbol in symbols {
        let j = task.model.index_of(symbol)?;
        let at = |held: &crate::model::Model, p: &[f64]| {
            let there = likelihood.maximise(held, p, Some(maximum.noise)).map_err(unusable)?;
            Ok(there.log_likelihood)
        };
        note_profile(&maximum.p, j, &mut fit, |place| profile(task.model, &maximum.p, place, at))?;
    }
    Ok(fit)
}

fn unusable(error: FilterError) -> IdentifyError {
    match error {
        FilterError::Model(error) => error.into(),
        FilterError::NotFinite => {
            IdentifyError::NoStart { method: NAME.into(), reason: error.into() }
        }
    }
}

/// The fit at a maximum, corrected for the bias by noise of the input.
fn fit(task: &Task, maximum: &Maximum, bias: &[f64]) -> Fit {
    let known = identified(
        task.model,
        &maximum.p,
        &maximum.information,
        None,
        SingleAxis::CountedOnce,
        task.train,
    );
    let unit = task.train[0].drive_unit();
    let p = maximum.p.iter().zip(bias).map(|(p, bias)| p - bias).collect();
    let mut fit = Fit::physical(NAME, task.model, p, known.covariance, unit);
    fit.notes = known.notes;
    let noise = maximum.noise;
    fit.notes.push(Note::InputNoise {
        white: noise.sigma_m,
        slow: noise.sigma_d,
        time_constant: noise.tau_d,
        unit: unit.symbol(),
    });
    fit.status = maximum.status.into();
    fit.work.iterations = maximum.iterations;
    fit.work.evaluations = maximum.evaluations;
    fit
}
