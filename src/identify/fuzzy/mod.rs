//! What the fuzzy methods share: options, the cost with its derivatives, and how a fit is put
//! together. The methods themselves are files of the room above.

mod finish;
mod levenberg;
mod pass;
mod problem;
mod settings;

pub use finish::finish;
pub use levenberg::{Limits, continuation, levenberg_marquardt};
pub use problem::{DIVERGED, Journal, Normal, Problem};
pub use settings::{InputGain, NamedRange, Range, Settings, Start, described};

#[cfg(test)]
mod comparison;
#[cfg(test)]
mod tests;
