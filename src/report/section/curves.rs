//! Curves of a study as points of a figure.

use crate::math::distribution::NORMAL_95;
use crate::math::median_high;
use crate::recording::{Regime, is_gap};
use crate::report::figure::{ColourRole, Layer};
use crate::study::{MethodStudy, Performance, RecordingStudy, Study};

/// A simulated speed above this multiple of the fastest measured one is not drawn: a diverging model would
/// compress everything else.
const FAR: f64 = 5.0;

/// The recording shown in detail, with its index: the judged recording with the largest ratio of error to
/// noise floor for the model as given.
pub(super) fn shown(study: &Study) -> Option<(usize, &RecordingStudy)> {
    let excess = |r: usize| {
        let error = study.given.as_ref()?.performance.get(r)?.window_rms;
        Some(error / study.recordings.get(r)?.floor.window_rms).filter(|ratio| ratio.is_finite())
    };
    let judged = study.judged();
    let first = *judged.first()?;
    let worst = judged.into_iter().filter_map(|r| Some((r, excess(r)?)));
    // the first of equal ones
    let worst = worst.reduce(|best, other| if other.1 > best.1 { other } else { best });
    let index = worst.map_or(first, |(r, _)| r);
    Some((index, study.recordings.get(index)?))
}

/// Performance of a method on the recording shown in detail.
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

/// Simulated speeds of one wheel over time, without values far outside the measured range.
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

/// A curve over time, interrupted at gaps.
pub(super) fn broken_at_gaps(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let times: Vec<f64> = points.iter().map(|point| point.0).collect();
    broken_where_rows_miss(&times, &points)
}

/// A curve with a time \[s\] for each point, interrupted at gaps.
pub(super) fn broken_where_rows_miss(times: &[f64], points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    // an interrupted curve already contains the position of the gap twice
    let steps = times.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
    let step = median_high(steps);
    let mut out: Vec<(f64, f64)> = Vec::with_capacity(points.len());
    for (k, point) in points.iter().enumerate() {
        if k > 0 && is_gap(times[k - 1], times[k], step) {
            out.push((point.0, f64::NAN));
        }
        out.push(*point);
    }
    out
}

fn fastest(recording: &RecordingStudy) -> f64 {
    let speeds = recording.omega.iter().flatten();
    speeds.filter(|v| v.is_finite()).fold(1e-9, |most: f64, v| most.max(v.abs()))
}

/// Time intervals in which a regime occurs; intervals closer than 0.1 s are joined.
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
    let failures = study.given.iter().flat_map(|m| &m.failures);
    let failing: Vec<Regime> = failures.filter(|f| f.significant).map(|f| f.regime).collect();
    let ranges = ranges(recording, |r| failing.contains(&r));
    let label = "regimes with significant residual torque".to_owned();
    (!ranges.is_empty()).then_some(Layer::Shade { ranges, label, role: ColourRole::Highlight })
}

/// 95 % band of the noise of a measured speed.
pub(super) fn noise_band(recording: &RecordingStudy, i: usize) -> Layer {
    let half = NORMAL_95 * recording.noise.omega[i];
    let ends = [recording.t.first(), recording.t.last()];
    Layer::Band {
        x: ends.into_iter().flatten().copied().collect(),
        lower: vec![-half; 2],
        upper: vec![half; 2],
        label: "95 % measurement-noise band".to_owned(),
        role: ColourRole::NoiseFloor,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::section::tests::full;

    #[test]
    fn a_curve_over_time_breaks_where_rows_are_missing_and_nowhere_else() {
        let rows = [0.0, 0.1, 0.2, 0.3, 1.5, 1.6, 1.7].map(|t| (t, 1.0)).to_vec();
        let broken = broken_at_gaps(rows);
        let places: Vec<usize> = (0..broken.len()).filter(|&k| broken[k].1.is_nan()).collect();
        assert_eq!(places, [4]);
        assert!(broken_at_gaps(vec![]).is_empty());
    }

    #[test]
    fn the_recording_that_is_shown_is_the_judged_one_with_the_largest_error_over_its_floor() {
        let mut study = full();
        let (first, _) = shown(&study).unwrap();
        study.recordings.push(study.recordings[first].clone());
        for model in study.given.iter_mut().chain(&mut study.completed) {
            model.performance.resize(study.recordings.len(), model.performance[first].clone());
        }
        // of equal ones the first
        assert_eq!(shown(&study).unwrap().0, first);
        let last = study.recordings.len() - 1;
        study.given.as_mut().unwrap().performance[last].window_rms *= 2.0;
        assert_eq!(shown(&study).unwrap().0, last);
        study.recordings[last].floor.window_rms *= 4.0;
        assert_eq!(shown(&study).unwrap().0, first);
    }
}
