//! Why a method has no fit, as typed errors.

use clarabel::solver::SolverStatus;

use crate::filter::FilterError;
use crate::math::MathError;
use crate::model::ModelError;
use crate::recording::RowsError;
use crate::simulate::SimulateError;

/// Why a method has no fit.
#[derive(Clone, Debug, thiserror::Error)]
pub enum IdentifyError {
    /// Nothing is left after samples near rest and at ends were dropped.
    #[error("{method}: {usable} usable samples are left of {samples}: {}", moving(*moving_s))]
    TooFewSamples {
        /// Name of the method, as in experiment files.
        method: String,
        /// Left.
        usable: usize,
        /// Recorded.
        samples: usize,
        /// Longest time in which both wheels move one way, without a rest or a gap \[s\].
        moving_s: f64,
    },
    /// No finite cost at the start or anywhere near.
    #[error("{method}: no start is found from which the model can be simulated: {reason}")]
    NoStart {
        /// Name of the method, as in experiment files.
        method: String,
        /// Why the last try failed.
        reason: NoStart,
    },
    /// The method does not treat this model.
    #[error("{method}: {reason}")]
    Unsupported {
        /// Name of the method, as in experiment files.
        method: String,
        /// The limitation, and an alternative.
        reason: Unsupported,
    },
    /// Rows that were there when the recording was checked cannot be read any more.
    #[error("{method}: the rows cannot be read again: {reason}")]
    Rows {
        /// Name of the method, as in experiment files.
        method: String,
        /// Why.
        reason: RowsError,
    },
    /// The inertias grew without limit: the speeds do not answer to the input.
    #[error(
        "{method}: the fit ran to an inertia of {inertia:.1e} {unit}, with which the largest input could change the speed by \
         {change:.1e} rad/s in all recordings together, where {recorded:.3} rad/s are recorded: the input does not explain these \
         speeds. Check which columns are assigned to inputs and speeds, and whether the speeds are set-points"
    )]
    Unbounded {
        /// Name of the method, as in experiment files.
        method: String,
        /// The smaller of a1 + a2 and a1 - a2.
        inertia: f64,
        /// Unit of the inertia: kg m^2, or that of the recorded input times s^2/rad.
        unit: String,
        /// Change of speed that the largest input could cause [rad/s].
        change: f64,
        /// Largest range of a recorded speed [rad/s].
        recorded: f64,
    },
    /// Simulation failed.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The model is not one.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// How long the wheels move, in words.
fn moving(seconds: f64) -> String {
    if seconds > 0.0 {
        format!(
            "both wheels turn one way for {seconds:.2} s at most without a rest or a gap; record longer motion"
        )
    } else {
        "the wheels stand still, or never both turn; record motion of both".into()
    }
}
/// Why no start is found from which the model can be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoStart {
    /// A free simulation from the start diverges.
    #[error("the start cannot be simulated")]
    Simulation,
    /// No simulation over the windows of a diagnosis is finite.
    #[error("no start can be simulated over the windows")]
    Windows,
    /// No start has a likelihood.
    #[error("the likelihood is not finite at any start")]
    Likelihood,
    /// No prediction horizon has a likelihood.
    #[error("the likelihood is not finite at any horizon")]
    Horizon,
    /// The filter fails at the start.
    #[error(transparent)]
    Filter(#[from] FilterError),
    /// The mass matrix is not positive definite.
    #[error("a1 = {a1:.3e} does not exceed |a2| = {:.3e}", .a2.abs())]
    Mass {
        /// Value of a1 [kg m^2, or that of another input].
        a1: f64,
        /// Value of a2, likewise.
        a2: f64,
    },
    /// The emulator diverges.
    #[error("the emulator diverges from the start; raise `gain`")]
    Emulator,
    /// The derivatives of the emulator overflow.
    #[error("the sensitivities at the start are not finite")]
    Sensitivities,
    /// No rule of the emulator is excited.
    #[error("no rule is excited by the recordings")]
    Rules,
    /// The optimiser refuses, with its message.
    #[error("{0}")]
    Optimiser(String),
}

/// A limitation of a method, and an alternative.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unsupported {
    /// A regression has no column.
    #[error("the model has no free parameter that enters linearly")]
    NoLinearParameter,
    /// The least-squares problem has no solution.
    #[error(transparent)]
    LeastSquares(#[from] MathError),
    /// Errors in the columns hide the direction of least variance.
    #[error("the total least-squares problem has no unique solution; use torque_regression")]
    NoSmallestDirection,
    /// The matrix of a closed form is singular.
    #[error("the recordings do not reach all rules; set `ridge` above 0")]
    UnreachedRules,
    /// The convex program has no solution.
    #[error("no parameters satisfy the bounds ({0:?}); widen within_construction")]
    Bounds(SolverStatus),
    /// The convex program is refused, with the message of the solver.
    #[error("{0}")]
    Solver(String),
}
