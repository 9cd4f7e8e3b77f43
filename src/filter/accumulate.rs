//! Sums of outer products, gathered in blocks so that the dense product does the work.

use nalgebra::{DMatrix, DVector};

/// Rows gathered before they are multiplied.
const BLOCK: usize = 256;
/// Columns up to which a row is added at once: the products of a short one cost less than to gather it.
const SHORT: usize = 12;

/// Information `H = Σ ψ ψ' / S` and score `g = Σ ψ e / S` of whitened innovations.
#[derive(Clone, Debug)]
pub struct Information {
    columns: usize,
    rows: Vec<f64>,
    matrix: DMatrix<f64>,
    score: DVector<f64>,
}

impl Information {
    /// Nothing yet, for `columns` parameters.
    #[must_use]
    pub fn new(columns: usize) -> Self {
        Self {
            columns,
            rows: Vec::with_capacity(BLOCK * columns),
            matrix: DMatrix::zeros(columns, columns),
            score: DVector::zeros(columns),
        }
    }

    /// Adds one innovation `e` of variance `s` with the derivatives `psi` of its prediction.
    pub fn add(&mut self, psi: &[f64], e: f64, s: f64) {
        let scaled = e / s;
        for (g, v) in self.score.iter_mut().zip(psi) {
            *g += v * scaled;
        }
        if self.columns <= SHORT {
            self.add_lower(psi, 1.0 / s);
            return;
        }
        let weight = 1.0 / s.sqrt();
        self.rows.extend(psi.iter().map(|v| v * weight));
        if self.rows.len() >= BLOCK * self.columns {
            self.flush();
        }
    }

    /// The products of one row on and below the diagonal.
    fn add_lower(&mut self, psi: &[f64], weight: f64) {
        let columns = self.matrix.as_mut_slice().chunks_exact_mut(self.columns.max(1));
        for (j, (column, x)) in columns.zip(psi).enumerate() {
            let x = x * weight;
            for (out, y) in column[j..].iter_mut().zip(&psi[j..]) {
                *out += x * y;
            }
        }
    }

    fn flush(&mut self) {
        if self.rows.is_empty() || self.columns == 0 {
            return;
        }
        let count = self.rows.len() / self.columns;
        let rows = nalgebra::DMatrixView::from_slice(&self.rows, self.columns, count);
        self.matrix.gemm(1.0, &rows, &rows.transpose(), 1.0);
        self.rows.clear();
    }

    /// Information matrix and score.
    #[must_use]
    pub fn finish(mut self) -> (DMatrix<f64>, DVector<f64>) {
        self.flush();
        if self.columns <= SHORT {
            self.matrix.fill_upper_triangle_with_lower_triangle();
        }
        (self.matrix, self.score)
    }
}
