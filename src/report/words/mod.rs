//! The sentences of typed results: findings, issues of the check of the recordings, and notes of a fit. The verdict
//! has its own file, since it is made from all of a diagnosis at once.

mod error_name;
mod factor;
mod finding;
mod issue;
mod name;
mod note;

pub use self::error_name::simulation_error;
pub(super) use self::error_name::simulation_error_over;
