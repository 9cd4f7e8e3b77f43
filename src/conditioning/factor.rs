//! Wrong samples of the column by which an input is multiplied: a battery voltage.
//!
//! ```text
//! lost    |v_k - median v| > 1/2 |median v| in one or two rows       a controller does not run on half its voltage
//! spikes  as those of a sensor (`spikes.rs`), unless the input steps: motors that start lower the voltage
//! ```
//! The input is computed again with the voltages on the line between their neighbours. Rows count in place of times, which
//! may be wrong.

use super::Settings;
use super::far_out::{Spike, in_order, short_runs, without};
use super::finding::{Channel, Finding, Kind};
use super::signal::median_high;
use super::spikes::spikes;
use super::thresholds::SAMPLES;
use crate::recording::{Channels, Factor, steps_before};

/// Replaces wrong samples of the factors of both inputs.
pub fn repair_factors(
    channels: &mut Channels,
    factors: &[Option<Factor>; 2],
    settings: &Settings,
) -> Vec<Finding> {
    let mut findings = vec![];
    for (i, factor) in factors.iter().enumerate() {
        let Some(factor) = factor else { continue };
        let found = wrong(factor);
        let Some(kind) = Kind::spikes(found.iter().map(|s| (s.rows.start, s.out))) else {
            continue;
        };
        findings.push(Finding::corrected(Channel::Factor(i), kind, "spikes", settings.spikes));
        if settings.spikes {
            for spike in found {
                let rows = spike.rows;
                rows.for_each(|k| channels.torque[k][i] = factor.input[k] * spike.value);
            }
        }
    }
    findings
}

fn wrong(factor: &Factor) -> Vec<Spike> {
    let values = &factor.values;
    if !values.iter().all(|v| v.is_finite()) {
        return vec![];
    }
    let rows: Vec<usize> = (0..values.len()).collect();
    let t: Vec<f64> = rows.iter().map(|k| *k as f64).collect();
    let usual = median_high(values.iter().copied());
    let is_lost = |k: usize| (values[k] - usual).abs() > SAMPLES.lost_voltage * usual.abs();
    let lost = rows.iter().filter(|k| is_lost(**k)).count();
    let few = lost as f64 <= SAMPLES.marks * values.len() as f64;
    let lost = if few { short_runs(&t, values, is_lost) } else { vec![] };
    let inputs: Vec<[f64; 2]> = factor.input.iter().map(|m| [*m; 2]).collect();
    let steps = steps_before(&inputs);
    let mut more = spikes(&t, &without(values.clone(), &lost), &rows);
    more.retain(|spike| !steps(spike.rows.start));
    in_order(lost, more)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Duty times a battery voltage of 3.6 V, with readings of the latter that are `wrong`.
    fn log(wrong: &[(usize, f64)]) -> (Channels, Factor) {
        let duty = |k: usize| if k < 100 { 0.4 } else { -0.3 };
        let mut values: Vec<f64> =
            (0..195).map(|k| 3.6 + 0.01 * (37.0 * (k * k) as f64).sin()).collect();
        wrong.iter().for_each(|(k, v)| values[*k] = *v);
        let input: Vec<f64> = (0..195).map(duty).collect();
        let torque = input.iter().zip(&values).map(|(m, v)| [m * v; 2]).collect();
        let t = (0..195).map(|k| 1e-3 * f64::from(k)).collect();
        (Channels { t, alpha: None, omega: None, torque }, Factor { values, input })
    }

    #[test]
    fn voltages_that_a_logger_loses_are_replaced_and_the_input_with_them() {
        let (mut channels, factor) = log(&[(2, 0.019), (41, 0.0), (51, 0.396), (120, 3.2)]);
        let factors = [Some(factor), None];
        let found = repair_factors(&mut channels, &factors, &Settings::default());
        assert!(
            matches!(
                found[..],
                [Finding {
                    channel: Channel::Factor(0),
                    kind: Kind::Spikes { count: 4, first: 3, .. },
                    ..
                }]
            ),
            "{found:?}"
        );
        // the voltages around deviate by 0.01 at most
        let off = |k: usize, duty: f64| (channels.torque[k][0] / duty - 3.6).abs();
        assert!([2, 41, 51].iter().all(|k| off(*k, 0.4) < 0.011) && off(120, -0.3) < 0.011);
        // the other input has no such column
        assert!(channels.torque[41][1] == 0.0);
        let kept = Settings { spikes: false, ..Settings::default() };
        let (mut channels, factor) = log(&[(41, 0.0)]);
        assert_eq!(repair_factors(&mut channels, &[Some(factor), None], &kept).len(), 1);
        assert!(channels.torque[41][0] == 0.0);
    }

    #[test]
    fn a_voltage_that_falls_as_the_motors_start_and_one_that_is_switched_off_stay() {
        let off: Vec<(usize, f64)> = (150..153).map(|k| (k, 0.0)).collect();
        for wrong in [&[(100, 3.1)][..], &off] {
            let (mut channels, factor) = log(wrong);
            let factors = [Some(factor), None];
            let found = repair_factors(&mut channels, &factors, &Settings::default());
            assert!(found.is_empty(), "{found:?}");
        }
    }
}
