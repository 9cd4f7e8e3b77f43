//! The method or setting of a grid with the smallest error, as far as the repetitions distinguish them.

use super::cell::{Cell, Row};
use super::competitors::Competitor;
use crate::math::Moments;
use crate::math::distribution::t_quantile;
use crate::report::format;

/// Smallest number of pairs for a comparison.
const FEWEST_PAIRS: usize = 3;
/// Probability of naming a best alternative if all are equal.
const LEVEL: f64 = 0.05;

/// The smallest 2 s simulation error, and the alternatives close to it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Winner {
    name: String,
    /// Geometric mean of its errors [rad/s].
    error: f64,
    /// The others, the nearest first.
    rivals: Vec<Rival>,
}

/// Another alternative on the same data.
#[derive(Clone, Debug, PartialEq)]
struct Rival {
    name: String,
    /// Ratio of its error to the smallest: mean and interval.
    ratio: f64,
    interval: (f64, f64),
    pairs: usize,
}

impl Rival {
    fn is_distinguished(&self) -> bool {
        self.pairs >= FEWEST_PAIRS && self.interval.0 > 1.0
    }
}

/// The winner among competitors, the best first; `None` where nothing competes.
///
/// Methods compete, and values of keys that are not of the data. Errors are compared by their ratio on the same
/// data (seed, noise and recordings), with a t interval over the data of the mean logarithm, at a level divided
/// by the number of rivals (Bonferroni), since the winner was chosen among them.
pub(super) fn winner(competitors: &[Competitor]) -> Option<Winner> {
    let (best, others) = competitors.split_first()?;
    if others.is_empty() {
        return None;
    }
    let level = LEVEL / others.len() as f64;
    let against_best = |other: &Competitor| {
        let pairs = other.runs.iter().zip(&best.runs);
        let logs: Vec<f64> = pairs.map(|(a, b)| a.error.ln() - b.error.ln()).collect();
        rival(&other.name, &logs, level)
    };
    let rivals = others.iter().map(against_best).collect();
    Some(Winner { name: best.name.clone(), error: best.mean_log().exp(), rivals })
}

fn rival(name: &str, logs: &[f64], level: f64) -> Rival {
    let sample = Moments::of(logs.iter().copied());
    let (mean, freedom) = (sample.mean, (sample.count - 1.0).max(1.0));
    let reach = t_quantile(1.0 - 0.5 * level, freedom) * sample.std_error();
    let interval = ((mean - reach).exp(), (mean + reach).exp());
    Rival { name: name.to_owned(), ratio: mean.exp(), interval, pairs: logs.len() }
}

/// The data on which the errors of a grid were computed, if not only validation data.
pub(super) fn judged_on(cells: &[Cell]) -> &'static str {
    // a cell without a fit has no error
    let with_errors = || cells.iter().filter(|cell| !cell.rows.iter().all(Row::failed));
    let trained = with_errors().filter(|cell| cell.on_training).count();
    match trained {
        0 => "",
        n if n == with_errors().count() => " on the training data",
        _ => " on validation data, or on the training data where there are none",
    }
}

impl Winner {
    /// The headline of the report; `on`: the data of the errors, [`judged_on`].
    pub(super) fn sentence(&self, on: &str) -> String {
        let nearest = &self.rivals[0];
        let error = format::digits(self.error, 3);
        if self.rivals.iter().all(Rival::is_distinguished) {
            let [ratio, low, high] = [nearest.ratio, nearest.interval.0, nearest.interval.1]
                .map(|ratio| format::percent(ratio - 1.0));
            return format!(
                "{} has the smallest 2 s simulation error{on}, {error} rad/s; that of {}, the next, is {ratio} larger \
                 (95 %: {low} to {high}, {} pairs).",
                self.name, nearest.name, nearest.pairs
            );
        }
        if self.rivals.iter().all(|rival| rival.interval == (1.0, 1.0)) {
            let names: Vec<&str> = self.rivals.iter().map(|rival| rival.name.as_str()).collect();
            return format!(
                "{} has the same 2 s simulation error{on} as {}, {error} rad/s.",
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
                "{} has the smallest 2 s simulation error{on}, {error} rad/s, in {pairs} repetition{}: too few to \
                 distinguish it from {others}.",
                self.name,
                if pairs == 1 { "" } else { "s" }
            );
        }
        let [low, high] =
            [nearest.interval.0, nearest.interval.1].map(|ratio| format::digits(ratio, 4));
        format!(
            "{} has the smallest 2 s simulation error{on}, {error} rad/s, but is not distinguishable from {others} \
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
        let said = winner(clear).sentence("");
        assert!(said.contains("that of b, the next, is 11 % larger (95 %: 9"), "{said}");
        let said = winner(rival("b", &[0.1, -0.1, 0.05, 0.0], 0.05)).sentence("");
        assert!(said.contains("not distinguishable from b"), "{said}");
        assert!(winner(two).sentence("").contains("too few"));
        let same = winner(rival("b", &[0.0, 0.0, 0.0], 0.05)).sentence("");
        assert_eq!(same, "a has the same 2 s simulation error as b, 0.0500 rad/s.");
        let trained = winner(rival("b", &[0.0; 3], 0.05)).sentence(" on the training data");
        assert_eq!(
            trained,
            "a has the same 2 s simulation error on the training data as b, 0.0500 rad/s."
        );
    }
}
