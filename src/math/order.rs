//! Order statistics.

/// Median of the absolute value of a standard normal variable, the upper quartile of the normal distribution.
const NORMAL_UPPER_QUARTILE: f64 = 0.674_489_750_196_081_7;

/// The empirical quantile at `share`, rounded to the nearest sample; zero for an empty sample.
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

/// Rank of the sample nearest to a share of `count` values.
fn place(count: usize, share: f64) -> usize {
    (count.saturating_sub(1) as f64 * share).round() as usize
}

/// Median difference between successive values: the usual step of time stamps, in their unit.
///
/// # Examples
/// ```
/// use amigo_ident::math::median_step;
/// assert_eq!(median_step(&[0.0, 1.0, 2.0, 9.0]), 1.0);
/// ```
#[must_use]
pub fn median_step(t: &[f64]) -> f64 {
    median_high(t.windows(2).map(|w| w[1] - w[0]))
}

/// The median; for an even number the mean of the middle two; zero for an empty sample.
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
    let count = sample.len();
    if count == 0 {
        return 0.0;
    }
    let (below, middle, _) = sample.select_nth_unstable_by(count / 2, f64::total_cmp);
    let before = below.iter().copied().max_by(f64::total_cmp).filter(|_| count.is_multiple_of(2));
    before.map_or(*middle, |before| 0.5 * (before + *middle))
}

/// The high median: the middle value, for an even number the larger of the two; zero for an empty sample.
///
/// It is a value of the sample: for a logger that alternates between steps of 10 and 20 ms it is not 15 ms,
/// and for run lengths it is an integer.
#[must_use]
pub fn median_high(values: impl IntoIterator<Item = f64>) -> f64 {
    quantile(values, 0.5)
}

/// Standard deviation of normal noise from its median absolute deviation from zero; zero for an empty sample.
///
/// ```text
/// s = median |e| / 0.6745
/// ```
/// Insensitive to outliers in less than half of the values.
///
/// Source: P. J. Huber, E. M. Ronchetti, *Robust Statistics*, 2nd ed., 5.1.
#[must_use]
pub fn robust_deviation(errors: impl IntoIterator<Item = f64>) -> f64 {
    median(errors.into_iter().map(f64::abs)) / NORMAL_UPPER_QUARTILE
}

/// Mean of the smallest 95 % of squares over what that is for a normal variable of variance one: jumps
/// and gaps do not count, and rows in which nothing changes do not hide the others.
pub(crate) fn trimmed_mean_square(mut squares: Vec<f64>) -> f64 {
    let kept = (squares.len() * 19).div_ceil(20);
    if kept < squares.len() {
        squares.select_nth_unstable_by(kept, f64::total_cmp);
        squares.truncate(kept);
    }
    squares.iter().sum::<f64>() / squares.len().max(1) as f64 / 0.759
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
