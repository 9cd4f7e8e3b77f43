//! Result of a method.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::Note;
use crate::math::MinimumStatus;
use crate::math::distribution::{normal_quantile, t_quantile};
use crate::model::Model;
use crate::simulate::{Dynamics, PhysicalDynamics};

/// One estimated parameter; never a bare number.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Estimate {
    /// As in the equations of its effect.
    pub symbol: String,
    /// Unit, for the unit of the input of the recordings.
    pub unit: String,
    /// Estimate, or the value at which the parameter was held.
    pub value: f64,
    /// Standard error; infinite where the parameter is not identifiable, zero where it is fixed.
    pub std_error: f64,
    /// Covers the true value in 95 % of repetitions where the method's assumptions hold.
    pub interval: (f64, f64),
    /// Whether the data determine the parameter.
    pub identifiable: bool,
    /// Held at its value instead of estimated.
    pub fixed: bool,
    /// Degrees of freedom of the standard error; infinite where it is not estimated from few
    /// blocks.
    #[serde(skip)]
    pub degrees: f64,
}

impl Estimate {
    /// An estimate with the normal 95 % interval, value ± 1.96 standard errors.
    #[must_use]
    pub fn new(symbol: &str, unit: String, value: f64, std_error: f64) -> Self {
        let identifiable = std_error.is_finite();
        let reach = 1.959_963_984_540_054 * std_error;
        Self {
            symbol: symbol.into(),
            unit,
            value,
            std_error,
            interval: (value - reach, value + reach),
            identifiable,
            fixed: false,
            degrees: f64::INFINITY,
        }
    }

    /// The same with the 95 % interval of Student's t with the given degrees of freedom.
    #[must_use]
    pub fn with_degrees(mut self, degrees: f64) -> Self {
        let t = if degrees.is_finite() {
            t_quantile(0.975, degrees.max(1.0))
        } else {
            normal_quantile(0.975)
        };
        let reach = t * self.std_error;
        (self.degrees, self.interval) = (degrees, (self.value - reach, self.value + reach));
        self
    }
}

/// How a method ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// At a minimum, or solved in closed form.
    Converged,
    /// Stopped by the limit of iterations.
    IterationLimit,
    /// No step lowers the cost, but the gradient is not zero.
    Stalled,
}

impl Status {
    /// Its name in `results.json` and in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::IterationLimit => "iteration_limit",
            Self::Stalled => "stalled",
        }
    }
}

impl From<MinimumStatus> for Status {
    fn from(status: MinimumStatus) -> Self {
        match status {
            MinimumStatus::Converged => Self::Converged,
            MinimumStatus::MaxIterations => Self::IterationLimit,
            MinimumStatus::Stalled | MinimumStatus::NoStart => Self::Stalled,
        }
    }
}

/// Computational work of a fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Work {
    /// Iterations of the method.
    pub iterations: usize,
    /// Passes over the data: simulations, filter runs, regressions.
    pub evaluations: usize,
}

/// Kind of the curves of a trace.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub enum TraceKind {
    /// Estimates of the parameters of these symbols, each in its own unit; one curve per symbol.
    Estimates(Vec<String>),
    /// The lowest quality index so far [rad^2/s]; one curve.
    Cost,
    /// Log-likelihood below its maximum, with all other parameters fitted; one curve.
    Profile,
}

/// Quantity on the axis of a trace.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub enum TraceAxis {
    /// Time \[s\].
    Time,
    /// Number of the evaluation.
    Evaluation,
    /// Value of a parameter.
    Parameter {
        /// As in the estimates.
        symbol: String,
        /// For the unit of the input.
        unit: String,
    },
}

/// Estimates or a cost over time, evaluations or a parameter, for drawing.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Trace {
    /// Quantity of the curves.
    pub kind: TraceKind,
    /// Quantity on the axis.
    pub axis: TraceAxis,
    /// Positions along it.
    pub at: Vec<f64>,
    /// One row per position, one value per curve.
    pub values: Vec<Vec<f64>>,
}

/// A model identified by a method.
#[derive(Clone)]
pub struct Fit {
    /// Name of the method.
    pub method: String,
    /// The identified dynamics.
    pub dynamics: Arc<dyn Dynamics>,
    /// One estimate per parameter of the physical model; empty for others.
    pub estimates: Vec<Estimate>,
    /// Covariance of all parameters (zero rows where fixed, infinite variance where the data
    /// do not identify one).
    pub covariance: Option<DMatrix<f64>>,
    /// How it ended.
    pub status: Status,
    /// Effort of the computation.
    pub work: Work,
    /// Notes for the reader: parameters that are not identifiable, active bounds, …
    pub notes: Vec<Note>,
    /// Curves for drawing.
    pub traces: Vec<Trace>,
    /// Horizon over which predictions were judged \[s\], where the method has one.
    pub horizon_s: Option<f64>,
}

impl Fit {
    /// A physical fit: `p` has one value per parameter of `model`, `covariance` is that of all of
    /// them; an infinite variance marks what is not identifiable.
    #[must_use]
    pub fn physical(
        method: &str,
        model: &Model,
        p: Vec<f64>,
        covariance: DMatrix<f64>,
        drive_unit: crate::recording::DriveUnit,
    ) -> Self {
        let estimates = model
            .parameters()
            .iter()
            .enumerate()
            .map(|(j, parameter)| {
                let fixed = parameter.fixed.is_some();
                let std_error = if fixed { 0.0 } else { covariance[(j, j)].sqrt() };
                let unit = drive_unit.of(&parameter.spec.unit);
                Estimate { fixed, ..Estimate::new(&parameter.spec.symbol, unit, p[j], std_error) }
            })
            .collect();
        Self {
            method: method.into(),
            dynamics: Arc::new(PhysicalDynamics { model: model.clone(), p }),
            estimates,
            covariance: Some(covariance),
            status: Status::Converged,
            work: Work::default(),
            notes: vec![],
            traces: vec![],
            horizon_s: None,
        }
    }

    /// The same with intervals of Student's t with the given degrees of freedom.
    #[must_use]
    pub fn with_degrees(mut self, degrees: f64) -> Self {
        let estimates = self.estimates.into_iter().map(|e| e.with_degrees(degrees));
        self.estimates = estimates.collect();
        self
    }

    /// Marks parameter `j` as not identifiable: its value stays, its variance is infinite.
    pub(super) fn set_unidentifiable(&mut self, j: usize) {
        let Estimate { symbol, unit, value, .. } = &self.estimates[j];
        self.estimates[j] = Estimate::new(symbol, unit.clone(), *value, f64::INFINITY);
        self.covariance.iter_mut().for_each(|c| c[(j, j)] = f64::INFINITY);
    }

    /// Whether the method held parameter `j` instead of estimating it.
    pub(crate) fn holds(&self, j: usize) -> bool {
        self.estimates.get(j).is_some_and(|e| e.fixed)
    }

    /// Gives parameter `j`, which the method held, the standard error of a measurement beside the fit, and adds
    /// to the variances of the others what that error changes in them.
    ///
    /// ```text
    /// C' = C + c c',   c = θ(value + std_error) - θ(value)
    /// ```
    /// `at_error` is the fit with the parameter held one standard error higher.
    pub(crate) fn set_measured(&mut self, j: usize, std_error: f64, at_error: &Self) {
        let pairs = self.estimates.iter().zip(&at_error.estimates);
        let mut change: Vec<f64> = pairs.map(|(e, other)| other.value - e.value).collect();
        change[j] = std_error;
        for (estimate, change) in self.estimates.iter_mut().zip(&change) {
            let Estimate { symbol, unit, value, .. } = &*estimate;
            let error = estimate.std_error.hypot(*change);
            if *change != 0.0 && error.is_finite() {
                *estimate = Estimate::new(symbol, unit.clone(), *value, error)
                    .with_degrees(estimate.degrees);
            }
        }
        let change = DVector::from_vec(change);
        self.covariance.iter_mut().for_each(|c| *c += &change * change.transpose());
    }

    /// The estimate of a symbol.
    #[must_use]
    pub fn estimate(&self, symbol: &str) -> Option<&Estimate> {
        self.estimates.iter().find(|e| e.symbol == symbol)
    }
}
