//! The sentences of typed results: of findings, of what the check of the recordings noticed, and of the notes of a fit.
//! The verdict has its own file, since it is made from all of a diagnosis at once.

mod finding;
mod issue;
mod name;
mod note;
