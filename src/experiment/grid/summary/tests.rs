//! The statistics of a grid against values computed by hand.

use super::super::cell::{Exact, RowStatus};
use super::*;
use crate::identify::Status;

fn row(method: &str, value: f64, std_error: f64) -> Row {
    let estimate = crate::identify::Estimate::new("a1", "kg m^2".into(), value, std_error);
    Row {
        method: method.into(),
        parameter: "a1".into(),
        unit: estimate.unit.as_str().into(),
        value: Exact(value),
        std_error: Exact(std_error),
        low: Exact(estimate.interval.0),
        high: Exact(estimate.interval.1),
        truth: Exact(1.0),
        ise_train: Exact(0.0),
        ise_validation: Exact(0.0),
        window_rms: Exact(0.2),
        floor: Exact(0.1),
        grade: None,
        status: RowStatus::Fitted(Status::Converged),
        reason: "".into(),
        seconds: Exact(0.0),
    }
}

fn failure(method: &str) -> Row {
    let (parameter, status) = ("".into(), RowStatus::Failed);
    Row { parameter, status, ..row(method, f64::NAN, f64::NAN) }
}

fn cells(rows: Vec<Vec<Row>>) -> Vec<Cell> {
    let cell = |(cell, rows)| {
        let (key, found) = (String::new(), String::new());
        Cell { key, cell, verdict: None, found, on_training: false, rows }
    };
    rows.into_iter().enumerate().map(cell).collect()
}

fn seeds(count: i64) -> GridPlan {
    let values = (1..=count).map(toml::Value::Integer).collect();
    let axis = crate::experiment::file::GridAxis {
        name: "seed".into(),
        key: "simulation.seed".into(),
        values,
    };
    let (table, path) = (toml::Table::new(), std::path::PathBuf::new());
    GridPlan { axes: vec![axis], table, path, source: None, drives: std::sync::Arc::default() }
}

fn near(a: f64, b: f64) {
    // rounding of a few sums
    assert!((a - b).abs() < 1e-12, "{a} is not {b}");
}

#[test]
fn bias_rmse_coverage_and_efficiency_follow_their_definitions() {
    let all = cells(vec![
        vec![row("prediction_error", 1.1, 0.1), row("other", 1.4, 0.01)],
        vec![row("prediction_error", 0.9, 0.1), row("other", 1.2, 0.2)],
        vec![row("prediction_error", 1.0, f64::INFINITY), failure("other")],
    ]);
    let all = summaries(&seeds(3), &all).unwrap();
    assert_eq!(all.len(), 2, "failures stand with the parameters");
    let [best, other] = [&all[0], &all[1]];
    assert_eq!((best.n, best.failures, best.unidentifiable), (2, 0, 1));
    near(best.bias, 0.0);
    near(best.rmse, 0.1);
    near(best.coverage, 1.0);
    near(best.efficiency, 1.0);
    assert_eq!((other.n, other.failures, other.unidentifiable), (2, 1, 0));
    near(other.bias, 0.3);
    near(other.rmse, 0.1_f64.sqrt());
    near(other.coverage, 0.5);
    near(other.efficiency, 0.01 / 0.1);
    near(other.floor, 0.1);
}

#[test]
fn without_the_efficient_method_the_smallest_claim_of_each_cell_is_the_bound() {
    let all = cells(vec![vec![row("p", 1.2, 0.1), row("q", 1.2, 0.2)]]);
    let all = summaries(&seeds(1), &all).unwrap();
    near(all[0].efficiency, 0.01 / 0.04);
    near(all[1].efficiency, 0.01 / 0.04);
}

#[test]
fn a_method_that_always_fails_has_a_summary_that_says_so() {
    let all = summaries(&seeds(2), &cells(vec![vec![failure("p")], vec![failure("p")]])).unwrap();
    assert_eq!((all.len(), all[0].n, all[0].failures), (1, 0, 2));
    assert!(all[0].rmse.is_nan() && all[0].coverage.is_nan());
}

#[test]
fn intervals_of_rmse_and_coverage_are_the_published_ones() {
    let all = cells((0..10).map(|k| vec![row("p", 1.0 + 0.1 * f64::from(k % 2), 0.01)]).collect());
    let s = &summaries(&seeds(10), &all).unwrap()[0];
    // chi-square quantiles of 10 degrees of freedom: 3.247 and 20.483; four digits
    let (low, high) = s.rmse_interval();
    assert!((low / s.rmse - (10.0_f64 / 20.483).sqrt()).abs() < 1e-4, "{low}");
    assert!((high / s.rmse - (10.0_f64 / 3.247).sqrt()).abs() < 1e-3, "{high}");
    // Wilson's interval of 5 in 10 is 0.2366 to 0.7634
    let (low, high) = s.coverage_interval();
    assert!((low - 0.2366).abs() < 1e-4 && (high - 0.7634).abs() < 1e-4, "{low} {high}");
}
