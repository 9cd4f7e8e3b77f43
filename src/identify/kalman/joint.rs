//! Where the search for a coupling starts: an oscillation that is off by half a period has no
//! slope towards the right one.

use super::Likelihood;
use crate::model::Model;

/// Factors of the typical value of a coupling's first parameter (stiffness) that are tried.
const STIFFNESS: [f64; 9] = [0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 4.0, 10.0];
/// Likewise of the second one (damping).
const DAMPING: [f64; 3] = [0.1, 1.0, 10.0];

impl Likelihood<'_> {
    /// Sets the free parameters of a coupling in `p` to the most likely of a grid, at the noise of
    /// the recordings alone. A model without a coupling is left as it is.
    pub fn place_joint(&self, model: &Model, p: &mut [f64]) {
        let Some(e) = model.coupling_effect() else { return };
        let noise = self.initial_noise();
        let slots: Vec<usize> = model.slots(e).collect();
        let free = |k: usize| slots.get(k).filter(|&&j| model.parameters()[j].fixed.is_none());
        let values = |k: usize, factors: &[f64]| match free(k) {
            Some(&j) => {
                let spec = &model.parameters()[j].spec;
                let bounded = |f: &f64| (f * spec.typical).clamp(spec.range.0, spec.range.1);
                factors.iter().map(bounded).map(|v| Some((j, v))).collect()
            }
            None => vec![None],
        };
        let mut best = (f64::NEG_INFINITY, p.to_vec());
        for first in values(0, &STIFFNESS) {
            for second in values(1, &DAMPING) {
                let mut trial = p.to_vec();
                for (j, value) in [first, second].into_iter().flatten() {
                    trial[j] = value;
                }
                let at = self.value(model, &trial, &noise).unwrap_or(f64::NEG_INFINITY);
                if at > best.0 {
                    best = (at, trial);
                }
            }
        }
        p.copy_from_slice(&best.1);
    }
}
