//! Integration tests: one binary, because every test binary links polars again.

mod layering;
