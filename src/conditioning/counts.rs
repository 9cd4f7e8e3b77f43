//! Speeds that were recorded without angles and come from an encoder's counts.
//!
//! A driver counts the steps of an encoder from row to row and divides by the time:
//!
//! ```text
//! omega_k = q/m sum over j < m of n_(k-j)/h_(k-j),   n_k whole,   h_k = t_k - t_(k-1),   alpha_k = q sum of n up to k
//! ```
//! with m = 1, or more where it takes the mean over m rows. The angle is that of the encoder: without delay, and
//! with no noise except rounding. Multiples of a step are also given by a driver that rounds a speed measured in
//! another way. Its errors in neighbouring rows are independent, while those of counts are compensated in the next
//! row:
//!
//! ```text
//! second differences of n:               var = 6 s²  rounded speeds,   20 s²  counts     (s² of one rounding)
//! the same of sums over two rows:              12 s²                   20 s²
//! ```
//! With n of one row the variance of counts is also 20/12, that of rounded speeds 6/12 (less if the motion is slow).
//! In a recording with fast motion the second criterion is not decisive; the decision is then that of the other
//! recordings of the log, or of the experiment file, if it describes the speeds as counts of an encoder and the ways
//! from row to row are whole numbers of them: a speed that is rounded to counts per second is not. If one recording
//! contradicts it, no speeds are replaced, because otherwise half of the log would be shifted by half a row against the
//! other.

use super::finding::{Channel, Finding, Kind};
use super::signal::{column, median_high};
use super::thresholds::SPEEDS;
use super::{Conditioned, Context, Settings};
use crate::math::noise::step_of_grid;
use crate::math::trimmed_mean_square;

/// The encoder from which speeds were computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder {
    /// One count \[rad\].
    pub step_rad: f64,
    /// Rows over which the driver took the mean.
    pub rows: usize,
}

impl Encoder {
    /// Whether its speeds are differences over single rows in steps of `count_rad` \[rad\].
    fn counts(self, count_rad: f64) -> bool {
        self.rows == 1 && (self.step_rad / count_rad - 1.0).abs() < SPEEDS.same_count
    }
}

/// The encoders from which speeds were computed, determined from all recordings of a log.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Encoders {
    /// Not determined: each recording is analysed separately.
    #[default]
    Unknown,
    /// Speeds are counts of these encoders, of the right and of the left wheel.
    Known([Encoder; 2]),
    /// Not all speeds can be counts.
    None,
}

/// The encoder according to the findings of the first recording that has any.
#[must_use]
pub fn common_encoders<'a>(
    mut recordings: impl Iterator<Item = &'a [Finding]>,
) -> Option<[Encoder; 2]> {
    let of = |findings: &[Finding], i: usize| {
        findings.iter().find_map(|f| match f.kind {
            Kind::Counts { step_rad, rows } if f.channel == Channel::Speed(i) => {
                Some(Encoder { step_rad, rows })
            }
            _ => None,
        })
    };
    recordings.find_map(|findings| of(findings, 0).zip(of(findings, 1))).map(Into::into)
}

/// Replaces speeds without angles that come from an encoder's counts by the angles that these add up to.
pub(super) fn angles(work: &mut Conditioned, settings: &Settings, context: &Context) {
    let channels = &work.channels;
    let (None, Some(omega)) = (&channels.alpha, &channels.omega) else { return };
    let steps = steps(&channels.t);
    let even = vec![median_high(steps[1..].iter().copied()); steps.len()];
    let of = |i: usize| {
        let omega = column(omega, i);
        let counts = |steps: &[f64]| match context.encoders {
            Encoders::Unknown => context.counts[i]
                .and_then(|step_rad| described(step_rad, &omega, steps))
                .or_else(|| counts(&omega, steps)),
            Encoders::Known(encoders) => {
                let described = context.counts[i].is_some_and(|count| encoders[i].counts(count));
                counts_of(encoders[i], &omega, steps, described)
            }
            Encoders::None => None,
        };
        counts(&steps).or_else(|| counts(&even))
    };
    let (Some(right), Some(left)) = (of(0), of(1)) else { return };
    for (i, wheel) in [&right, &left].into_iter().enumerate() {
        let kind = Kind::Counts { step_rad: wheel.step, rows: wheel.rows };
        work.findings.push(Finding::corrected(Channel::Speed(i), kind, "speeds", settings.speeds));
    }
    if settings.speeds {
        let sums = right.sums().zip(left.sums());
        work.channels.alpha = Some(sums.map(|(right, left)| [right, left]).collect());
        work.channels.omega = None;
    }
}

/// Time from the row before to each row; the first has none before it.
fn steps(t: &[f64]) -> Vec<f64> {
    std::iter::once(0.0).chain(t.windows(2).map(|w| w[1] - w[0])).collect()
}

/// Counts of a wheel.
struct Counts {
    /// One count \[rad\].
    step: f64,
    /// From row to row.
    counts: Vec<f64>,
    /// Rows over which the driver took the mean.
    rows: usize,
}

impl Counts {
    /// The angle in every row, from zero on \[rad\].
    fn sums(&self) -> impl Iterator<Item = f64> {
        self.counts.iter().scan(0.0, |sum, n| {
            *sum += n;
            Some(self.step * *sum)
        })
    }
}

/// The counts of a known encoder, `None` if speeds that were divided by `steps` are not on its grid, or if their
/// errors are not compensated in the next row although the motion is slow enough, unless they are described as counts.
fn counts_of(encoder: Encoder, omega: &[f64], steps: &[f64], described: bool) -> Option<Counts> {
    let Encoder { step_rad, rows } = encoder;
    on_grid(&sizes(&ways(omega, steps)), step_rad / rows as f64)?;
    let counts = by_row(omega, steps, step_rad, rows);
    let shown = described || taken_back(&counts) != Some(false);
    shown.then_some(Counts { step: step_rad, counts, rows })
}

/// The counts of an encoder that the experiment file describes, if the speeds are differences of them over single rows.
fn described(step_rad: f64, omega: &[f64], steps: &[f64]) -> Option<Counts> {
    let sizes = sizes(&ways(omega, steps));
    let step = on_grid(&sizes, step_rad).filter(|_| sizes.len() >= SPEEDS.counted_rows)?;
    let is_same = Encoder { step_rad: step, rows: 1 }.counts(step_rad);
    is_same.then(|| Counts { step, counts: by_row(omega, steps, step, 1), rows: 1 })
}

/// How far the wheel moved from row to row \[rad\].
fn ways(omega: &[f64], steps: &[f64]) -> Vec<f64> {
    omega.iter().zip(steps).map(|(w, h)| w * h).collect()
}

/// The sizes of the increments, ascending, in rows with motion.
fn sizes(ways: &[f64]) -> Vec<f64> {
    let mut sizes: Vec<f64> = ways.iter().map(|d| d.abs()).filter(|d| *d > 0.0).collect();
    sizes.sort_by(f64::total_cmp);
    sizes
}

/// The counts of speeds that were divided by `steps`; `None` for other speeds.
fn counts(omega: &[f64], steps: &[f64]) -> Option<Counts> {
    let ways = ways(omega, steps);
    let sizes = sizes(&ways);
    if sizes.len() < SPEEDS.counted_rows {
        return None;
    }
    // a spike or a digit may be smaller still
    let least = sizes[sizes.len() / SPEEDS.counted_rows];
    let step =
        (1..=SPEEDS.least_counts).find_map(|part| on_grid(&sizes, least / f64::from(part)))?;
    let mut levels: Vec<f64> = ways.iter().map(|d| (d / step).round()).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    if levels.len() < SPEEDS.counted_levels {
        return None;
    }
    let over = |rows: usize| {
        let step = step * rows as f64;
        Counts { step, counts: by_row(omega, steps, step, rows), rows }
    };
    (1..=SPEEDS.mean_rows).map(over).find(|found| taken_back(&found.counts) == Some(true))
}

/// Counts of `step` from row to row, where each speed is the mean of those of `rows` rows and nothing moved before
/// the first. Whole numbers prevent errors from accumulating over the rows.
fn by_row(omega: &[f64], steps: &[f64], step: f64, rows: usize) -> Vec<f64> {
    let mut counts: Vec<f64> = Vec::with_capacity(omega.len());
    for (k, w) in omega.iter().enumerate() {
        let before = (1..rows.min(k)).map(|j| counts[k - j] / steps[k - j]).sum::<f64>();
        counts.push((steps[k] * (rows as f64 * w / step - before)).round());
    }
    counts
}

/// The step of the grid, near `step`, on which all increments lie; `sizes` are theirs, ascending.
fn on_grid(sizes: &[f64], step: f64) -> Option<f64> {
    let step = step_of_grid(sizes, step);
    let off = |d: &f64| (d / step - (d / step).round()).powi(2);
    let error = trimmed_mean_square(sizes.iter().map(off).collect()).sqrt();
    (error < SPEEDS.off_counts).then_some(step)
}

/// Whether counting errors are compensated in the next row; `None` if motion hides this.
fn taken_back(counts: &[f64]) -> Option<bool> {
    let variance = |n: &[f64]| {
        let bends = n.windows(3).filter(|w| w.iter().any(|n| *n != 0.0));
        trimmed_mean_square(bends.map(|w| (w[2] - 2.0 * w[1] + w[0]).powi(2)).collect())
    };
    let pairs: Vec<f64> = counts.chunks_exact(2).map(|pair| pair[0] + pair[1]).collect();
    let single = variance(counts);
    let taken_back = || single > SPEEDS.counted && variance(&pairs) < SPEEDS.taken_back * single;
    (single > 0.0 && single < SPEEDS.hidden_by_motion).then(taken_back)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Channels;
    use rand::{Rng, SeedableRng};

    const COUNT: f64 = std::f64::consts::TAU / 1024.0;

    fn motion(t: f64) -> [f64; 2] {
        [6.0 * t + 2.0 * (1.3 * t).sin(), 4.0 * (0.9 * t).sin()]
    }

    /// Rows of about 10 ms at uneven times; `speed` from the angles before and now, and the time between.
    fn work(speed: impl Fn(f64, f64, f64) -> f64) -> (Conditioned, Vec<[f64; 2]>) {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let late = |k: i32, rng: &mut rand_chacha::ChaCha8Rng| {
            0.01 * f64::from(k) + 5e-4 * rng.random::<f64>()
        };
        let t: Vec<f64> = (0..2000).map(|k| late(k, &mut rng)).collect();
        let angles: Vec<[f64; 2]> = t.iter().map(|t| motion(*t)).collect();
        let row = |k: usize| {
            let before = if k == 0 { angles[0] } else { angles[k - 1] };
            let h = if k == 0 { 0.01 } else { t[k] - t[k - 1] };
            [0, 1].map(|i| speed(before[i], angles[k][i], h))
        };
        let omega = Some((0..t.len()).map(row).collect());
        let torque = vec![[0.1; 2]; t.len()];
        let channels = Channels { t, alpha: None, omega, torque };
        (Conditioned { channels, findings: vec![] }, angles)
    }

    #[test]
    fn differences_of_counts_add_up_to_the_angle() {
        let counted = |a: f64| (a / COUNT).floor();
        let (mut work, angles) =
            work(|before, now, h| COUNT * (counted(now) - counted(before)) / h);
        super::angles(&mut work, &Settings::default(), &Context::default());
        assert!(
            matches!(work.findings[0].kind, Kind::Counts { step_rad, rows: 1 } if (step_rad / COUNT - 1.0).abs() < 1e-9)
        );
        assert!(work.channels.omega.is_none());
        let found = work.channels.alpha.unwrap();
        for (found, is) in found.iter().zip(&angles) {
            let off = [0, 1].map(|i| found[i] - (is[i] - angles[0][i]));
            assert!(off.iter().all(|off| off.abs() < 1.01 * COUNT), "{off:?}");
        }
    }

    #[test]
    fn means_over_rows_are_taken_apart() {
        // 2000 rows of 10 ms from rest
        let angle = |k: i32| 3.0 * (1.0 - (0.02 * f64::from(k.max(0))).cos());
        let counted = |k: i32| (angle(k) / COUNT).floor();
        for rows in [2, 3, 5] {
            let speed =
                |k: i32| COUNT * (counted(k) - counted(k - rows)) / (0.01 * f64::from(rows));
            let t: Vec<f64> = (0..2000).map(|k| 0.01 * f64::from(k)).collect();
            let omega = Some((0..2000).map(|k| [speed(k); 2]).collect());
            let channels = Channels { torque: vec![[0.1; 2]; t.len()], t, alpha: None, omega };
            let mut work = Conditioned { channels, findings: vec![] };
            super::angles(&mut work, &Settings::default(), &Context::default());
            assert!(
                matches!(work.findings[0].kind, Kind::Counts { rows: n, .. } if n == rows as usize)
            );
            for (k, found) in work.channels.alpha.unwrap().iter().enumerate() {
                assert!((found[0] - angle(k as i32)).abs() < 1.01 * COUNT);
            }
        }
    }

    #[test]
    fn speeds_that_are_rounded_or_exact_stay() {
        // rounded to steps as coarse as those of a count in a row
        let rounded = |before: f64, now: f64, h: f64| {
            let step = COUNT / 0.01;
            ((now - before) / h / step).round() * step
        };
        for speed in
            [&rounded as &dyn Fn(f64, f64, f64) -> f64, &|before, now, h| (now - before) / h]
        {
            let (mut work, _) = work(speed);
            super::angles(&mut work, &Settings::default(), &Context::default());
            assert!(work.findings.is_empty(), "{:?}", work.findings);
        }
    }

    /// Counts of a wheel that shakes: their second differences are far more than those of rounding.
    fn shaking(counted: impl Fn(f64) -> f64) -> Conditioned {
        let angle = |k: i32| 3.0 * (0.02 * f64::from(k)).sin() + 0.05 * (0.9 * f64::from(k)).sin();
        let speed = |k: i32| COUNT * (counted(angle(k)) - counted(angle(k - 1))) / 0.01;
        let t: Vec<f64> = (0..2000).map(|k| 0.01 * f64::from(k)).collect();
        let omega = Some((0..2000).map(|k| [speed(k); 2]).collect());
        let channels = Channels { torque: vec![[0.1; 2]; t.len()], t, alpha: None, omega };
        Conditioned { channels, findings: vec![] }
    }

    #[test]
    fn described_counts_are_added_up_where_motion_hides_them() {
        let described = Context { counts: [Some(COUNT); 2], ..Context::default() };
        let is_counted = |mut work: Conditioned| {
            super::angles(&mut work, &Settings::default(), &described);
            work.channels.omega.is_none()
        };
        assert!(is_counted(shaking(|a| (a / COUNT).floor())));
        assert!(!is_counted(shaking(|a| a / COUNT)));
        // a speed in whole counts per second, and counts of another encoder
        let speed = |w: f64| (w / COUNT).round() * COUNT;
        let mut rounded = shaking(|a| a / COUNT);
        rounded.channels.omega.iter_mut().flatten().for_each(|w| *w = w.map(speed));
        assert!(!is_counted(rounded));
        assert!(!is_counted(shaking(|a| (a / COUNT / 1.3).floor() * 1.3)));
    }

    #[test]
    fn other_recordings_of_the_log_tell_where_motion_hides_the_counts() {
        let counted = |a: f64| (a / COUNT).floor();
        let (mut slow, _) = work(|before, now, h| COUNT * (counted(now) - counted(before)) / h);
        let mut fast = shaking(counted);
        for work in [&mut slow, &mut fast] {
            super::angles(work, &Settings::default(), &Context::default());
        }
        assert!(slow.channels.omega.is_none() && fast.channels.omega.is_some());
        let found = [&fast, &slow].map(|work| work.findings.as_slice());
        let encoders = Encoders::Known(common_encoders(found.into_iter()).unwrap());
        super::angles(&mut fast, &Settings::default(), &Context { encoders, ..Context::default() });
        assert!(fast.channels.omega.is_none());
        // speeds on no such grid are unchanged, and so are all if one recording cannot be counts
        let mut exact = shaking(|a| a / COUNT);
        super::angles(
            &mut exact,
            &Settings::default(),
            &Context { encoders, ..Context::default() },
        );
        assert!(exact.channels.omega.is_some());
        let (mut slow, _) = work(|before, now, h| COUNT * (counted(now) - counted(before)) / h);
        let none = Context { encoders: Encoders::None, ..Context::default() };
        super::angles(&mut slow, &Settings::default(), &none);
        assert!(slow.channels.omega.is_some());
    }

    #[test]
    fn the_switch_leaves_the_speeds() {
        let counted = |a: f64| (a / COUNT).floor();
        let (mut work, _) = work(|before, now, h| COUNT * (counted(now) - counted(before)) / h);
        super::angles(
            &mut work,
            &Settings { speeds: false, ..Settings::default() },
            &Context::default(),
        );
        assert!(work.channels.alpha.is_none() && work.findings.len() == 2);
    }
}
