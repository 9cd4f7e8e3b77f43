//! Sums of logarithms.

/// Range of a product before its logarithm is taken; one further factor does not overflow.
const RANGE: std::ops::Range<f64> = 1e-150..1e150;

/// A sum of logarithms of positive numbers, computed from their product with one logarithm for many factors.
///
/// A number that is not positive makes the sum minus infinity or NaN, as its own logarithm would.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LogProduct {
    sum: f64,
    product: f64,
}

impl LogProduct {
    /// The sum over nothing.
    pub(crate) fn new() -> Self {
        Self { sum: 0.0, product: 1.0 }
    }

    /// Adds the logarithm of a number.
    #[inline]
    pub(crate) fn add(&mut self, number: f64) {
        self.product *= number;
        if !RANGE.contains(&self.product) {
            self.sum += self.product.ln();
            self.product = 1.0;
        }
    }

    /// The sum.
    pub(crate) fn finish(self) -> f64 {
        self.sum + self.product.ln()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(numbers: &[f64]) -> f64 {
        let mut out = LogProduct::new();
        numbers.iter().for_each(|number| out.add(*number));
        out.finish()
    }

    #[test]
    fn the_logarithm_of_the_product_is_the_sum_of_the_logarithms() {
        let numbers: Vec<f64> = (0..1000).map(|k| 10_f64.powi(k % 120 - 80) * 1.7).collect();
        let expected: f64 = numbers.iter().map(|x| x.ln()).sum();
        // a rounding each
        assert!((sum(&numbers) - expected).abs() < 1e-14 * 1000.0 * 180.0);
    }

    #[test]
    fn what_is_not_positive_has_no_logarithm_even_twice() {
        assert!(sum(&[-1.0, -1.0]).is_nan() && sum(&[f64::NAN, 1.0]).is_nan());
        assert_eq!(sum(&[3.0, 0.0]), f64::NEG_INFINITY);
    }
}
