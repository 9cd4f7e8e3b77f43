//! In which regimes of driving the model fails, and whether that is more than noise.

use super::missing_moment::{log_significance, project, score_statistic};
use crate::identify::kalman::{Columns, Instant, Likelihood, ProcessNoise};
use crate::model::{Model, ModelError};
use crate::recording::Regime;

/// One regime and wheel where the error is looked at.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Failure {
    /// Regime.
    pub regime: Regime,
    /// Wheel, 1 (right) or 2 (left).
    pub wheel: usize,
    /// Share of the summed squared window error of both wheels that falls here.
    pub share_of_ise: f64,
    /// Root mean square window error here over that of the noise floor.
    pub ratio_to_noise: f64,
    /// Probability of a missing moment as large as seen, were nothing missing; by a score test.
    pub p_value: f64,
    /// Missing moment here [N m].
    pub moment: f64,
    /// Its standard error.
    pub std_error: f64,
    /// Samples.
    pub samples: usize,
    /// Whether it stays significant at 5 % after Holm's correction for looking at all regimes.
    pub significant: bool,
}

struct Indicators {
    regimes: Vec<Regime>,
}

impl Columns for Indicators {
    fn count(&self) -> usize {
        2 * Regime::ALL.len()
    }
    fn torque(&self, at: &Instant, out: &mut [[f64; 2]]) {
        out.iter_mut().for_each(|column| *column = [0.0; 2]);
        let index = self.regimes[at.sample] as usize;
        out[2 * index] = [1.0, 0.0];
        out[2 * index + 1] = [0.0, 1.0];
    }
}

/// Regimes ranked by how far the error exceeds noise. `errors` are the window errors of each
/// recording of `likelihood` and `floors` their noise floors [rad/s].
///
/// # Errors
/// If the model has no acceleration.
pub fn failures(
    model: &Model,
    p: &[f64],
    noise: &ProcessNoise,
    likelihood: &Likelihood,
    errors: &[Vec<[f64; 2]>],
    floors: &[f64],
) -> Result<Vec<Failure>, ModelError> {
    let columns: Vec<Indicators> = likelihood
        .prepared
        .iter()
        .map(|p| Indicators { regimes: p.recording.regimes(&p.recording.local_motion()) })
        .collect();
    let all: Vec<&dyn Columns> = columns.iter().map(|c| c as &dyn Columns).collect();
    let (h, g) = likelihood.totals(model, p, noise, &all)?;
    let base = model.free();
    let total: f64 = errors
        .iter()
        .flatten()
        .map(|e| e[0] * e[0] + e[1] * e[1])
        .filter(|e| e.is_finite())
        .sum::<f64>()
        .max(1e-300);
    let mut out = Vec::new();
    for regime in Regime::ALL {
        for wheel in 0..2 {
            let (mut sum, mut expected, mut samples) = (0.0, 0.0, 0);
            for ((indicator, errors), floor) in columns.iter().zip(errors).zip(floors) {
                for (r, e) in indicator.regimes.iter().zip(errors) {
                    if *r == regime {
                        sum += e[wheel] * e[wheel];
                        expected += floor * floor;
                        samples += 1;
                    }
                }
            }
            if samples < 5 {
                continue;
            }
            let column = p.len() + 2 * (regime as usize) + wheel;
            let (information, score) = project(&h, &g, &base, &[column]);
            let weak = information[(0, 0)] <= 1e-8 * h[(column, column)];
            let (statistic, rank) =
                if weak { (0.0, 0) } else { score_statistic(&information, &score) };
            let moment = if weak { f64::NAN } else { score[0] / information[(0, 0)] };
            let std_error = if weak { f64::INFINITY } else { 1.0 / information[(0, 0)].sqrt() };
            out.push(Failure {
                regime,
                wheel: wheel + 1,
                share_of_ise: sum / total,
                ratio_to_noise: (sum / expected.max(1e-300)).sqrt(),
                p_value: (-log_significance(statistic, rank)).exp(),
                moment,
                std_error,
                samples,
                significant: false,
            });
        }
    }
    holm(&mut out);
    out.sort_by(|a, b| {
        b.significant.cmp(&a.significant).then(b.ratio_to_noise.total_cmp(&a.ratio_to_noise))
    });
    Ok(out)
}

/// Holm's step-down correction at 5 %.
fn holm(failures: &mut [Failure]) {
    failures.sort_by(|a, b| a.p_value.total_cmp(&b.p_value));
    let count = failures.len();
    for (k, failure) in failures.iter_mut().enumerate() {
        if failure.p_value > 0.05 / (count - k) as f64 {
            break;
        }
        failure.significant = true;
    }
}
