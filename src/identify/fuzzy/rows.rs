//! Normal equations gathered row by row.

use nalgebra::DMatrix;

/// Normal equations gathered row by row, in blocks so that the products are fast.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    /// ∫ S'S dt.
    pub(super) h: DMatrix<f64>,
    /// ∫ S'e dt, one column an error.
    pub(super) g: DMatrix<f64>,
    /// ∫ e² dt.
    pub(super) cost: f64,
    block: Vec<f64>,
    /// Whether H is wanted.
    curvature: bool,
}

/// Rows of a block.
const BLOCK: usize = 256;

impl Rows {
    /// Nothing yet; H stays zero unless `curvature`.
    pub(super) fn new(columns: usize, errors: usize, curvature: bool) -> Self {
        Self {
            h: DMatrix::zeros(columns, columns),
            g: DMatrix::zeros(columns, errors),
            cost: 0.0,
            block: Vec::with_capacity(if curvature { BLOCK * columns } else { 0 }),
            curvature,
        }
    }

    pub(super) fn columns(&self) -> usize {
        self.h.nrows()
    }

    pub(super) fn push(&mut self, row: &[f64], errors: &[f64], weight: f64) {
        for (j, e) in errors.iter().enumerate() {
            self.cost += weight * e * e;
            for (g, x) in self.g.column_mut(j).iter_mut().zip(row) {
                *g += weight * e * x;
            }
        }
        if !self.curvature {
            return;
        }
        let root = weight.sqrt();
        self.block.extend(row.iter().map(|x| root * x));
        if self.block.len() == BLOCK * self.columns() {
            self.flush();
        }
    }

    fn flush(&mut self) {
        let rows = self.block.len() / self.columns();
        if rows == 0 {
            return;
        }
        let x = DMatrix::from_column_slice(self.columns(), rows, &self.block);
        self.h.gemm(1.0, &x, &x.transpose(), 1.0);
        self.block.clear();
    }

    pub(super) fn finished(mut self) -> Self {
        self.flush();
        self
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.h += &other.h;
        self.g += &other.g;
        self.cost += other.cost;
    }
}
