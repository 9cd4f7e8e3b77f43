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
    /// Whether it measures a single state as it is, as those of two independent wheels do.
    #[inline]
    fn is_plain(&self) -> bool {
        self.at[0].1 == 1.0 && self.at[1].1 == 0.0
    }

    /// What it measures of the states `x`. A plain one needs no products by one and by zero.
    #[inline]
    fn of(&self, x: impl Fn(usize) -> f64) -> f64 {
        let [(i, by_i), (k, by_k)] = self.at;
        if self.is_plain() { x(i) } else { by_i * x(i) + by_k * x(k) }
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

/// One scalar measurement: returns innovation and its variance, corrects mean, covariance and
/// derivatives; `psi_row` receives the derivative of the prediction by every column.
pub(super) fn correct<const N: usize>(
    channel: &Channel,
    value: f64,
    mean: &mut Mean<N>,
    covariance: &mut Covariance<N>,
    psi: &mut [[f64; N]],
    psi_row: &mut [f64],
) -> (f64, f64) {
    let [(i, by_i), (k, by_k)] = channel.at;
    let e = value - channel.of(|j| mean[j]);
    let mut seen: Mean<N> = covariance.column(i).into_owned();
    if !channel.is_plain() {
        seen = seen * by_i + covariance.column(k) * by_k;
    }
    let s = channel.of(|j| channel.of(|l| covariance[(j, l)])) + channel.variance;
    let share = 1.0 / s;
    let gain = seen * share;
    *mean += gain * e;
    let (seen, gain): ([f64; N], [f64; N]) = (seen.into(), gain.into());
    for (column, by) in covariance.as_mut_slice().chunks_exact_mut(N).zip(seen) {
        for (value, seen) in column.iter_mut().zip(seen) {
            // in an order that rounding leaves symmetric
            *value -= (seen * by) * share;
        }
    }
    for (out, column) in psi_row.iter_mut().zip(psi.iter_mut()) {
        let predicted = channel.of(|j| column[j]);
        *out = predicted;
        for (value, gain) in column.iter_mut().zip(gain) {
            *value -= gain * predicted;
        }
    }
    (e, s)
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    #[test]
    fn the_channels_of_a_row_correct_as_the_whole_measurement() {
        let number = |k: usize| ((7 * k + 3) as f64).sin();
        let root = Covariance::<6>::from_fn(|i, k| number(6 * i + k));
        let (p, x) = (root * root.transpose(), Mean::<6>::from_fn(|i, _| number(50 + i)));
        let psi: Vec<[f64; 6]> =
            (0..3).map(|c| [0, 1, 2, 3, 4, 5].map(|i| number(c + i))).collect();
        let values = [0.3, -0.4, 1.2, 0.7];
        let variance = [0.5, 0.2, 0.3, 0.1];
        let cases = [([true; 4], false), ([true, true, false, true], false), ([true; 4], true)];
        for (used, single) in cases {
            let channels = channels(&variance, &used, single);
            let n = channels.len();
            let value = |c: &Channel| c.value.map_or(0.0, |v| values[v]);
            let weight = |c: &Channel, i: usize| {
                c.at.iter().filter(|(state, _)| *state == i).map(|(_, by)| by).sum()
            };
            let h = DMatrix::from_fn(n, 6, |j, i| weight(&channels[j], i));
            let r = DMatrix::from_diagonal(&DVector::from_fn(n, |j, _| channels[j].variance));
            // Kalman's gain of all channels together
            let s = &h * p * h.transpose() + r;
            let e = DVector::from_fn(n, |j, _| value(&channels[j])) - &h * x;
            let inverse = s.clone().try_inverse().unwrap();
            let gain = p * h.transpose() * &inverse;
            let (mut mean, mut covariance, mut moved) = (x, p, psi.clone());
            let (mut square, mut log, mut product) = (0.0, 0.0, 0.0);
            for channel in &channels {
                let mut row = [0.0; 3];
                let (mean, covariance) = (&mut mean, &mut covariance);
                let (e, s) =
                    correct(channel, value(channel), mean, covariance, &mut moved, &mut row);
                (square, log, product) =
                    (square + e * e / s, log + s.ln(), product + row[0] * row[2] / s);
            }
            assert!((mean - (x + &gain * &e)).amax() < 1e-12);
            assert!((covariance - (p - &gain * &h * p)).amax() < 1e-12);
            assert_eq!(covariance, covariance.transpose());
            for (before, after) in psi.iter().zip(&moved) {
                let before = Mean::<6>::from(*before);
                let expected = before - &gain * &h * before;
                assert!((Mean::<6>::from(*after) - expected).amax() < 1e-12);
            }
            // innovations given those before them are white, and so are their derivatives
            let column = |c: usize| &h * Mean::<6>::from(psi[c]);
            assert!((square - e.dot(&(&inverse * &e))).abs() < 1e-12 * square);
            assert!((log - s.determinant().ln()).abs() < 1e-12);
            assert!((product - column(0).dot(&(&inverse * column(2)))).abs() < 1e-12);
        }
    }
}
