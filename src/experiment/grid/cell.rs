//! One combination: run, and reduced to rows.

use std::borrow::Cow;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::resolve::resolve_cell;
use super::word::Word;
use crate::experiment::combinations::GridPlan;
use crate::experiment::comparison::{Comparison, compare_figures};
use crate::experiment::diagnosis::diagnose;
use crate::experiment::fits::fits;
use crate::identify::{Estimate, Status};
use crate::study::{Grade, MethodStudy, Role, Verdict};

/// A number that is stored exactly, including non-finite values, which JSON does not support.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exact(pub(super) f64);

impl Serialize for Exact {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for Exact {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map(Self).map_err(serde::de::Error::custom)
    }
}

const MISSING: Exact = Exact(f64::NAN);

/// Result of a method in a cell, one row per parameter; a single row without a parameter if it has none.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Row {
    pub(super) method: Word,
    pub(super) parameter: Word,
    pub(super) unit: Word,
    pub(super) value: Exact,
    pub(super) std_error: Exact,
    pub(super) low: Exact,
    pub(super) high: Exact,
    pub(super) truth: Exact,
    pub(super) ise_train: Exact,
    pub(super) ise_validation: Exact,
    pub(super) window_rms: Exact,
    pub(super) floor: Exact,
    #[serde(default)]
    pub(super) grade: Option<Grade>,
    pub(super) status: RowStatus,
    pub(super) reason: Word,
    pub(super) seconds: Exact,
}

/// Status of a method in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum RowStatus {
    Failed,
    #[serde(untagged)]
    Fitted(Status),
}

impl RowStatus {
    /// Its name in `estimates.parquet`.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Failed => "failed",
            Self::Fitted(status) => status.name(),
        }
    }
}

impl Row {
    /// Whether the method has no fit.
    pub(super) fn failed(&self) -> bool {
        self.status == RowStatus::Failed
    }

    /// Its texts, to be shared with other rows.
    pub(super) fn words(&mut self) -> [&mut Word; 4] {
        let Self { method, parameter, unit, reason, .. } = self;
        [method, parameter, unit, reason]
    }
}

/// Verdict of the diagnosis of a cell, or the reason of its failure.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum CellVerdict {
    Failed(String),
    #[serde(untagged)]
    Concluded(Verdict),
}

impl CellVerdict {
    /// Name in `estimates.parquet`.
    pub(super) fn text(&self) -> Cow<'static, str> {
        match self {
            Self::Concluded(verdict) => verdict.name().into(),
            Self::Failed(reason) => format!("failed: {reason}").into(),
        }
    }
}

/// A completed combination: one line of the journal.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Cell {
    /// Hash of everything on which the result depends, including the cell.
    pub(super) key: String,
    /// Its number, from 0.
    pub(super) cell: usize,
    /// Verdict of its diagnosis, if requested.
    pub(super) verdict: Option<CellVerdict>,
    /// Effects found, joined by `+`.
    pub(super) found: String,
    /// Whether errors are computed on the training data, because no recording is held out.
    #[serde(default)]
    pub(super) on_training: bool,
    pub(super) rows: Vec<Row>,
}

impl Cell {
    /// Whether a method failed in it.
    pub(super) fn failed(&self) -> bool {
        self.rows.iter().any(Row::failed)
    }
}

/// Runs a cell. Failures are recorded in its rows; `methods` are the names used if nothing can be run.
pub(super) fn run_cell(grid: &GridPlan, cell: usize, key: String, methods: &[&str]) -> Cell {
    let start = Instant::now();
    let failed = |reason: String| {
        let seconds = start.elapsed().as_secs_f64();
        methods.iter().map(|m| failed_row(m, &reason, seconds)).collect()
    };
    let mut out =
        Cell { key, cell, verdict: None, found: String::new(), on_training: false, rows: vec![] };
    let plan = match resolve_cell(grid, cell) {
        Ok(plan) => plan,
        // without the file name, which may differ between machines
        Err(e) => return Cell { rows: failed(e.without_file()), ..out },
    };
    let comparison = match compare_figures(&plan, &fits(&plan)) {
        Ok(comparison) => comparison,
        Err(e) => return Cell { rows: failed(e.to_string()), ..out },
    };
    let truth = &plan.truth;
    out.on_training = !comparison.judged().are_held_out();
    out.rows = comparison.methods.iter().flat_map(|m| rows(&comparison, m, truth)).collect();
    out.verdict = match diagnose(&plan, comparison).and_then(|diagnosed| diagnosed.verdict(&plan)) {
        Ok(words) => words.map(|words| {
            out.found = words.found.join("+");
            CellVerdict::Concluded(words.verdict)
        }),
        Err(e) => Some(CellVerdict::Failed(e.to_string())),
    };
    out
}

fn failed_row(method: &str, reason: &str, seconds: f64) -> Row {
    Row {
        method: method.into(),
        parameter: "".into(),
        unit: "".into(),
        value: MISSING,
        std_error: MISSING,
        low: MISSING,
        high: MISSING,
        truth: MISSING,
        ise_train: MISSING,
        ise_validation: MISSING,
        window_rms: MISSING,
        floor: MISSING,
        grade: None,
        status: RowStatus::Failed,
        reason: reason.into(),
        seconds: Exact(seconds),
    }
}

fn rows(comparison: &Comparison, method: &MethodStudy, truth: &[(String, f64)]) -> Vec<Row> {
    let judged = comparison.judged();
    let floor = Exact(judged.floor());
    if let Some(reason) = &method.failure {
        return vec![Row {
            floor,
            ..failed_row(&method.name, &reason.to_string(), method.seconds)
        }];
    }
    let trained = comparison.recordings.iter().zip(&method.performance);
    let ise_train = trained.filter(|(r, _)| r.role == Role::Train);
    let ise_train = ise_train.map(|(_, p)| p.ise[0] + p.ise[1]).sum();
    let error = judged.window_rms(&method.performance);
    let base = Row {
        ise_train: Exact(ise_train),
        ise_validation: Exact(judged.ise(&method.performance)),
        window_rms: Exact(error),
        floor,
        grade: Some(Grade::of(error, judged.floor(), judged.top_speed())),
        status: RowStatus::Fitted(method.status.unwrap_or(Status::Converged)),
        ..failed_row(&method.name, "", method.seconds)
    };
    if method.estimates.is_empty() {
        return vec![base];
    }
    method.estimates.iter().map(|e| with_estimate(&base, e, truth)).collect()
}

fn with_estimate(base: &Row, e: &Estimate, truth: &[(String, f64)]) -> Row {
    let known = truth.iter().find(|(symbol, _)| *symbol == e.symbol);
    Row {
        parameter: e.symbol.as_str().into(),
        unit: e.unit.as_str().into(),
        value: Exact(e.value),
        std_error: Exact(e.std_error),
        low: Exact(e.interval.0),
        high: Exact(e.interval.1),
        truth: Exact(known.map_or(f64::NAN, |(_, v)| *v)),
        ..base.clone()
    }
}
