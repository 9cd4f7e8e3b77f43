//! The correction of the filter by the measured values of a row, and operations that keep a covariance symmetric and
//! consistent.

use nalgebra::{Matrix2, SMatrix, SVector};

/// alpha1, alpha2, omega1, omega2, d1, d2, and behind a coupling u1, u2, phi1, phi2.
pub(super) type Mean<const N: usize> = SVector<f64, N>;
/// Their covariance.
pub(super) type Covariance<const N: usize> = SMatrix<f64, N, N>;

/// Variance of a wheel that is at rest [rad^2/s^2].
pub(super) const STILL: f64 = 1e-10;
/// Channels of a row, at most: angles and speeds of both wheels.
pub(super) const CHANNELS: usize = 4;

/// Removes asymmetry by rounding.
pub(super) fn make_symmetric<const N: usize>(covariance: &mut Covariance<N>) {
    *covariance = (*covariance + covariance.transpose()) * 0.5;
}

/// Adds the variance `torque` of a torque on the wheels [N^2 m^2] that acts on the states by `gain`.
#[inline]
pub(super) fn add_torque_noise<const N: usize>(
    covariance: &mut Covariance<N>,
    gain: &SMatrix<f64, N, 2>,
    torque: &Matrix2<f64>,
) {
    let by_torque = gain * torque;
    for j in 0..N {
        for i in 0..N {
            covariance[(i, j)] +=
                by_torque[(i, 0)] * gain[(j, 0)] + by_torque[(i, 1)] * gain[(j, 1)];
        }
    }
    make_symmetric(covariance);
}

/// `F P F'` for few states, in loops of known length: nalgebra's product calls its general routine for every column.
#[inline]
pub(super) fn carried_over<const N: usize>(f: &Covariance<N>, p: &Covariance<N>) -> Covariance<N> {
    let (mut product, mut out) = (Covariance::<N>::zeros(), Covariance::<N>::zeros());
    for j in 0..N {
        for k in 0..N {
            for i in 0..N {
                product[(i, j)] += f[(i, k)] * p[(k, j)];
            }
        }
    }
    for j in 0..N {
        for k in 0..N {
            for i in 0..N {
                out[(i, j)] += product[(i, k)] * f[(j, k)];
            }
        }
    }
    out
}

/// Holds wheel `i` at rest.
pub(super) fn freeze<const N: usize>(covariance: &mut Covariance<N>, mean: &mut Mean<N>, i: usize) {
    mean[2 + i] = 0.0;
    for k in 0..N {
        covariance[(2 + i, k)] = 0.0;
        covariance[(k, 2 + i)] = 0.0;
    }
    covariance[(2 + i, 2 + i)] = STILL;
}

/// A scalar measurement.
#[derive(Clone, Copy, Debug)]
pub(super) struct Channel {
    /// Number of its value in a row: alpha1, alpha2, omega1, omega2; none for a difference that is zero by definition.
    pub(super) value: Option<usize>,
    /// What it measures: two states with their weights.
    pub(super) at: [(usize, f64); 2],
    /// Variance of its noise.
    pub(super) variance: f64,
}

impl Channel {
    fn weighted(&self, state: &[f64]) -> f64 {
        let [(i, by_i), (k, by_k)] = self.at;
        by_i * state[i] + by_k * state[k]
    }
}

/// Channels of a recording with these `variance`s, of which the `used` ones are measured. A `single` axis mapped to
/// both wheels is measured once, by the mean of the wheels; their difference, always zero, is a measurement without
/// information that keeps the wheels together.
pub(super) fn channels(variance: &[f64; 4], used: &[bool; 4], single: bool) -> Vec<Channel> {
    let mut out = vec![];
    for i in (0..CHANNELS).filter(|&i| used[i]) {
        let variance = variance[i];
        if !single {
            out.push(Channel { value: Some(i), at: [(i, 1.0), (i, 0.0)], variance });
        } else if i % 2 == 0 {
            out.push(Channel { value: Some(i), at: [(i, 0.5), (i + 1, 0.5)], variance });
            out.push(Channel { value: None, at: [(i, 1.0), (i + 1, -1.0)], variance });
        }
    }
    out
}

/// A channel after those before it in its row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<const N: usize> {
    /// Covariance of the states with its prediction.
    pub(super) states: Mean<N>,
    /// Innovation.
    pub(super) e: f64,
    /// Its variance, and the inverse of that and of its root.
    pub(super) s: f64,
    pub(super) share: f64,
    pub(super) weight: f64,
    /// Gains of the channels before it on its prediction.
    by: [f64; CHANNELS],
}

impl<const N: usize> Seen<N> {
    pub(super) fn nothing() -> Self {
        let states = Mean::<N>::zeros();
        Self { states, e: 0.0, s: 1.0, share: 1.0, weight: 1.0, by: [0.0; CHANNELS] }
    }
}

/// Corrects mean, covariance and derivatives `psi` by the `values` of a row. Fills `seen` channel by channel, and
/// `predicted` with the derivatives of the predictions, each given the channels before it.
///
/// ```text
/// c_j = P h_j - Σ_i<j c_i b_ji,   b_ji = h_j' c_i / s_i,   e_j = y_j - h_j' x - Σ_i<j b_ji e_i,   s_j = h_j' c_j + r_j
/// x <- x + Σ c_j e_j / s_j,   P <- P - Σ c_j c_j' / s_j
/// ```
/// One measurement after the other, with the states moved once.
#[inline]
pub(super) fn correct<const N: usize>(
    channels: &[Channel],
    values: &[f64; 4],
    (mean, covariance): (&mut Mean<N>, &mut Covariance<N>),
    psi: &mut [[f64; N]],
    predicted: &mut [[f64; CHANNELS]],
    seen: &mut [Seen<N>; CHANNELS],
) {
    let count = channels.len().min(CHANNELS);
    for (j, channel) in channels.iter().enumerate().take(count) {
        let (before, from) = seen.split_at_mut(j);
        let Some(now) = from.first_mut() else { break };
        let [(i, by_i), (k, by_k)] = channel.at;
        let mut states: Mean<N> = covariance.column(i) * by_i;
        if by_k != 0.0 {
            states += covariance.column(k) * by_k;
        }
        let value = channel.value.map_or(0.0, |value| values[value]);
        let mut e = value - channel.weighted(mean.as_slice());
        for (by, before) in now.by.iter_mut().zip(&*before) {
            *by = channel.weighted(before.states.as_slice()) * before.share;
            states -= before.states * *by;
            e -= before.e * *by;
        }
        let s = channel.weighted(states.as_slice()) + channel.variance;
        let share = 1.0 / s;
        (now.states, now.e, now.s, now.share, now.weight) = (states, e, s, share, share.sqrt());
    }
    let seen = &seen[..count];
    for now in seen {
        *mean += now.states * (now.share * now.e);
        // a product that rounding leaves symmetric
        let known: [f64; N] = (now.states * now.weight).into();
        for (column, by) in covariance.as_mut_slice().chunks_exact_mut(N).zip(known) {
            for (value, known) in column.iter_mut().zip(known) {
                *value -= known * by;
            }
        }
    }
    for (column, predicted) in psi.iter_mut().zip(predicted) {
        for (j, channel) in channels.iter().enumerate().take(count) {
            let mut here = channel.weighted(column);
            for i in 0..j {
                here -= seen[j].by[i] * predicted[i];
            }
            predicted[j] = here;
        }
        for (now, predicted) in seen.iter().zip(&*predicted) {
            let share = now.share * predicted;
            for (value, states) in column.iter_mut().zip(now.states.as_slice()) {
                *value -= share * states;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_correction_by_a_row_is_that_of_the_whole_measurement() {
        let number = |k: usize| ((7 * k + 3) as f64).sin();
        let root = Covariance::<6>::from_fn(|i, k| number(6 * i + k));
        let p = root * root.transpose();
        let x = Mean::<6>::from_fn(|i, _| number(50 + i));
        let psi: Vec<[f64; 6]> =
            (0..3).map(|c| [0, 1, 2, 3, 4, 5].map(|i| number(c + i))).collect();
        let values = [0.3, -0.4, 1.2, 0.7];
        let variance = [0.5, 0.2, 0.3, 0.1];
        for (used, single) in
            [([true; 4], false), ([true, true, false, true], false), ([true; 4], true)]
        {
            let channels = channels(&variance, &used, single);
            let n = channels.len();
            let h = nalgebra::DMatrix::from_fn(n, 6, |j, i| {
                channels[j].at.iter().filter(|(state, _)| *state == i).map(|(_, by)| by).sum()
            });
            let r = nalgebra::DMatrix::from_diagonal(&nalgebra::DVector::from_fn(n, |j, _| {
                channels[j].variance
            }));
            let y =
                nalgebra::DVector::from_fn(n, |j, _| channels[j].value.map_or(0.0, |v| values[v]));
            // Kalman's gain in one
            let s = &h * p * h.transpose() + r;
            let e = y - &h * x;
            let gain = p * h.transpose() * s.clone().try_inverse().unwrap();
            let (mut mean, mut covariance, mut moved) = (x, p, psi.clone());
            let (mut predicted, mut seen) = (vec![[0.0; 4]; 3], [Seen::<6>::nothing(); 4]);
            correct(
                &channels,
                &values,
                (&mut mean, &mut covariance),
                &mut moved,
                &mut predicted,
                &mut seen,
            );
            assert!((mean - (x + &gain * &e)).amax() < 1e-12);
            assert!((covariance - (p - &gain * &h * p)).amax() < 1e-12);
            assert_eq!(covariance, covariance.transpose());
            for (before, after) in psi.iter().zip(&moved) {
                let before = Mean::<6>::from(*before);
                let expected = before - &gain * &h * before;
                assert!((Mean::<6>::from(*after) - expected).amax() < 1e-12);
            }
            // the innovations given those before them whiten all, and so do their derivatives
            let seen = &seen[..n];
            let square: f64 = seen.iter().map(|c| c.e * c.e * c.share).sum();
            let inverse = s.clone().try_inverse().unwrap();
            assert!((square - e.dot(&(&inverse * &e))).abs() < 1e-12 * square);
            let log: f64 = seen.iter().map(|c| c.s.ln()).sum();
            assert!((log - s.determinant().ln()).abs() < 1e-12);
            let column = |c: usize| &h * Mean::<6>::from(psi[c]);
            let product: f64 =
                (0..n).map(|j| predicted[0][j] * predicted[2][j] * seen[j].share).sum();
            assert!((product - column(0).dot(&(&inverse * column(2)))).abs() < 1e-12);
        }
    }
}
