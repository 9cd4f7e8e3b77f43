//! Sums of outer products, gathered in blocks so that the dense product does the work.

use nalgebra::{DMatrix, DVector};

use crate::math::{FILLED, add_products};

/// Rows gathered before they are multiplied.
const BLOCK: usize = 256;
/// Columns up to which rows are multiplied one by one in the widest registers; beyond, as matrices.
const SHORT: usize = 12;
/// Columns of a matrix that are multiplied with those from the first of them on: the product is symmetric, so that the
/// others are known.
const PART: usize = 32;

/// Information `H = Σ ψ ψ' / S` and score `g = Σ ψ e / S` of whitened innovations.
#[derive(Clone, Debug)]
pub struct ScoreSums {
    columns: usize,
    /// Numbers of a gathered row: of a short one derivatives and innovation, filled up.
    width: usize,
    /// Rows over the standard deviation of their innovation.
    rows: Vec<f64>,
    /// How many rows are gathered.
    count: usize,
    /// Products of short rows: of column c with the derivatives and the innovation from place `c width` on.
    sums: Vec<f64>,
    matrix: DMatrix<f64>,
    score: DVector<f64>,
    /// The score since it was last taken.
    recent: DVector<f64>,
}

impl ScoreSums {
    /// Nothing yet, for `columns` parameters.
    #[must_use]
    pub fn new(columns: usize) -> Self {
        let short = columns <= SHORT;
        let width = if short { (columns + 1).next_multiple_of(FILLED) } else { columns };
        Self {
            columns,
            width,
            rows: vec![0.0; if columns > 0 { BLOCK * width } else { 0 }],
            count: 0,
            sums: vec![0.0; if short { columns * width } else { 0 }],
            matrix: DMatrix::zeros(columns, columns),
            score: DVector::zeros(columns),
            recent: DVector::zeros(columns),
        }
    }

    /// Where the derivatives of the next prediction are to be written, before [`ScoreSums::add`].
    pub fn next_row(&mut self) -> &mut [f64] {
        let first = if self.columns > 0 { self.count * self.width } else { 0 };
        &mut self.rows[first..][..self.columns]
    }

    /// Adds one innovation `e` of variance `s`, whose derivatives stand in [`ScoreSums::next_row`].
    pub fn add(&mut self, e: f64, s: f64) {
        if self.columns > 0 {
            let weight = 1.0 / s.sqrt();
            let row = &mut self.rows[self.count * self.width..][..self.width];
            row.iter_mut().for_each(|v| *v *= weight);
            self.gather(e * weight);
        }
    }

    /// Adds one innovation over its standard deviation, whose derivatives are `psi` times `weight`; `psi` is padded with
    /// zeros to a multiple of eight numbers.
    #[inline]
    pub fn add_row(&mut self, psi: &[f64], weight: f64, e: f64) {
        if self.columns == 0 {
            return;
        }
        let row = &mut self.rows[self.count * self.width..][..self.width];
        let (whole, rest) = row.as_chunks_mut::<FILLED>();
        let (padded, last) = psi.as_chunks::<FILLED>();
        // of short rows whole registers, with zeros behind the columns
        for (out, psi) in whole.iter_mut().zip(padded) {
            for i in 0..FILLED {
                out[i] = weight * psi[i];
            }
        }
        let psi = padded.get(whole.len()).map_or(last, |next| &next[..]);
        rest.iter_mut().zip(psi).for_each(|(out, psi)| *out = weight * psi);
        self.gather(e);
    }

    /// Counts the next row, whose innovation over its standard deviation is `e`.
    fn gather(&mut self, e: f64) {
        let row = &mut self.rows[self.count * self.width..][..self.width];
        if self.columns <= SHORT {
            row[self.columns] = e;
        } else {
            self.recent.iter_mut().zip(&*row).for_each(|(g, v)| *g += v * e);
        }
        self.count += 1;
        if self.count == BLOCK {
            self.flush();
        }
    }

    fn flush(&mut self) {
        if self.count == 0 || self.columns == 0 {
            return;
        }
        let rows = &self.rows[..self.count * self.width];
        if self.columns <= SHORT {
            add_products((rows, self.width), (rows, self.width), &mut self.sums);
        } else {
            let rows = nalgebra::DMatrixView::from_slice(rows, self.columns, self.count);
            let columns = rows.transpose();
            for first in (0..self.columns).step_by(PART) {
                let (left, own) = (self.columns - first, PART.min(self.columns - first));
                let mut products = self.matrix.view_mut((first, first), (left, own));
                products.gemm(1.0, &rows.rows(first, left), &columns.columns(first, own), 1.0);
            }
        }
        self.count = 0;
    }

    /// The score of what was added since it was last taken.
    pub fn take_score(&mut self) -> DVector<f64> {
        self.flush();
        if self.columns <= SHORT {
            for c in 0..self.columns {
                self.recent[c] = std::mem::take(&mut self.sums[c * self.width + self.columns]);
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
                let row = &self.sums[c * self.width..];
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
