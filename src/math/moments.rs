//! Mean and variance of values, and the straight line through points.

/// Mean of values; NaN without values.
pub(crate) fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, n), v| (sum + v, n + 1.0));
    sum / count
}

/// Root mean square of values; NaN without values.
pub(crate) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    mean(values.map(|v| v * v)).sqrt()
}

/// Size, mean and variance of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moments {
    /// Number of values n.
    pub(crate) count: f64,
    /// Mean; NaN without values.
    pub(crate) mean: f64,
    /// s² = Σ (x - mean)²/(n - 1).
    pub(crate) variance: f64,
}

impl Moments {
    /// Mean and variance of `values`.
    pub(crate) fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let (count, mean) = (values.clone().count() as f64, mean(values.clone()));
        let squares: f64 = values.map(|v| (v - mean).powi(2)).sum();
        Self { count, mean, variance: squares / (count - 1.0) }
    }

    /// Standard error of the mean, of independent values.
    pub(crate) fn std_error(&self) -> f64 {
        (self.variance / self.count).sqrt()
    }
}

/// The line `y = mean + slope (x - middle)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    /// Mean of x.
    pub(crate) middle: f64,
    /// Mean of y.
    pub(crate) mean: f64,
    /// Slope; NaN where all x are equal.
    pub(crate) slope: f64,
}

impl Line {
    /// The line through points (x, y) by least squares.
    ///
    /// ```text
    /// slope = Σ (x - middle)(y - mean)/Σ (x - middle)²
    /// ```
    pub(crate) fn through(points: impl Iterator<Item = (f64, f64)> + Clone) -> Self {
        let sums = points.clone().fold((0.0, 0.0, 0.0), |(x, y, n), p| (x + p.0, y + p.1, n + 1.0));
        let (middle, mean) = (sums.0 / sums.2, sums.1 / sums.2);
        let (mut product, mut square) = (0.0, 0.0);
        for (x, y) in points {
            product += (x - middle) * (y - mean);
            square += (x - middle).powi(2);
        }
        Self { middle, mean, slope: product / square }
    }

    /// Its value at x.
    pub(crate) fn at(&self, x: f64) -> f64 {
        self.mean + self.slope * (x - self.middle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_variance_are_those_of_numpy() {
        // numpy: mean([1, 2, 4, 9]), var(ddof=1), and scipy.stats.sem
        let sample = Moments::of([1.0, 2.0, 4.0, 9.0].into_iter());
        assert_eq!((sample.count, sample.mean), (4.0, 4.0));
        assert!((sample.variance - 12.666_666_666_666_666).abs() < 1e-14);
        assert!((sample.std_error() - 1.779_513_042_005_219).abs() < 1e-14);
        // numpy: sqrt(mean(square([1, 2, 4, 9])))
        assert!((rms([1.0, 2.0, 4.0, 9.0].into_iter()) - 5.049_752_469_181_039).abs() < 1e-14);
    }

    #[test]
    fn a_line_is_that_of_numpy() {
        // numpy.polyfit([0, 1, 2, 4], [1, 3, 2, 7], 1)
        let line = Line::through([(0.0, 1.0), (1.0, 3.0), (2.0, 2.0), (4.0, 7.0)].into_iter());
        assert!((line.slope - 1.4).abs() < 1e-14);
        assert!((line.at(0.0) - 0.8).abs() < 1e-14, "{line:?}");
        assert!(Line::through([(1.0, 2.0), (1.0, 3.0)].into_iter()).slope.is_nan());
    }
}
