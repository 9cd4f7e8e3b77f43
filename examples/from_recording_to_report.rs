//! Every stage without an experiment file: recording, fit, comparison, diagnosis, verdict, report.
//!
//! `cargo run --release --example from_recording_to_report [FOLDER]` on `train_1.csv`, `train_2.csv` and
//! `validation.csv` of a folder; writes `report.html` to the present one.
#![allow(clippy::print_stdout)]

use std::path::PathBuf;

use amigo_ident::experiment::{Reading, compare, diagnose, fits, plan_of, study};
use amigo_ident::recording::DriveUnit;
use amigo_ident::report::render;
use amigo_ident::robot::Robot;
use amigo_ident::simulate::Hold;
use amigo_ident::study::Role;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).unwrap_or("recordings/simulated_3d/slope".into());
    let reading = Reading::new(Robot::amigobot(), DriveUnit::NewtonMetre);
    let read = |role, name| reading.file(role, &PathBuf::from(&folder).join(name));
    let recordings = vec![
        read(Role::Train, "train_1.csv")?,
        read(Role::Train, "train_2.csv")?,
        read(Role::Validation, "validation.csv")?,
    ];
    // the keys of an experiment file: model, methods, diagnosis
    let keys =
        toml::from_str("method = [{ name = \"prediction_error\" }]\n[diagnosis]\nmax_effects = 1")?;
    let plan = plan_of("slope", &keys, recordings, Hold::Linear)?;
    let comparison = compare(&plan, &fits(&plan))?;
    let study = study(&plan, diagnose(&plan, comparison)?)?;
    let diagnosis = study.diagnosis.as_ref().ok_or("the keys have [diagnosis]")?;
    println!("{:?}: {}", diagnosis.verdict, diagnosis.sentence);
    std::fs::write("report.html", render(&study)?.html)?;
    Ok(())
}
