//! Sums of outer products, gathered in blocks so that the dense product does the work.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::math::{FILLED, add_own_products};

/// Rows gathered before they are multiplied.
const BLOCK: usize = 256;
/// Columns up to which rows are multiplied one by one in the widest registers; beyond, as matrices.
const SHORT: usize = 12;
/// Numbers of a short row in two of the widest registers.
const TWO: usize = 2 * FILLED;
/// Columns of a matrix that are multiplied with those from the first of them on: the product is symmetric, so that the
/// others are known.
const PART: usize = 32;

/// Information `H = Σ ψ ψ' / S` and score `g = Σ ψ e / S` of whitened innovations.
#[derive(Clone, Debug)]
pub struct ScoreSums {
    columns: usize,
    groups: Groups,
    /// Numbers of a gathered row: of a short one innovation and derivatives, filled up.
    width: usize,
    /// Gathered rows: derivatives, of long rows over the standard deviation of the innovation.
    rows: Vec<f64>,
    /// Of short rows the factors by which they are multiplied, of long ones the innovations over their standard
    /// deviations.
    beside: Vec<f64>,
    /// Products of short rows: of number c of a row with those before it and itself, from place `c width` on.
    sums: Vec<f64>,
    matrix: DMatrix<f64>,
    score: DVector<f64>,
    /// The score since it was last taken.
    recent: DVector<f64>,
}

/// Columns whose products are needed: the first ones with all, those of a group with each other.
#[derive(Clone, Copy, Debug)]
struct Groups {
    /// How many come first.
    first: usize,
    /// How many are in each group behind them.
    size: usize,
}

impl ScoreSums {
    /// Nothing yet, for `columns` parameters.
    #[must_use]
    pub fn new(columns: usize) -> Self {
        Self::in_groups(columns, columns, columns)
    }

    /// Nothing yet, for the information of the `first` columns with all others, and of the others within groups of
    /// `size` with each other. Products of columns of different groups may be left at zero.
    #[must_use]
    pub fn in_groups(columns: usize, first: usize, size: usize) -> Self {
        let short = columns <= SHORT;
        let width = if short { (columns + 1).next_multiple_of(FILLED) } else { columns };
        Self {
            columns,
            groups: Groups { first, size: size.max(1) },
            width,
            rows: vec![0.0; if columns > 0 { BLOCK * width } else { 0 }],
            beside: Vec::with_capacity(if columns > 0 { BLOCK } else { 0 }),
            sums: vec![0.0; if short { (columns + 1) * width } else { 0 }],
            matrix: DMatrix::zeros(columns, columns),
            score: DVector::zeros(columns),
            recent: DVector::zeros(columns),
        }
    }

    /// Where the derivatives of the next prediction are to be written, before [`ScoreSums::add`].
    pub fn next_row(&mut self) -> &mut [f64] {
        let first = if self.columns > 0 { self.beside.len() * self.width } else { 0 };
        let behind = if self.columns > 0 && self.columns <= SHORT { 1 } else { 0 };
        &mut self.rows[first + behind..][..self.columns]
    }

    /// Adds one innovation `e` of variance `s`, whose derivatives stand in [`ScoreSums::next_row`].
    pub fn add(&mut self, e: f64, s: f64) {
        if self.columns > 0 {
            self.gather(e, 1.0 / s.sqrt());
        }
    }

    /// Adds one innovation `e`, whose derivatives are `psi`, padded with zeros, and whose weight is one over its
    /// standard deviation.
    #[inline]
    pub fn add_row(&mut self, psi: &[f64], weight: f64, e: f64) {
        if self.columns == 0 {
            return;
        }
        let (first, columns) = (self.beside.len() * self.width, self.columns);
        let row = &mut self.rows[first..][..self.width];
        match (row.first_chunk_mut::<TWO>(), psi.first_chunk::<{ TWO - 1 }>()) {
            // two registers, as of the base model and its initial state, without a call
            (Some([_, row @ ..]), Some(psi)) if columns <= SHORT => *row = *psi,
            _ => self.next_row().copy_from_slice(&psi[..columns]),
        }
        self.gather(e, weight);
    }

    /// Counts the next row, of innovation `e` and this weight. Short rows are multiplied by it with the next block.
    #[inline]
    fn gather(&mut self, e: f64, weight: f64) {
        let row = &mut self.rows[self.beside.len() * self.width..][..self.width];
        if self.columns <= SHORT {
            row[0] = e;
            self.beside.push(weight);
        } else {
            row.iter_mut().for_each(|v| *v *= weight);
            self.beside.push(e * weight);
        }
        if self.beside.len() == BLOCK {
            self.flush();
        }
    }

    fn flush(&mut self) {
        let count = self.beside.len();
        if count == 0 || self.columns == 0 {
            return;
        }
        let rows = &mut self.rows[..count * self.width];
        if self.columns <= SHORT {
            add_own_products((rows, self.width), &self.beside, self.columns, &mut self.sums);
        } else {
            let rows = nalgebra::DMatrixView::from_slice(rows, self.columns, count);
            let innovations = nalgebra::DVectorView::from_slice(&self.beside, count);
            self.recent.gemv(1.0, &rows, &innovations, 1.0);
            let transposed = rows.transpose();
            let Groups { first, size } = self.groups;
            let all = self.columns;
            let mut add = |own: Range<usize>, end: usize| {
                for c in own.clone().step_by(PART) {
                    let (left, some) = (end - c, PART.min(own.end - c));
                    let mut products = self.matrix.view_mut((c, c), (left, some));
                    products.gemm(1.0, &rows.rows(c, left), &transposed.columns(c, some), 1.0);
                }
            };
            add(0..first.min(all), all);
            for start in (first..all).step_by(size) {
                let end = (start + size).min(all);
                add(start..end, end);
            }
        }
        self.beside.clear();
    }

    /// The score of what was added since it was last taken.
    pub fn take_score(&mut self) -> DVector<f64> {
        self.flush();
        if self.columns <= SHORT {
            for c in 0..self.columns {
                self.recent[c] = std::mem::take(&mut self.sums[(c + 1) * self.width]);
            }
        }
        let recent = std::mem::replace(&mut self.recent, DVector::zeros(self.columns));
        self.score += &recent;
        recent
    }

    /// Information matrix and score.
    #[must_use]
    pub fn finish(mut self) -> (DMatrix<f64>, DVector<f64>) {
        let _ = self.take_score();
        if self.columns <= SHORT {
            for c in 0..self.columns {
                let row = &self.sums[(c + 1) * self.width + 1..];
                (0..=c).for_each(|d| self.matrix[(c, d)] = row[d]);
            }
        }
        self.matrix.fill_upper_triangle_with_lower_triangle();
        (self.matrix, self.score)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_different_groups_are_left_out() {
        let (columns, first, size) = (SHORT + 20, 5, 9);
        let number = |k: usize| ((3 * k + 1) as f64).sin();
        let [mut all, mut some] =
            [ScoreSums::new(columns), ScoreSums::in_groups(columns, first, size)];
        for k in 0..700 {
            let psi: Vec<f64> = (0..columns).map(|c| number(k * columns + c)).collect();
            for sums in [&mut all, &mut some] {
                sums.next_row().copy_from_slice(&psi);
                sums.add(number(7 * k), 1.5 + number(k));
            }
        }
        let ((h, g), (of_groups, same)) = (all.finish(), some.finish());
        assert_eq!(g, same);
        let group = |c: usize| c.checked_sub(first).map(|c| c / size);
        for c in 0..columns {
            for d in 0..columns {
                let needed = c < first || d < first || group(c) == group(d);
                let expected = if needed { h[(c, d)] } else { 0.0 };
                assert!((of_groups[(c, d)] - expected).abs() < 1e-11, "{c} {d}");
            }
        }
    }

    #[test]
    fn short_and_long_rows_sum_up_alike_block_by_block() {
        let number = |k: usize| ((3 * k + 1) as f64).sin();
        for columns in [0, 1, 6, 7, SHORT, SHORT + 5, 2 * PART + 3] {
            let mut sums = ScoreSums::new(columns);
            let (mut h, mut g) = (DMatrix::zeros(columns, columns), DVector::zeros(columns));
            let mut taken = DVector::zeros(columns);
            for k in 0..1000 {
                let psi: Vec<f64> = (0..columns).map(|c| number(k * columns + c)).collect();
                let (e, s) = (number(7 * k), 1.5 + number(k));
                sums.next_row().copy_from_slice(&psi);
                sums.add(e, s);
                let psi = DVector::from(psi);
                h += &psi * psi.transpose() / s;
                g += psi * (e / s);
                if k % 300 == 299 {
                    taken += sums.take_score();
                }
            }
            let (matrix, score) = sums.clone().finish();
            taken += sums.take_score();
            let close = |a: f64, b: f64| (a - b).abs() < 1e-11 * (1.0 + b.abs());
            assert!(matrix.iter().zip(&h).all(|(a, b)| close(*a, *b)), "{columns}");
            assert!(score.iter().zip(&g).all(|(a, b)| close(*a, *b)), "{columns}");
            assert!(taken.iter().zip(&g).all(|(a, b)| close(*a, *b)), "{columns}");
        }
    }
}
