//! What a single run is doing, on a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::plan::Plan;

/// The stages of a run, shown while they last.
pub(super) struct Stages(ProgressBar);

impl Stages {
    /// Shows nothing unless asked to, and nothing but on a terminal.
    pub(super) fn new(plan: &Plan, shown: bool) -> Self {
        let target =
            if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(None, target);
        let style = ProgressStyle::with_template("{spinner} {prefix}: {msg} ({elapsed})");
        if let Ok(style) = style {
            bar.set_style(style);
        }
        bar.set_prefix(plan.name.clone());
        if shown {
            bar.enable_steady_tick(Duration::from_millis(120));
        }
        Self(bar)
    }

    /// A stage begins.
    pub(super) fn enter(&self, stage: &str) {
        self.0.set_message(stage.to_owned());
    }
}

impl Drop for Stages {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
