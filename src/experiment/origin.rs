//! Whose results a folder holds: two experiments of one name never take each other's place unasked.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::error::ExperimentError;
use super::plan::Plan;
use crate::io::{ResultFolder, exists, path_from, resolved};

/// The file that an experiment is of: its own, or the first of the recordings that were typed without one.
fn file(plan: &Plan) -> &Path {
    plan.typed.first().map_or(&plan.source, PathBuf::as_path)
}

/// That file as `results.json` names it: by its path from the result folder under `out`, which stays true from
/// whatever folder the next command is given and where the whole tree has moved.
pub(super) fn origin(plan: &Plan, out: &Path) -> String {
    path_from(&out.join(&plan.name), file(plan)).display().to_string()
}

/// Refuses to write over the results of another experiment that has the same name.
pub(super) fn not_of_another(plan: &Plan, out: &Path) -> Result<(), ExperimentError> {
    let folder = ResultFolder::new(out, &plan.name);
    let earlier = folder.earlier("results.json").and_then(|t| serde_json::from_str(&t).ok());
    let earlier: Value = earlier.unwrap_or_default();
    let Some(name) = earlier["file"].as_str() else { return Ok(()) };
    let (other, own) = (resolved(&folder.path().join(name)), resolved(file(plan)));
    // a file that was moved or removed is no other one
    if other == own || !exists(&other) || is_of_its_recordings(plan, &other, &earlier) {
        return Ok(());
    }
    let message = format!(
        "its result folder `{}` holds the results of {}; rename one of the files, or choose another \
         folder with --out",
        plan.name,
        other.display()
    );
    Err(ExperimentError::Meaning { file: file(plan).display().to_string(), message })
}

/// Whether a recording that was run without a file is run by one now, or the other way round: one of the two is
/// no experiment file, and they have a recording in common.
fn is_of_its_recordings(plan: &Plan, other: &Path, earlier: &Value) -> bool {
    let is_file = |path: &Path| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    let known = earlier["recordings"].as_array().into_iter().flatten();
    let known: Vec<&str> = known.filter_map(|r| r["sha256"].as_str()).collect();
    let mut own = plan.recordings.iter().filter_map(|m| m.sha256.as_deref());
    !(is_file(file(plan)) && is_file(other)) && own.any(|sha256| known.contains(&sha256))
}
