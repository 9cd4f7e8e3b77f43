//! Least squares with non-negative coefficients.

use nalgebra::{DMatrix, DVector};

use super::Information;

/// Directions of the scaled information below this share are discarded.
const WEAK: f64 = 1e-9;

/// The coefficients that minimise `½ x'Hx - g'x` with `x_n >= 0` where `bounded[n]`, and twice the decrease
/// from zero: constrained ones that come out negative are set to zero one after the other.
///
/// ```text
/// H x = g,   gain = g'x
/// ```
/// Source: active set of Lawson and Hanson, Solving Least Squares Problems (1974), ch. 23, for columns that
/// leave and do not come back.
#[must_use]
pub fn nonnegative(h: &DMatrix<f64>, g: &DVector<f64>, bounded: &[bool]) -> (Vec<f64>, f64) {
    let count = g.len();
    let mut kept: Vec<usize> = (0..count).collect();
    while !kept.is_empty() {
        let n = kept.len();
        let own = h.select_rows(&kept).select_columns(&kept);
        let right = g.select_rows(&kept);
        let solution = Information::truncated(&own, WEAK).solve(&right);
        let worst = (0..n)
            .filter(|&a| bounded[kept[a]] && solution[a] < 0.0)
            .min_by(|a, b| solution[*a].total_cmp(&solution[*b]));
        match worst {
            Some(a) => {
                kept.remove(a);
            }
            None => {
                let mut x = vec![0.0; count];
                (0..n).for_each(|a| x[kept[a]] = solution[a]);
                return (x, solution.dot(&right));
            }
        }
    }
    (vec![0.0; count], 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coefficient_that_may_not_be_negative_leaves_the_others_to_explain() {
        let h = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 3.0]);
        let g = DVector::from_row_slice(&[-1.0, 2.0]);
        // H x = g has x = (-1, 1), gain 3; without the first x = (0, 2/3), gain 4/3
        let (free, gain) = nonnegative(&h, &g, &[false, false]);
        assert!((free[0] + 1.0).abs() < 1e-12 && (gain - 3.0).abs() < 1e-12);
        let (x, gain) = nonnegative(&h, &g, &[true, true]);
        assert_eq!(x[0], 0.0);
        assert!((x[1] - 2.0 / 3.0).abs() < 1e-12 && (gain - 4.0 / 3.0).abs() < 1e-12);
        assert_eq!(nonnegative(&h, &DVector::from_row_slice(&[-1.0, -2.0]), &[true, true]).1, 0.0);
    }
}
