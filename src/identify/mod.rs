//! One identification method per file, and the list.
//!
//! Every method takes the same [`Task`] (a model and training recordings) and returns the same
//! [`Fit`]; not converging is a status of the fit, not an error.

mod between_rows;
mod combined;
mod driving;
mod fit;
pub mod fuzzy;
mod identifiability;
mod inverse_dynamics;
mod linear_fit;
mod method;
mod note;
mod one_size;
mod open_loop;
mod profile;
mod reason;
mod regressor;
mod runaway;
mod sampling;
mod screening;
mod simulation_cost;
pub mod start;
mod streamed;
mod stretch;
mod text;
mod unexcited;
mod weak;

pub use fit::{Estimate, Fit, Status, Trace, TraceAxis, TraceKind, Work};
pub(crate) use identifiability::among_all;
pub(crate) use method::fields_as_options;
pub use method::{
    Identifier, MethodDescription, MethodOption, OptionError, Task, doc_text, from_options,
    options_schema,
};

pub use note::{Contradiction, Note, PhysicalBound, SingleAxis, Unknown};
pub(crate) use one_size::{frictionless_start, start_without_friction};
pub use profile::DROP;
pub use reason::{IdentifyError, NoStart, Unsupported};
pub use text::{details, overview};
pub use unexcited::Excited;
pub(crate) use unexcited::excited_start;

use crate::catalogue;

catalogue! {
    dyn Identifier;
    prediction_error::PredictionError,
    output_error::OutputError,
    weak_form::WeakForm,
    torque_regression::TorqueRegression,
    total_least_squares::TotalLeastSquares,
    instrumental_variable::InstrumentalVariable,
    constrained_regression::ConstrainedRegression,
    recursive_least_squares::RecursiveLeastSquares,
    fuzzy_least_squares::FuzzyLeastSquares,
    fuzzy_levenberg_marquardt::FuzzyLevenbergMarquardt,
    fuzzy_gradient::FuzzyGradient,
    fuzzy_line_search::FuzzyLineSearch,
    fuzzy_nelder_mead::FuzzyNelderMead,
    fuzzy_genetic::FuzzyGenetic,
    fuzzy_anfis::FuzzyAnfis,
}

/// The registered method of that name, with its default options.
#[must_use]
pub fn find(name: &str) -> Option<Box<dyn Identifier>> {
    all().into_iter().find(|method| method.describe().name == name)
}

#[cfg(test)]
mod contract;
