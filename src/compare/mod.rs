//! Measured against simulated.
