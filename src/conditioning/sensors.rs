//! Sensors: those that never move, their refresh, their steps.

use super::error::ConditioningError;
use super::finding::{Action, Channel, Finding, Kind, WHEELS};
use super::signal::{column, median_high, noise_variance, quantile};
use super::{Conditioned, Settings};
use crate::math::noise::quantum;
use crate::recording::refreshed;

/// Part of the other wheel's input from which on a wheel counts as driven as well.
const DRIVEN: f64 = 0.5;

/// Refuses a wheel whose sensors never change although it is driven like the other, which moves.
pub(super) fn still(work: &Conditioned, settings: &Settings) -> Result<(), ConditioningError> {
    if !settings.refuse {
        return Ok(());
    }
    let c = &work.channels;
    let size = |i: usize| quantile(c.torque.iter().map(|m| m[i].abs()), 0.9);
    let constant = |rows: Option<&Vec<[f64; 2]>>, i: usize| {
        rows.is_none_or(|rows| rows.iter().all(|v| v[i] == rows[0][i]))
    };
    let dead = |i: usize| constant(c.alpha.as_ref(), i) && constant(c.omega.as_ref(), i);
    for i in 0..2 {
        if dead(i) && !dead(1 - i) && size(i) > DRIVEN * size(1 - i) && size(i) > 0.0 {
            let value = c.alpha.as_ref().or(c.omega.as_ref()).map_or(0.0, |v| v[0][i]);
            return Err(ConditioningError::Dead { wheel: WHEELS[i], value, rows: c.t.len() });
        }
    }
    Ok(())
}

/// Reports the refresh interval of the sensors, and their quantisation steps.
pub(super) fn refresh(work: &mut Conditioned) {
    let c = &work.channels;
    let fresh = refreshed(c);
    let rows: Vec<usize> = (0..fresh.len()).filter(|&k| fresh[k]).collect();
    let mut found = Vec::new();
    if rows.len() < fresh.len() {
        let period_s = median_high(rows.windows(2).map(|w| c.t[w[1]] - c.t[w[0]]));
        let kind = Kind::Refresh { period_s };
        found.push(Finding { channel: Channel::Sensors, kind, action: Action::Used });
    }
    for i in 0..2 {
        for (channel, values) in
            [(Channel::Angle(i), c.alpha.as_ref()), (Channel::Speed(i), c.omega.as_ref())]
        {
            let Some(values) = values else { continue };
            let values: Vec<f64> = rows.iter().map(|&k| column(values, i)[k]).collect();
            // only where the steps are what the noise consists of
            let step = quantum(&values).filter(|q| 2.0 * q * q / 12.0 > noise_variance(&values));
            if let Some(step) = step {
                found.push(Finding { channel, kind: Kind::Quantum { step }, action: Action::Used });
            }
        }
    }
    work.findings.extend(found);
}
