//! Progress of a single run on a terminal.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::diagnose::Progress;

/// The stages of a run, shown while they are active.
pub(super) struct Stages(Shown);

/// The progress shown, shared by its counters.
#[derive(Clone)]
struct Shown {
    bar: ProgressBar,
    stage: Arc<Mutex<String>>,
}

impl Stages {
    /// Shows nothing.
    pub(super) fn hidden() -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        Self(Shown { bar, stage: Arc::default() })
    }

    /// Shows nothing unless requested, and only on a terminal.
    pub(super) fn new(experiment: &str, shown: bool) -> Self {
        let stages = Self::hidden();
        if !shown {
            return stages;
        }
        let bar = &stages.0.bar;
        bar.set_draw_target(ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template("{spinner} {prefix}: {msg} ({elapsed})");
        if let Ok(style) = style {
            bar.set_style(style);
        }
        bar.set_prefix(experiment.to_owned());
        bar.enable_steady_tick(Duration::from_millis(120));
        stages
    }

    /// Begins a stage.
    pub(super) fn enter(&self, stage: &str) {
        self.0.bar.set_message(stage.to_owned());
        if let Ok(mut current) = self.0.stage.lock() {
            stage.clone_into(&mut current);
        }
    }

    /// Returns a function that shows the number of completed `items` of the stage and the remaining time.
    pub(super) fn counting(&self, items: &'static str) -> Progress {
        let shown = self.0.clone();
        let rate = Mutex::new(Rate::from(0, Instant::now()));
        Arc::new(move |done, total| {
            let (Ok(stage), Ok(mut rate)) = (shown.stage.lock(), rate.lock()) else { return };
            let left = rate.left(done, total, Instant::now());
            // after the last item follows work that is not counted
            shown.bar.set_message(match done < total {
                true => format!("{stage}, {done} of {total} {items}{}", words(left)),
                false => stage.clone(),
            });
        })
    }
}

impl Drop for Stages {
    fn drop(&mut self) {
        self.0.bar.finish_and_clear();
    }
}

/// Remaining times below this are not shown.
const SHORT: Duration = Duration::from_secs(2);
/// Number of items after the first that must be completed before the rate is known.
const FEWEST: usize = 2;

fn words(left: Option<Duration>) -> String {
    let left = left.filter(|left| *left >= SHORT);
    left.map_or(String::new(), |left| format!(", {:#} left", HumanDuration(left)))
}

/// Rate of completed items. The first is excluded, because it includes work common to all.
struct Rate {
    first: usize,
    since: Instant,
    last: usize,
}

impl Rate {
    fn from(first: usize, since: Instant) -> Self {
        Self { first, since, last: first }
    }

    /// The remaining time for the other items of `total`, if the rate is known.
    fn left(&mut self, done: usize, total: usize, now: Instant) -> Option<Duration> {
        if self.last == 0 || done < self.last {
            // another round
            *self = Self::from(done, now);
        }
        self.last = done;
        let counted = done - self.first;
        let known = counted >= FEWEST && done < total;
        known.then(|| (now - self.since).mul_f64((total - done) as f64 / counted as f64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_that_of_the_other_items_at_the_rate_since_the_first() {
        let start = Instant::now();
        let after = |s: u64| start + Duration::from_secs(s);
        let mut rate = Rate::from(0, start);
        // the first item takes longer than the others
        assert_eq!(rate.left(1, 11, after(20)), None);
        assert_eq!(rate.left(2, 11, after(23)), None);
        assert_eq!(rate.left(3, 11, after(26)), Some(Duration::from_secs(24)));
        assert_eq!(rate.left(11, 11, after(50)), None);
        // the next round
        assert_eq!(rate.left(1, 5, after(60)), None);
        assert_eq!(rate.left(3, 5, after(70)), Some(Duration::from_secs(10)));
        assert_eq!(words(Some(Duration::from_secs(24))), ", 24s left");
        assert_eq!(words(Some(Duration::from_millis(900))), "");
    }
}
