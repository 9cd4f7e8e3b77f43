//! Sensors: their refresh, their steps.

use super::Conditioned;
use super::align::refreshed_alone;
use super::finding::{Action, Channel, Finding, Kind};
use super::signal::{column, median_high, noise_variance};
use crate::math::noise::quantum;
use crate::recording::{Channels, refreshed};

/// Time between new values of the slowest sensor \[s\]: corrections of their times may have moved those of the others into other
/// rows.
fn period(c: &Channels) -> f64 {
    let sensors = [c.alpha.as_ref(), c.omega.as_ref()].into_iter().flatten();
    let each = sensors.flat_map(|values| [0, 1].map(|i| column(values, i))).map(|values| {
        let new = refreshed_alone(&c.t, &values);
        let t: Vec<f64> = c.t.iter().zip(new).filter_map(|(t, new)| new.then_some(*t)).collect();
        median_high(t.windows(2).map(|t| t[1] - t[0]))
    });
    each.fold(0.0, f64::max)
}

/// Reports the refresh interval of the sensors, and their quantisation steps.
pub(super) fn refresh(work: &mut Conditioned) {
    let c = &work.channels;
    let fresh = refreshed(c);
    let rows: Vec<usize> = (0..fresh.len()).filter(|&k| fresh[k]).collect();
    let mut found = Vec::new();
    if rows.len() < fresh.len() {
        let period_s = period(c);
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
