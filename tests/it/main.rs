//! Integration tests: one binary, because every test binary links polars again.

#![allow(clippy::print_stdout)]

mod bad_experiment;
mod bad_recording;
mod conditioning;
mod console_logs;
mod dead_time;
mod docs;
mod export;
mod exported;
mod face;
mod first_contact;
mod formats;
mod fuzz;
mod grades;
mod hidden_effects;
mod imports;
mod index;
mod kept;
mod language;
mod layering;
mod log_headers;
mod log_styles;
mod log_styles_rows;
mod long;
mod modelica;
mod next_step;
mod page;
mod prose;
mod quoted;
mod recordings;
mod robot_logs;
mod shards;
mod stated_logs;
mod stray_logs;
mod support;
mod versions;
