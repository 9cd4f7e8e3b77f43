//! Sensors: their refresh, their steps.

use super::Conditioned;
use super::finding::{Action, Channel, Finding, Kind};
use super::signal::{column, median_high, noise_variance};
use crate::math::noise::quantum;
use crate::recording::refreshed;

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
            let values = column(values, i);
            let values: Vec<f64> = rows.iter().map(|&k| values[k]).collect();
            // only where the steps are what the noise consists of
            let step = quantum(&values).filter(|q| 2.0 * q * q / 12.0 > noise_variance(&values));
            if let Some(step) = step {
                found.push(Finding { channel, kind: Kind::Quantum { step }, action: Action::Used });
            }
        }
    }
    work.findings.extend(found);
}
