//! Order statistics.

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
    let place = ((sample.len() - 1) as f64 * share).round() as usize;
    *sample.select_nth_unstable_by(place, f64::total_cmp).1
}

/// The value in the middle, of an even number the upper one; zero of nothing.
#[must_use]
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    quantile(values, 0.5)
}
