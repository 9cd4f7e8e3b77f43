//! Sums of products of a few columns with many columns, in the widest registers.

use pulp::{Simd, WithSimd};

use super::lanes::{Lanes, in_lanes};

/// Rows are padded with zeros to a multiple of this length, that of the widest register.
pub(crate) const FILLED: usize = 8;
/// Number of columns that are multiplied with a row at a time: as many sums as hide the time that each takes.
const TOGETHER: usize = 8;

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
            self.add_some(simd, b);
        }
    }
}

/// Multiplies each row by its factor, then adds `rows[k][c] rows[k][b]` to `sums[c][b]` for `1 <= c <= last` and b from
/// 0 to at least c, in the order of the rows.
///
/// A row, like row c of `sums`, has `width` numbers, a multiple of [`FILLED`].
pub(crate) fn add_own_products(
    (rows, width): (&mut [f64], usize),
    factors: &[f64],
    last: usize,
    sums: &mut [f64],
) {
    debug_assert!(width % FILLED == 0 && last < width && sums.len() == (last + 1) * width);
    in_lanes(OwnProducts { rows, width, factors, last, sums });
}

/// Those of [`add_own_products`].
struct OwnProducts<'a> {
    rows: &'a mut [f64],
    width: usize,
    factors: &'a [f64],
    last: usize,
    sums: &'a mut [f64],
}

impl WithSimd for OwnProducts<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { rows, width, factors, last, sums } = self;
        for (row, factor) in rows.chunks_exact_mut(width).zip(factors) {
            for part in row.chunks_exact_mut(Lanes::<S>::COUNT) {
                (Lanes::load(simd, part) * *factor).store(part);
            }
        }
        for b in (0..=last).step_by(Lanes::<S>::COUNT) {
            // a register is needed for the numbers from its first one on
            let (mut first, end) = (b.max(1), last + 1);
            let parts = (end - first).div_ceil(TOGETHER);
            for part in 0..parts {
                let some = (end - first).div_ceil(parts - part);
                let sums = &mut sums[first * width..(first + some) * width];
                let (columns, rows) = (&*rows, &*rows);
                Products { columns, own: width, first, rows, width, sums }.add_some(simd, b);
                first += some;
            }
        }
    }
}

impl Products<'_> {
    /// Adds the products of all columns with one register of each row, from column `b` on.
    #[inline(always)]
    fn add_some<S: Simd>(&mut self, simd: S, b: usize) {
        match self.sums.len() / self.width {
            1 => self.add::<S, 1>(simd, b),
            2 => self.add::<S, 2>(simd, b),
            3 => self.add::<S, 3>(simd, b),
            4 => self.add::<S, 4>(simd, b),
            5 => self.add::<S, 5>(simd, b),
            6 => self.add::<S, 6>(simd, b),
            7 => self.add::<S, 7>(simd, b),
            _ => self.add::<S, TOGETHER>(simd, b),
        }
    }

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

    #[test]
    fn products_of_weighted_rows_with_themselves_are_those_of_plain_loops() {
        let numbers = |n: usize| (0..n).map(|k| ((5 * k + 2) as f64).sin()).collect::<Vec<f64>>();
        let (count, width) = (37, 16);
        let (plain, factors) = (numbers(count * width), numbers(count));
        for last in 1..width {
            let before = numbers((last + 1) * width);
            for arch in every_width() {
                let (mut rows, mut sums) = (plain.clone(), before.clone());
                let (rows, factors) = (&mut rows[..], &factors[..]);
                arch.dispatch(OwnProducts { rows, width, factors, last, sums: &mut sums });
                for c in 1..=last {
                    for b in 0..=c {
                        let mut expected = before[c * width + b];
                        for k in 0..count {
                            let at = |place: usize| plain[k * width + place];
                            expected += (at(b) * factors[k]) * (at(c) * factors[k]);
                        }
                        assert_eq!(sums[c * width + b], expected, "{last} {c} {b}");
                    }
                }
            }
        }
    }
}
