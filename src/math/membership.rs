//! Gaussian membership functions of fuzzy sets.

/// Spacing over width of a family whose neighbours cross at one half: 2 sqrt(2 ln 2) rounded as
/// in the MATLAB fuzzy toolbox.
pub const SPACING_OVER_WIDTH: f64 = 2.355;

/// A Gaussian membership function.
///
/// ```text
/// mu(x) = exp(-(x - c)^2 / (2 sigma^2))
/// ```
///
/// # Examples
/// ```
/// use amigo_ident::math::membership::Gaussian;
/// let slow = Gaussian { centre: 0.0, width: 2.0 };
/// assert!((slow.degree(2.0) - (-0.5_f64).exp()).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gaussian {
    /// Centre c, in the unit of x.
    pub centre: f64,
    /// Width sigma > 0, in the unit of x.
    pub width: f64,
}

impl Gaussian {
    /// Degree of membership of `x`, from 0 to 1.
    #[must_use]
    pub fn degree(&self, x: f64) -> f64 {
        self.log_degree(x).exp()
    }

    /// Natural logarithm of the degree, finite where the degree underflows.
    #[must_use]
    pub fn log_degree(&self, x: f64) -> f64 {
        -0.5 * ((x - self.centre) / self.width).powi(2)
    }

    /// `count` functions with centres evenly from `low` to `high` and neighbours that cross at
    /// one half (width = spacing / 2.355).
    ///
    /// A single function gets the middle and the whole range as its spacing; a range of no extent
    /// is widened to one unit.
    #[must_use]
    pub fn family(low: f64, high: f64, count: usize) -> Vec<Self> {
        let extent = if high == low { 1.0 } else { (high - low).abs() };
        if count == 1 {
            let centre = 0.5 * (low + high);
            return vec![Self { centre, width: extent / SPACING_OVER_WIDTH }];
        }
        let start = if high == low { low - 0.5 } else { low.min(high) };
        let spacing = extent / count.saturating_sub(1).max(1) as f64;
        let width = spacing / SPACING_OVER_WIDTH;
        (0..count).map(|i| Self { centre: start + i as f64 * spacing, width }).collect()
    }
}

/// Normalised firing strengths of rules from the logarithms of their firing strengths.
///
/// ```text
/// h_i = exp(l_i) / sum_j exp(l_j)
/// ```
///
/// Computed relative to the largest, so that far outside all sets, where every strength
/// underflows, the nearest rule still fires instead of 0/0.
///
/// # Examples
/// ```
/// use amigo_ident::math::membership::normalise;
/// let mut strengths = [-1000.0, -1000.0 - 3.0_f64.ln()];
/// normalise(&mut strengths);
/// assert!((strengths[0] - 0.75).abs() < 1e-12);
/// ```
pub fn normalise(log_strengths: &mut [f64]) {
    let largest = log_strengths.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    for strength in log_strengths.iter_mut() {
        *strength = (*strength - largest).exp();
    }
    let total: f64 = log_strengths.iter().sum();
    for strength in log_strengths.iter_mut() {
        *strength /= total;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_of_a_family_cross_at_one_half() {
        let family = Gaussian::family(0.0, 30.0, 6);
        assert_eq!(family.len(), 6);
        assert_eq!((family[0].centre, family[5].centre), (0.0, 30.0));
        // by hand: spacing 6, sigma 6/2.355, exp(-2.355^2/8) = 0.499947
        for pair in family.windows(2) {
            let middle = 0.5 * (pair[0].centre + pair[1].centre);
            assert!((pair[0].degree(middle) - 0.499_947_0).abs() < 1e-6);
            assert!((pair[0].degree(middle) - pair[1].degree(middle)).abs() < 1e-14);
        }
    }

    #[test]
    fn a_family_without_extent_or_members_is_still_usable() {
        assert!(Gaussian::family(0.0, 1.0, 0).is_empty());
        assert_eq!(Gaussian::family(2.0, 4.0, 1)[0].centre, 3.0);
        let narrow = Gaussian::family(5.0, 5.0, 3);
        assert_eq!(narrow.iter().map(|g| g.centre).collect::<Vec<_>>(), [4.5, 5.0, 5.5]);
        assert!(narrow.iter().all(|g| g.width > 0.0));
    }

    #[test]
    fn firing_strengths_sum_to_one_even_far_outside() {
        for x in [-500.0, 0.3, 7.7, 1e4] {
            let family = Gaussian::family(0.0, 10.0, 5);
            let mut strengths: Vec<f64> = family.iter().map(|g| g.log_degree(x)).collect();
            normalise(&mut strengths);
            assert!((strengths.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        }
    }
}
