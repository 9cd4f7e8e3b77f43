//! What was measured: checked once, never changed.
