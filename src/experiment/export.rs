//! `experiment export`: the results of the last run, for other programs.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

use super::error::ExperimentError;
use super::execute::load;
use super::fitted::{Columns, FittedModel, FittedModels};
use super::overlay::{Overlay, overlay};
use super::plan::Plan;
use crate::export::{GainErrors, Gains, Operation, Simulator, gains_files, mjcf, urdf_sdf};
use crate::identify::Estimate;
use crate::io::{
    ResultFolder, TableColumn, make_folder, write_csv_table, write_mcap_table, write_parquet_table,
    write_whole,
};
use crate::recording::Recording;
use crate::report::page::unique;
use crate::study::Combination;

/// A format of `experiment export`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExportFormat {
    /// Measured and simulated motion of each recording as CSV.
    Csv,
    /// The same as Parquet.
    Parquet,
    /// The same as MCAP, for PlotJuggler, Foxglove and Rerun.
    Mcap,
    /// The identified robot for MuJoCo.
    Mjcf,
    /// The identified robot as URDF and SDF.
    Urdf,
    /// Feed-forward and controller gains.
    Gains,
}

impl ExportFormat {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Csv, Self::Parquet, Self::Mcap, Self::Mjcf, Self::Urdf, Self::Gains];

    /// As on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
            Self::Mcap => "mcap",
            Self::Mjcf => "mjcf",
            Self::Urdf => "urdf",
            Self::Gains => "gains",
        }
    }
}

impl std::str::FromStr for ExportFormat {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|f| f.name() == text).ok_or_else(|| {
            let known = Self::ALL.map(Self::name).join(", ");
            format!("unknown format `{text}`; use one of {known}")
        })
    }
}

/// Writes the results of the last run of an experiment into the folder `export` of its result folder; returns
/// a description.
///
/// # Errors
/// A file that was not run, or was changed since; a file that cannot be written.
pub fn export(
    file: &Path,
    formats: &[ExportFormat],
    out: &Path,
    set: &[String],
) -> Result<String, ExperimentError> {
    let plan = load(file, set)?;
    let models = last_run(&plan, out)?;
    let folder = out.join(&plan.name).join("export");
    make_folder(&folder)?;
    let mut message = format!("{}\n", words(&models));
    let mut write = |files: Vec<(String, Vec<u8>)>| -> Result<(), ExperimentError> {
        for (name, bytes) in files {
            let path = folder.join(name);
            write_whole(&path, &bytes)?;
            let _ = writeln!(message, "    {}", path.display());
        }
        Ok(())
    };
    write(overlays(&plan, &models, formats)?)?;
    let robot = Robot::of(&plan, &models);
    let mut remarks = Vec::new();
    for format in formats {
        let (files, words) = robot.written(&plan, *format);
        write(files.into_iter().map(|(name, text)| (name, text.into_bytes())).collect())?;
        remarks.extend(words.into_iter().filter(|w| !remarks.contains(w)).collect::<Vec<_>>());
    }
    for remark in remarks {
        let _ = writeln!(message, "{remark}");
    }
    Ok(message)
}

/// The identified robot for controllers and simulators.
struct Robot<'a> {
    fitted: &'a FittedModel,
    columns: Columns,
    operation: Operation,
}

/// Sampling period of the robot's controller, that of WPILib \[s\].
const PERIOD: f64 = 0.02;

/// Shifts of the input below this are not mentioned \[s\].
const SHIFT: f64 = 1e-3;

impl<'a> Robot<'a> {
    fn of(plan: &Plan, models: &'a FittedModels) -> Self {
        let fitted = models.last();
        let each = || plan.recordings.iter().map(|m| &m.recording);
        let largest = |of: &dyn Fn(&Recording) -> f64| each().map(of).fold(0.0, f64::max);
        let peak = |r: &Recording| r.torque().iter().flatten().fold(0.0_f64, |a, m| a.max(m.abs()));
        let operation = Operation {
            top_speed: largest(&Recording::top_speed),
            largest_input: largest(&peak),
            time: largest(&Recording::duration),
            period: PERIOD,
        };
        Self { fitted, columns: fitted.columns(), operation }
    }

    /// Files of a format, and effects that it does not express.
    fn written(&self, plan: &Plan, format: ExportFormat) -> (Vec<(String, String)>, Vec<String>) {
        let it = self.fitted.identified(plan, &self.columns, &[]);
        let simulator = |made: Simulator| (made.files, made.left_out, made.notes);
        let (files, left_out, notes) = match format {
            ExportFormat::Mjcf => simulator(mjcf(&it, self.operation.time)),
            ExportFormat::Urdf => simulator(urdf_sdf(&it, self.operation.time)),
            ExportFormat::Gains => {
                let gains = Gains::of(it.model, it.values, &self.operation);
                let errors =
                    GainErrors::of(it.model, it.values, &self.fitted.covariance, &self.operation);
                let left_out = gains.left_out.clone();
                let notes = errors.not_identified(&gains, it.drive_unit);
                (gains_files(&it, &gains, &errors, &self.operation), left_out, notes)
            }
            ExportFormat::Csv | ExportFormat::Parquet | ExportFormat::Mcap => {
                return (vec![], vec![]);
            }
        };
        let name = format.name();
        let mut words: Vec<String> = notes.into_iter().map(|n| format!("{name}: {n}")).collect();
        words.extend(
            left_out.iter().map(|l| format!("{name} does not express {}: {}", l.effect, l.reason)),
        );
        if self.fitted.input_shift_s.abs() > SHIFT {
            let shift = 1e3 * self.fitted.input_shift_s;
            words
                .push(format!("{name}: the recorded input acts {shift:.1} ms later than recorded"));
        }
        (files, words)
    }
}

/// Which of the models it is.
fn words(models: &FittedModels) -> String {
    match &models.found {
        Some(found) => format!(
            "the model with the effects found ({})",
            found.model.effect_ids()[models.given.model.effects().len()..].join(", ")
        ),
        None => format!("the model of the file, fitted by {}", models.given.method),
    }
}

/// Measured and simulated motion of every recording, files by name.
fn overlays(
    plan: &Plan,
    models: &FittedModels,
    formats: &[ExportFormat],
) -> Result<Vec<(String, Vec<u8>)>, ExperimentError> {
    let tables = [ExportFormat::Csv, ExportFormat::Parquet, ExportFormat::Mcap];
    let formats: Vec<_> = formats.iter().filter(|f| tables.contains(f)).collect();
    let mut files = Vec::new();
    if formats.is_empty() {
        return Ok(files);
    }
    for measured in &plan.recordings {
        let made = overlay(&measured.recording, plan.hold, models)
            .map_err(|e| ExperimentError::Run(e.into()))?;
        for &format in &formats {
            let name = free_name(&stem(&made.recording), format.name(), &files);
            let bytes = table(&made, *format, Path::new(&name))?;
            files.push((name, bytes));
        }
    }
    Ok(files)
}

/// The name of a file that is not among `files`, with a number from 2 on if recordings have the same name.
fn free_name(stem: &str, ending: &str, files: &[(String, Vec<u8>)]) -> String {
    let with_ending = |name: &str| format!("{name}.{ending}");
    let is_free = |name: &str| files.iter().all(|(taken, _)| *taken != with_ending(name));
    with_ending(&unique(stem.to_owned(), is_free))
}

/// The name of a recording without its extension, with the test of a file of tests, as part of a file name.
fn stem(recording: &str) -> String {
    let (file, test) = recording.split_once('#').unwrap_or((recording, ""));
    let stem = Path::new(file).file_stem().map_or(file.into(), |s| s.to_string_lossy());
    let name = if test.is_empty() { stem.into_owned() } else { format!("{stem}_{test}") };
    name.replace(|c: char| !c.is_alphanumeric() && c != '-' && c != '_', "_")
}

fn table(overlay: &Overlay, format: ExportFormat, path: &Path) -> Result<Vec<u8>, ExperimentError> {
    let columns = || -> Vec<TableColumn> {
        let column =
            |(name, values): &(String, Vec<f64>)| TableColumn::Number(name.clone(), values.clone());
        overlay.columns.iter().map(column).collect()
    };
    Ok(match format {
        ExportFormat::Parquet => write_parquet_table(path, &columns())?,
        ExportFormat::Mcap => {
            let (time, others) = overlay.columns.split_at(1);
            write_mcap_table(path, &stem(&overlay.recording), &time[0].1, others)?
        }
        _ => write_csv_table(&columns())?,
    })
}

/// The models of the last run of a plan, from `model.json` and `results.json` in its folder.
fn last_run(plan: &Plan, out: &Path) -> Result<FittedModels, ExperimentError> {
    let folder = ResultFolder::new(out, &plan.name);
    let shown = plan.source.display().to_string();
    let wrong = |message: String| ExperimentError::Meaning { file: shown.clone(), message };
    let missing = || {
        wrong(format!(
            "{} has no results of it; run it first: experiment {shown}",
            folder.path().display()
        ))
    };
    let read = |name: &str| -> Option<Value> {
        folder.earlier(name).and_then(|text| serde_json::from_str(&text).ok())
    };
    if plan.grid.is_some() {
        return Err(wrong("is a grid, which has many results; export a single experiment".into()));
    }
    let results = read("results.json").ok_or_else(missing)?;
    if let Some(changed) = changed_since(plan, &folder, &results) {
        return Err(wrong(changed));
    }
    let model = read("model.json").ok_or_else(|| {
        wrong(
            "no method of the last run identified a physical model, so there is none to export"
                .into(),
        )
    })?;
    let given: Vec<Estimate> =
        listed(&model["effects"]).flat_map(|e| listed(&e["parameters"])).map(estimate).collect();
    let method = model["provenance"]["method"].as_str().unwrap_or_default();
    let diagnosis = &results["diagnosis"];
    let found = listed(&diagnosis["found"]).filter_map(|id| id.as_str().map(str::to_owned));
    let found: Vec<String> = found.collect();
    let with: Vec<Estimate> = listed(&diagnosis["parameters"]).map(estimate).collect();
    let fitted = listed(&results["methods"]).find(|m| m["method"].as_str() == Some(method));
    let fitted = fitted.unwrap_or(&Value::Null);
    let combinations: Vec<Combination> = listed(&fitted["combinations"])
        .filter_map(|c| serde_json::from_value(c.clone()).ok())
        .collect();
    let of = |added: &[String], values: &[Estimate], from: &Value, method: &str| {
        let correlations = matrix(&from["correlations"]);
        FittedModel::new(plan, added, values, (&correlations, &combinations), method)
            .map_err(|e| wrong(e.to_string()))
    };
    let given = of(&[], &given, fitted, method)?.ok_or_else(missing)?;
    let found = if found.is_empty() { None } else { of(&found, &with, diagnosis, "diagnosis")? };
    Ok(FittedModels { given, found })
}

/// Changes since the run that wrote these `results`, as text.
fn changed_since(plan: &Plan, folder: &ResultFolder, results: &Value) -> Option<String> {
    if folder.earlier("experiment.toml").is_some_and(|text| text != plan.file) {
        let words = "was changed since its last run (or is read with another --set); run it again";
        return Some(words.into());
    }
    let mut recordings = plan.recordings.iter().zip(listed(&results["recordings"]));
    let (changed, _) =
        recordings.find(|(m, last)| m.sha256.as_deref() != last["sha256"].as_str())?;
    let name = changed.recording.name();
    Some(format!("{name} was changed since the last run; run it again"))
}

/// The entries of a list; empty for other values.
fn listed(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

/// Rows of numbers; what is none is NaN.
fn matrix(value: &Value) -> Vec<Vec<f64>> {
    let row = |row: &Value| listed(row).map(|x| x.as_f64().unwrap_or(f64::NAN)).collect();
    listed(value).map(row).collect()
}

/// A parameter as `model.json` and `results.json` write it.
fn estimate(entry: &Value) -> Estimate {
    let number = |key: &str| entry[key].as_f64();
    let text = |key: &str| entry[key].as_str().unwrap_or_default();
    let value = number("value").unwrap_or(f64::NAN);
    let std_error = number("std_error").unwrap_or(f64::INFINITY);
    let fixed = entry["fixed"].as_bool().unwrap_or(false);
    Estimate { fixed, ..Estimate::new(text("symbol"), text("unit").into(), value, std_error) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_recording_has_a_file_of_its_own() {
        assert_eq!(stem("runs/a b.csv"), "a_b");
        assert_eq!(stem("drive.json#slow-backward"), "drive_slow-backward");
        let mut files: Vec<(String, Vec<u8>)> = Vec::new();
        for recording in ["one/train.csv", "two/train.csv", "three/train.csv"] {
            files.push((free_name(&stem(recording), "csv", &files), vec![]));
        }
        let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["train.csv", "train-2.csv", "train-3.csv"]);
    }
}
