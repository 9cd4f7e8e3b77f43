//! Robots with hidden effects: cases that are determined by their id, simulated by the program's own simulator and by a
//! second one that shares no code with it, and the outcome of the diagnosis. The benchmark runs all of them
//! (`benches/hidden_effects`), the tests a few (`tests/it/hidden_effects.rs`).

pub mod case;
pub mod hidden;
pub mod judge;
pub mod logger;
pub mod mechanics;
pub mod own;
pub mod robots;
pub mod scenario;
pub mod second;
