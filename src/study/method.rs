//! Results of the methods of an experiment.

use super::undetermined::Undetermined;
use crate::identify::{Estimate, IdentifyError, Note, Status, Trace, Unknown, Work};
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

/// Result of a method, or the reason of its failure.
#[derive(Clone, Debug)]
pub struct MethodStudy {
    /// Name in the experiment file.
    pub name: String,
    /// Title of the method.
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
    /// Notes on the fit.
    pub notes: Vec<Note>,
    /// Curves.
    pub traces: Vec<Trace>,
    /// Performance on each recording of the experiment.
    pub performance: Vec<Performance>,
    /// The fuzzy system, if the method fits one.
    pub fuzzy: Option<FuzzyStudy>,
}

/// `first + weight second` with its standard error, in the unit of both parameters.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Combination {
    /// Symbol of the first parameter.
    pub first: String,
    /// Symbol of the second parameter.
    pub second: String,
    /// Factor of the second parameter.
    pub weight: f64,
    /// Estimate of the combination.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
}

impl MethodStudy {
    /// A method without results, with its name, title, options and wall time \[s\].
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

    /// Whether the columns do not determine the model: the descent stalled without an identifiable inertia, or no
    /// parameter of the base model is identifiable, nor a combination of the inertias (of a single axis: any
    /// combination). The simulation error of such a fit may still be small, for example with a huge inertia if a nearly
    /// constant column is used as a speed.
    #[must_use]
    pub fn is_undetermined(&self) -> bool {
        let is_open = |j: usize| self.estimates.get(j).is_some_and(|e| !e.identifiable && !e.fixed);
        let stalled = self.status == Some(Status::Stalled) && is_open(A1);
        let is_unknown =
            |j: usize| self.estimates.get(j).is_some_and(|e| !e.identifiable || e.fixed);
        let nothing = is_open(A1) && [A2, A4, A5].into_iter().all(is_unknown);
        let single_axis = self.notes.iter().any(|note| matches!(note, Note::SingleAxis(_)));
        match single_axis {
            // its a1 is the sum of both wheels
            true => nothing && self.combinations().is_empty(),
            false => (stalled || nothing) && !self.gives_inertia(),
        }
    }

    /// Why the recordings do not determine the model: its inertias may be due to the input between the rows, or the
    /// columns do not determine them.
    #[must_use]
    pub fn undetermined(&self) -> Option<Undetermined> {
        let of_columns = || self.is_undetermined().then_some(Undetermined::Columns);
        self.undetermined_between_rows().or_else(of_columns)
    }

    /// The same among `all` methods: also if the inertias of another one grew without limit and this one does not identify
    /// them either.
    #[must_use]
    pub fn undetermined_among(&self, all: &[Self]) -> Option<Undetermined> {
        let is_unbounded = |m: &Self| matches!(m.failure, Some(IdentifyError::Unbounded { .. }));
        let is_open = self.estimates.get(A1).is_some_and(|e| !e.identifiable && !e.fixed);
        let of_another = || is_open && !self.gives_inertia() && all.iter().any(is_unbounded);
        self.undetermined().or_else(|| of_another().then_some(Undetermined::Columns))
    }

    /// The uncertainty of the inertias due to the input between its rows, if it is the larger part of them.
    fn undetermined_between_rows(&self) -> Option<Undetermined> {
        self.notes.iter().find_map(|note| match note {
            &Note::BetweenRows { share, step_s, rate, .. } => {
                Some(Undetermined::BetweenRows { share, step_s, rate })
            }
            _ => None,
        })
    }

    /// Combinations of two parameters that are identifiable where neither of the two is.
    #[must_use]
    pub fn combinations(&self) -> Vec<Combination> {
        let of = |note: &Note| match note {
            Note::Unknown {
                unknown: Unknown::Two { first, second, weight, value, std_error },
                ..
            } => Some(Combination {
                first: first.clone(),
                second: second.clone(),
                weight: *weight,
                value: *value,
                std_error: *std_error,
            }),
            _ => None,
        };
        self.notes.iter().filter_map(of).collect()
    }

    /// Whether a combination of the inertias is identifiable, as on straight runs.
    fn gives_inertia(&self) -> bool {
        let inertias = [A1, A2].map(|j| self.estimates.get(j).map(|e| &e.symbol));
        let of_inertias = |c: &Combination| [Some(&c.first), Some(&c.second)] == inertias;
        self.combinations().iter().any(of_inertias)
    }
}

/// A fuzzy Takagi-Sugeno pair, sampled for figures.
#[derive(Clone, Debug)]
pub struct FuzzyStudy {
    /// Speeds at which membership functions are evaluated, per input [rad/s].
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
    use crate::identify::SingleAxis;

    #[test]
    fn a_fit_that_stalled_without_a1_determines_nothing() {
        let fit = |status, std_error| MethodStudy {
            status: Some(status),
            estimates: ["a1", "a2"]
                .map(|symbol| Estimate::new(symbol, "kg m^2".into(), 9e16, std_error))
                .into(),
            ..MethodStudy::new("output_error", "", "", 0.0)
        };
        let stalled = fit(Status::Stalled, f64::INFINITY);
        assert!(stalled.is_undetermined());
        assert!(!fit(Status::Converged, f64::INFINITY).is_undetermined());
        assert!(!fit(Status::Stalled, 1.0).is_undetermined());
        // on straight runs a1 + a2 is identifiable, and a1 is not
        let [first, second] = ["a1", "a2"].map(String::from);
        let unknown = Unknown::Two { first, second, weight: 1.0, value: 0.03, std_error: 1e-4 };
        let notes = vec![Note::Unknown { unknown, effect: "inertia".into() }];
        assert!(!MethodStudy { notes, ..stalled }.is_undetermined());
    }

    #[test]
    fn a_fit_without_a1_beside_one_that_ran_to_infinity_determines_nothing() {
        let fit = |std_error| MethodStudy {
            estimates: ["a1", "a2", "a3", "a4", "a5"]
                .map(|s| Estimate::new(s, "A".into(), 0.1, if s == "a1" { std_error } else { 1.0 }))
                .into(),
            ..MethodStudy::new("torque_regression", "", "", 0.0)
        };
        let failed = MethodStudy {
            failure: Some(IdentifyError::Unbounded {
                method: "prediction_error".into(),
                inertia: 1e24,
                unit: "A s^2/rad".into(),
                change: 1e-22,
                recorded: 3.0,
            }),
            ..MethodStudy::new("prediction_error", "", "", 0.0)
        };
        let among = |std_error| fit(std_error).undetermined_among(std::slice::from_ref(&failed));
        assert_eq!(among(f64::INFINITY), Some(Undetermined::Columns));
        assert_eq!((among(0.01), fit(f64::INFINITY).undetermined_among(&[])), (None, None));
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
        assert!(of([unknown, unknown, 1.0, unknown, unknown]).is_undetermined());
        assert!(!of([1.0, unknown, unknown, unknown, unknown]).is_undetermined());
        // a single axis, of which a2 and a3 are fixed
        let mut axis = of([unknown, 0.0, 0.0, unknown, unknown]);
        [1, 2].into_iter().for_each(|j| axis.estimates[j].fixed = true);
        assert!(axis.is_undetermined());
        axis.notes = vec![Note::SingleAxis(SingleAxis::CountedOnce)];
        assert!(axis.is_undetermined());
        let [first, second] = ["a4", "a5"].map(String::from);
        let unknown = Unknown::Two { first, second, weight: 1.0, value: 40.0, std_error: 2.0 };
        axis.notes.push(Note::Unknown { unknown, effect: "base".into() });
        assert!(!axis.is_undetermined());
        // without that note the frictions of two wheels do not determine their inertias
        axis.notes.remove(0);
        assert!(axis.is_undetermined());
    }
}
