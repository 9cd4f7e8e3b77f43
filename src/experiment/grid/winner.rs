//! Which method or setting of a grid has the smallest error, as far as the repetitions distinguish them.

use std::collections::BTreeMap;

use super::cell::Cell;
use crate::experiment::combinations::GridPlan;
use crate::math::distribution::t_quantile;
use crate::report::format;

/// Pairs below which nothing is said of a difference.
const FEWEST_PAIRS: usize = 3;
/// Chance of naming a winner where all are alike.
const LEVEL: f64 = 0.05;

/// What competes, with the logarithms of its 2 s simulation errors by the data that they were found on.
type Errors = BTreeMap<String, BTreeMap<Vec<usize>, f64>>;

/// The smallest 2 s simulation error, and what comes closest to it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Winner {
    name: String,
    /// Geometric mean of its errors [rad/s].
    error: f64,
    /// The others, the nearest first.
    rivals: Vec<Rival>,
}

/// Another competitor on the same data.
#[derive(Clone, Debug, PartialEq)]
struct Rival {
    name: String,
    /// Its error over that of the winner: mean and interval.
    ratio: f64,
    interval: (f64, f64),
    pairs: usize,
}

impl Rival {
    fn is_distinguished(&self) -> bool {
        self.pairs >= FEWEST_PAIRS && self.interval.0 > 1.0
    }
}

/// The winner among methods and settings; `None` where nothing competes.
///
/// Methods compete, and values of keys that are not of the data. Errors are compared by their ratio on the same
/// data (seed, noise and recordings), with a t interval over the data of the mean logarithm, at a level divided
/// by the number of rivals (Bonferroni), since the winner was chosen among them.
pub(super) fn winner(grid: &GridPlan, cells: &[Cell]) -> Option<Winner> {
    let errors = errors(grid, cells);
    // of data on which a competitor has no error nothing is compared
    let first = errors.values().next()?;
    let common: Vec<&Vec<usize>> =
        first.keys().filter(|data| errors.values().all(|e| e.contains_key(*data))).collect();
    if errors.len() < 2 || common.is_empty() {
        return None;
    }
    let mean = |name: &String| {
        common.iter().map(|data| errors[name][*data]).sum::<f64>() / common.len() as f64
    };
    let best = errors.keys().min_by(|a, b| mean(a).total_cmp(&mean(b)))?;
    let level = LEVEL / (errors.len() - 1) as f64;
    let mut rivals: Vec<Rival> = errors
        .keys()
        .filter(|name| *name != best)
        .map(|name| {
            let logs: Vec<f64> =
                common.iter().map(|data| errors[name][*data] - errors[best][*data]).collect();
            rival(name, &logs, level)
        })
        .collect();
    rivals.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
    Some(Winner { name: best.clone(), error: mean(best).exp(), rivals })
}

fn rival(name: &str, logs: &[f64], level: f64) -> Rival {
    let n = logs.len() as f64;
    let mean = logs.iter().sum::<f64>() / n;
    let variance = logs.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let reach = t_quantile(1.0 - 0.5 * level, (n - 1.0).max(1.0)) * (variance / n).sqrt();
    let interval = ((mean - reach).exp(), (mean + reach).exp());
    Rival { name: name.to_owned(), ratio: mean.exp(), interval, pairs: logs.len() }
}

fn errors(grid: &GridPlan, cells: &[Cell]) -> Errors {
    let mut out = Errors::new();
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
            out.entry(name).or_default().insert(data.clone(), row.window_rms.0.ln());
        }
    }
    out
}

impl Winner {
    /// The headline of the report.
    pub(super) fn sentence(&self) -> String {
        let nearest = &self.rivals[0];
        let error = format::digits(self.error, 3);
        if nearest.is_distinguished() {
            let [ratio, low, high] = [nearest.ratio, nearest.interval.0, nearest.interval.1]
                .map(|ratio| format::percent(ratio - 1.0));
            return format!(
                "{} has the smallest 2 s simulation error, {error} rad/s; that of {}, the next, is {ratio} larger \
                 (95 %: {low} to {high}, {} pairs).",
                self.name, nearest.name, nearest.pairs
            );
        }
        if self.rivals.iter().all(|rival| rival.interval == (1.0, 1.0)) {
            let names: Vec<&str> = self.rivals.iter().map(|rival| rival.name.as_str()).collect();
            return format!(
                "{} has the same 2 s simulation error as {}, {error} rad/s.",
                self.name,
                names.join(", ")
            );
        }
        let alike: Vec<&Rival> = self.rivals.iter().filter(|r| !r.is_distinguished()).collect();
        let others = match alike.as_slice() {
            [one] => one.name.clone(),
            many if many.len() == self.rivals.len() => format!("any of the {} others", many.len()),
            many => format!("{} of the {} others", many.len(), self.rivals.len()),
        };
        let pairs = nearest.pairs;
        if pairs < FEWEST_PAIRS {
            return format!(
                "{} has the smallest 2 s simulation error, {error} rad/s, in {pairs} repetition{}: too few to \
                 distinguish it from {others}.",
                self.name,
                if pairs == 1 { "" } else { "s" }
            );
        }
        let [low, high] =
            [nearest.interval.0, nearest.interval.1].map(|ratio| format::digits(ratio, 4));
        format!(
            "{} has the smallest 2 s simulation error, {error} rad/s, but is not distinguishable from {others} \
             (error of {} over it, 95 %: {low} to {high}, {pairs} pairs).",
            self.name, nearest.name
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_is_said_with_the_interval_of_the_pairs() {
        // logs 0.1 and 0.3, mean 0.2, standard error 0.1; t(0.975, 1) = 12.706
        let two = rival("b", &[0.1, 0.3], 0.05);
        assert!((two.ratio - 0.2_f64.exp()).abs() < 1e-12);
        // 1e-3: digits of the tabulated quantile
        assert!((two.interval.0.ln() - (0.2 - 1.2706)).abs() < 1e-3, "{two:?}");
        assert!(!two.is_distinguished());
        let clear = rival("b", &[0.10, 0.11, 0.09, 0.10], 0.05);
        assert!(clear.is_distinguished());
        let winner = |rival: Rival| Winner { name: "a".into(), error: 0.05, rivals: vec![rival] };
        let said = winner(clear).sentence();
        assert!(said.contains("that of b, the next, is 11 % larger (95 %: 9"), "{said}");
        let said = winner(rival("b", &[0.1, -0.1, 0.05, 0.0], 0.05)).sentence();
        assert!(said.contains("not distinguishable from b"), "{said}");
        assert!(winner(two).sentence().contains("too few"));
        let same = winner(rival("b", &[0.0, 0.0, 0.0], 0.05)).sentence();
        assert_eq!(same, "a has the same 2 s simulation error as b, 0.0500 rad/s.");
    }
}
