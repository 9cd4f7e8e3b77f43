//! Healthy recordings with their true parameters: simulated here, or read from a folder.

use std::fs;
use std::path::Path;

use amigo_ident::experiment;
use amigo_ident::model::Model;
use amigo_ident::model::base::A4;
use amigo_ident::recording::Recording;
use amigo_ident::robot::{Robot, presets};
use amigo_ident::simulate::{Movement, NoiseLevel, Recorder, record};
use amigo_ident::study::Role;
use rayon::prelude::*;

/// Number of recordings to fit; one more is held out.
const RECORDINGS: u64 = 4;
/// Length of a recording [s].
const SECONDS: f64 = 20.0;
/// Top speed of the wheels [rad/s].
const TOP: f64 = 12.0;
/// Noise of the recorded torque as a share of the Coulomb friction of a wheel, of the speeds
/// [rad/s], of the angles [rad], for a typical robot.
const TORQUE_NOISE: f64 = 0.04;
const SPEED_NOISE: f64 = 0.05;
const ANGLE_NOISE: f64 = 1e-3;

/// A healthy robot's recordings.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) robot: String,
    pub(crate) model: Model,
    pub(crate) truth: Vec<f64>,
    pub(crate) train: Vec<Recording>,
    pub(crate) held_out: Recording,
}

/// `sets` sets of every preset, at 100 and 200 Hz in turn.
pub(crate) fn of_presets(sets: u64) -> Vec<Case> {
    let places: Vec<(usize, u64)> =
        (0..presets().len()).flat_map(|n| (0..sets).map(move |seed| (n, seed))).collect();
    places.into_par_iter().map(|(n, seed)| of_preset(n, seed)).collect()
}

fn of_preset(n: usize, seed: u64) -> Case {
    let preset = presets().swap_remove(n);
    let robot = Robot::new(preset.name, preset.construction).expect("presets are sound");
    let model = Model::base(robot);
    let truth = model.initial();
    let noise =
        NoiseLevel { dalpha: SPEED_NOISE, alpha: ANGLE_NOISE, torque: TORQUE_NOISE * truth[A4] };
    let rate = if seed.is_multiple_of(2) { 100.0 } else { 200.0 };
    let mut recordings: Vec<Recording> = (0..RECORDINGS)
        .map(|r| {
            let seed = 1000 * (n as u64 + 1) + 10 * seed + r;
            let movement = Movement::rich(model.robot(), seed, SECONDS, TOP);
            let recorder = Recorder { rate, control_rate: 1000.0, noise, ticks: None, seed };
            record("healthy", &model, &truth, &movement, &recorder).expect("the truth can move")
        })
        .collect();
    let held_out = recordings.pop().expect("four recordings");
    Case {
        name: format!("{}_{seed}", preset.name),
        robot: preset.name.into(),
        model,
        truth,
        train: recordings,
        held_out,
    }
}

/// The healthy cases of a folder of worlds.
pub(crate) fn of_folder(folder: &Path) -> Vec<Case> {
    let text = fs::read_to_string(folder.join("truth.json")).expect("truth.json");
    let truths: serde_json::Value = serde_json::from_str(&text).expect("truth.json is JSON");
    let truths = truths.as_object().expect("one entry a case");
    let only = std::env::var("ONLY").ok();
    let wanted = |name: &str| only.as_deref().is_none_or(|o| o.split(",").any(|o| o == name));
    let healthy =
        truths.iter().filter(|(n, t)| wanted(n) && t["kind"] == "none" && t["true"].is_object());
    let folder = folder.canonicalize().expect("the folder exists");
    healthy.filter_map(|(name, truth)| of_world(&folder.join(name), name, truth)).collect()
}

fn of_world(folder: &Path, name: &str, truth: &serde_json::Value) -> Option<Case> {
    let file = |name: &str| folder.join(name).display().to_string();
    let text = format!(
        "{}\n[recordings]\ntrain = [{:?}, {:?}]\nvalidation = [{:?}]\n\n[[method]]\nname = \
         \"prediction_error\"\n",
        truth["robot_toml"].as_str().unwrap_or_default(),
        file("train_1.parquet"),
        file("train_2.parquet"),
        file("validation.parquet"),
    );
    let place = tempfile::tempdir().expect("a temporary folder");
    let path = place.path().join(format!("{name}.toml"));
    fs::write(&path, text).expect("a temporary file");
    let plan = match experiment::load(&path, &[]) {
        Ok(plan) => plan,
        Err(e) => {
            println!("{name}: {e}");
            return None;
        }
    };
    let symbols = plan.model.symbols();
    Some(Case {
        name: name.into(),
        robot: truth["robot"].as_str().unwrap_or("amigobot").into(),
        truth: symbols.iter().map(|s| truth["true"][s].as_f64().unwrap_or(f64::NAN)).collect(),
        train: plan.of(Role::Train),
        held_out: plan.of(Role::Validation).pop()?,
        model: plan.model,
    })
}
