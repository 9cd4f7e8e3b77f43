//! Common parts of the fuzzy methods: options, the cost with its derivatives, and the construction of a fit.
//! The methods themselves are files of the module above.

mod finish;
mod levenberg;
mod method;
mod pass;
mod piece;
mod problem;
mod rows;
mod scaled;
mod sensitivity;
mod settings;
mod side_by_side;

pub use levenberg::{Descent, Limits, Penalty, continuation, levenberg_marquardt};
pub use method::{Found, Fuzzy, Job, Search};
pub use problem::{DIVERGED, Journal, Normal, Problem};
pub use scaled::Scaled;
pub use settings::{InputGain, NamedRange, Range, Settings, Start};

#[cfg(test)]
mod comparison;
#[cfg(test)]
mod tests;
