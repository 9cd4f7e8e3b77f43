//! Integration tests: one binary, because every test binary links polars again.

mod bad_input;
mod face;
mod layering;
mod recordings;
mod support;
