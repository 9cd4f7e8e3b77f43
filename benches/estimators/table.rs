//! Tables of the results, by robot.

use amigo_ident::identify::{Estimate, Fit};

use super::cases::Case;

/// A parameter: symbol, error in standard errors, whether the interval covers the true value, and whether it is held at
/// a known value.
type Found = (String, f64, bool, bool);

/// Result of one case.
pub(crate) struct Row {
    name: String,
    robot: String,
    /// Results by parameter.
    found: Vec<Found>,
    /// Relative error of the first parameter.
    first: f64,
    ratio: f64,
    seconds: f64,
    notes: Vec<String>,
    evaluations: usize,
}

impl Row {
    pub(crate) fn failed(case: &Case, seconds: f64) -> Self {
        let (name, robot) = (case.name.clone(), case.robot.clone());
        Self {
            name,
            robot,
            found: vec![],
            first: f64::NAN,
            ratio: f64::INFINITY,
            seconds,
            notes: vec![],
            evaluations: 0,
        }
    }

    pub(crate) fn new(
        case: &Case,
        estimates: &[(&Estimate, &f64)],
        ratio: f64,
        seconds: f64,
        fit: &Fit,
    ) -> Self {
        let found = estimates.iter().map(|(e, truth)| {
            let covered = e.interval.0 <= **truth && **truth <= e.interval.1;
            (
                e.symbol.clone(),
                (e.value - **truth) / e.std_error,
                covered,
                e.identifiable && !e.fixed,
            )
        });
        Self {
            name: case.name.clone(),
            robot: case.robot.clone(),
            found: found.collect(),
            first: estimates[0].0.value / estimates[0].1 - 1.0,
            ratio,
            seconds,
            notes: fit.notes.iter().map(ToString::to_string).collect(),
            evaluations: fit.work.evaluations,
        }
    }
}

pub(crate) fn print(method: &str, rows: &[Row]) {
    if std::env::var_os("CASES").is_some() {
        rows.iter().for_each(case);
    }
    let mut robots: Vec<&str> = rows.iter().map(|r| r.robot.as_str()).collect();
    robots.sort_unstable();
    robots.dedup();
    println!("{method}: covered of 95 % intervals, rms z, 2 s error over that of the true values");
    println!(
        "robot              sets | covered a1 .. a5 [%]      | rms z a1 .. a5                | mean   90 %   max   | s/fit"
    );
    for robot in robots {
        line(robot, &rows.iter().filter(|r| r.robot == robot).collect::<Vec<_>>());
    }
    line("all", &rows.iter().collect::<Vec<_>>());
}

fn case(row: &Row) {
    let z: Vec<String> = row.found.iter().map(|(s, z, ..)| format!("{s} {z:6.2}")).collect();
    let note =
        |n: &&String| n.contains("horizon") || n.contains("held") || n.contains("regression");
    let notes: Vec<&String> = row.notes.iter().filter(note).collect();
    let (seconds, passes) = (row.seconds, row.evaluations);
    let head =
        format!("{:12} {:10} {:6.3} {seconds:5.2} s {passes:3}", row.name, row.robot, row.ratio);
    println!("{head} {:+7.2} % {} {notes:?}", 100.0 * row.first, z.join(" "));
}

/// Summary of several sets.
pub(crate) struct Figures {
    sets: usize,
    /// Share of the 95 % intervals that cover the true value, by parameter [%].
    covered: Vec<f64>,
    /// Root mean square error in standard errors, by parameter.
    size: Vec<f64>,
    /// 2 s simulation error over that of the true parameters: mean, 90 % quantile, maximum.
    ratio: [f64; 3],
    seconds: f64,
}

impl Figures {
    pub(crate) fn of(rows: &[&Row]) -> Self {
        let count = rows.iter().map(|r| r.found.len()).max().unwrap_or(0);
        let known = |j: usize| rows.iter().filter_map(move |r| r.found.get(j)).filter(|f| f.3);
        let mean = |j: usize, value: &dyn Fn(&Found) -> f64| {
            known(j).map(value).sum::<f64>() / known(j).count().max(1) as f64
        };
        let covered = |j: usize| 100.0 * mean(j, &|f| f64::from(u8::from(f.2)));
        let mut ratios: Vec<f64> = rows.iter().map(|r| r.ratio).collect();
        ratios.sort_by(f64::total_cmp);
        let n = ratios.len();
        let average = ratios.iter().sum::<f64>() / n as f64;
        Self {
            sets: n,
            covered: (0..count).map(covered).collect(),
            size: (0..count).map(|j| mean(j, &|f| f.1 * f.1).sqrt()).collect(),
            ratio: [average, ratios[(n * 9 / 10).min(n - 1)], ratios[n - 1]],
            seconds: rows.iter().map(|r| r.seconds).sum::<f64>() / n as f64,
        }
    }

    pub(crate) fn json(&self, method: &str) -> serde_json::Value {
        let rounded = |v: f64, digits: i32| (v * 10f64.powi(digits)).round() / 10f64.powi(digits);
        serde_json::json!({
            "method": method,
            "sets": self.sets,
            "covered_percent": self.covered.iter().map(|v| rounded(*v, 1)).collect::<Vec<_>>(),
            "error_over_that_of_the_true_parameters": {
                "mean": rounded(self.ratio[0], 4),
                "nine_tenths": rounded(self.ratio[1], 3),
                "largest": rounded(self.ratio[2], 3),
            },
        })
    }
}

fn line(robot: &str, rows: &[&Row]) {
    let Figures { sets, covered, size, ratio, seconds } = Figures::of(rows);
    let covered: String = covered.iter().map(|v| format!("{v:5.1}")).collect();
    let size: String = size.iter().map(|v| format!("{v:6.2}")).collect();
    let [mean, most, largest] = ratio;
    println!(
        "{robot:18} {sets:4} |{covered} |{size} | {mean:6.3} {most:6.3} {largest:6.3} | {seconds:.2}"
    );
}
