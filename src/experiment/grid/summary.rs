//! Statistics over the repetitions: bias, RMSE, coverage and efficiency of each method per combination of the
//! keys other than the seed.

use std::collections::{HashMap, HashSet};
use std::sync::LazyLock;

use serde_json::json;

use super::cell::{Cell, Row};
use super::table::column_name;
use crate::experiment::combinations::GridPlan;
use crate::identify;
use crate::io::{IoError, TableColumn, group_rows};
use crate::math::distribution::{chi2_quantile, normal_quantile};
use crate::math::mean;

/// Names of the methods whose reported variance is the proxy of the Cramér-Rao bound.
static EFFICIENT: LazyLock<HashSet<String>> = LazyLock::new(|| {
    let efficient = identify::all().into_iter().filter(|method| method.is_efficient());
    efficient.map(|method| method.describe().name).collect()
});

/// Smallest number of repetitions for which a coverage is reported: of 20 correct intervals 19 cover the true
/// value on average; of fewer, all or all but one do for any coverage between 85 and 100 %.
pub(super) const FEWEST_COVERED: usize = 20;

/// A method and a parameter over the repetitions of a combination.
///
/// ```text
/// bias       = mean(v - v0)                  RMSE = sqrt(mean((v - v0)^2))
/// coverage   = share of 95 % intervals that cover v0
/// efficiency = mean(s^2) / RMSE^2
/// ```
/// with the estimate v and the true value v0. s is the standard error reported in the same cell by an efficient
/// method (`prediction_error`), a proxy of the Cramér-Rao bound; if none is run, s is the smallest standard error
/// reported by any method. Estimates that are not identifiable (infinite standard error) are counted
/// separately and excluded from the means; fixed parameters have no coverage and no efficiency.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Summary {
    /// Index on every axis except the seed, in the order of [`conditions`].
    pub(super) places: Vec<usize>,
    pub(super) method: String,
    pub(super) parameter: String,
    pub(super) unit: String,
    /// Number of estimates in the means.
    pub(super) n: usize,
    /// Number of cells in which the method failed.
    pub(super) failures: usize,
    /// Number of estimates with infinite standard error.
    pub(super) unidentifiable: usize,
    pub(super) truth: f64,
    pub(super) bias: f64,
    pub(super) rmse: f64,
    pub(super) std_error: f64,
    pub(super) coverage: f64,
    pub(super) efficiency: f64,
    /// Mean 2 s simulation error on the judged recordings [rad/s].
    pub(super) window_rms: f64,
    /// Mean noise floor of it [rad/s].
    pub(super) floor: f64,
}

impl Summary {
    /// 95 % interval of the RMSE: n RMSE^2 / sigma^2 is chi-square with n degrees of freedom if the
    /// error is normal without bias.
    pub(super) fn rmse_interval(&self) -> (f64, f64) {
        let n = self.n as f64;
        if self.n == 0 {
            return (f64::NAN, f64::NAN);
        }
        let end = |p: f64| self.rmse * (n / chi2_quantile(p, n)).sqrt();
        (end(0.975), end(0.025))
    }

    pub(super) fn coverage_interval(&self) -> (f64, f64) {
        share_interval(self.coverage, self.n)
    }
}

/// 95 % interval of a share of n draws. Source: Wilson, J. Am. Stat. Assoc. 22 (1927) 209-212.
pub(super) fn share_interval(p: f64, n: usize) -> (f64, f64) {
    let (n, z) = (n as f64, normal_quantile(0.975));
    let centre = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
    let reach = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + (z / (2.0 * n)).powi(2)).sqrt();
    (centre - reach, centre + reach)
}

/// The axes except the seed.
pub(super) fn conditions(grid: &GridPlan) -> Vec<usize> {
    (0..grid.axes.len()).filter(|k| !grid.axes[*k].is_seed()).collect()
}

/// Summaries of sorted cells, in the order of their first row.
///
/// # Errors
/// If the rows cannot be grouped.
pub(super) fn summaries(grid: &GridPlan, cells: &[Cell]) -> Result<Vec<Summary>, IoError> {
    let axes = conditions(grid);
    let rows: Vec<(&Cell, &Row)> =
        cells.iter().flat_map(|cell| cell.rows.iter().map(move |row| (cell, row))).collect();
    let places = |cell: &Cell| -> Vec<usize> {
        let all = grid.places(cell.cell);
        axes.iter().map(|k| all[*k]).collect()
    };
    let sizes: Vec<usize> = axes.iter().map(|k| grid.axes[*k].values.len()).collect();
    let condition = |cell: &Cell| places(cell).iter().zip(&sizes).fold(0, |n, (p, s)| n * s + p);
    let condition: Vec<usize> =
        cells.iter().flat_map(|c| std::iter::repeat_n(condition(c), c.rows.len())).collect();
    let mut failures: HashMap<(usize, &str), usize> = HashMap::new();
    let mut ran: HashSet<(usize, &str)> = HashSet::new();
    for ((_, row), condition) in rows.iter().zip(&condition) {
        if row.failed() {
            *failures.entry((*condition, &row.method)).or_default() += 1;
        } else {
            ran.insert((*condition, &row.method));
        }
    }
    let number = |name: &str, of: &mut dyn FnMut(usize) -> usize| {
        TableColumn::Number(name.into(), (0..rows.len()).map(|r| of(r) as f64).collect())
    };
    let (mut methods, mut parameters) = (Numbers::default(), Numbers::default());
    let groups = group_rows(&[
        number("condition", &mut |r| condition[r]),
        number("method", &mut |r| methods.of(&rows[r].1.method)),
        number("parameter", &mut |r| parameters.of(&rows[r].1.parameter)),
    ])?;
    let mut out = Vec::new();
    for group in groups {
        let (cell, first) = rows[group[0]];
        let at = (condition[group[0]], &*first.method);
        // failures are counted with the parameters, if the method has any
        let failed = group.iter().all(|r| rows[*r].1.failed());
        if failed && ran.contains(&at) {
            continue;
        }
        let members: Vec<(&Cell, &Row)> = group.iter().map(|r| rows[*r]).collect();
        let failures = failures.get(&at).copied().unwrap_or(0);
        out.push(summary(places(cell), &members, failures));
    }
    Ok(out)
}

/// Numbers texts in the order of their occurrence.
#[derive(Default)]
struct Numbers<'a>(HashMap<&'a str, usize>);

impl<'a> Numbers<'a> {
    fn of(&mut self, text: &'a str) -> usize {
        let next = self.0.len();
        *self.0.entry(text).or_insert(next)
    }
}

/// The variance used as the bound of a parameter in a cell.
fn bound(cell: &Cell, parameter: &str) -> Option<f64> {
    let claimed =
        |r: &&Row| *r.parameter == *parameter && r.std_error.0.is_finite() && r.std_error.0 > 0.0;
    let least = |rows: &mut dyn Iterator<Item = &Row>| {
        rows.map(|r| r.std_error.0.powi(2)).min_by(f64::total_cmp)
    };
    let claims = || cell.rows.iter().filter(claimed);
    least(&mut claims().filter(|r| EFFICIENT.contains(&*r.method))).or_else(|| least(&mut claims()))
}

fn summary(places: Vec<usize>, rows: &[(&Cell, &Row)], failures: usize) -> Summary {
    let first = rows[0].1;
    let given: Vec<&(&Cell, &Row)> =
        rows.iter().filter(|(_, r)| r.value.0.is_finite() && r.std_error.0.is_finite()).collect();
    let error = |r: &Row| r.value.0 - r.truth.0;
    let mse = mean(given.iter().map(|(_, r)| error(r).powi(2)));
    let free = given.iter().any(|(_, r)| r.std_error.0 > 0.0);
    let known = free && first.truth.0.is_finite();
    let covered = |r: &Row| f64::from(u8::from(r.low.0 <= r.truth.0 && r.truth.0 <= r.high.0));
    let bound = mean(given.iter().filter_map(|(cell, r)| bound(cell, &r.parameter)));
    let only = |known: bool, value: f64| if known { value } else { f64::NAN };
    Summary {
        places,
        method: first.method.to_string(),
        parameter: first.parameter.to_string(),
        unit: first.unit.to_string(),
        n: given.len(),
        failures,
        unidentifiable: rows.iter().filter(|(_, r)| r.std_error.0.is_infinite()).count(),
        truth: mean(given.iter().map(|(_, r)| r.truth.0)),
        bias: mean(given.iter().map(|(_, r)| error(r))),
        rmse: mse.sqrt(),
        std_error: mean(given.iter().map(|(_, r)| r.std_error.0)),
        coverage: only(known, mean(given.iter().map(|(_, r)| covered(r)))),
        efficiency: only(known, bound / mse),
        window_rms: mean(rows.iter().map(|(_, r)| r.window_rms.0).filter(|v| !v.is_nan())),
        floor: mean(rows.iter().map(|(_, r)| r.floor.0).filter(|v| !v.is_nan())),
    }
}

type Number = (&'static str, fn(&Summary) -> f64);

/// The numbers of a summary by name.
const NUMBERS: [Number; 13] = [
    ("n", |s| s.n as f64),
    ("failures", |s| s.failures as f64),
    ("unidentifiable", |s| s.unidentifiable as f64),
    ("truth", |s| s.truth),
    ("bias", |s| s.bias),
    ("rmse", |s| s.rmse),
    ("mean_std_error", |s| s.std_error),
    ("coverage_95", |s| s.coverage),
    ("coverage_95_low", |s| s.coverage_interval().0),
    ("coverage_95_high", |s| s.coverage_interval().1),
    ("efficiency", |s| s.efficiency),
    ("window_rms_validation", |s| s.window_rms),
    ("floor", |s| s.floor),
];

/// The summaries as a table: the conditions, method, parameter, unit and the numbers.
pub(super) fn columns(grid: &GridPlan, summaries: &[Summary]) -> Vec<TableColumn> {
    let mut out = Vec::new();
    for (j, k) in conditions(grid).into_iter().enumerate() {
        let axis = &grid.axes[k];
        let texts = summaries.iter().map(|s| axis.text(s.places[j])).collect();
        out.push(TableColumn::Text(column_name(axis), texts));
    }
    let text = |name: &str, of: fn(&Summary) -> &String| {
        TableColumn::Text(name.into(), summaries.iter().map(|s| of(s).clone()).collect())
    };
    out.push(text("method", |s| &s.method));
    out.push(text("parameter", |s| &s.parameter));
    out.push(text("unit", |s| &s.unit));
    for (name, of) in NUMBERS {
        out.push(TableColumn::Number(name.into(), summaries.iter().map(of).collect()));
    }
    out
}

/// A summary for `results.json`; numbers that are not finite are null.
pub(super) fn json(grid: &GridPlan, s: &Summary) -> serde_json::Value {
    let mut out = json!({ "method": s.method, "parameter": s.parameter, "unit": s.unit });
    let conditions = conditions(grid).into_iter().zip(&s.places);
    let conditions: serde_json::Map<_, _> = conditions
        .map(|(k, p)| (grid.axes[k].name.clone(), json!(grid.axes[k].values[*p])))
        .collect();
    out["combination"] = conditions.into();
    for (name, of) in NUMBERS {
        out[name] = json!(of(s));
    }
    for name in ["n", "failures", "unidentifiable"] {
        out[name] = json!(out[name].as_f64().unwrap_or_default() as u64);
    }
    out
}

#[cfg(test)]
mod tests;
