//! Sums over the rows of a window for gradient and curvature of the cost.

use nalgebra::{DMatrix, DVector};

use crate::math::descent::Quadratic;
use crate::math::{FILLED, add_products};

/// Variance of a start that is known exactly.
pub(super) const TINY: f64 = 1e-300;

/// Sums of one window over its rows, for each wheel, without the part that the start explains.
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
    cost.is_finite().then(|| Quadratic {
        cost,
        gradient: -score,
        hessian: information,
        scatter: 0.0,
    })
}

/// Sums over the rows of a window, with and without the constant by which its initial speed may be wrong: the rows of
/// each wheel, which are multiplied at once.
pub(super) struct Accumulator {
    columns: usize,
    width: usize,
    wheels: [Gathered; 2],
}

/// The rows of a wheel.
struct Gathered {
    lasts: bool,
    /// Derivatives, error, and one while the constant lasts, filled up to `width` numbers.
    rows: Vec<f64>,
    /// One over the variance of each row.
    weight: Vec<f64>,
    /// Sum of the weights while the constant lasts.
    weights: f64,
}

impl Accumulator {
    /// For up to `rows` rows.
    pub(super) fn new(columns: usize, rows: usize) -> Self {
        let width = (columns + 2).next_multiple_of(FILLED);
        let wheel = || Gathered {
            lasts: true,
            rows: Vec::with_capacity(rows * width),
            weight: Vec::with_capacity(rows),
            weights: 0.0,
        };
        Self { columns, width, wheels: [wheel(), wheel()] }
    }

    pub(super) fn add(&mut self, wheel: usize, e: f64, psi: &[f64], weight: f64, still: bool) {
        let wheel = &mut self.wheels[wheel];
        wheel.lasts &= !still;
        if weight == 0.0 {
            return;
        }
        let first = wheel.rows.len();
        wheel.rows.resize(first + self.width, 0.0);
        let row = &mut wheel.rows[first..];
        row[..self.columns].copy_from_slice(psi);
        row[self.columns] = e;
        wheel.weight.push(weight);
        if wheel.lasts {
            row[self.columns + 1] = 1.0;
            wheel.weights += weight;
        }
    }

    /// Removes the part that the start explains; `None` if a sum is not finite.
    pub(super) fn finish(self, variance: &[f64; 2]) -> Option<Sums> {
        let Self { columns, width, wheels } = self;
        let mut out = Sums::zero(columns);
        let (mut products, mut weighted) = (vec![0.0; (columns + 1) * width], Vec::new());
        for (wheel, v) in wheels.iter().zip(variance) {
            products.fill(0.0);
            weighted.clear();
            weighted.extend_from_slice(&wheel.rows);
            for (row, weight) in weighted.chunks_exact_mut(width).zip(&wheel.weight) {
                row.iter_mut().for_each(|value| *value *= weight);
            }
            add_products((&weighted, width), (&wheel.rows, width), &mut products);
            let total = wheel.weights + 1.0 / v.max(TINY);
            let row = |a: usize| &products[a * width..][..width];
            // what the constant of the window explains
            let constant = |a: usize| row(a)[columns + 1];
            let left = |a: usize, b: usize| row(a)[b] - constant(a) * constant(b) / total;
            out.square += left(columns, columns);
            for a in 0..columns {
                out.score[a] += left(a, columns);
                (0..=a).for_each(|b| out.information[(a, b)] += left(a, b));
            }
        }
        out.information.fill_upper_triangle_with_lower_triangle();
        let finite = out.square.is_finite() && out.information.iter().all(|v| v.is_finite());
        finite.then_some(out)
    }
}
