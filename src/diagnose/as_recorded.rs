//! A model fitted to recordings as they are, with which every account of the logger is compared.

use std::sync::OnceLock;

use rayon::prelude::*;

use super::fit::{WindowFit, fit};
use super::rivals::{Bodies, rivals};
use super::scale::scale_of;
use super::timing::{Timed, timed, with_timing};
use crate::effects::Scale;
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::Hold;

/// A model near `p` and the recordings to which it is fitted, along with the time of their input. The fits are computed
/// on first use, and shared by the accounts ([`super::more_likely_logging`], [`super::speed_filter`]).
pub struct AsRecorded<'a> {
    pub(super) model: Model,
    pub(super) p: Vec<f64>,
    pub(super) recordings: &'a [&'a Recording],
    /// The input between the rows, as the experiment file describes it.
    pub(super) hold: Hold,
    pub(super) scale: Scale,
    fit: OnceLock<Option<Timed<'a>>>,
    rivals: OnceLock<Vec<Rival>>,
    second_bodies: OnceLock<Vec<Rival>>,
}

/// A model with an effect more, fitted to the same windows.
pub(super) struct Rival {
    pub(super) model: Model,
    /// The fit, with the time of the input behind the parameters of the model.
    pub(super) fit: WindowFit,
}

impl Rival {
    /// Parameters of its model.
    pub(super) fn p(&self) -> &[f64] {
        &self.fit.p[..self.model.parameters().len()]
    }
}

impl<'a> AsRecorded<'a> {
    /// A model near `p` for recordings with their input as in `hold`.
    #[must_use]
    pub fn new(model: &Model, p: &[f64], recordings: &'a [&'a Recording], hold: Hold) -> Self {
        let scale = scale_of(model, p, recordings);
        Self::with_scale(model, p, (recordings, hold), scale)
    }

    /// The same recordings with another model, at the same scale.
    pub(super) fn with_model(&self, model: &Model, p: &[f64]) -> Self {
        Self::with_scale(model, p, (self.recordings, self.hold), self.scale.clone())
    }

    fn with_scale(
        model: &Model,
        p: &[f64],
        (recordings, hold): (&'a [&'a Recording], Hold),
        scale: Scale,
    ) -> Self {
        Self {
            model: model.clone(),
            p: p.to_vec(),
            recordings,
            hold,
            scale,
            fit: OnceLock::new(),
            rivals: OnceLock::new(),
            second_bodies: OnceLock::new(),
        }
    }

    /// The fit of the model; `None` where it cannot follow the motion.
    pub(super) fn fit(&self) -> Option<&Timed<'a>> {
        let Self { model, p, recordings, hold, scale, .. } = self;
        self.fit.get_or_init(|| timed(model, p, 0.0, recordings, *hold, scale)).as_ref()
    }

    /// Parameters of the model by its fit.
    pub(super) fn fitted(&self) -> Option<&[f64]> {
        self.fit().map(|timed| &timed.fit.p[..self.p.len()])
    }

    /// The model with each effect of [`rivals`] but a second body, fitted from its fit without one.
    pub(super) fn rivals(&self) -> &[Rival] {
        self.rivals.get_or_init(|| self.fitted_rivals(Bodies::One))
    }

    /// The model with each second body.
    pub(super) fn second_bodies(&self) -> &[Rival] {
        self.second_bodies.get_or_init(|| self.fitted_rivals(Bodies::Two))
    }

    fn fitted_rivals(&self, bodies: Bodies) -> Vec<Rival> {
        let Some((plain, p)) = self.fit().zip(self.fitted()) else { return vec![] };
        let fitted = |(model, p): (Model, Vec<f64>)| {
            let timed = with_timing(&model, self.hold, &self.scale)?;
            let start: Vec<f64> = p.into_iter().chain([plain.time_s()]).collect();
            let fit = fit(&plain.windows, &timed, &start, &self.scale)?;
            Some(Rival { model, fit })
        };
        rivals(&self.model, p, &self.scale, bodies).into_par_iter().filter_map(fitted).collect()
    }
}
