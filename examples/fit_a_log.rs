//! Fit the base model to one or more logs and print the parameters with their 95 % intervals.
//!
//! ```sh
//! cargo run --release --example fit_a_log -- recordings/simulated_3d/slope/train_1.csv
//! ```
//!
//! Columns as in docs/files.md: t [s], alpha1, alpha2 [rad], dalpha1, dalpha2 [rad/s], M1, M2 [N m].

#![allow(clippy::print_stdout)]

use amigo_ident::identify::{Identifier, PredictionError, Task};
use amigo_ident::io::{ColumnMap, read_recording};
use amigo_ident::model::Model;
use amigo_ident::recording::DriveUnit;
use amigo_ident::robot::Robot;
use amigo_ident::simulate::Hold;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut train = Vec::new();
    for path in std::env::args().skip(1) {
        let (recording, _) =
            read_recording(path.as_ref(), &ColumnMap::default(), DriveUnit::NewtonMetre)?;
        train.push(recording);
    }
    if train.is_empty() {
        return Err("give one or more recordings: fit_a_log RUN.csv...".into());
    }
    let model = Model::base(Robot::amigobot());
    let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 0 };
    let fit = PredictionError::default().identify(&task)?;
    for e in &fit.estimates {
        let (low, high) = e.interval;
        println!("{:<4} {:>12.6}  [{low:.6}, {high:.6}] {}", e.symbol, e.value, e.unit);
    }
    for note in &fit.notes {
        println!("{note}");
    }
    Ok(())
}
