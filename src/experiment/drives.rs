//! Motions of simulated robots that the cells of a grid share: their noise and its seed do not change the motion.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::custom::Own;
use super::file::{MovementEntry, NamedMovement, SimulationEntry};
use crate::robot::Robot;
use crate::simulate::{Drive, SimulateError};

/// Motions that are kept at most, of about 0.1 MB each.
const MOST: usize = 100;

/// The motions so far, by everything on which they depend.
#[derive(Default)]
pub(super) struct Drives(Mutex<HashMap<String, Arc<Drive>>>);

impl Drives {
    /// The motion of an experiment, simulated by `make` if no earlier cell has the same.
    ///
    /// # Errors
    /// Those of `make`.
    pub(super) fn get(
        &self,
        (entry, own, robot): (&SimulationEntry, &[Own], &Robot),
        make: impl FnOnce() -> Result<Drive, SimulateError>,
    ) -> Result<Arc<Drive>, SimulateError> {
        // a user-defined effect may differ between cells, and the seed of the noise is that of a rich movement
        let is_rich = entry.movement == MovementEntry::Named(NamedMovement::Rich);
        if is_rich || !own.is_empty() {
            return make().map(Arc::new);
        }
        let SimulationEntry { movement, hidden, truth, rate_hz, control_rate_hz, .. } = entry;
        let key =
            format!("{robot:?} {movement:?} {hidden:?} {truth:?} {rate_hz:?} {control_rate_hz:?}");
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(drive) = kept().get(&key) {
            return Ok(Arc::clone(drive));
        }
        // without the lock, so that others go on; two that simulate the same find the same
        let drive = Arc::new(make()?);
        let mut kept = kept();
        if kept.len() < MOST {
            kept.insert(key, Arc::clone(&drive));
        }
        Ok(drive)
    }
}
