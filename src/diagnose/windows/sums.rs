//! Sums over the rows of a window, from which gradient and curvature of the cost are made.

use nalgebra::{DMatrix, DVector};

use crate::math::descent::Quadratic;

/// Variance of a start that is known exactly.
pub(super) const TINY: f64 = 1e-300;

/// Sums of one window over its rows, wheel by wheel; what the start explains is out already.
#[derive(Clone, Debug)]
pub struct Sums {
    /// `Σ e² / s²`, e the error of a speed, s its standard deviation.
    pub square: f64,
    /// `Σ ψ e / s²`, ψ the derivative of the simulated speed.
    pub score: DVector<f64>,
    /// `Σ ψ ψ' / s²`, the curvature of half the square.
    pub information: DMatrix<f64>,
}

impl Sums {
    pub(super) fn zero(columns: usize) -> Self {
        let (score, information) = (DVector::zeros(columns), DMatrix::zeros(columns, columns));
        Self { square: 0.0, score, information }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.square += other.square;
        self.score += &other.score;
        self.information += &other.information;
    }
}

/// Cost, gradient and curvature from the sums of all windows over `columns` parameters.
pub(in crate::diagnose) fn quadratic_of(sums: &[Sums], columns: usize) -> Option<Quadratic> {
    let mut total = Sums::zero(columns);
    sums.iter().for_each(|s| total.add(s));
    let Sums { square, score, information } = total;
    let cost = 0.5 * square;
    cost.is_finite().then(|| Quadratic { cost, gradient: -score, hessian: information })
}

/// Sums over the rows of a window, with and without the constant that its start may be off by.
pub(super) struct Accumulator {
    square: f64,
    score: DVector<f64>,
    /// Lower triangle, row by row.
    information: Vec<f64>,
    constant: [Constant; 2],
}

struct Constant {
    lasts: bool,
    weights: f64,
    error: f64,
    psi: DVector<f64>,
}

impl Accumulator {
    pub(super) fn new(columns: usize) -> Self {
        let constant =
            || Constant { lasts: true, weights: 0.0, error: 0.0, psi: DVector::zeros(columns) };
        Self {
            square: 0.0,
            score: DVector::zeros(columns),
            information: vec![0.0; columns * columns],
            constant: [constant(), constant()],
        }
    }

    pub(super) fn add(&mut self, wheel: usize, e: f64, psi: &[f64], weight: f64, still: bool) {
        let constant = &mut self.constant[wheel];
        constant.lasts &= !still;
        if weight == 0.0 {
            return;
        }
        self.square += weight * e * e;
        let n = psi.len();
        for (a, row) in self.information.chunks_exact_mut(n.max(1)).enumerate() {
            let weighted = weight * psi[a];
            self.score[a] += weighted * e;
            row[..=a].iter_mut().zip(psi).for_each(|(sum, psi)| *sum += weighted * psi);
        }
        if constant.lasts {
            constant.weights += weight;
            constant.error += weight * e;
            for a in 0..n {
                constant.psi[a] += weight * psi[a];
            }
        }
    }

    /// Takes out what the start explains; `None` where a sum is not finite.
    pub(super) fn finish(mut self, variance: &[f64; 2]) -> Option<Sums> {
        let n = self.score.len();
        let mut information = DMatrix::from_row_slice(n, n, &self.information);
        for (c, v) in self.constant.iter().zip(variance) {
            let total = c.weights + 1.0 / v.max(TINY);
            self.square -= c.error * c.error / total;
            for a in 0..n {
                self.score[a] -= c.psi[a] * c.error / total;
                for b in 0..=a {
                    information[(a, b)] -= c.psi[a] * c.psi[b] / total;
                }
            }
        }
        information.fill_upper_triangle_with_lower_triangle();
        let Self { square, score, .. } = self;
        let finite = square.is_finite() && information.iter().all(|v| v.is_finite());
        finite.then_some(Sums { square, score, information })
    }
}
