//! The alternatives compared in a grid: methods and settings, each with its runs on the same data.

use std::collections::BTreeMap;

use super::cell::Cell;
use crate::experiment::combinations::GridPlan;
use crate::math::mean;
use crate::study::Grade;

/// A run of an alternative.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    /// Number of its combination.
    pub(super) cell: usize,
    /// 2 s simulation error [rad/s].
    pub(super) error: f64,
    /// Its noise floor [rad/s].
    pub(super) floor: f64,
    pub(super) grade: Option<Grade>,
}

/// A method with values of the keys that are not of the data.
#[derive(Clone, Debug)]
pub(super) struct Competitor {
    pub(super) name: String,
    /// Runs by data (seed, noise and recordings), for those on which every alternative has an error.
    pub(super) runs: Vec<Run>,
}

impl Competitor {
    /// Mean of the logarithms of its errors.
    pub(super) fn mean_log(&self) -> f64 {
        mean(self.runs.iter().map(|run| run.error.ln()))
    }
}

/// The alternatives, that with the smallest geometric mean of the error first; empty if no data are common to
/// all.
pub(super) fn competitors(grid: &GridPlan, cells: &[Cell]) -> Vec<Competitor> {
    let all = by_data(grid, cells);
    let is_common = |data: &Vec<usize>| all.values().all(|runs| runs.contains_key(data));
    let of = |(name, runs): (&String, &BTreeMap<Vec<usize>, Run>)| {
        let common = runs.iter().filter(|(data, _)| is_common(data));
        Competitor { name: name.clone(), runs: common.map(|(_, run)| *run).collect() }
    };
    let mut out: Vec<Competitor> = all.iter().map(of).filter(|c| !c.runs.is_empty()).collect();
    out.sort_by(|a, b| a.mean_log().total_cmp(&b.mean_log()));
    out
}

fn by_data(grid: &GridPlan, cells: &[Cell]) -> BTreeMap<String, BTreeMap<Vec<usize>, Run>> {
    let mut out: BTreeMap<String, BTreeMap<Vec<usize>, Run>> = BTreeMap::new();
    for cell in cells {
        let places = grid.places(cell.cell);
        let axes = || grid.axes.iter().zip(&places);
        let data: Vec<usize> = axes().filter(|(a, _)| a.is_data()).map(|(_, p)| *p).collect();
        let settings: Vec<String> = axes()
            .filter(|(axis, _)| !axis.is_data() && axis.values.len() > 1)
            .map(|(axis, place)| format!("{} = {}", axis.name, axis.text(*place)))
            .collect();
        for row in cell.rows.iter().filter(|row| row.window_rms.0 > 0.0) {
            let parts = std::iter::once(row.method.to_string()).chain(settings.iter().cloned());
            let name = parts.collect::<Vec<_>>().join(", ");
            let (error, floor) = (row.window_rms.0, row.floor.0);
            let run = Run { cell: cell.cell, error, floor, grade: row.grade };
            out.entry(name).or_default().insert(data.clone(), run);
        }
    }
    out
}

/// The alternative with the smallest error, over all its runs.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Best {
    pub(super) name: String,
    /// Geometric mean of its errors [rad/s].
    pub(super) error: f64,
    /// Geometric mean of their noise floors [rad/s].
    pub(super) floor: f64,
    /// The grade reached by half of its runs.
    pub(super) grade: Option<Grade>,
    /// Number of runs with this grade, and of all runs.
    pub(super) runs: (usize, usize),
}

impl Best {
    /// The first of [`competitors`].
    pub(super) fn of(competitors: &[Competitor]) -> Option<Self> {
        let best = competitors.first()?;
        let mut grades: Vec<Grade> = best.runs.iter().filter_map(|run| run.grade).collect();
        grades.sort_unstable();
        let grade = grades.get(grades.len() / 2).copied();
        let alike = grades.iter().filter(|g| Some(**g) == grade).count();
        Some(Self {
            name: best.name.clone(),
            error: best.mean_log().exp(),
            floor: mean(best.runs.iter().map(|run| run.floor.ln())).exp(),
            grade,
            runs: (alike, best.runs.len()),
        })
    }

    /// Description of what the grade refers to, with the number of runs.
    pub(super) fn words(&self) -> String {
        let (alike, all) = self.runs;
        format!("{}, {alike} of {all} runs", self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_has_the_grade_that_half_of_its_runs_reach() {
        let run = |cell: usize, error: f64, grade: Grade| Run {
            cell,
            error,
            floor: 0.05,
            grade: Some(grade),
        };
        let (at, near, poor) = (Grade::AtFloor, Grade::Near, Grade::Poor);
        let runs =
            vec![run(0, 0.05, at), run(1, 0.07, near), run(2, 0.4, poor), run(3, 0.07, near)];
        let competitor = Competitor { name: "a".into(), runs };
        let best = Best::of(&[competitor]).unwrap();
        assert_eq!((best.grade, best.words().as_str()), (Some(near), "a, 2 of 4 runs"));
        // (0.05 0.07² 0.4)^(1/4)
        assert!(
            (best.error - 0.0995).abs() < 1e-4 && (best.floor - 0.05).abs() < 1e-12,
            "{best:?}"
        );
        assert_eq!(Best::of(&[]), None);
    }
}
