//! Columns of a study as points to draw.

use crate::recording::Regime;
use crate::report::figure::{Layer, Role};
use crate::study::{MethodStudy, Performance, RecordingStudy, Study};

/// A simulated speed beyond this many times the fastest measured one is not drawn: a model that
/// diverges would flatten everything else.
const FAR: f64 = 5.0;

/// The recording shown in detail, the first judged one, with its index.
pub(super) fn shown(study: &Study) -> Option<(usize, &RecordingStudy)> {
    let first = *study.judged().first()?;
    Some((first, study.recordings.get(first)?))
}

/// How a method does on the recording shown in detail.
pub(super) fn shown_performance<'a>(
    study: &'a Study,
    method: &'a MethodStudy,
) -> Option<(&'a RecordingStudy, &'a Performance)> {
    let (index, recording) = shown(study)?;
    Some((recording, method.performance.get(index)?))
}

/// Values of one wheel over time.
pub(super) fn wheel(t: &[f64], rows: &[[f64; 2]], i: usize) -> Vec<(f64, f64)> {
    t.iter().zip(rows).map(|(t, row)| (*t, row[i])).collect()
}

/// Simulated speeds of one wheel over time, without what is far outside the measured ones.
pub(super) fn simulated(
    recording: &RecordingStudy,
    rows: &[[f64; 2]],
    i: usize,
) -> Vec<(f64, f64)> {
    let limit = FAR * fastest(recording);
    let near = |v: f64| if v.abs() <= limit { v } else { f64::NAN };
    wheel(&recording.t, rows, i).into_iter().map(|(t, v)| (t, near(v))).collect()
}

/// Measured minus simulated speed of one wheel over time.
pub(super) fn residual(recording: &RecordingStudy, rows: &[[f64; 2]], i: usize) -> Vec<(f64, f64)> {
    let points = simulated(recording, rows, i);
    points.into_iter().zip(&recording.omega).map(|((t, v), m)| (t, m[i] - v)).collect()
}

fn fastest(recording: &RecordingStudy) -> f64 {
    let speeds = recording.omega.iter().flatten();
    speeds.filter(|v| v.is_finite()).fold(1e-9, |most: f64, v| most.max(v.abs()))
}

/// Time ranges in which a regime holds; ranges closer than 0.1 s are joined.
pub(super) fn ranges(recording: &RecordingStudy, of: impl Fn(Regime) -> bool) -> Vec<(f64, f64)> {
    const JOIN: f64 = 0.1;
    let mut ranges: Vec<(f64, f64)> = Vec::new();
    for (k, (t, regime)) in recording.t.iter().zip(&recording.regimes).enumerate() {
        if !of(*regime) {
            continue;
        }
        let until = recording.t.get(k + 1).copied().unwrap_or(*t);
        match ranges.last_mut() {
            Some(last) if *t - last.1 <= JOIN => last.1 = until,
            _ => ranges.push((*t, until)),
        }
    }
    ranges
}

/// The regimes in which the model fails significantly, as shades.
pub(super) fn failing(study: &Study, recording: &RecordingStudy) -> Option<Layer> {
    let failing: Vec<Regime> =
        study.failures.iter().filter(|f| f.significant).map(|f| f.regime).collect();
    let ranges = ranges(recording, |r| failing.contains(&r));
    let label = "regimes where a moment is missing".to_owned();
    (!ranges.is_empty()).then_some(Layer::Shade { ranges, label, role: Role::Highlight })
}

/// Where the robot turns, as shades.
pub(super) fn turning(recording: &RecordingStudy) -> Option<Layer> {
    let is_turn = |r: Regime| {
        let name = r.name();
        name.starts_with("pivot") || name.starts_with("curve")
    };
    let (ranges, label) = (ranges(recording, is_turn), "turning".to_owned());
    (!ranges.is_empty()).then_some(Layer::Shade { ranges, label, role: Role::NoiseFloor })
}

/// The range that holds all but the outermost half percent of x on either side.
pub(super) fn most_of(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let mut x: Vec<f64> = points.iter().map(|p| p.0).filter(|x| x.is_finite()).collect();
    x.sort_by(f64::total_cmp);
    let last = x.len().checked_sub(1)?;
    let aside = x.len() / 200;
    let (low, high) = (x[aside], x[last - aside]);
    (low < high).then_some((low, high))
}

/// Mean and standard error of the mean of y over bins of x with equal counts.
pub(super) fn binned(points: &[(f64, f64)], bins: usize) -> Vec<(f64, f64, f64)> {
    let mut sorted: Vec<(f64, f64)> =
        points.iter().copied().filter(|p| p.0.is_finite() && p.1.is_finite()).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let size = sorted.len().div_ceil(bins.max(1)).max(1);
    sorted
        .chunks(size)
        .filter(|chunk| chunk.len() >= 2)
        .map(|chunk| {
            let n = chunk.len() as f64;
            let at = chunk.iter().map(|p| p.0).sum::<f64>() / n;
            let mean = chunk.iter().map(|p| p.1).sum::<f64>() / n;
            let variance = chunk.iter().map(|p| (p.1 - mean).powi(2)).sum::<f64>() / (n - 1.0);
            (at, mean, (variance / n).sqrt())
        })
        .collect()
}

/// At most `limit` of the items, evenly spaced.
pub(super) fn thin<T: Copy>(items: &[T], limit: usize) -> Vec<T> {
    items.iter().copied().step_by(items.len().div_ceil(limit.max(1)).max(1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_hold_equal_counts_and_the_standard_error_of_their_mean() {
        let points = [(3.0, 1.0), (1.0, 2.0), (2.0, 4.0), (4.0, 3.0), (f64::NAN, 1.0)];
        // variance of (2, 4) is 2, of (1, 3) too; over two values the error is 1
        assert_eq!(binned(&points, 2), vec![(1.5, 3.0, 1.0), (3.5, 2.0, 1.0)]);
        assert!(binned(&[], 3).is_empty());
        assert_eq!(thin(&[1, 2, 3, 4, 5], 2), vec![1, 4]);
    }

    #[test]
    fn the_outermost_half_percent_is_left_aside() {
        let points: Vec<(f64, f64)> = (0..=200).map(|k| (f64::from(k), 0.0)).collect();
        assert_eq!(most_of(&points), Some((1.0, 199.0)));
        assert_eq!(most_of(&points[..1]), None);
        assert_eq!(most_of(&[]), None);
    }
}
