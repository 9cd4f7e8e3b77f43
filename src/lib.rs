//! Identify the dynamics of a two-wheel mobile robot from its logs, see where the model fails,
//! and learn which physical effect is missing.
//!
//! The data flows one way: a [`recording`] is measured, [`identify`] fits a [`model`] (a sum of
//! physical [`effects`]) to it, [`compare`] simulates the fitted model and compares it with the
//! measurement, [`diagnose`] names the effect that is missing, [`study`] holds all results as plain
//! data, and [`report`] renders them; [`export`] writes the model for other programs.
//!
//! All quantities are in SI units; wheel 1 is the right one.
//!
//! # Example
//!
//! A robot is simulated whose tyres resist turning, which the model lacks: the fit leaves an
//! error above the noise floor, and the diagnosis names the effect.
//!
//! ```
//! use amigo_ident::compare::{noise_floor, simulate_recording, window_rms};
//! use amigo_ident::diagnose::{Data, Settings, diagnose};
//! use amigo_ident::identify::{Identifier, PredictionError, Task, start::start};
//! use amigo_ident::simulate::{Hold, Movement, NoiseLevel, Recorder, record};
//! use amigo_ident::{model::Model, robot::Robot};
//!
//! // a recording; one of your own: io::read_recording
//! let robot = Model::with_effects(Robot::amigobot(), &["turning_scrub"])?;
//! let noise = NoiseLevel { dalpha: 0.02, alpha: 5e-4, torque: 0.002 };
//! let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed: 1 };
//! let movement = Movement::rich(robot.robot(), 1, 25.0, 12.0);
//! let train = [record("synthetic", &robot, &robot.initial(), &movement, &recorder)?];
//!
//! // fit
//! let model = Model::base(Robot::amigobot());
//! let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 0 };
//! let fit = PredictionError::default().identify(&task)?;
//!
//! // compare: RMSE of 2 s simulations, and the noise floor [rad/s]
//! let simulated = simulate_recording(&*fit.dynamics, &train[0], Hold::Linear)?;
//! let floor = noise_floor(&*fit.dynamics, &train[0], Hold::Linear, 0)?.window_rms;
//! assert!(window_rms(&train[0], &simulated.windows) > 1.5 * floor);
//!
//! // diagnose
//! let data = Data { train: &train, validation: &[], hold: Hold::Linear, corrected_s: 0.0 };
//! let settings = Settings { max_effects: 1, ..Settings::default() };
//! let diagnosis = diagnose(&model, &[start(&task, "example")?], &data, &settings)?;
//! assert_eq!(diagnosis.found(), ["turning_scrub"]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod catalogue;
pub mod compare;
pub mod conditioning;
pub mod diagnose;
pub mod effects;
pub mod experiment;
pub mod export;
pub mod filter;
pub mod identify;
pub mod io;
pub mod math;
pub mod model;
pub mod recording;
pub mod report;
pub mod robot;
pub mod simulate;
pub mod study;
pub mod verdict;

/// The examples of the guide to the library, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
struct LibraryGuide;
