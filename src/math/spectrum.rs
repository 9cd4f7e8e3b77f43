//! Oscillations at given frequencies in signals sampled at any times.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::distribution::f_survival;
use super::error::{MathError, check_finite, check_length};
use super::least_squares::fit;

/// The oscillation of one frequency that fits a signal best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillation {
    /// Frequency, in cycles per unit of the abscissa ([Hz] if that is time).
    pub frequency: f64,
    /// Amplitude, in the unit of the signal.
    pub amplitude: f64,
    /// Phase phi of `amplitude cos(2 pi f t + phi)` [rad].
    pub phase: f64,
    /// Share of the variance about the mean that it explains: the generalised Lomb-Scargle power.
    pub explained: f64,
    /// Probability of so large a share in white noise, at this one frequency (F test with 2 and
    /// n - 3 degrees of freedom); correct it for the number of frequencies looked at.
    pub p_value: f64,
}

/// Fits a mean and one oscillation for each frequency by least squares.
///
/// ```text
/// y_k = c + a cos(2 pi f t_k) + b sin(2 pi f t_k) + e_k
/// ```
///
/// The abscissa need not be time: over a wheel angle in turns the frequencies are orders.
///
/// Source: M. Zechmeister, M. Kuerster, Astron. Astrophys. 496 (2009), generalised Lomb-Scargle.
///
/// # Errors
/// If lengths differ, a value is not finite, or there are fewer than four samples.
pub fn oscillations(
    abscissa: &[f64],
    signal: &[f64],
    frequencies: &[f64],
) -> Result<Vec<Oscillation>, MathError> {
    check_length("the signal", signal.len(), abscissa.len())?;
    check_finite("the frequencies", frequencies)?;
    let y = DVector::from_column_slice(signal);
    let about_mean = y.add_scalar(-y.mean()).norm_squared();
    frequencies.iter().map(|&f| oscillation(abscissa, &y, about_mean, f)).collect()
}

fn oscillation(
    abscissa: &[f64],
    y: &DVector<f64>,
    about_mean: f64,
    frequency: f64,
) -> Result<Oscillation, MathError> {
    let x = DMatrix::from_fn(abscissa.len(), 3, |k, column| {
        let angle = TAU * frequency * abscissa[k];
        [1.0, angle.cos(), angle.sin()][column]
    });
    let fit = fit(&x, y, None)?;
    let left = fit.residuals.norm_squared();
    let (cosine, sine) = (fit.coefficients[1], fit.coefficients[2]);
    let explained = if about_mean > 0.0 { (1.0 - left / about_mean).max(0.0) } else { 0.0 };
    let freedom = fit.degrees_of_freedom as f64;
    let statistic = explained / 2.0 / ((1.0 - explained) / freedom);
    Ok(Oscillation {
        frequency,
        amplitude: cosine.hypot(sine),
        phase: (-sine).atan2(cosine),
        explained,
        p_value: f_survival(statistic, 2.0, freedom),
    })
}

#[cfg(test)]
mod tests {
    use super::super::least_squares::tests::{assert_close, lcg};
    use super::*;

    #[test]
    fn a_noisy_oscillation_on_uneven_times_equals_numpy_and_scipy_lombscargle() {
        let mut t = 0.0;
        let step = |e: &f64| {
            t += 0.01 + 0.005 * e;
            t
        };
        let times: Vec<f64> = lcg(80, 5).iter().map(step).collect();
        let wave = |t: f64| 0.7 + 0.3 * (TAU * 4.0 * t).cos() - 0.2 * (TAU * 4.0 * t).sin();
        let noise = lcg(80, 9);
        let signal: Vec<f64> = (0..80).map(|k| wave(times[k]) + 0.2 * noise[k]).collect();
        let found = oscillations(&times, &signal, &[4.0, 7.5]).unwrap();
        // numpy.linalg.lstsq, scipy.stats.f.sf; the shares also by scipy.signal.lombscargle
        // (floating_mean=True, normalize=True)
        let expected = [
            [0.3592727505545587, 0.5937173142581156, 0.9423957300657707, 1.8945455785533242e-48],
            [0.024854655482252512, -2.028951781020986, 0.004621544856753146, 0.8366563195261031],
        ];
        for (o, e) in found.iter().zip(expected) {
            assert_close(o.amplitude, e[0], 1e-11);
            assert_close(o.phase, e[1], 1e-11);
            assert_close(o.explained, e[2], 1e-11);
            assert_close(o.p_value, e[3], 1e-8);
        }
    }

    #[test]
    fn a_constant_holds_no_oscillation() {
        let times: Vec<f64> = (0..20).map(f64::from).collect();
        let found = oscillations(&times, &[3.0; 20], &[0.1]).unwrap();
        assert_eq!((found[0].explained, found[0].p_value), (0.0, 1.0));
    }
}
