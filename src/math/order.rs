//! Order statistics.

/// Median of the size of a normal variable of standard deviation one, the upper quartile of the normal distribution.
const NORMAL_UPPER_QUARTILE: f64 = 0.674_489_750_196_081_7;

/// The value of a sample below which a share of all lies, the nearest one in order; zero of nothing.
///
/// # Examples
/// ```
/// use amigo_ident::math::quantile;
/// assert_eq!(quantile([3.0, 1.0, 2.0], 0.5), 2.0);
/// assert_eq!(quantile([], 0.5), 0.0);
/// ```
#[must_use]
pub fn quantile(values: impl IntoIterator<Item = f64>, share: f64) -> f64 {
    let mut sample: Vec<f64> = values.into_iter().collect();
    if sample.is_empty() {
        return 0.0;
    }
    let place = place(sample.len(), share);
    *sample.select_nth_unstable_by(place, f64::total_cmp).1
}

/// [`quantile`] of a sample in ascending order.
///
/// # Examples
/// ```
/// use amigo_ident::math::quantile_of_sorted;
/// assert_eq!(quantile_of_sorted(&[1.0, 2.0, 3.0], 0.75), 3.0);
/// assert_eq!(quantile_of_sorted(&[], 0.5), 0.0);
/// ```
#[must_use]
pub fn quantile_of_sorted(sample: &[f64], share: f64) -> f64 {
    sample.get(place(sample.len(), share)).copied().unwrap_or(0.0)
}

/// The place in ascending order that is nearest to a share of `count` values.
fn place(count: usize, share: f64) -> usize {
    (count.saturating_sub(1) as f64 * share).round() as usize
}

/// The median; of an even number the mean of the middle two; zero of nothing.
///
/// That of values which vary continuously: of two it is the mean, so that neither counts for more.
///
/// # Examples
/// ```
/// use amigo_ident::math::{median, median_high};
/// let steps = [0.01, 0.01, 0.02, 0.02];
/// assert_eq!(median(steps), 0.015);
/// assert_eq!(median_high(steps), 0.02);
/// ```
#[must_use]
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut sample: Vec<f64> = values.into_iter().collect();
    sample.sort_by(f64::total_cmp);
    let half = sample.len() / 2;
    match sample.len() {
        0 => 0.0,
        count if count % 2 == 1 => sample[half],
        _ => 0.5 * (sample[half - 1] + sample[half]),
    }
}

/// The high median: the value in the middle, of an even number the upper one; zero of nothing.
///
/// It is a value of the sample. A logger that alternates between steps of 10 and 20 ms has none of 15 ms, and a run
/// of rows has a whole number of them.
#[must_use]
pub fn median_high(values: impl IntoIterator<Item = f64>) -> f64 {
    quantile(values, 0.5)
}

/// Standard deviation of normal noise from its median absolute deviation from zero; zero of nothing.
///
/// ```text
/// s = median |e| / 0.6745
/// ```
/// Half of the values may be anything without moving it far.
///
/// Source: P. J. Huber, E. M. Ronchetti, *Robust Statistics*, 2nd ed., 5.1.
#[must_use]
pub fn robust_deviation(errors: impl IntoIterator<Item = f64>) -> f64 {
    median(errors.into_iter().map(f64::abs)) / NORMAL_UPPER_QUARTILE
}

#[cfg(test)]
mod tests {
    use super::super::distribution::normal_quantile;
    use super::*;

    #[test]
    fn the_robust_deviation_is_that_of_statsmodels_mad() {
        // statsmodels.robust.scale.mad([1, -2, 3, -4, 100], center=0) and of the first four
        assert!(
            (robust_deviation([1.0, -2.0, 3.0, -4.0, 100.0]) - 4.447_806_655_516_806).abs() < 1e-12
        );
        assert!((robust_deviation([1.0, -2.0, 3.0, -4.0]) - 3.706_505_546_264_005).abs() < 1e-12);
        assert_eq!(robust_deviation([]), 0.0);
    }

    #[test]
    fn the_quantiles_of_a_normal_variable_have_its_deviation() {
        let sample = (0..1000).map(|k| 0.3 * normal_quantile((f64::from(k) + 0.5) / 1000.0));
        // the steps between the quantiles near 0.25 and 0.75 are 0.001/0.318 of a deviation
        assert!((robust_deviation(sample) / 0.3 - 1.0).abs() < 2e-3);
    }
}
