//! Every stage without an experiment file: recording, fit, comparison, diagnosis, verdict, report.
//!
//! `cargo run --release --example from_recording_to_report [FOLDER]` on `train_1.csv`, `train_2.csv` and
//! `validation.csv` of a folder; writes `report.html` to the current folder.
#![allow(clippy::print_stdout)]

use std::path::Path;

use amigo_ident::diagnose::Settings;
use amigo_ident::experiment::{
    MethodPlan, Plan, PlanOptions, Reading, compare, diagnose, fits, study,
};
use amigo_ident::identify::PredictionError;
use amigo_ident::model::Model;
use amigo_ident::recording::DriveUnit;
use amigo_ident::report::{render, sentence};
use amigo_ident::robot::Robot;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).unwrap_or("recordings/simulated_3d/slope".into());
    let file = |name: &str| Path::new(&folder).join(name);
    let reading = Reading::new(Robot::amigobot(), DriveUnit::NewtonMetre);
    let train = [file("train_1.csv"), file("train_2.csv")];
    let recordings = reading.files(&train, &[file("validation.csv")])?;
    let options = PlanOptions {
        methods: vec![MethodPlan::new(PredictionError::default())],
        diagnosis: Some(Settings { max_effects: 1, ..Settings::default() }.into()),
        ..PlanOptions::default()
    };
    let plan = Plan::new("slope", Model::base(Robot::amigobot()), recordings, options)?;
    let comparison = compare(&plan, &fits(&plan))?;
    let study = study(&plan, diagnose(&plan, comparison)?)?;
    let diagnosis = study.diagnosis.as_ref().ok_or("the options ask for a diagnosis")?;
    println!("{:?}: {}", diagnosis.verdict, sentence(diagnosis));
    std::fs::write("report.html", render(&study)?.html)?;
    Ok(())
}
