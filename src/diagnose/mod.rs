//! Which effect is missing.
