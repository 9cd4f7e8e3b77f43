//! Sections on full and almost empty studies.
