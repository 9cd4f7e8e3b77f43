//! Recordings and experiment file of a case.

use std::path::{Path, PathBuf};

use amigo_ident::io::{TableColumn, write_parquet_table};
use amigo_ident::recording::Channels;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::case::{Case, Simulator};
use super::hidden::{Extent, Outside, Values, values, with_gear};
use super::logger::{Exact, record};
use super::robots::Machine;
use super::{own, second};

/// Number of recordings to fit; one more is held out.
const TRAIN: u64 = 2;
/// Length of a recording [s].
pub const DURATION: f64 = 25.0;

/// The recordings of a case.
pub struct Scenario {
    /// The robot.
    pub machine: Machine,
    /// The hidden effects of the catalogue, with their parameters.
    pub effects: Vec<(String, Values)>,
    /// The true a1..a5.
    pub truth: [f64; 5],
    recordings: Vec<(String, Channels)>,
}

impl Scenario {
    /// Simulates and records the case.
    pub fn new(case: &Case) -> Result<Self, String> {
        let machine = Machine::of(&case.robot).ok_or("no such robot")?;
        let mut rng = ChaCha8Rng::seed_from_u64(case.stream());
        // sizes are those of an ordinary motion of the healthy robot
        let plain = second::input(&machine, &vec![], None, 1.0, 0.5 * DURATION, 0);
        let extent = Extent::of(&plain);
        let mut effects: Vec<(String, Values)> = Vec::new();
        for hidden in &case.hidden {
            let own = values(hidden, case.size, &machine, &extent, &mut rng);
            if !own.is_empty() {
                effects.push((hidden.clone(), own));
            }
        }
        let all: Values = effects.iter().flat_map(|(_, own)| own.clone()).collect();
        let machine = Machine { truth: with_gear(&machine.truth, &all), ..machine };
        let robot = machine.robot();
        let mut recordings = Vec::new();
        for r in 0..=TRAIN {
            let seed = case.stream().wrapping_add(1 + r);
            let outside = Outside::of(&case.hidden, case.size, &machine, &extent, &mut rng);
            let exact: Exact = match case.simulator {
                Simulator::Own => {
                    own::input(&machine, robot.clone(), &effects, outside, DURATION, seed)?
                }
                Simulator::Second => {
                    second::input(&machine, &all, outside, extent.torque, DURATION, seed)
                }
            };
            let channels = record(&exact, case.log, &machine, case.level(), &mut rng);
            let name = if r < TRAIN { format!("train_{}", r + 1) } else { "validation".into() };
            recordings.push((name, channels));
        }
        let truth = machine.truth.parameters().to_array();
        Ok(Self { machine, effects, truth, recordings })
    }

    /// Writes the recordings as Parquet or CSV and an experiment file with a diagnosis; returns its path.
    pub fn write(&self, folder: &Path, csv: bool) -> Result<PathBuf, String> {
        self.write_asking(folder, csv, "[diagnosis]\ncandidates = \"all\"\n")
    }

    /// Writes the recordings and an experiment file whose model contains the hidden effects; returns its path.
    pub fn write_given(&self, folder: &Path) -> Result<PathBuf, String> {
        let ids: Vec<&str> = self.effects.iter().map(|(id, _)| id.as_str()).collect();
        self.write_asking(folder, false, &format!("[model]\neffects = {ids:?}\n"))
    }

    fn write_asking(&self, folder: &Path, csv: bool, asked: &str) -> Result<PathBuf, String> {
        let words = |e: std::io::Error| format!("{}: {e}", folder.display());
        std::fs::create_dir_all(folder).map_err(words)?;
        let ending = if csv { "csv" } else { "parquet" };
        let file = |name: &str| format!("{name}.{ending}");
        for (name, channels) in &self.recordings {
            let path = folder.join(file(name));
            let columns = columns(channels);
            let bytes = match csv {
                true => text(&columns).into_bytes(),
                false => write_parquet_table(&path, &columns).map_err(|e| e.to_string())?,
            };
            std::fs::write(&path, bytes).map_err(words)?;
        }
        let toml = folder.join("experiment.toml");
        let names: Vec<String> =
            self.recordings.iter().map(|(name, _)| format!("\"{}\"", file(name))).collect();
        let (held_out, train) = names.split_last().expect("three recordings");
        let robot = toml::to_string(&self.machine.known).map_err(|e| e.to_string())?;
        let text = format!(
            "[robot]\n{robot}\n[recordings]\ntrain = [{}]\nvalidation = [{held_out}]\n\n\
             [[method]]\nname = \"prediction_error\"\n\n{asked}",
            train.join(", ")
        );
        std::fs::write(&toml, text).map_err(words)?;
        Ok(toml)
    }
}

fn columns(channels: &Channels) -> Vec<TableColumn> {
    let mut out = vec![TableColumn::Number("t".into(), channels.t.clone())];
    let mut pair = |name: &str, rows: &[[f64; 2]]| {
        for i in 0..2 {
            let values = rows.iter().map(|row| row[i]).collect();
            out.push(TableColumn::Number(format!("{name}{}", i + 1), values));
        }
    };
    channels.alpha.iter().for_each(|rows| pair("alpha", rows));
    channels.omega.iter().for_each(|rows| pair("dalpha", rows));
    pair("M", &channels.torque);
    out
}

/// Columns of numbers as CSV.
fn text(columns: &[TableColumn]) -> String {
    let numbers: Vec<(&String, &Vec<f64>)> = columns
        .iter()
        .filter_map(|c| match c {
            TableColumn::Number(name, values) => Some((name, values)),
            TableColumn::Text(..) => None,
        })
        .collect();
    let names: Vec<&str> = numbers.iter().map(|(name, _)| name.as_str()).collect();
    let rows = numbers.first().map_or(0, |(_, values)| values.len());
    let mut out = names.join(",") + "\n";
    for k in 0..rows {
        let cells: Vec<String> = numbers.iter().map(|(_, values)| values[k].to_string()).collect();
        out += &(cells.join(",") + "\n");
    }
    out
}
