//! Identify the dynamics of a two-wheel mobile robot from its logs, see where the model fails,
//! and learn which physical effect is missing.
//!
//! The data flows one way, in six stages: a [`recording`] is measured, [`identify`] fits a
//! [`model`] (a sum of physical [`effects`]) to it, [`compare`] simulates the fit and sets it
//! against the measurement, [`diagnose`] names the effect that is missing, [`study`] holds all
//! results as plain data, and [`report`] draws them; [`export`] writes the model for other programs.

// rustdoc takes a unit in brackets, [rad], for a link
#![allow(rustdoc::broken_intra_doc_links)]

pub mod catalogue;
pub mod compare;
pub mod diagnose;
pub mod effects;
pub mod experiment;
pub mod export;
pub mod identify;
pub mod io;
pub mod math;
pub mod model;
pub mod recording;
pub mod report;
pub mod robot;
pub mod simulate;
pub mod study;

/// The examples of the guide to the library, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
struct LibraryGuide;
