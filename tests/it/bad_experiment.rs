//! Wrong experiment files and places for results: a clear message and the right exit code, and nothing is written.

use amigo_ident::robot::Robot;

use crate::support::{Folder, csv, motion, on};

/// An experiment file that needs no recording, with a line of its own.
fn made(more: &str) -> String {
    format!(
        "[simulation]\nmovement = \"paper\"\ntrain = 1\nvalidation = 0\n\n\
         [[method]]\nname = \"prediction_error\"\n\n{more}"
    )
}

fn file_refused(text: impl AsRef<[u8]>, words: &[&str]) {
    let folder = Folder::new();
    folder.write("e.toml", text);
    folder.run(&["e.toml"]).says(2, words);
    folder.run(&["check", "e.toml"]).says(2, words);
    assert!(!folder.has("reports"));
}

#[test]
fn wrong_keys_types_and_names_in_the_experiment_file_are_named() {
    file_refused(made("[model]\nefects = []\n"), &["e.toml", "line 10", "did you mean `effects`?"]);
    file_refused(made("[model]\neffects = \"slope\"\n"), &["e.toml", "line 10", "effects"]);
    file_refused(made("[model]\neffects = [\"slop\"]\n"), &["e.toml", "did you mean `slope`?"]);
    file_refused(
        made("[[method]]\nname = \"predictionerror\"\n"),
        &["did you mean `prediction_error`?"],
    );
    file_refused(made("[[method]]\n"), &["[[method]] has no name"]);
    file_refused(
        made("[[method]]\nname = \"prediction_error\"\nmax_itertions = 3\n"),
        &["e.toml", "max_itertions"],
    );
    file_refused(
        made("[diagnosis]\ncandidates = [\"viscos_friction\"]\n"),
        &["e.toml", "did you mean `viscous_friction`?"],
    );
    file_refused("title = \n", &["e.toml", "line 1"]);
    file_refused("", &["e.toml", "[recordings]"]);
    file_refused([0x74, 0xff, 0xfe], &["e.toml", "UTF-8"]);
}

#[test]
fn a_wrong_robot_is_named() {
    file_refused(made("[robot]\npreset = \"amigobott\"\n"), &["[robot]", "`amigobot`"]);
    file_refused(
        made("[robot]\npreset = \"amigobot\"\nm1_kgs = 3.0\n"),
        &["[robot]", "`m1_kgs`", "did you mean `m1_kg`?"],
    );
    let all = ["[robot]", "l2_m", "iz4_kg_m2", "are missing", "preset = \"unknown\""];
    file_refused(made("[robot]\nl1_m = 0.14\n"), &all);
    // what only the caster has may be left out
    let values = Robot::amigobot().construction;
    let wheels = values.values().filter(|(key, _)| !key.contains('3') && *key != "l4_m");
    let lines: String = wheels.map(|(key, value)| format!("{key} = {value:?}\n")).collect();
    let folder = Folder::new();
    folder.write("e.toml", made(&format!("[robot]\n{lines}")));
    folder.run(&["check", "e.toml"]).says(0, &[]);
    file_refused(made("[robot]\npreset = \"amigobot\"\nr_m = -1.0\n"), &["[robot]", "r_m"]);
    file_refused(made("[robot]\npreset = \"amigobot\"\nr_m = \"x\"\n"), &["[robot]", "r_m"]);
}

#[test]
fn values_that_are_not_finite_in_the_experiment_file_are_named() {
    file_refused(made("[model]\nfixed = { a1 = nan }\n"), &["model.fixed.a1", "finite"]);
    let hidden = "[simulation]\nhidden = { viscous_friction = { b = nan } }\n";
    file_refused(hidden, &["simulation.hidden.viscous_friction.b", "finite"]);
    file_refused("[simulation]\ntruth = { a4 = inf }\n", &["simulation.truth.a4", "finite"]);
    file_refused(made("[diagnosis]\ncandidates = []\n"), &["diagnosis.candidates", "empty"]);
}

#[test]
fn a_grid_of_nothing_is_named() {
    file_refused(made("[grid]\nnoise_scale = []\n"), &["e.toml", "grid.noise_scale", "no value"]);
    file_refused(made("[grid]\nseed = { count = 0 }\n"), &["e.toml", "grid.seed", "no value"]);
    file_refused(made("[grid]\n"), &["e.toml", "[grid]", "no key"]);
}

#[test]
fn a_title_with_markup_is_escaped_in_the_report() {
    let folder = Folder::new();
    let script = "<script>alert(1)</script>";
    folder.write("e.toml", format!("title = \"{script}\"\n{}", made("")));
    folder.run(&["e.toml"]).says(0, &[]);
    let page = folder.read("reports/e/report.html");
    assert!(!page.contains(script));
    assert!(page.contains("&lt;script&gt;alert(1)"));
}

#[test]
fn a_file_in_place_of_the_result_folder_is_named_before_anything_runs() {
    let folder = Folder::new();
    folder.write("e.toml", made("")).write("taken", "words");
    folder.run(&["e.toml", "--out", "taken"]).says(2, &["taken"]);
    folder.run(&["e.toml", "--out", "taken/deeper"]).says(2, &["taken"]);
    assert_eq!(folder.read("taken"), "words");
}

#[test]
fn the_other_experiment_still_runs_when_one_fails() {
    let folder = Folder::new();
    folder.write("good.toml", made("")).write("bad.toml", made(""));
    std::fs::create_dir(folder.path("reports")).unwrap();
    folder.write("reports/bad", "a file where the result folder should be");
    let ran = folder.run(&["bad.toml", "good.toml"]);
    ran.says(1, &["error: bad: ", "1 of 2 experiments failed: bad", "good: "]);
    assert!(folder.has("reports/good/results.json") && folder.has("reports/index.html"));
    assert!(folder.read("reports/index.html").contains("failed"));
}

#[test]
fn two_files_of_one_name_are_refused() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("deeper")).unwrap();
    folder.write("e.toml", made("")).write("deeper/e.toml", made(""));
    folder.run(&["e.toml", "deeper/e.toml"]).says(2, &["called e"]);
}

#[test]
fn a_place_where_results_cannot_be_is_named_before_anything_runs() {
    let folder = Folder::new();
    folder.write("run.csv", csv(&motion())).write("e.toml", on("run.csv")).write("out", "");
    folder.run(&["e.toml", "--out", "out"]).says(2, &["out is a file", "--out"]);
    std::fs::create_dir(folder.path("second")).unwrap();
    folder.write("second/e", "");
    folder.run(&["e.toml", "--out", "second"]).says(1, &["second/e is a file"]);
    std::fs::create_dir_all(folder.path("third/e/report.html")).unwrap();
    folder.run(&["e.toml", "--out", "third"]).says(1, &["report.html is a folder"]);
    let left: Vec<_> = std::fs::read_dir(folder.path("third/e")).unwrap().collect();
    assert_eq!(left.len(), 1, "{left:?}");
}
