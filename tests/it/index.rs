//! The index of a folder of results.

use crate::support::Folder;

const SINGLE: &str = r#"title = "A single run"
[simulation]
noise      = { dalpha = 0.05, alpha = 0.001, M = 0.005 }
train      = 1
validation = VALIDATION
duration_s = 8.0
[[method]]
name = "weak_form"
[[method]]
name = "torque_regression"
"#;

fn single() -> String {
    SINGLE.replace("VALIDATION", "1")
}

fn grid(validation: u32) -> String {
    let text = SINGLE.replace("VALIDATION", &validation.to_string());
    format!("{text}[grid]\nseed = {{ count = 4 }}\n").replace("A single run", "A grid")
}

/// The rows of the index, by the folder that each leads to.
fn row(folder: &Folder, name: &str) -> String {
    let html = folder.read("reports/index.html");
    let rows = html.split("<tr>").filter(|row| row.contains("<td"));
    let link = format!("href=\"{name}/report.html\"");
    let mut rows = rows.filter(|row| row.contains(&link)).map(str::to_owned);
    let row = rows.next().unwrap_or_else(|| panic!("no row of {name}"));
    assert_eq!(rows.next(), None, "{name} has several rows");
    row
}

#[test]
fn a_run_of_one_file_lists_all_results_of_the_folder_once_there_are_several() {
    let folder = Folder::new();
    folder.write("first.toml", single()).write("second.toml", single());
    folder.run(&["first.toml"]).says(0, &[]);
    assert!(!folder.has("reports/index.html"), "one experiment has no index");
    folder.run(&["second.toml"]).says(0, &[]);
    assert!(row(&folder, "first").contains("noise floor"));
    // a repeated run changes its row, and not the other
    folder.write("first.toml", single().replace("A single run", "Another title"));
    folder.run(&["first.toml"]).says(0, &[]);
    assert!(row(&folder, "first").contains("Another title"));
    assert!(row(&folder, "second").contains("A single run"));
    assert!(folder.read("reports/index.html").contains("2 experiments"));
}

#[test]
fn the_row_of_a_grid_has_a_picture_a_grade_and_its_runs() {
    let folder = Folder::new();
    folder.write("one.toml", single()).write("grid.toml", grid(1));
    folder.run(&["one.toml", "grid.toml"]).says(0, &[]);
    let best = &folder.results("reports/grid")["best"];
    let ratio = best["window_rms"].as_f64().unwrap() / best["noise_floor"].as_f64().unwrap();
    for name in ["one", "grid"] {
        let row = row(&folder, name);
        assert!(row.contains("<img class=\"thumbnail\""), "{name} has no picture");
        assert!(row.contains("noise floor") || row.contains("useful"), "{name} has no grade");
    }
    let row = row(&folder, "grid");
    assert!(
        row.contains("of 4 runs") && row.contains(&format!("data-value=\"{ratio}\"")),
        "{ratio}"
    );
}

#[test]
fn the_headline_of_a_grid_without_validation_says_that_errors_are_on_training_data() {
    let folder = Folder::new();
    folder.write("with.toml", grid(1)).write("without.toml", grid(0));
    let said = "2 s simulation error on the training data";
    let headline = |name: &str| {
        let ran = folder.run(&[&format!("{name}.toml")]);
        ran.says(0, &[]);
        (ran.out.contains(said), folder.read(&format!("reports/{name}/report.html")).contains(said))
    };
    assert_eq!(headline("with"), (false, false));
    assert_eq!(headline("without"), (true, true));
}
