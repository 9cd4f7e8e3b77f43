//! Grids: keys, order, failures, repetition and resumption.

use std::fs;
use std::path::PathBuf;

use crate::experiment::{Outcome, Plan, RunOptions, execute, load};
use crate::io::{TableColumn, read_parquet_table};

/// Short recordings and a closed-form method: a cell takes some ten milliseconds.
const FILE: &str = r#"
[simulation]
noise = { dalpha = 0.05, alpha = 0.001, M = 0.005 }
train = 1
validation = 0
duration_s = 4.0
[[method]]
name = "torque_regression"
"#;

struct Folder(tempfile::TempDir);

impl Folder {
    fn with(grid: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("g.toml"), format!("{FILE}[grid]\n{grid}")).unwrap();
        Self(folder)
    }

    fn load(&self) -> Result<Plan, String> {
        load(&self.0.path().join("g.toml"), &[]).map_err(|e| e.to_string())
    }

    fn run(&self, resume: bool) -> Outcome {
        let out = self.0.path().to_path_buf();
        let options = RunOptions { out, set: vec![], resume, shard: None, progress: false };
        execute(self.load().unwrap(), &options)
    }

    fn journal(&self) -> PathBuf {
        self.0.path().join("g/grid.journal.jsonl")
    }

    /// The table without wall times, numbers bit for bit.
    fn table(&self) -> Vec<(String, Vec<String>)> {
        let columns = read_parquet_table(&self.0.path().join("g/estimates.parquet")).unwrap();
        let columns = columns.into_iter().map(|column| match column {
            TableColumn::Number(name, values) => {
                (name, values.iter().map(|v| format!("{:x}", v.to_bits())).collect())
            }
            TableColumn::Text(name, values) => (name, values),
        });
        columns.filter(|(name, _)| name != "seconds").collect()
    }

    fn text(&self, name: &str) -> Vec<String> {
        self.table().into_iter().find(|(n, _)| n == name).unwrap().1
    }

    fn results(&self) -> serde_json::Value {
        let text = fs::read_to_string(self.0.path().join("g/results.json")).unwrap();
        serde_json::from_str(&text).unwrap()
    }
}

#[test]
fn a_wrong_key_of_another_table_is_named_with_what_was_meant() {
    let e = Folder::with("\"model.efects\" = [[]]").load().err().unwrap();
    assert!(e.contains("grid.model.efects") && e.contains("did you mean `effects`?"), "{e}");
    let e = Folder::with("seed = [1, \"two\"]").load().err().unwrap();
    assert!(e.contains("grid.seed = \"two\""), "{e}");
}

#[test]
fn the_last_key_in_alphabetical_order_varies_fastest() {
    let folder = Folder::with("seed = [1, 2, 3]\nnoise_scale = [0.5, 1.0]");
    let grid = folder.load().unwrap().grid.unwrap();
    assert_eq!(grid.words(), "noise_scale (2) × seed (3)");
    let all: Vec<Vec<usize>> = (0..grid.cells()).map(|c| grid.places(c)).collect();
    assert_eq!(all, [[0, 0], [0, 1], [0, 2], [1, 0], [1, 1], [1, 2]]);
}

#[test]
fn a_failing_cell_is_a_row_with_its_reason_and_not_the_end() {
    let folder =
        Folder::with("noise_scale = [-1.0, 1.0]\n\"model.effects\" = [[], [\"no_such_effect\"]]");
    folder.run(false).result.unwrap();
    let (cells, status) = (folder.text("cell"), folder.text("status"));
    let failed: Vec<String> =
        cells.iter().zip(&status).filter(|(_, s)| *s == "failed").map(|(c, _)| c.clone()).collect();
    // keys in order: model.effects, noise_scale; only cell 1 (base model, noise 1) makes sense
    let bits = |x: f64| format!("{:x}", x.to_bits());
    assert_eq!(failed, [bits(0.0), bits(2.0), bits(3.0)]);
    assert_eq!(status.len(), 8, "five parameters and three failures");
    let reasons = folder.text("reason").join("\n");
    assert!(
        reasons.contains("simulation.noise") && reasons.contains("no_such_effect"),
        "{reasons}"
    );
    let results = folder.results();
    assert_eq!(results["schema"], 1);
    assert_eq!(results["cells"], 4);
    assert_eq!(results["failures"].as_array().unwrap().len(), 3);
}

#[test]
fn a_grid_gives_the_same_table_on_one_thread_and_on_two() {
    let run = |threads: usize| {
        let folder = Folder::with("noise_scale = [0.5, 1.0]\nseed = { count = 3 }");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| folder.run(false)).result.unwrap();
        folder.table()
    };
    assert_eq!(run(1), run(2));
}

#[test]
fn a_journal_torn_at_any_byte_resumes_to_the_same_table() {
    let folder = Folder::with("noise_scale = [0.5, 1.0, -1.0]\nseed = { count = 2 }");
    folder.run(false).result.unwrap();
    let table = folder.table();
    let whole = fs::read(folder.journal()).unwrap();
    let text = String::from_utf8(whole.clone()).unwrap();
    for end in [0, 1, whole.len() / 3, whole.len() / 2, whole.len() - 1, whole.len()] {
        fs::write(folder.journal(), &whole[..end]).unwrap();
        let complete = whole[..end].iter().filter(|b| **b == b'\n').count();
        folder.run(true).result.unwrap();
        assert_eq!(folder.table(), table, "cut at byte {end}");
        // wall times tell a cell that was kept from one that ran again
        let after = fs::read_to_string(folder.journal()).unwrap();
        let kept = text.lines().take(complete).filter(|line| after.contains(line)).count();
        assert_eq!((kept, after.lines().count()), (complete, 6), "cut at byte {end}");
    }
}

#[test]
fn a_journal_of_another_file_is_not_resumed() {
    let folder = Folder::with("seed = { count = 2 }");
    folder.run(false).result.unwrap();
    let before = folder.table();
    let path = folder.0.path().join("g.toml");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(path, text.replace("dalpha = 0.05", "dalpha = 0.1")).unwrap();
    folder.run(true).result.unwrap();
    assert_ne!(folder.table(), before);
}

#[test]
fn coverage_is_stated_from_twenty_repetitions_on_with_its_interval_and_the_runs() {
    let verdict = |count: usize| {
        let done = Folder::with(&format!("seed = {{ count = {count} }}")).run(false).result;
        done.unwrap().verdict
    };
    assert!(!verdict(15).contains("cover"), "{}", verdict(15));
    // some runs of this small experiment have no fit
    let stated = verdict(25);
    assert!(
        stated.contains("torque_regression: 95 % intervals cover the true value in"),
        "{stated}"
    );
    let runs = stated.rsplit(" %, ").next().and_then(|s| s.split(' ').next()).unwrap();
    assert!((20..=25).contains(&runs.parse::<u32>().unwrap()), "{stated}");
}

#[test]
fn keys_for_which_no_colours_are_left_are_held_and_said() {
    let grid = "duration_s = [2.0, 3.0]\nnoise_scale = [1, 2, 4]\nrate_hz = [50, 100, 200]\n\
                \"model.effects\" = [[], [\"turning_scrub\"]]";
    let folder = Folder::with(grid);
    folder.run(false);
    let html = fs::read_to_string(folder.0.path().join("g/report.html")).unwrap();
    // six curves: the model's key before those of the data
    assert!(html.contains("After the method: model.effects, noise_scale."), "{}", html.len());
    assert!(html.contains("Shown at rate_hz = 100; all combinations are in summary.csv."));
}
