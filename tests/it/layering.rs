//! The house stays a house: imports go one way, and heavy crates stay behind their fences.

use std::fs;
use std::path::{Path, PathBuf};

/// Rooms in the order in which they may import: each one only those before it.
const ORDER: [&str; 13] = [
    "math",
    "robot",
    "recording",
    "effects",
    "model",
    "simulate",
    "export",
    "identify",
    "compare",
    "diagnose",
    "study",
    "report",
    "experiment",
];

/// External crates and the only places that may name them.
const FENCES: [(&str, &[&str]); 9] = [
    ("polars", &["src/io/"]),
    ("mcap", &["src/io/"]),
    ("flate2", &["src/io/"]),
    ("std::fs", &["src/io/", "src/bin/"]),
    ("plotters", &["src/report/plot/", "src/report/plot.rs"]),
    ("argmin", &["src/identify/", "src/math/"]),
    ("clarabel", &["src/identify/", "src/math/"]),
    ("clap", &["src/bin/"]),
    ("anyhow", &["src/bin/"]),
];

fn sources(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

/// Every source file with its path from the root, and its text before the tests.
fn files() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = Vec::new();
    sources(&root.join("src"), &mut paths);
    paths
        .into_iter()
        .map(|path| {
            let name = path.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
            let text = fs::read_to_string(&path).unwrap();
            let code = text.split("#[cfg(test)]").next().unwrap_or_default().to_string();
            (name, code)
        })
        .filter(|(name, _)| !is_test(name))
        .collect()
}

/// Files that are compiled for tests only.
fn is_test(name: &str) -> bool {
    name.ends_with("/tests.rs") || name.ends_with("/contract.rs") || name.contains("/tests/")
}

fn room(name: &str) -> Option<&str> {
    let inner = name.strip_prefix("src/")?;
    let first = inner.split('/').next()?;
    Some(first.trim_end_matches(".rs"))
}

/// Rooms that a line of code names as `crate::room`; comments do not count.
fn imports(line: &str) -> Vec<String> {
    let code = line.split("//").next().unwrap_or_default();
    code.match_indices("crate::")
        .map(|(at, word)| {
            let rest = &code[at + word.len()..];
            rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
        })
        .collect()
}

#[test]
fn every_room_imports_only_rooms_before_it() {
    let place = |room: &str| ORDER.iter().position(|r| *r == room);
    let mut broken = Vec::new();
    for (name, code) in files() {
        let Some(own) = room(&name) else { continue };
        for (number, line) in code.lines().enumerate() {
            for target in imports(line) {
                let allowed = match (own, target.as_str()) {
                    (own, target) if own == target => true,
                    ("lib" | "bin" | "catalogue", _) | (_, "catalogue") => true,
                    ("experiment", "io") => true,
                    (_, "io") => false,
                    // files hold recordings and plain results; io knows nothing of fits
                    ("io", target) => {
                        matches!(target, "math" | "robot" | "recording" | "study")
                    }
                    (own, target) => match (place(own), place(target)) {
                        (Some(own), Some(target)) => target < own,
                        // not a room: a macro or a constant of the crate's root
                        (_, None) => true,
                        _ => false,
                    },
                };
                if !allowed {
                    broken.push(format!("{name}:{}: {own} imports {target}", number + 1));
                }
            }
        }
    }
    assert!(broken.is_empty(), "imports against the one direction:\n{}", broken.join("\n"));
}

#[test]
fn heavy_crates_stay_behind_their_fences() {
    let mut broken = Vec::new();
    for (name, code) in files() {
        for (number, line) in code.lines().enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            for (word, places) in FENCES {
                let path = format!("{word}::");
                let named = code.match_indices(&path).any(|(at, _)| {
                    let before = code[..at].chars().last();
                    before.is_none_or(|c| !c.is_alphanumeric() && c != '_' && c != ':')
                });
                if named && !places.iter().any(|place| name.starts_with(place)) {
                    broken.push(format!("{name}:{}: {word}", number + 1));
                }
            }
        }
    }
    assert!(broken.is_empty(), "crates outside their fence:\n{}", broken.join("\n"));
}
