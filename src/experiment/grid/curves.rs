//! Selection and names of the curves in figures of a grid.

use std::collections::BTreeSet;

use super::summary::{Summary, conditions};
use crate::experiment::combinations::GridPlan;

/// Largest number of curves per figure: that of the colours.
pub(super) const MOST_SERIES: usize = 7;

/// One curve per method and value of the varied keys; other keys are fixed.
pub(super) struct Curves {
    pub(super) names: Vec<String>,
    /// Indices, among the conditions, of the keys that distinguish curves.
    varied: Vec<usize>,
    /// Indices, among the conditions, of the keys that are fixed, each with the value.
    held: Vec<(usize, usize)>,
}

impl Curves {
    /// Keys other than that of the axis distinguish curves as long as there are enough colours, keys of the
    /// model and the method before those of the data; the others are fixed at their middle value.
    pub(super) fn new(grid: &GridPlan, summaries: &[Summary], along: usize) -> Self {
        let axes = conditions(grid);
        let methods: BTreeSet<&str> = summaries.iter().map(|s| s.method.as_str()).collect();
        let size = |j: usize| grid.axes[axes[j]].values.len();
        let mut others: Vec<usize> =
            (0..axes.len()).filter(|j| *j != along && size(*j) > 1).collect();
        others.sort_by_key(|j| grid.axes[axes[*j]].is_data());
        let mut out = Self { names: vec![], varied: vec![], held: vec![] };
        let mut count = methods.len().max(1);
        for j in others {
            if count * size(j) <= MOST_SERIES {
                count *= size(j);
                out.varied.push(j);
            } else {
                out.held.push((j, (size(j) - 1) / 2));
            }
        }
        let shown = summaries.iter().filter(|s| !s.parameter.is_empty() && out.shows(s));
        let mut names: Vec<String> = Vec::new();
        for name in shown.map(|s| out.name(grid, s)) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        out.names = names;
        out
    }

    /// Whether a summary belongs to the curve with this name.
    pub(super) fn has(&self, grid: &GridPlan, s: &Summary, name: &str) -> bool {
        self.shows(s) && self.name(grid, s) == name
    }

    fn shows(&self, s: &Summary) -> bool {
        self.held.iter().all(|(j, value)| s.places[*j] == *value)
    }

    /// The method and the values of the varied keys.
    fn name(&self, grid: &GridPlan, s: &Summary) -> String {
        let axes = conditions(grid);
        let values = self.varied.iter().map(|j| grid.axes[axes[*j]].text(s.places[*j]));
        std::iter::once(s.method.clone()).chain(values).collect::<Vec<_>>().join(", ")
    }

    /// Information that the names omit: the varied keys, the values of fixed keys, and curves without a
    /// colour.
    pub(super) fn words(&self, grid: &GridPlan) -> String {
        let axes = conditions(grid);
        let key = |j: usize| &grid.axes[axes[j]];
        let mut out = String::new();
        if !self.varied.is_empty() {
            let keys: Vec<&str> = self.varied.iter().map(|j| key(*j).name.as_str()).collect();
            out += &format!(" After the method: {}.", keys.join(", "));
        }
        if !self.held.is_empty() {
            let value = |(j, value): &(usize, usize)| {
                format!("{} = {}", key(*j).name, key(*j).text(*value))
            };
            let held: Vec<String> = self.held.iter().map(value).collect();
            out += &format!(" Shown at {}; all combinations are in summary.csv.", held.join(", "));
        }
        if self.names.len() > MOST_SERIES {
            out += &format!(
                " The first {MOST_SERIES} of {} curves; all are in summary.csv.",
                self.names.len()
            );
        }
        out
    }
}
