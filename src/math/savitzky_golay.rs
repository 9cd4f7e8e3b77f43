//! Savitzky-Golay smoothing and differentiation of evenly sampled signals.

use nalgebra::{DMatrix, DVector};

use super::error::{MathError, check_finite};

/// A moving window in which a polynomial is fitted by least squares.
///
/// # Examples
/// ```
/// use amigo_ident::math::savitzky_golay::SavitzkyGolay;
/// let parabola: Vec<f64> = (0..20).map(|k| (0.1 * k as f64).powi(2)).collect();
/// let slope = SavitzkyGolay::new(7, 2)?.derivative(&parabola, 1, 0.1)?;
/// assert!((slope[19] - 2.0 * 1.9).abs() < 1e-12); // exact for polynomials up to the order, ends too
/// # Ok::<(), amigo_ident::math::MathError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SavitzkyGolay {
    window: usize,
    order: usize,
    /// Row j maps the samples of a window to coefficient j of the polynomial in z = position / half
    /// width, z in [-1, 1].
    projection: DMatrix<f64>,
}

impl SavitzkyGolay {
    /// A window of `window` samples (odd) and a polynomial of degree `order`.
    ///
    /// Source: A. Savitzky, M. J. E. Golay, Anal. Chem. 36 (1964).
    ///
    /// # Errors
    /// If the window is even or one, or not longer than the order.
    pub fn new(window: usize, order: usize) -> Result<Self, MathError> {
        if window.is_multiple_of(2) || window < 3 {
            let (setting, expected) = ("Savitzky-Golay window [samples]", "odd, at least 3");
            return Err(MathError::OutOfRange { setting, found: window as f64, expected });
        }
        if order >= window {
            let (setting, expected) = ("Savitzky-Golay order", "less than the window");
            return Err(MathError::OutOfRange { setting, found: order as f64, expected });
        }
        let half = (window / 2) as f64;
        let position = |row: usize| (row as f64 - half) / half;
        let powers = DMatrix::from_fn(window, order + 1, |i, j| position(i).powi(j as i32));
        let (q, r) = powers.qr().unpack();
        // the powers of distinct positions are independent, so r has an inverse
        let projection = r.solve_upper_triangular(&q.transpose()).unwrap_or_else(|| q.transpose());
        Ok(Self { window, order, projection })
    }

    /// The signal with its noise averaged inside the window.
    ///
    /// # Errors
    /// As [`Self::derivative`].
    pub fn smooth(&self, signal: &[f64]) -> Result<Vec<f64>, MathError> {
        self.derivative(signal, 0, 1.0)
    }

    /// The derivative of order `derivative` of the fitted polynomial at each sample; `step` is the
    /// sampling interval [s].
    ///
    /// The half windows at the ends are read off the polynomial of the first and the last full
    /// window (`scipy.signal.savgol_filter` with `mode="interp"`).
    ///
    /// # Errors
    /// If the signal is shorter than the window, a value is not finite or the step not positive.
    pub fn derivative(
        &self,
        signal: &[f64],
        derivative: usize,
        step: f64,
    ) -> Result<Vec<f64>, MathError> {
        check_finite("the signal", signal)?;
        if !(step > 0.0 && step.is_finite()) {
            let (setting, expected) = ("sampling interval [s]", "positive");
            return Err(MathError::OutOfRange { setting, found: step, expected });
        }
        let (n, half) = (signal.len(), self.window / 2);
        if n < self.window {
            let (method, required) = ("the Savitzky-Golay filter", self.window);
            return Err(MathError::TooFewSamples { method, found: n, required });
        }
        let unit = (half as f64 * step).powi(derivative as i32);
        let taps = |at: f64| self.taps(derivative, at) / unit;
        let centre = taps(0.0);
        let value = |k: usize| {
            let start = k.saturating_sub(half).min(n - self.window);
            let inside = &signal[start..start + self.window];
            if k == start + half {
                dot(&centre, inside)
            } else {
                dot(&taps((k as f64 - (start + half) as f64) / half as f64), inside)
            }
        };
        Ok((0..n).map(value).collect())
    }

    /// Weights of the window's samples that give the derivative (with respect to z) at `at`.
    fn taps(&self, derivative: usize, at: f64) -> DVector<f64> {
        let mut taps = DVector::zeros(self.window);
        for power in derivative..=self.order {
            let falling: f64 = (0..derivative).map(|i| (power - i) as f64).product();
            let factor = falling * at.powi((power - derivative) as i32);
            taps += self.projection.row(power).transpose() * factor;
        }
        taps
    }
}

fn dot(taps: &DVector<f64>, samples: &[f64]) -> f64 {
    taps.iter().zip(samples).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::super::filter::tests::{assert_samples, noisy_sine};
    use super::*;

    #[test]
    fn noisy_signals_and_their_derivatives_equal_scipy_savgol_filter_ends_included() {
        let filter = SavitzkyGolay::new(11, 4).unwrap();
        let at = [0, 3, 5, 30, 57, 59];
        // scipy 1.17 savgol_filter(v, 11, 4, deriv=d, delta=0.01), mode "interp"
        let expected = [
            [
                -0.27624653375426633,
                0.414303587231888,
                0.34294769028921557,
                1.0189907078011262,
                0.32507591143283876,
                0.22558960680104012,
            ],
            [
                59.54146290633202,
                0.3065681742292936,
                -4.567085315714418,
                -18.266522694418672,
                -2.674346054981111,
                -8.814336536796313,
            ],
            [
                -3502.4809879729187,
                -740.2097183427153,
                122.31204749257631,
                103.04981791899866,
                -94.74670359541761,
                -556.7623421746896,
            ],
        ];
        // SciPy's own rounding grows by 1/step per derivative
        let tolerance = [1e-12, 1e-10, 1e-8];
        for d in 0..3 {
            let found = filter.derivative(&noisy_sine(), d, 0.01).unwrap();
            assert_samples(&found, &at, &expected[d], tolerance[d]);
        }
    }

    #[test]
    fn a_derivative_above_the_order_is_zero() {
        let filter = SavitzkyGolay::new(5, 2).unwrap();
        assert_eq!(filter.derivative(&noisy_sine(), 3, 0.01).unwrap(), [0.0; 60]);
    }

    #[test]
    fn impossible_windows_are_refused() {
        assert!(SavitzkyGolay::new(4, 2).is_err());
        assert!(SavitzkyGolay::new(5, 5).is_err());
        let five = SavitzkyGolay::new(5, 2).unwrap();
        assert!(five.smooth(&[0.0; 4]).is_err());
        assert!(five.derivative(&[0.0; 9], 1, 0.0).is_err());
    }
}
