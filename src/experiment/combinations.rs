//! The axes of a grid and the numbering of its combinations.

use std::path::PathBuf;
use std::sync::Arc;

use toml::Table;

use super::drives::Drives;
use super::file::GridAxis;
use super::source::Source;

/// The combinations of a grid.
#[derive(Clone)]
pub struct GridPlan {
    /// The axes; the last one varies fastest.
    pub axes: Vec<GridAxis>,
    /// The experiment file without its grid.
    pub(super) table: Table,
    pub(super) path: PathBuf,
    /// The recordings, if all combinations have the same.
    pub(super) source: Option<Arc<Source>>,
    /// Motions of simulated robots.
    pub(super) drives: Arc<Drives>,
}

impl GridPlan {
    /// Number of combinations.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.axes.iter().map(|axis| axis.values.len()).product()
    }

    /// The index of a cell on every axis; the last one varies fastest.
    #[must_use]
    pub fn places(&self, cell: usize) -> Vec<usize> {
        let mut rest = cell;
        let mut places: Vec<usize> = self
            .axes
            .iter()
            .rev()
            .map(|axis| {
                let place = rest % axis.values.len();
                rest /= axis.values.len();
                place
            })
            .collect();
        places.reverse();
        places
    }

    /// Description of the axes: `noise_scale (5) × seed (100)`.
    #[must_use]
    pub fn words(&self) -> String {
        let axes = self.axes.iter().map(|a| format!("{} ({})", a.name, a.values.len()));
        axes.collect::<Vec<_>>().join(" × ")
    }
}
