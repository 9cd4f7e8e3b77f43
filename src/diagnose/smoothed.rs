//! Recordings after the low-pass of the screening.

use std::sync::Arc;

use rayon::prelude::*;

use crate::compare::{filtered, smooth_motion};
use crate::recording::{LocalMotion, Recording};

/// A recording after the low-pass.
pub(super) struct Smooth<'a> {
    pub(super) recording: &'a Recording,
    /// Its number.
    pub(super) index: usize,
    /// Smoothed motion of every row.
    pub(super) motion: Vec<LocalMotion>,
    /// The recorded input, low-passed twice, as the torques with which it is compared [N m].
    pub(super) input: Vec<[f64; 2]>,
}

/// Low-passed recordings, computed once for all regressions.
#[derive(Clone)]
pub(super) struct Smoothed<'a> {
    /// Cut-off of the low-pass \[Hz\].
    pub(super) cutoff: f64,
    pub(super) recordings: Arc<[Smooth<'a>]>,
}

impl<'a> Smoothed<'a> {
    /// `recordings` low-passed at a cut-off frequency \[Hz\].
    #[must_use]
    pub(super) fn new(recordings: &[&'a Recording], cutoff: f64) -> Self {
        let one = |(index, recording): (usize, &&'a Recording)| {
            let motion = smooth_motion(recording, cutoff);
            let once = filtered(recording, cutoff, recording.torque());
            let input = filtered(recording, cutoff, &once);
            Smooth { recording, index, motion, input }
        };
        let recordings: Vec<Smooth> = recordings.par_iter().enumerate().map(one).collect();
        Self { cutoff, recordings: recordings.into() }
    }
}
