//! Effects added up.
