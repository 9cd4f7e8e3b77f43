//! Consequents in coordinates in which the index curves alike in all directions.

use nalgebra::{DMatrix, DVector};

/// Consequents about a start, of which some are free; `L` is a Cholesky factor of the curvature over these.
///
/// ```text
/// theta = start + L'⁻¹ z
/// ```
pub struct Scaled {
    /// Where z is zero.
    pub start: DVector<f64>,
    /// The consequents that are free.
    pub free: Vec<usize>,
    /// L.
    pub factor: DMatrix<f64>,
}

impl Scaled {
    /// The consequents at z, one entry of which belongs to each that is free.
    #[must_use]
    pub fn theta(&self, z: &DVector<f64>) -> DVector<f64> {
        let mut step = z.clone();
        self.factor.tr_solve_lower_triangular_mut(&mut step);
        let mut theta = self.start.clone();
        self.free.iter().zip(step.iter()).for_each(|(&j, step)| theta[j] += step);
        theta
    }
}
