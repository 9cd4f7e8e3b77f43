//! What the methods of an experiment found.

use super::undetermined::Undetermined;
use crate::identify::{Estimate, IdentifyError, Note, Status, Trace, Work};
use crate::model::base::{A1, A2, A4, A5};

/// A method on one recording.
#[derive(Clone, Debug, Default)]
pub struct Performance {
    /// Quality index of the free simulation per wheel [rad^2/s].
    pub ise: [f64; 2],
    /// Root mean square error over windows of 2 s [rad/s].
    pub window_rms: f64,
    /// Root mean square error of the angles of the free simulation, both wheels, without the first 20
    /// samples \[rad\]: the score of the nonlinear benchmarks (Schoukens and Noël 2017).
    pub angle_rms: f64,
    /// Quality index of the emulator in parallel structure [rad^2/s].
    pub ise_parallel: f64,
    /// Quality index of the emulator in serial-parallel structure [rad^2/s].
    pub ise_serial_parallel: f64,
    /// Wheel speeds of the free simulation [rad/s].
    pub free: Vec<[f64; 2]>,
    /// Wheel speeds over windows [rad/s].
    pub windows: Vec<[f64; 2]>,
    /// Rows at which the windows start.
    pub window_starts: Vec<usize>,
    /// States there (alpha1, alpha2, omega1, omega2).
    pub window_states: Vec<[f64; 4]>,
    /// Emulator states in parallel structure (alpha1, alpha2, omega1, omega2).
    pub emulator: Vec<[f64; 4]>,
}

/// What a method found, or why it found nothing.
#[derive(Clone, Debug)]
pub struct MethodStudy {
    /// Name in the experiment file.
    pub name: String,
    /// In words.
    pub title: String,
    /// Options that differ from the defaults, as written.
    pub options: String,
    /// Why there is no fit.
    pub failure: Option<IdentifyError>,
    /// How it ended.
    pub status: Option<Status>,
    /// Wall time \[s\].
    pub seconds: f64,
    /// Evaluations and iterations.
    pub work: Work,
    /// Estimates of the parameters, in the order of the model.
    pub estimates: Vec<Estimate>,
    /// Correlations between the parameters, row by row; empty where there are none.
    pub correlations: Vec<Vec<f64>>,
    /// What the reader of the fit must know.
    pub notes: Vec<Note>,
    /// Curves.
    pub traces: Vec<Trace>,
    /// One per recording of the experiment.
    pub performance: Vec<Performance>,
    /// The fuzzy system, where the method fits one.
    pub fuzzy: Option<FuzzyStudy>,
}

impl MethodStudy {
    /// A method of which nothing is known but what it is called and how long it took \[s\].
    #[must_use]
    pub fn new(name: &str, title: &str, options: &str, seconds: f64) -> Self {
        Self {
            name: name.into(),
            title: title.into(),
            options: options.into(),
            failure: None,
            status: None,
            seconds,
            work: Work::default(),
            estimates: vec![],
            correlations: vec![],
            notes: vec![],
            traces: vec![],
            performance: vec![],
            fuzzy: None,
        }
    }

    /// Whether the columns do not determine the model: the descent stalled, and a1 is not identifiable. Such a fit
    /// may simulate well, as one with a huge inertia does where a column that hardly moves is taken for a speed.
    #[must_use]
    pub fn is_undetermined(&self) -> bool {
        let a1 = self.estimates.get(A1);
        self.status == Some(Status::Stalled) && a1.is_some_and(|e| !e.identifiable && !e.fixed)
    }

    /// What the input between its rows leaves open of the inertias, where that is the larger part of them.
    #[must_use]
    pub fn undetermined_between_rows(&self) -> Option<Undetermined> {
        self.notes.iter().find_map(|note| match note {
            &Note::BetweenRows { share, step_s, rate, .. } => {
                Some(Undetermined::BetweenRows { share, step_s, rate })
            }
            _ => None,
        })
    }

    /// Whether none of the inertias and dry frictions of the base model is identifiable, and none was given.
    #[must_use]
    pub fn identifies_nothing(&self) -> bool {
        let of_base: Vec<_> =
            [A1, A2, A4, A5].iter().filter_map(|j| self.estimates.get(*j)).collect();
        !of_base.is_empty() && of_base.iter().all(|e| !e.identifiable && !e.fixed)
    }
}

/// A fuzzy Takagi-Sugeno pair as numbers to draw.
#[derive(Clone, Debug)]
pub struct FuzzyStudy {
    /// Speeds at which memberships are drawn, per input [rad/s].
    pub grid: [Vec<f64>; 2],
    /// Membership functions per input on that grid.
    pub memberships: [Vec<Vec<f64>>; 2],
    /// Consequents (constant part) of f31 and f41, rule i1 * count + i2.
    pub consequents: [Vec<f64>; 2],
    /// Output surfaces of f31 and f41 on the grid, row w1, column w2 [rad/s^2].
    pub surface: [Vec<Vec<f64>>; 2],
    /// The system as a function: files as name and text.
    pub functions: Vec<(String, String)>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_that_stalled_without_a1_determines_nothing() {
        let fit = |status, std_error| MethodStudy {
            status: Some(status),
            estimates: vec![Estimate::new("a1", "kg m^2".into(), 9e16, std_error)],
            ..MethodStudy::new("output_error", "", "", 0.0)
        };
        assert!(fit(Status::Stalled, f64::INFINITY).is_undetermined());
        // on runs straight ahead a1 + a2 is found, and a1 is not
        assert!(!fit(Status::Converged, f64::INFINITY).is_undetermined());
        assert!(!fit(Status::Stalled, 1.0).is_undetermined());
    }

    #[test]
    fn a_fit_of_held_parameters_identifies_nothing() {
        let of = |errors: [f64; 5]| {
            let estimate = |(n, e): (usize, &f64)| {
                Estimate::new(&format!("a{}", n + 1), "kg m^2".into(), 0.1, *e)
            };
            let estimates = errors.iter().enumerate().map(estimate).collect();
            MethodStudy { estimates, ..MethodStudy::new("prediction_error", "", "", 0.0) }
        };
        let unknown = f64::INFINITY;
        assert!(of([unknown, unknown, 1.0, unknown, unknown]).identifies_nothing());
        assert!(!of([1.0, unknown, unknown, unknown, unknown]).identifies_nothing());
    }
}
