//! Sums over the rows of a window for gradient and curvature of the cost.

use nalgebra::{DMatrix, DVector};

use super::window::Window;
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

/// Sums over the rows of a window, with and without what an error of its initial speeds explains: the rows of each
/// wheel, which are multiplied at once.
pub(super) struct Accumulator {
    columns: usize,
    width: usize,
    wheels: [Gathered; 2],
}

/// The rows of a wheel.
struct Gathered {
    rests: bool,
    /// Derivatives, error, and response of the speed to the initial speeds, filled up to `width` numbers.
    rows: Vec<f64>,
    /// One over the variance of each row.
    weight: Vec<f64>,
}

impl Accumulator {
    /// For up to `rows` rows.
    pub(super) fn new(columns: usize, rows: usize) -> Self {
        let width = (columns + 3).next_multiple_of(FILLED);
        let wheel = || Gathered {
            rests: false,
            rows: Vec::with_capacity(rows * width),
            weight: Vec::with_capacity(rows),
        };
        Self { columns, width, wheels: [wheel(), wheel()] }
    }

    /// Adds row `k` of a window.
    pub(super) fn add(
        &mut self,
        (window, k, wheel): (&Window, usize, usize),
        e: f64,
        psi: &[f64],
        weight: f64,
        still: bool,
    ) {
        let gathered = &mut self.wheels[wheel];
        gathered.rests |= still;
        if weight == 0.0 {
            return;
        }
        let first = gathered.rows.len();
        gathered.rows.resize(first + self.width, 0.0);
        let row = &mut gathered.rows[first..];
        row[..self.columns].copy_from_slice(psi);
        row[self.columns] = e;
        gathered.weight.push(weight);
        let [right, left] = window.response(k, wheel, gathered.rests);
        (row[self.columns + 1], row[self.columns + 2]) = (right, left);
    }

    /// Removes the part that the start explains, whose speeds have this variance; `None` if a sum is not finite.
    pub(super) fn finish(self, variance: &[f64; 2]) -> Option<Sums> {
        let Self { columns, width, wheels } = self;
        let mut out = Sums::zero(columns);
        let (mut products, mut weighted) = (vec![0.0; (columns + 3) * width], Vec::new());
        for wheel in &wheels {
            weighted.clear();
            weighted.extend_from_slice(&wheel.rows);
            for (row, weight) in weighted.chunks_exact_mut(width).zip(&wheel.weight) {
                row.iter_mut().for_each(|value| *value *= weight);
            }
            add_products((&weighted, width), (&wheel.rows, width), &mut products);
        }
        let row = |a: usize| &products[a * width..][..width];
        let starts = columns + 1;
        let start = Start::new(|i, j| row(starts + i)[starts + j], variance);
        let by_start = |a: usize| [row(a)[starts], row(a)[starts + 1]];
        let left = |a: usize, b: usize| row(a)[b] - start.explains(by_start(a), by_start(b));
        out.square = left(columns, columns);
        for a in 0..columns {
            out.score[a] = left(a, columns);
            (0..=a).for_each(|b| out.information[(a, b)] = left(a, b));
        }
        out.information.fill_upper_triangle_with_lower_triangle();
        let finite = out.square.is_finite() && out.information.iter().all(|v| v.is_finite());
        finite.then_some(out)
    }
}

/// What an error of the initial speeds of a window explains of products of its rows.
///
/// ```text
/// x' W y - x' W S (S' W S + V⁻¹)⁻¹ S' W y
/// ```
/// S: response of the speeds to their initial values, V: variance of these.
pub(super) struct Start {
    /// (S' W S + V⁻¹)⁻¹, symmetric: 00, 01, 11.
    inverse: [f64; 3],
}

impl Start {
    /// `products(i, j)`: S' W S; a start of variance zero is known exactly.
    pub(super) fn new(products: impl Fn(usize, usize) -> f64, variance: &[f64; 2]) -> Self {
        let [a, c] = [0, 1].map(|i| products(i, i) + 1.0 / variance[i].max(TINY));
        let b = products(0, 1);
        // without a common response the wheels stay exact where one is known and the other is not
        let inverse = if b == 0.0 {
            [1.0 / a, 0.0, 1.0 / c]
        } else {
            let determinant = a * c - b * b;
            [c / determinant, -b / determinant, a / determinant]
        };
        Self { inverse }
    }

    /// Of the product of two columns, from theirs with S.
    pub(super) fn explains(&self, x: [f64; 2], y: [f64; 2]) -> f64 {
        let [a, b, c] = self.inverse;
        x[0] * (a * y[0] + b * y[1]) + x[1] * (b * y[0] + c * y[1])
    }
}
