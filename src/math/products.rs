//! Sums of products of a few columns with many columns, in the widest registers.

use pulp::{Simd, WithSimd};

use super::lanes::{Lanes, in_lanes};

/// Rows are padded with zeros to a multiple of this length, that of the widest register.
pub(crate) const FILLED: usize = 8;
/// Number of columns that are multiplied with a row at a time.
const TOGETHER: usize = 4;

/// Adds `Σ_k columns[k][c] rows[k][b]` to `sums[c][b]`, in the order of the rows.
///
/// Row k of `columns` has `own` numbers, of which the first ones (as many as `sums` has rows) are used; row k
/// of `rows`, like row c of `sums`, has `width` numbers, a multiple of [`FILLED`].
pub(crate) fn add_products(
    (columns, own): (&[f64], usize),
    (rows, width): (&[f64], usize),
    sums: &mut [f64],
) {
    let count = sums.len() / width;
    debug_assert!(width % FILLED == 0 && sums.len() == count * width && count <= own);
    for first in (0..count).step_by(TOGETHER) {
        let last = (first + TOGETHER).min(count);
        let sums = &mut sums[first * width..last * width];
        in_lanes(Products { columns, own, first, rows, width, sums });
    }
}

/// Those of up to [`TOGETHER`] columns from `first` on.
struct Products<'a> {
    columns: &'a [f64],
    own: usize,
    first: usize,
    rows: &'a [f64],
    width: usize,
    sums: &'a mut [f64],
}

impl WithSimd for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        for b in (0..self.width).step_by(Lanes::<S>::COUNT) {
            match self.sums.len() / self.width {
                1 => self.add::<S, 1>(simd, b),
                2 => self.add::<S, 2>(simd, b),
                3 => self.add::<S, 3>(simd, b),
                _ => self.add::<S, TOGETHER>(simd, b),
            }
        }
    }
}

impl Products<'_> {
    /// Adds the products of `N` columns with one register of each row, from column `b` on.
    #[inline(always)]
    fn add<S: Simd, const N: usize>(&mut self, simd: S, b: usize) {
        let mut sums = [Lanes::splat(simd, 0.0); N];
        for c in 0..N {
            sums[c] = Lanes::load(simd, &self.sums[c * self.width + b..]);
        }
        let rows = self.rows.chunks_exact(self.width);
        for (row, columns) in rows.zip(self.columns.chunks_exact(self.own)) {
            let (row, columns) = (Lanes::load(simd, &row[b..]), &columns[self.first..][..N]);
            for c in 0..N {
                sums[c] = sums[c] + row * columns[c];
            }
        }
        for c in 0..N {
            sums[c].store(&mut self.sums[c * self.width + b..]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::lanes::every_width;
    use super::*;

    #[test]
    fn the_sums_are_those_of_plain_loops_at_every_width_of_the_registers() {
        let numbers = |n: usize| (0..n).map(|k| ((5 * k + 2) as f64).sin()).collect::<Vec<f64>>();
        let (count, width) = (37, 16);
        let rows = numbers(count * width);
        for own in 1..=6 {
            let columns = numbers(count * own);
            let mut expected = numbers(own * width);
            let mut sums = expected.clone();
            for k in 0..count {
                for c in 0..own {
                    for b in 0..width {
                        expected[c * width + b] += rows[k * width + b] * columns[k * own + c];
                    }
                }
            }
            let before = sums.clone();
            add_products((&columns, own), (&rows, width), &mut sums);
            assert_eq!(sums, expected);
            for arch in every_width() {
                let some = own.min(TOGETHER);
                let mut sums = before[..some * width].to_vec();
                let (columns, rows) = (&columns[..], &rows[..]);
                let first = 0;
                arch.dispatch(Products { columns, own, first, rows, width, sums: &mut sums });
                assert_eq!(sums, expected[..some * width]);
            }
        }
    }
}
