//! Sums of passes over many recordings.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::pass::{Columns, NoColumns, Pass, PassSettings, filter_pass};
use super::{Likelihood, ProcessNoise};
use crate::model::{Model, ModelError};

/// Passes kept in memory at a time if only their sum is needed.
const HELD: usize = 64;

impl Likelihood<'_> {
    /// Information and score of parameters and columns, summed over all recordings.
    ///
    /// Of a pass with many columns only these two are large, and only a few passes are held at a
    /// time, so that thousands of recordings take no more memory than a few.
    ///
    /// # Errors
    /// If the mass matrix is not positive definite.
    pub fn totals(
        &self,
        model: &Model,
        p: &[f64],
        noise: &ProcessNoise,
        columns: &[&dyn Columns],
    ) -> Result<(DMatrix<f64>, DVector<f64>), ModelError> {
        let settings = self.settings(noise, true);
        let mut total: Option<(DMatrix<f64>, DVector<f64>)> = None;
        for start in (0..self.prepared.len()).step_by(HELD) {
            let end = (start + HELD).min(self.prepared.len());
            let passes: Vec<Pass> = (start..end)
                .into_par_iter()
                .map(|r| self.pass(r, model, p, &settings, columns))
                .collect::<Result<_, _>>()?;
            // in the order of the recordings, so that the sums do not depend on threads
            for pass in passes {
                match &mut total {
                    None => total = Some((pass.information, pass.score)),
                    Some((information, score)) => {
                        *information += pass.information;
                        *score += pass.score;
                    }
                }
            }
        }
        Ok(total.unwrap_or_else(|| (DMatrix::zeros(0, 0), DVector::zeros(0))))
    }

    /// A pass over one recording.
    pub(super) fn pass(
        &self,
        r: usize,
        model: &Model,
        p: &[f64],
        settings: &PassSettings,
        columns: &[&dyn Columns],
    ) -> Result<Pass, ModelError> {
        let none: &dyn Columns = &NoColumns;
        let columns = columns.get(r).copied().unwrap_or(none);
        filter_pass(model, p, &self.prepared[r], settings, columns)
    }
}
