//! Means with standard errors for values that are correlated within blocks.

/// A mean with its standard error.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Mean {
    /// Mean; NaN without rows.
    pub value: f64,
    /// Standard error, from the sums over blocks of 1 s.
    pub std_error: f64,
    /// Number of blocks of 1 s in the bin.
    pub blocks: usize,
}

/// Mean of values, each with the number of its block, in the order of the blocks.
///
/// ```text
/// se² = B/(B - 1) Σ_b (Σ_k in b (x_k - mean))²/n²
/// ```
#[must_use]
pub(super) fn clustered_mean(values: &[(usize, f64)]) -> Mean {
    let sample = |&(block, value): &(usize, f64)| Sample { block, per: 1.0, value };
    clustered_factor(&values.iter().map(sample).collect::<Vec<_>>())
}

/// A value y, its regressor x and the number of its block.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    /// Number of its block.
    pub(super) block: usize,
    /// Regressor x.
    pub(super) per: f64,
    /// Value y, in the unit of the factor times that of `per`.
    pub(super) value: f64,
}

/// The factor c of values y = c x by least squares, blocks in order.
///
/// ```text
/// c = Σ x y/Σ x²,   se² = B/(B - 1) Σ_b (Σ_k in b x_k (y_k - c x_k))²/(Σ x²)²
/// ```
pub(super) fn clustered_factor(samples: &[Sample]) -> Mean {
    let square: f64 = samples.iter().map(|s| s.per * s.per).sum();
    let value = samples.iter().map(|s| s.per * s.value).sum::<f64>() / square;
    let score =
        |block: &[Sample]| -> f64 { block.iter().map(|s| s.per * (s.value - value * s.per)).sum() };
    let scores = samples.chunk_by(|a, b| a.block == b.block).map(score);
    let (blocks, scatter) = scores.fold((0, 0.0), |(n, sum), score| (n + 1, sum + score * score));
    let std_error = match blocks {
        0 | 1 => f64::NAN,
        _ => (blocks as f64 / (blocks - 1) as f64 * scatter).sqrt() / square,
    };
    Mean { value, std_error, blocks }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_a_mean_counts_blocks_and_not_rows() {
        // three blocks of two equal rows: as three values 1, 2, 6 of mean 3, whose standard error is
        // sqrt(((1-3)² + (2-3)² + (6-3)²)/2/3)
        let values = [(0, 1.0), (0, 1.0), (1, 2.0), (1, 2.0), (2, 6.0), (2, 6.0)];
        let mean = clustered_mean(&values);
        assert_eq!((mean.value, mean.blocks), (3.0, 3));
        assert!((mean.std_error - (14.0_f64 / 6.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn the_error_of_a_factor_is_that_of_a_clustered_regression() {
        // White's covariance clustered by blocks, written out: c = Σxy/Σx² = 18/15, scores x (y - c x) summed by block
        let sample = |block, per, value| Sample { block, per, value };
        let samples = vec![
            sample(0, 1.0, 1.0),
            sample(0, 1.0, 2.0),
            sample(1, 2.0, 3.0),
            sample(2, 3.0, 3.0),
        ];
        let factor = clustered_factor(&samples);
        assert!((factor.value - 18.0 / 15.0).abs() < 1e-12);
        let scores: [f64; 3] = [3.0 - 2.0 * 1.2, 2.0 * (3.0 - 2.4), 3.0 * (3.0 - 3.6)];
        let square: f64 = scores.iter().map(|s| s * s).sum();
        assert!((factor.std_error - (1.5 * square).sqrt() / 15.0).abs() < 1e-12);
    }
}
