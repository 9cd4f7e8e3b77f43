//! Low-passes of speed sensors, distinguished from actuator lags.

use rayon::prelude::*;

use super::as_recorded::{AsRecorded, Rival};
use super::evidence::{evidence, noiseless, without_noise};
use super::fit::{WindowFit, fit};
use super::low_pass::{Computed, LowPass};
use super::thresholds::THRESHOLDS;
use super::timing::{Timed, log_likelihood, timed, with_timing};
use super::windows::{Errors, Windows};
use crate::effects::{Change, Effect, Scale};
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::Hold;

/// Ratio of one time constant that is tried to the next: three of them span a factor of two, over which a parabola in
/// the logarithm follows the error.
const RATIO: f64 = 1.4;

/// A low-pass of the recorded speeds, as determined from the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedFilter {
    /// Its form and time constant.
    pub low_pass: LowPass,
    /// Standard error of the time constant \[s\].
    pub std_error_s: f64,
    /// Whether a late actuator explains the speeds hardly worse.
    pub or_late: bool,
}

/// The low-pass filter of the sensor through which the speeds passed. `None` if angles were recorded too (they
/// determine it directly), if the model agrees with the speeds without a filter or with the dead time alone, or if a
/// late actuator explains them significantly better.
///
/// ```text
/// T w_r' = w - w_r          w: speed of the wheel, w_r: as recorded
/// w = w_r + T w_r'          the model is fitted to w at every T
/// e = w_r - F(w_simulated)  error of the comparison, F: the low-pass filter
/// ```
/// An average over the rows is inverted exactly, and its noise is then white again. The form with the smaller error is
/// returned.
///
/// A lag of the input and one of the sensor commute in a linear system. Friction distinguishes them: after a low-pass
/// filter of the sensor it appears delayed as well. Friction that is larger at rest makes speeds late too: if an effect
/// of the catalogue explains the speeds significantly better, the filter must be found again with it in the model.
#[must_use]
pub fn speed_filter(given: &AsRecorded) -> Option<SpeedFilter> {
    if given.recordings.iter().any(|r| r.measured().alpha) {
        return None;
    }
    let found = filter_under(given)?;
    let Some(rival) = better_effect(given, &found.left) else { return Some(found.filter) };
    filter_under(&given.with_model(&rival.model, rival.p())).map(|found| found.filter)
}

/// A low-pass with the squared innovations that it leaves in every window.
struct Found {
    filter: SpeedFilter,
    left: Vec<f64>,
}

/// The effect of the catalogue that explains the speeds as recorded best, if significantly better than a low-pass that
/// leaves these squared innovations.
fn better_effect<'b>(given: &'b AsRecorded, left: &[f64]) -> Option<&'b Rival> {
    let windows = &given.fit()?.windows;
    let better = given.rivals().par_iter().filter_map(|rival| {
        let with_effect = noiseless(windows, &rival.fit)?;
        is_better(&with_effect, left).then(|| (with_effect.iter().sum::<f64>(), rival))
    });
    better.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, rival)| rival)
}

/// Whether squared innovations in every window are significantly smaller than others.
fn is_better(one: &[f64], other: &[f64]) -> bool {
    let sum = |squares: &[f64]| squares.iter().sum::<f64>();
    sum(one) < sum(other) && evidence(one, other) > THRESHOLDS.uncertain.powi(2)
}

/// The low-pass with the model given, whatever else it lacks.
fn filter_under(given: &AsRecorded) -> Option<Found> {
    let AsRecorded { model, recordings, hold, scale, .. } = given;
    let (plain, start) = given.fit().zip(given.fitted())?;
    // at the noise floor there is no more to explain; above it the inertia may have absorbed the delay
    let is_late = plain.is_late(scale.logging);
    if plain.fit.is_short() || !is_late && plain.error() <= THRESHOLDS.above_floor {
        return None;
    }
    let search = Search { plain, model, p: start, recordings, hold: *hold, scale };
    let filter = search.best()?;
    let left = search.left(filter.low_pass, Noise::Removed)?;
    let sum = |squares: &[f64]| squares.iter().sum::<f64>();
    let without = noiseless(&plain.windows, &fit(&plain.windows, model, start, scale)?)?;
    let most = sum(&left) < THRESHOLDS.most_left * sum(&without);
    let beyond_chance = |late: &Vec<f64>, z2: f64| evidence(late, &left) > z2;
    // of speeds that are late as a whole a short low-pass with the rest as dead time is a part of that
    let shifted = noiseless(&plain.windows, &plain.fit)?;
    let bends = sum(&left) < sum(&shifted) && beyond_chance(&shifted, THRESHOLDS.strong);
    if !(most && bends) {
        return None;
    }
    let late = search.late_actuators(filter.low_pass);
    if !search.is_likely(filter.low_pass, &late) {
        return None;
    }
    let late: Vec<Vec<f64>> =
        late.iter().filter_map(|fit| noiseless(&plain.windows, fit)).collect();
    let least = !late.iter().any(|late| is_better(late, &left));
    let or_late = !late.iter().all(|late| beyond_chance(late, THRESHOLDS.alike));
    let filter = SpeedFilter { or_late, ..filter };
    least.then_some(Found { filter, left })
}

/// Contribution of noise of the recorded input to squared innovations.
enum Noise {
    Kept,
    Removed,
}

/// An average of the speeds over the rows.
pub(super) struct Averaged {
    pub(super) low_pass: SpeedFilter,
    /// Log-likelihood of the recorded speeds.
    pub(super) likelihood: f64,
    /// Parameters of the model fitted before the average.
    pub(super) p: Vec<f64>,
    /// Ratio of the error of that fit to noise.
    pub(super) error: f64,
}

/// The low-passes of speeds, with a model near `p`.
pub(super) struct Search<'a, 'b> {
    /// The model fitted to the speeds as recorded.
    pub(super) plain: &'b Timed<'a>,
    pub(super) model: &'b Model,
    pub(super) p: &'b [f64],
    pub(super) recordings: &'b [&'a Recording],
    pub(super) hold: Hold,
    pub(super) scale: &'b Scale,
}

impl Search<'_, '_> {
    /// The form and time constant of least error.
    fn best(&self) -> Option<SpeedFilter> {
        let of = |computed| self.best_of(computed);
        let found = [Computed::Continuously, Computed::AtRows].into_iter().filter_map(of);
        found.min_by(|a, b| self.sum(a.low_pass).total_cmp(&self.sum(b.low_pass)))
    }

    /// The time constant of least error, and its error by the bend of that.
    fn best_of(&self, computed: Computed) -> Option<SpeedFilter> {
        let sum = |time_s: f64| self.sum(LowPass { computed, time_s });
        let (time_s, bend) = self.least(&sum)?;
        let error = sum(time_s) / self.plain.windows.values() as f64;
        let std_error_s = time_s * (2.0 * error / bend).sqrt();
        let low_pass = LowPass { computed, time_s };
        Some(SpeedFilter { low_pass, std_error_s, or_late: true })
    }

    /// The time constant of least `score`, and the second derivative of that by the logarithm of the time constant.
    /// `None` without a minimum inside the range; the longest time constants leave noise alone of the speeds, whose
    /// score has no minimum.
    fn least(&self, score: &dyn Fn(f64) -> f64) -> Option<(f64, f64)> {
        let first = THRESHOLDS.logging * self.scale.step;
        let count = ((THRESHOLDS.longest_delay_s / first).ln() / RATIO.ln()).ceil().max(2.0) as i32;
        let times: Vec<f64> = (0..=count).map(|k| first * RATIO.powi(k)).collect();
        let scores: Vec<f64> = times.iter().map(|&t| score(t)).collect();
        let inside = (1..scores.len() - 1)
            .filter(|&n| scores[n] <= scores[n - 1] && scores[n] <= scores[n + 1]);
        let n = inside.min_by(|a, b| scores[*a].total_cmp(&scores[*b]))?;
        // a parabola through the logarithms of three times, twice, the second time closer
        let (mut middle, mut step, mut bend) = (times[n].ln(), RATIO.ln(), 0.0);
        for _ in 0..2 {
            let [low, least, high] = [-1.0, 0.0, 1.0].map(|k| score((middle + k * step).exp()));
            bend = (low - 2.0 * least + high) / (step * step);
            if !(bend > 0.0) {
                return None;
            }
            middle += (0.5 * (low - high) / (step * bend)).clamp(-step, step);
            step *= 0.4;
        }
        Some((middle.exp(), bend))
    }

    fn sum(&self, filter: LowPass) -> f64 {
        self.left(filter, Noise::Kept).map_or(f64::INFINITY, |left| left.iter().sum())
    }

    /// The recordings with the speeds before a low-pass.
    fn before(&self, filter: LowPass) -> Vec<Recording> {
        self.recordings.iter().map(|r| filter.before(r)).collect()
    }

    fn fitted<'r>(&self, recordings: &'r [Recording]) -> Option<Timed<'r>> {
        let recordings: Vec<&Recording> = recordings.iter().collect();
        timed(self.model, self.p, 0.0, &recordings, self.hold, self.scale)
    }

    /// Squared innovations of the recorded speeds in every window, with a model fitted before the low-pass.
    fn left(&self, filter: LowPass, noise: Noise) -> Option<Vec<f64>> {
        let before = self.before(filter);
        let Timed { windows, fit, .. } = self.fitted(&before)?;
        let recorded = &self.plain.windows;
        let squares = |windows: &Windows| {
            let errors = windows.errors(&fit.model, &fit.p)?;
            let behind = |(n, e): (usize, &Errors)| behind(recorded, n, e, &before, filter);
            let errors: Vec<Errors> = errors.iter().enumerate().map(behind).collect();
            Some(recorded.innovations(&errors))
        };
        match noise {
            Noise::Kept => squares(&windows),
            Noise::Removed => without_noise(&windows, squares),
        }
    }

    /// The likeliest average over the rows. Noise of the sensor that passed through an average is correlated from row
    /// to row, whatever the motion, and white before it. `None` of recordings with angles, which determine a low-pass
    /// directly.
    pub(super) fn most_likely(&self) -> Option<Averaged> {
        if self.recordings.iter().any(|r| r.measured().alpha) {
            return None;
        }
        let computed = Computed::AtRows;
        let of = |time_s: f64| self.averaged(LowPass { computed, time_s });
        let score = |time_s: f64| of(time_s).map_or(f64::INFINITY, |a| -2.0 * a.likelihood);
        let (time_s, bend) = self.least(&score)?;
        let found = of(time_s)?;
        let std_error_s = time_s * (2.0 / bend).sqrt();
        Some(Averaged { low_pass: SpeedFilter { std_error_s, ..found.low_pass }, ..found })
    }

    /// The recorded speeds y as averages over the rows of speeds x, with the model fitted to these. `None` where the
    /// robot would move before its input.
    ///
    /// ```text
    /// ln p(y) = ln p(x) - n ln g,   x(k) = y(k-1) + (y(k) - y(k-1))/g,   n: number of speeds
    /// ```
    fn averaged(&self, filter: LowPass) -> Option<Averaged> {
        let before = self.before(filter);
        let rows: Vec<&Recording> = before.iter().collect();
        let wheels = if rows.iter().all(|r| r.is_single_axis()) { 1.0 } else { 2.0 };
        let of = |r: &&Recording| {
            let speeds = wheels * (r.len() - r.pieces().len()) as f64;
            speeds * (1.0 - (-r.step() / filter.time_s).exp()).ln()
        };
        let narrowed: f64 = rows.iter().map(of).sum();
        let fitted = self.fitted(&before)?;
        let likelihood = log_likelihood(&fitted.fit, &rows, self.hold)? - narrowed;
        let low_pass = SpeedFilter { low_pass: filter, std_error_s: 0.0, or_late: false };
        let (p, error) = (fitted.fit.p[..self.p.len()].to_vec(), fitted.error());
        let causal = !fitted.is_early(self.scale.logging);
        causal.then_some(Averaged { low_pass, likelihood, p, error })
    }

    /// Whether the recorded speeds are more likely behind a low-pass than without it, and than with each of the `late`
    /// actuators: noise of the sensor, and a value that jumps within a row, pass through an average over the rows too.
    /// Noise may enter behind a low-pass that is computed before the sampling; it is not asked.
    fn is_likely(&self, filter: LowPass, late: &[WindowFit]) -> bool {
        if filter.computed == Computed::Continuously {
            return true;
        }
        let without = [&self.plain.fit].into_iter().chain(late);
        let of = |fit| log_likelihood(fit, self.recordings, self.hold);
        let without = without.filter_map(of).fold(f64::NEG_INFINITY, f64::max);
        self.averaged(filter).is_some_and(|with| with.likelihood > without)
    }

    /// Fits with each effect that delays the actuator, starting at about the time constant of the filter. As with the
    /// low-pass filter, the shift of the input is estimated too, except with a delay, which is equivalent. The initial
    /// values are those found with the low-pass filter, because a fit to delayed speeds attributes much of the delay to
    /// the inertia.
    pub(super) fn late_actuators(&self, filter: LowPass) -> Vec<WindowFit> {
        let before = self.before(filter);
        let found = self.fitted(&before).map_or_else(|| self.p.to_vec(), |behind| behind.fit.p);
        let late = crate::effects::all().into_iter().filter(|e| e.change() == Change::TimeShift);
        let windows = &self.plain.windows;
        let left = |effect: Box<dyn Effect>| {
            let timed = match effect.is_delay() {
                true => self.model.clone(),
                false => with_timing(self.model, windows.hold, self.scale)?,
            };
            let mut start = found.clone();
            start.resize(timed.parameters().len(), 0.0);
            let model = timed.add_effect(std::sync::Arc::from(effect)).ok()?;
            start.resize(model.parameters().len(), filter.time_s);
            fit(windows, &model, &start, self.scale)
        };
        late.filter_map(left).collect()
    }
}

/// Errors of window `n` of the recorded speeds, from those of the speeds `before` the low-pass.
fn behind(
    windows: &Windows,
    n: usize,
    errors: &Errors,
    before: &[Recording],
    filter: LowPass,
) -> Errors {
    let window = &windows.windows[n];
    let recorded = windows.recordings[window.recording];
    let (t, first) = (recorded.t(), window.rows.start);
    let speeds = before[window.recording].omega();
    let (mut low, mut last) = (window.start.omega, [0.0; 2]);
    let row = |(k, e): (usize, &[f64; 2])| {
        let row = first + k;
        let speed = [0, 1].map(|i| speeds[row][i] - e[i]);
        if k > 0 {
            let h = t[row] - t[row - 1];
            low = [0, 1].map(|i| filter.after(low[i], [last[i], speed[i]], h));
        }
        last = speed;
        [0, 1].map(|i| recorded.omega()[row][i] - low[i])
    };
    let error = errors.error.iter().enumerate().map(row).collect();
    Errors { error, ..*errors }
}
