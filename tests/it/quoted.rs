//! The pages quote what the program prints: their commands are run, and the figures compared.

use std::fs;
use std::path::Path;

use crate::support::{Folder, root};

/// Difference of quoted and printed figures, in units of the last digit that is quoted: another machine may round
/// the other way.
const LAST_DIGITS: f64 = 1.0 + 1e-6;

/// A fenced block of a page: its language and its lines.
struct Fence {
    language: String,
    lines: Vec<String>,
}

fn fences(page: &str) -> Vec<Fence> {
    let mut out: Vec<Fence> = Vec::new();
    let mut is_open = false;
    for line in page.lines() {
        match line.strip_prefix("```") {
            Some(_) if is_open => is_open = false,
            Some(language) => {
                out.push(Fence { language: language.to_owned(), lines: vec![] });
                is_open = true;
            }
            None if is_open => out.last_mut().unwrap().lines.push(line.to_owned()),
            None => {}
        }
    }
    out
}

/// Words and figures of a line; a typographic minus is a minus.
fn words(line: &str) -> Vec<String> {
    let line = line.replace('−', "-");
    let separators = |c: char| c.is_whitespace() || "(),;:".contains(c);
    line.split(separators)
        .map(|word| word.trim_end_matches('.').to_owned())
        .filter(|w| !w.is_empty())
        .collect()
}

/// Whether both are the same word, or figures that differ by no more than one of the last digit.
fn alike(quoted: &str, printed: &str) -> bool {
    match (quoted.parse::<f64>(), printed.parse::<f64>()) {
        (Ok(q), Ok(p)) => {
            let decimals = quoted.split('.').nth(1).map_or(0, str::len) as i32;
            (q - p).abs() <= LAST_DIGITS * 10f64.powi(-decimals)
        }
        _ => quoted == printed,
    }
}

/// Whether the quoted lines stand in the printed ones in order; "…" stands for any lines.
fn quotes(quoted: &[String], printed: &str) -> Result<(), String> {
    let mut lines = printed.lines().map(words).filter(|w| !w.is_empty());
    for line in quoted.iter().filter(|line| !line.trim().is_empty() && line.trim() != "…") {
        let wanted = words(line);
        let is_same = |printed: Vec<String>| {
            printed.len() == wanted.len() && wanted.iter().zip(&printed).all(|(q, p)| alike(q, p))
        };
        if !lines.any(is_same) {
            return Err(format!("not printed: {line}\nprinted:\n{printed}"));
        }
    }
    Ok(())
}

/// The arguments of a command, with `*.csv` written out as a shell does.
fn arguments(command: &str) -> Vec<String> {
    let mut out = Vec::new();
    for word in command.split_whitespace().skip(1) {
        match word.strip_suffix("/*.csv") {
            Some(folder) => {
                let entries = fs::read_dir(root().join(folder)).unwrap();
                let mut names: Vec<String> = entries
                    .map(|e| format!("{folder}/{}", e.unwrap().file_name().to_string_lossy()))
                    .filter(|name| name.ends_with(".csv"))
                    .collect();
                names.sort();
                out.extend(names);
            }
            None => out.push(word.to_owned()),
        }
    }
    out
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target);
        } else {
            fs::copy(&path, target).unwrap();
        }
    }
}

#[test]
fn the_guide_quotes_what_its_commands_print() {
    let page = fs::read_to_string(root().join("docs/guide.md")).unwrap();
    let (_, start) = page.split_once("\n## Get started\n").unwrap();
    let start = start.split("\n## ").next().unwrap();
    let folder = Folder::new();
    copy(&root().join("recordings"), &folder.path("recordings"));
    let (mut printed, mut compared) = (String::new(), 0);
    for fence in fences(start) {
        match fence.language.as_str() {
            "sh" => {
                for line in fence.lines.iter().filter(|l| l.starts_with("sed ")) {
                    let mut shell = std::process::Command::new("sh");
                    let done = shell.args(["-c", line]).current_dir(folder.path("")).status();
                    assert!(done.unwrap().success(), "{line}");
                }
                for command in fence.lines.iter().filter(|l| l.starts_with("experiment ")) {
                    let arguments = arguments(command);
                    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
                    let ran = folder.run(&arguments);
                    ran.says(0, &[]);
                    printed = ran.out;
                }
            }
            "text" => {
                quotes(&fence.lines, &printed).unwrap_or_else(|e| panic!("docs/guide.md: {e}"));
                compared += 1;
            }
            _ => {}
        }
    }
    assert!(compared >= 4, "{compared} outputs compared");
}

#[test]
fn the_readme_says_of_its_example_what_the_program_finds() {
    let page = fs::read_to_string(root().join("README.md")).unwrap();
    let folder = Folder::new();
    let file = root().join("experiments/hidden_scrub.toml");
    folder.run(&[file.to_str().unwrap()]).says(0, &[]);
    let results = folder.results("reports/hidden_scrub");
    let steps = results["diagnosis"]["staircase"].as_array().unwrap();
    let error =
        |step: &serde_json::Value| step["window_rms_validation"].as_f64().unwrap().to_string();
    let quoted: Vec<String> = words(page.split("turning scrub,\n").nth(1).unwrap());
    let figures: Vec<&String> = quoted.iter().filter(|w| w.parse::<f64>().is_ok()).collect();
    let size = results["diagnosis"]["ranking"][0]["parameters"][0]["value"].as_f64().unwrap();
    let found = [size.to_string(), "2".to_owned(), error(&steps[0]), error(&steps[1])];
    for (quoted, found) in figures.into_iter().zip(&found) {
        assert!(alike(quoted, found), "README.md says {quoted}, the program {found}");
    }
}

/// Named, all and exact of the rows "now" and of the simulators on the page of the worlds.
fn counts(page: &str) -> Vec<(u32, u32, u32)> {
    let rows = ["| now |", "| equations of motion |", "| 3-D physics |"];
    let row = |start: &str| page.lines().find(|line| line.starts_with(start)).unwrap().to_owned();
    let cell = |line: &str, n: usize| -> (u32, u32) {
        let text = line.split('|').nth(n).unwrap();
        let mut figures = text.split(['/', '(']).map(|w| w.trim().parse().ok());
        (figures.next().flatten().unwrap(), figures.next().flatten().unwrap())
    };
    let both = |line: String| (cell(&line, 2).0, cell(&line, 2).1, cell(&line, 3).0);
    rows.iter().map(|start| both(row(start))).collect()
}

#[test]
fn the_readme_sums_the_tables_of_other_simulators() {
    let read = |name: &str| fs::read_to_string(root().join(name)).unwrap();
    let rows = counts(&read("docs/other_simulators.md"));
    let (named, all, exact) = rows.iter().fold((0, 0, 0), |s, r| (s.0 + r.0, s.1 + r.1, s.2 + r.2));
    let sentence = format!("named first in {named} of {all} sets, in {exact} of them");
    assert!(read("README.md").contains(&sentence), "README.md does not say: {sentence}");
}

#[test]
fn the_guide_quotes_an_error_above_its_floor_as_the_program_finds_it() {
    let page = fs::read_to_string(root().join("docs/guide.md")).unwrap();
    let page = page.split_whitespace().collect::<Vec<_>>().join(" ");
    let (_, quoted) = page.split_once("found a few per cent above it (").unwrap();
    let (figures, behind) = quoted.split_once(" in `").unwrap();
    let (error, floor) = figures.split_once(" against ").unwrap();
    let folder = Folder::new();
    let file = root().join(behind.split('`').next().unwrap());
    let ran = folder.run(&[file.to_str().unwrap()]);
    ran.says(0, &[]);
    let printed = words(&ran.out);
    for (before, quoted) in [("error", error), ("floor", floor)] {
        let at = printed.iter().position(|word| word == before).unwrap();
        assert!(alike(quoted, &printed[at + 1]), "{quoted} is not in: {}", ran.out);
    }
}

/// The sets of the table of healthy robots on the page of the benchmark, and those that the text below adds: how many,
/// and in how many an effect was named at a false-alarm rate of 5 %.
fn healthy(page: &str) -> (u32, u32) {
    let number = |text: &str| text.trim().parse::<u32>().unwrap();
    let table = page.split("No hidden effect: ").nth(1).unwrap();
    let all: Vec<&str> =
        table.lines().find(|line| line.starts_with("| all |")).unwrap().split('|').collect();
    let sets: u32 = all[4].split(',').map(number).sum();
    let named: u32 = all[5].split(',').map(|cell| number(cell.split('/').next().unwrap())).sum();
    let more = table.split("In another ").nth(1).unwrap().split(' ').next().unwrap();
    // each is named with the rates at which it was found
    let below =
        table.split("In another ").nth(1).unwrap().split("intervals covered").next().unwrap();
    let found = below.matches("at every rate").count() + below.matches("at 0.05").count();
    (sets + number(more), named + found as u32)
}

#[test]
fn the_readme_counts_the_healthy_sets_of_the_benchmark() {
    let read = |name: &str| fs::read_to_string(root().join(name)).unwrap();
    let (sets, named) = healthy(&read("docs/hidden_effects.md"));
    let word = ["none", "one", "two", "three", "four"][named as usize];
    let readme = read("README.md").split_whitespace().collect::<Vec<_>>().join(" ");
    let start = format!("Of {sets} healthy sets of the benchmark (");
    let (_, behind) = readme.split_once(&start).unwrap_or_else(|| panic!("README: {start}"));
    let said = behind.split_once(") ").unwrap().1;
    assert!(
        said.starts_with(&format!("{word} were reported with a missing effect")),
        "{sets}: {said}"
    );
}

/// What the benchmark of the estimators wrote.
struct Estimators {
    sets: u64,
    /// Share of the 95 % intervals that cover the true value, by parameter [%].
    covered: Vec<String>,
    found: serde_json::Value,
}

impl Estimators {
    fn of(file: &str) -> Self {
        let text = fs::read_to_string(root().join("benchmarks/estimators").join(file)).unwrap();
        let found: serde_json::Value = serde_json::from_str(&text).unwrap();
        let covered = found["covered_percent"].as_array().unwrap().iter();
        let covered = covered.map(|v| format!("{:.0}", v.as_f64().unwrap())).collect();
        Self { sets: found["sets"].as_u64().unwrap(), covered, found }
    }

    /// 2 s simulation error over that of the true parameters.
    fn ratio(&self, key: &str, digits: usize) -> String {
        let value = self.found["error_over_that_of_the_true_parameters"][key].as_f64().unwrap();
        format!("{value:.digits$}")
    }
}

#[test]
fn the_readme_quotes_the_estimators_as_their_benchmark_wrote_them() {
    let worlds = Estimators::of("worlds.json");
    let (last, first) = worlds.covered.split_last().unwrap();
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let readme = readme.split_whitespace().collect::<Vec<_>>().join(" ");
    for sentence in [
        format!("The default method on {} healthy sets", worlds.sets),
        format!("is {} times that of the true parameters", worlds.ratio("mean", 3)),
        format!("(worst {}), and its 95 % intervals", worlds.ratio("largest", 2)),
        format!("cover the true a1..a5 in {} and {last} %", first.join(", ")),
    ] {
        assert!(readme.contains(&sentence), "README.md does not say: {sentence}");
    }
}

#[test]
fn the_page_of_methods_quotes_the_estimators_as_their_benchmark_wrote_them() {
    let page = fs::read_to_string(root().join("docs/methods.md")).unwrap();
    for (file, robots) in [("worlds.json", "healthy robots"), ("amigobot.json", "AmigoBots")] {
        let found = Estimators::of(file);
        let figures = [("mean", 3), ("nine_tenths", 2), ("largest", 2)];
        let ratios = figures.map(|(key, digits)| found.ratio(key, digits)).join(" | ");
        let row = format!("| {} | {ratios} |", found.covered.join(" "));
        let start = format!("| {} {robots}", found.sets);
        let line = page.lines().find(|line| line.starts_with(&start)).unwrap();
        assert!(line.ends_with(&row), "docs/methods.md: {line} for {row}");
    }
}

#[test]
fn a_stale_figure_is_seen_and_a_last_digit_is_not() {
    let quote = |line: &str, printed: &str| quotes(&[line.to_owned()], printed).is_ok();
    assert!(quote("error 0.1847 to 0.0303 rad/s.", "first\nerror 0.1846 to 0.0303 rad/s\n"));
    assert!(!quote("error 0.0302 rad/s", "error 0.0298 rad/s"));
    assert!(!quote("error 0.1824 to 0.0315 rad/s", "error 0.1847 to 0.0303 rad/s"));
    assert!(!quote("Missing: slope", "Missing: inclined floor (slope)"));
    assert!(quote("…", "anything"));
}
