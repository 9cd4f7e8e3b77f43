//! Motion from a model.
