//! When the residual torque is far above its usual size: a wheel that was held, a floor bump, a motor that was switched
//! off.

use crate::diagnose::THRESHOLDS;
use crate::math::median;
use crate::report::block::{Cell, Column, Table};
use crate::report::format;
use crate::report::section::words;
use crate::study::{RecordingStudy, Study, Verdict};

/// Length of a block \[s\], that of the windows of the search.
const BLOCK_S: f64 = 1.0;
/// Largest number of intervals that are listed.
const MOST: usize = 5;

/// An interval of a recording in which the residual torque of a wheel is large.
#[derive(Clone, Debug, PartialEq)]
struct Interval {
    recording: usize,
    wheel: usize,
    from: f64,
    to: f64,
    /// Sum of the squares of its blocks.
    square: f64,
    blocks: usize,
}

impl Interval {
    fn rms(&self) -> f64 {
        (self.square / self.blocks as f64).sqrt()
    }
}

/// The intervals in which the residual torque of the last model, root mean square over blocks of 1 s, exceeds
/// [`Thresholds::far_above_floor`] times its median over all blocks; those with the largest one, in the order of their
/// recordings. `None` where there are none, and unless something unknown is missing.
///
/// [`Thresholds::far_above_floor`]: crate::diagnose::Thresholds::far_above_floor
pub(super) fn intervals(study: &Study) -> Option<Table> {
    let verdict = study.diagnosis.as_ref()?.verdict;
    let model = study.last_model().filter(|_| verdict == Verdict::UnknownEffect)?;
    let blocks: Vec<Interval> = study
        .recordings
        .iter()
        .zip(&model.residual_torque)
        .enumerate()
        .flat_map(|(r, (recording, torque))| blocks(r, recording, torque))
        .collect();
    let usual = median(blocks.iter().map(Interval::rms));
    let large = blocks.into_iter().filter(|b| b.rms() > THRESHOLDS.far_above_floor * usual);
    let mut found = joined(large);
    found.sort_by(|a, b| b.rms().total_cmp(&a.rms()));
    found.truncate(MOST);
    found.sort_by(|a, b| a.recording.cmp(&b.recording).then(a.from.total_cmp(&b.from)));
    (!found.is_empty() && usual > 0.0).then(|| table(study, &found, usual))
}

/// Root mean square residual torque of each wheel in blocks of 1 s, without rows near rest, where it is not known.
fn blocks(r: usize, recording: &RecordingStudy, torque: &[[f64; 2]]) -> Vec<Interval> {
    let t = &recording.t;
    let mut out = Vec::new();
    let mut first = 0;
    while first < t.len() {
        let end = first + t[first..].partition_point(|now| now - t[first] < BLOCK_S);
        let Some(rows) = torque.get(first..end) else { break };
        for wheel in 0..2 {
            let values = rows.iter().map(|m| m[wheel]);
            let known: Vec<f64> = values.filter(|m| m.is_finite()).collect();
            // of a block that is mostly at rest little is known
            if 2 * known.len() > end - first {
                let square = known.iter().map(|m| m * m).sum::<f64>() / known.len() as f64;
                let (from, to) = (t[first], t[end - 1]);
                out.push(Interval { recording: r, wheel, from, to, square, blocks: 1 });
            }
        }
        first = end.max(first + 1);
    }
    out.sort_by_key(|block| block.wheel);
    out
}

/// Blocks of a wheel that follow each other as one interval.
fn joined(blocks: impl Iterator<Item = Interval>) -> Vec<Interval> {
    let mut out: Vec<Interval> = Vec::new();
    for block in blocks {
        let follows = |last: &&mut Interval| {
            (last.recording, last.wheel) == (block.recording, block.wheel)
                && block.from >= last.to
                && block.from - last.to < 0.5 * BLOCK_S
        };
        match out.last_mut().filter(follows) {
            Some(last) => {
                last.to = block.to;
                last.square += block.square;
                last.blocks += 1;
            }
            None => out.push(block),
        }
    }
    out
}

fn table(study: &Study, found: &[Interval], usual: f64) -> Table {
    let unit = study.drive_unit.symbol();
    let columns = vec![
        Column::text("Recording"),
        Column::text("Wheel"),
        Column::number("From", "s"),
        Column::number("To", "s"),
        Column::number("Residual torque, rms", unit),
    ];
    let caption = format!(
        "When the residual torque is largest: seconds with more than {} times its median, {} {unit}. Something acted on the robot \
         then (a wheel was held, a bump, another load), or the recorded input did not reach the motors.",
        THRESHOLDS.far_above_floor,
        format::significant(usual, 2),
    );
    let mut table = Table::new(caption, columns);
    for interval in found {
        let rms = interval.rms();
        let time = |v: f64| Cell::formatted(format!("{v:.1}"), v);
        table.push(vec![
            Cell::text(study.recordings[interval.recording].file.clone()),
            Cell::text(words::WHEELS[interval.wheel].to_owned()),
            time(interval.from),
            time(interval.to),
            Cell::formatted(format::significant(rms, 2), rms),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::section::tests::full;

    #[test]
    fn a_wheel_that_was_held_for_two_seconds_is_listed_with_its_time() {
        let study = full();
        let recording = RecordingStudy {
            t: (0..1000).map(|k| 0.01 * f64::from(k)).collect(),
            ..study.recordings[0].clone()
        };
        let size = |k: usize| if (300..500).contains(&k) { 0.5 } else { 0.02 };
        let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let torque: Vec<[f64; 2]> =
            (0..1000).map(|k| [0.02 * sign(k), size(k) * sign(k)]).collect();
        let all = blocks(0, &recording, &torque);
        assert_eq!(all.len(), 20);
        let found = joined(all.into_iter().filter(|b| b.rms() > 0.1));
        let [held] = &found[..] else { panic!("{found:?}") };
        assert_eq!((held.wheel, held.blocks), (1, 2));
        // to the row
        assert!((held.from - 3.0).abs() < 0.011 && (held.to - 4.99).abs() < 0.011, "{held:?}");
        assert!((held.rms() - 0.5).abs() < 0.01);
        // rows near rest have no residual torque
        assert!(blocks(0, &recording, &vec![[f64::NAN; 2]; 1000]).is_empty());
    }
}
