//! Tables of what was found, by robot.

use amigo_ident::identify::{Estimate, Fit};

use super::cases::Case;

/// What one case gave.
pub(crate) struct Row {
    name: String,
    robot: String,
    /// Error in standard errors and whether the interval covers the truth, of each parameter.
    found: Vec<(String, f64, bool, bool)>,
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
    println!("{method}: covered of 95 % intervals, rms z, 2 s error over that of the truth");
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

fn line(robot: &str, rows: &[&Row]) {
    let count = rows.iter().map(|r| r.found.len()).max().unwrap_or(0);
    let (mut covered, mut size) = (String::new(), String::new());
    for j in 0..count {
        let known: Vec<_> = rows.iter().filter_map(|r| r.found.get(j)).filter(|f| f.3).collect();
        let of = known.len().max(1) as f64;
        let share = known.iter().filter(|f| f.2).count() as f64 / of;
        let square = known.iter().map(|f| f.1 * f.1).sum::<f64>() / of;
        covered += &format!("{:5.1}", 100.0 * share);
        size += &format!("{:6.2}", square.sqrt());
    }
    let mut ratios: Vec<f64> = rows.iter().map(|r| r.ratio).collect();
    ratios.sort_by(f64::total_cmp);
    let n = ratios.len();
    let mean = ratios.iter().sum::<f64>() / n as f64;
    let seconds = rows.iter().map(|r| r.seconds).sum::<f64>() / n as f64;
    println!(
        "{robot:18} {n:4} |{covered} |{size} | {mean:6.3} {:6.3} {:6.3} | {seconds:.2}",
        ratios[(n * 9 / 10).min(n - 1)],
        ratios[n - 1],
    );
}
