//! Imports go one way between modules and between files, and heavy crates stay in their modules.

use std::collections::{BTreeMap, BTreeSet};

use crate::imports::{edges, files, rings};
use crate::prose::literals;

/// Modules in the order in which they may import: each one only those before it.
const ORDER: [&str; 16] = [
    "math",
    "robot",
    "recording",
    "conditioning",
    "effects",
    "model",
    "simulate",
    "export",
    "filter",
    "identify",
    "compare",
    "diagnose",
    "study",
    "verdict",
    "report",
    "experiment",
];

/// External crates and the only places that may name them.
const FENCES: [(&str, &[&str]); 9] = [
    ("polars", &["src/io/"]),
    ("mcap", &["src/io/"]),
    ("flate2", &["src/io/", "src/report/png.rs"]),
    ("std::fs", &["src/io/", "src/bin/"]),
    ("plotters", &["src/report/plot/", "src/report/plot.rs"]),
    ("argmin", &["src/identify/", "src/math/"]),
    ("clarabel", &["src/identify/", "src/math/"]),
    ("clap", &["src/bin/"]),
    ("signal_hook", &["src/experiment/interrupt.rs"]),
];

fn module(name: &str) -> Option<&str> {
    let inner = name.strip_prefix("src/")?;
    let first = inner.split('/').next()?;
    Some(first.trim_end_matches(".rs"))
}

/// Modules that a line of code names as `crate::module`; comments do not count.
fn imports(line: &str) -> Vec<String> {
    let code = line.split("//").next().unwrap_or_default();
    code.match_indices("crate::")
        .map(|(at, word)| {
            let rest = &code[at + word.len()..];
            rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
        })
        .collect()
}

/// Whether a file of the module `own` may import from the module `target`.
fn may_import(own: &str, target: &str) -> bool {
    let place = |module: &str| ORDER.iter().position(|m| *m == module);
    match (own, target) {
        (own, target) if own == target => true,
        ("lib" | "bin" | "catalogue", _) | (_, "catalogue") => true,
        ("experiment", "io") => true,
        (_, "io") => false,
        // files hold recordings and plain results; io imports no fits
        ("io", target) => matches!(target, "math" | "robot" | "recording" | "study"),
        (own, target) => match (place(own), place(target)) {
            (Some(own), Some(target)) => target < own,
            // not a module: a macro or a constant of the crate's root
            (_, None) => true,
            _ => false,
        },
    }
}

#[test]
fn every_module_imports_only_modules_before_it() {
    let mut broken = Vec::new();
    for (name, code) in files() {
        let Some(own) = module(&name) else { continue };
        for (number, line) in code.lines().enumerate() {
            let targets = imports(line).into_iter().filter(|target| !may_import(own, target));
            broken.extend(targets.map(|t| format!("{name}:{}: {own} imports {t}", number + 1)));
        }
    }
    // groups and paths through `super`
    for (name, targets) in edges(&files()) {
        let Some(own) = module(&name) else { continue };
        let targets = targets.iter().filter(|t| module(t).is_some_and(|t| !may_import(own, t)));
        broken.extend(targets.map(|t| format!("{name} imports {t}")));
    }
    assert!(broken.is_empty(), "imports against the one direction:\n{}", broken.join("\n"));
}

#[test]
fn heavy_crates_stay_in_their_modules() {
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

/// Whether a text names an effect. Of an id that is a word of the language too only the text by itself, or quoted
/// in another one, does.
fn names_effect(text: &str, id: &str) -> bool {
    if id.contains('_') {
        text.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == id)
    } else {
        text == id || text.contains(&format!("\\\"{id}\\\""))
    }
}

/// Texts that are the id of an effect and mean something else, with their file.
const NO_EFFECT: [(&str, &str); 1] = [("src/io/wpilog.rs", "payload")];

#[test]
fn effects_are_named_in_their_own_files_alone() {
    let ids: Vec<String> = amigo_ident::effects::all().iter().map(|e| e.id()).collect();
    let mut broken = Vec::new();
    for (name, code) in files().iter().filter(|(name, _)| !name.starts_with("src/effects/")) {
        for text in literals(code) {
            let named = ids.iter().filter(|id| {
                names_effect(&text, id) && !NO_EFFECT.contains(&(name.as_str(), id.as_str()))
            });
            broken.extend(named.map(|id| format!("{name}: {id}")));
        }
    }
    assert!(broken.is_empty(), "effects named outside src/effects:\n{}", broken.join("\n"));
}

#[test]
fn an_effect_is_named_by_its_id_and_not_by_a_word_of_a_sentence() {
    assert!(names_effect("(see the effect torque_saturation)", "torque_saturation"));
    assert!(!names_effect("torque_saturation_limit", "torque_saturation"));
    assert!(names_effect("slope", "slope") && names_effect("effects = [\\\"slope\\\"]", "slope"));
    assert!(!names_effect("the slope of the angle", "slope"));
}

/// The stages through which an experiment passes, with the files and folders of `src/experiment` that hold them.
/// Each imports only its own stage and those before it.
const STAGES: [(&str, &[&str]); 9] = [
    (
        "the file",
        &["file", "error", "remark", "remarks", "unrepaired", "no_motion", "guess", "new_file"],
    ),
    (
        "a plan",
        &[
            "drives",
            "combinations",
            "copies",
            "custom",
            "robot_table",
            "quality",
            "source",
            "plan",
            "stages",
        ],
    ),
    (
        "from the file to a plan",
        &[
            "long",
            "reading",
            "together",
            "measured",
            "between_rows",
            "input_time",
            "align",
            "assemble",
            "resolve",
        ],
    ),
    ("from a plan to fits", &["fits", "fitted"]),
    ("from fits to a comparison", &["fuzzy_study", "contradiction", "comparison"]),
    ("from a comparison to a diagnosis", &["diagnosis"]),
    ("from a diagnosis to a study", &["models", "model_out", "what_if", "run"]),
    ("from a study to files", &["overlay", "estimates", "shard", "options", "origin", "grid"]),
    ("commands", &["execute", "check", "export", "index", "interrupt", "loop_commands"]),
];

#[test]
fn no_files_import_each_other_in_a_ring() {
    let found = rings(&edges(&files()));
    assert!(found.is_empty(), "files that import each other:\n{found:#?}");
}

/// The file or folder of `src/experiment` in which a file stands; none for its list of modules.
fn part_of_experiment(file: &str) -> Option<&str> {
    let inner = file.strip_prefix("src/experiment/")?;
    let part = inner.split('/').next()?.trim_end_matches(".rs");
    (part != "mod").then_some(part)
}

#[test]
fn an_experiment_passes_through_its_stages_in_one_direction() {
    let stage = |part: &str| STAGES.iter().position(|(_, parts)| parts.contains(&part));
    let mut broken = Vec::new();
    for (file, targets) in edges(&files()) {
        let Some(part) = part_of_experiment(&file) else { continue };
        let Some(own) = stage(part) else {
            broken.push(format!("{file} is in no stage"));
            continue;
        };
        let parts = targets.iter().filter_map(|target| part_of_experiment(target));
        let later = parts.filter(|target| stage(target).is_some_and(|stage| stage > own));
        broken.extend(later.map(|target| format!("{file} imports {target}")));
    }
    assert!(broken.is_empty(), "against the order of the stages:\n{}", broken.join("\n"));
}

/// Files by the folder of their module that holds them: `src/experiment/grid` for all of `grid/`.
fn folders(edges: &BTreeMap<String, BTreeSet<String>>) -> BTreeMap<String, BTreeSet<String>> {
    let folder = |file: &String| {
        let parts: Vec<&str> = file.trim_end_matches(".rs").splitn(4, '/').take(3).collect();
        parts.join("/")
    };
    let mut out: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (file, targets) in edges {
        let own = folder(file);
        let others = targets.iter().map(folder).filter(|target| *target != own).collect::<Vec<_>>();
        out.entry(own).or_default().extend(others);
    }
    out
}

#[test]
fn no_folders_of_a_module_import_each_other_in_a_ring() {
    let found = rings(&folders(&edges(&files())));
    assert!(found.is_empty(), "folders that import each other:\n{found:#?}");
}
