//! A grid on several machines: parts, what is missing of them, and the table that they give.

use std::process::Command;

use amigo_ident::io::{TableColumn, read_parquet_table};

use crate::support::{Folder, root, short};

/// Twelve combinations of some ten milliseconds, two of which fail.
fn grid_file() -> String {
    let grid = "\n[grid]\nnoise_scale = [0.5, 1.0, -1.0, 2.0]\nseed        = { count = 3 }\n";
    short("Parts") + grid
}

/// What a grid writes that does not hold wall times.
const SAME: [&str; 4] = ["summary.csv", "results.json", "report.html", "experiment.toml"];

fn grid() -> Folder {
    let folder = Folder::new();
    folder.write("g.toml", grid_file());
    folder
}

fn shard(folder: &Folder, part: &str) {
    let ran = folder.run(&["g.toml", "--out", "parts", "--shard", part]);
    ran.says(0, &["experiment merge --out parts g.toml", "of 12 combinations"]);
}

/// `estimates.parquet` but for the wall times: names, and numbers bit for bit.
fn table(folder: &Folder, out: &str) -> Vec<(String, Vec<String>)> {
    let path = folder.path(&format!("{out}/g/estimates.parquet"));
    let columns = read_parquet_table(&path).unwrap().into_iter().map(|column| match column {
        TableColumn::Number(name, x) => {
            (name, x.iter().map(|x| format!("{:x}", x.to_bits())).collect())
        }
        TableColumn::Text(name, texts) => (name, texts),
    });
    columns.filter(|(name, _)| name != "seconds").collect()
}

/// Checks that `parts` holds what one run writes.
fn equals_one_run(folder: &Folder) {
    folder.run(&["g.toml", "--out", "one"]).says(0, &["12 combinations", "3 with a failure"]);
    assert_eq!(table(folder, "parts"), table(folder, "one"));
    for name in SAME {
        let [parts, one] = ["parts", "one"].map(|out| folder.read(&format!("{out}/g/{name}")));
        assert!(parts == one, "{name} differs");
    }
}

#[test]
fn three_parts_joined_equal_one_run() {
    let folder = grid();
    for part in ["1/3", "2/3", "3/3"] {
        shard(&folder, part);
    }
    assert!(!folder.has("parts/g/report.html"), "a part has no report");
    let merged = folder.run(&["merge", "g.toml", "--out", "parts"]);
    merged.says(0, &["g: 12 combinations", "parts/g/report.html"]);
    equals_one_run(&folder);
}

#[test]
fn a_part_killed_midway_resumes_and_gives_the_same_table() {
    let folder = grid();
    shard(&folder, "1/2");
    shard(&folder, "2/2");
    let journal = "parts/g/part-2-of-2.jsonl";
    let whole = folder.read(journal);
    folder.write(journal, &whole[..whole.len() - 40]);
    let missing = folder.run(&["merge", "g.toml", "--out", "parts"]);
    missing.says(2, &["1 of 12", "experiment --shard 2/2 --resume --out parts g.toml", "1 of 6"]);
    let resumed = folder.run(&["g.toml", "--out", "parts", "--shard", "2/2", "--resume"]);
    resumed.says(0, &["part 2/2: 6 of 12"]);
    // wall times tell a cell that was kept from one that ran again
    let kept: Vec<&str> = whole.lines().take(5).collect();
    let after = folder.read(journal);
    assert_eq!(after.lines().take(5).collect::<Vec<_>>(), kept);
    assert_eq!(after.lines().count(), 6);
    folder.run(&["merge", "g.toml", "--out", "parts"]).says(0, &[]);
    equals_one_run(&folder);
}

#[test]
fn a_missing_part_is_named_with_its_command() {
    let folder = grid();
    folder.run(&["merge", "g.toml"]).says(2, &["reports/g", "no part of the 12", "--shard I/N"]);
    shard(&folder, "1/3");
    shard(&folder, "3/3");
    let ran = folder.run(&["merge", "g.toml", "--out", "parts"]);
    ran.says(2, &["4 of 12", "experiment --shard 2/3 --out parts g.toml", "4 of 4"]);
    assert!(!ran.err.contains("--shard 1/3"), "{}", ran.err);
    assert!(!folder.has("parts/g/results.json"));
}

#[test]
fn parts_of_different_cuts_are_joined() {
    let folder = grid();
    for part in ["1/2", "2/4", "4/4"] {
        shard(&folder, part);
    }
    folder.run(&["merge", "g.toml", "--out", "parts"]).says(0, &[]);
    equals_one_run(&folder);
}

#[test]
fn a_part_of_another_version_is_refused_until_it_has_run_again() {
    let folder = grid();
    shard(&folder, "1/2");
    folder.write("g.toml", grid_file().replace("dalpha = 0.05", "dalpha = 0.06"));
    shard(&folder, "2/2");
    let words = ["part-1-of-2.jsonl", "6 of its", "checksums", "--shard 1/2 --resume"];
    folder.run(&["merge", "g.toml", "--out", "parts"]).says(2, &words);
    folder.run(&["g.toml", "--out", "parts", "--shard", "1/2", "--resume"]).says(0, &[]);
    folder.run(&["merge", "g.toml", "--out", "parts"]).says(0, &[]);
    equals_one_run(&folder);
}

#[test]
fn overridden_keys_stand_in_the_commands_and_count_as_another_version() {
    let folder = grid();
    let set = ["--set", "title=\"my parts\"", "--out", "parts"];
    let with = |first: &[&str]| folder.run(&[first, &set].concat());
    with(&["g.toml", "--shard", "1/1"]).says(0, &["--set 'title=\"my parts\"' g.toml"]);
    folder.run(&["merge", "g.toml", "--out", "parts"]).says(2, &["--set values"]);
    with(&["merge", "g.toml"]).says(0, &["parts/g/report.html"]);
}

#[test]
fn a_shard_that_makes_no_sense_is_wrong_usage() {
    let folder = grid();
    for wrong in ["0/3", "4/3", "3", "a/b", ""] {
        folder.run(&["g.toml", "--shard", wrong]).says(2, &["--shard", "for example 2/4"]);
    }
    let alone = short("Parts");
    folder.write("alone.toml", alone);
    folder.run(&["alone.toml", "--shard", "1/2"]).says(2, &["alone.toml", "no [grid]"]);
    folder.run(&["merge", "alone.toml"]).says(2, &["alone", "no [grid]"]);
    folder.run(&["merge"]).says(2, &["FILE.toml"]);
    // more parts than combinations: one without any is no error and is not missed
    folder.run(&["g.toml", "--shard", "13/13"]).says(0, &["0 of 12"]);
    assert!(!folder.has("reports/g/report.html"));
}

/// Runs a Slurm cluster of two nodes on this machine, which takes about a minute; needs root, and
/// Slurm and munge as Debian packages them: `cargo test --release -- --ignored slurm`.
#[test]
#[ignore = "needs Slurm and root"]
fn the_array_job_gives_what_one_run_gives() {
    let there = Command::new("sbatch").arg("--version").output().is_ok();
    if !there {
        println!("skipped: there is no sbatch on this machine");
        return;
    }
    let ran = Command::new("sh")
        .arg(root().join("tests/slurm.sh"))
        .arg(env!("CARGO_BIN_EXE_experiment"))
        .output()
        .unwrap();
    let out = String::from_utf8_lossy(&ran.stdout).into_owned();
    println!("{out}");
    assert!(ran.status.success(), "{out}{}", String::from_utf8_lossy(&ran.stderr));
}
