//! From a synthetic recording to the effect that the model lacks, without any file.
//!
//! ```sh
//! cargo run --release --example find_the_missing_effect -- turning_scrub
//! ```
//!
//! The argument is the effect that the simulated robot has and the fitted model does not; the
//! catalogue: `experiment effects`.

#![allow(clippy::print_stdout)]

use amigo_ident::diagnose::{Data, Settings, diagnose};
use amigo_ident::identify::{Task, start};
use amigo_ident::model::Model;
use amigo_ident::report::sentence;
use amigo_ident::robot::Robot;
use amigo_ident::simulate::{Hold, Movement, NoiseLevel, Recorder, record};
use amigo_ident::verdict::{Basis, verdict};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let hidden = std::env::args().nth(1).unwrap_or_else(|| "turning_scrub".into());
    let robot = Model::with_effects(Robot::amigobot(), &[&hidden])?;
    let noise = NoiseLevel { dalpha: 0.02, alpha: 5e-4, torque: 0.002 };
    let mut recordings = Vec::new();
    for seed in 1..=3 {
        let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed };
        let movement = Movement::rich(robot.robot(), seed, 25.0, 12.0);
        recordings.push(record("synthetic", &robot, &robot.initial(), &movement, &recorder)?);
    }
    let (train, validation) = recordings.split_at(2);

    let model = Model::base(Robot::amigobot());
    let task = Task { model: &model, train, hold: Hold::Linear, seed: 0 };
    let starts = [start::start(&task, "find_the_missing_effect")?];
    let data = Data { train, validation, hold: Hold::Linear, corrected_s: 0.0 };
    let diagnosis = diagnose(&model, &starts, &data, &Settings::default())?;
    println!("hidden: {hidden}; found: {:?}", diagnosis.found());
    let said = verdict(&diagnosis, &Basis::new(train, validation, Hold::Linear))?;
    println!("{}", sentence(&said));
    for ranked in diagnosis.ranking.iter().take(5) {
        println!("  {:<24} ΔBIC {:8.1}", ranked.candidate.id, -ranked.bic);
    }
    Ok(())
}
