//! Runs the stages; the only room that sees all.
