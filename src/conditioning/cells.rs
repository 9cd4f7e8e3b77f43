//! The channels as columns of a table.

use super::finding::Channel;
use crate::recording::Channels;

/// Every column by itself.
pub(super) fn columns(c: &Channels) -> Vec<(Channel, Vec<f64>)> {
    let mut out = vec![(Channel::Time, c.t.clone())];
    for i in 0..2 {
        let pairs = [
            (Channel::Angle(i), c.alpha.as_ref()),
            (Channel::Speed(i), c.omega.as_ref()),
            (Channel::Input(i), Some(&c.torque)),
        ];
        let there = pairs.into_iter().filter_map(|(name, v)| v.map(|v| (name, v)));
        out.extend(there.map(|(name, v)| (name, v.iter().map(|x| x[i]).collect())));
    }
    out
}

/// One column; empty where the recording has no such channel.
pub(super) fn column(c: &Channels, channel: Channel) -> Vec<f64> {
    let found = columns(c).into_iter().find(|(name, _)| *name == channel);
    found.map_or(vec![], |(_, values)| values)
}

/// Replaces one column, if the recording has it.
pub(super) fn put(c: &mut Channels, channel: Channel, values: &[f64]) {
    let (rows, i) = match channel {
        Channel::Angle(i) => (c.alpha.as_mut(), i),
        Channel::Speed(i) => (c.omega.as_mut(), i),
        Channel::Input(i) => (Some(&mut c.torque), i),
        Channel::Time | Channel::Sensors | Channel::Factor(_) => return,
    };
    rows.into_iter().flatten().zip(values).for_each(|(row, value)| row[i] = *value);
}

/// The rows whose flag is set.
pub(super) fn keep(c: &mut Channels, flags: &[bool]) {
    fn filter<T: Copy>(v: &mut Vec<T>, flags: &[bool]) {
        let mut k = 0;
        v.retain(|_| {
            k += 1;
            flags[k - 1]
        });
    }
    filter(&mut c.t, flags);
    filter(&mut c.torque, flags);
    for v in [c.alpha.as_mut(), c.omega.as_mut()].into_iter().flatten() {
        filter(v, flags);
    }
}
