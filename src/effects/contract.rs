//! The contract that every registered effect keeps.
