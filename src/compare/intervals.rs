//! Intervals in which the residual torque is far above its usual size: the robot was pushed, a gust of wind, a bump.

use crate::math::distribution::t_survival;
use crate::math::{mean, median};

/// Length of a block \[s\], that of the windows of the search.
const BLOCK_S: f64 = 1.0;
/// How many normal values determine their scale by the standard deviation as well as one does by their median
/// absolute value.
///
/// Source: Rousseeuw and Croux, J. Am. Stat. Assoc. 88 (1993): efficiency 37 %.
const EFFICIENCY: f64 = 0.37;
/// Median absolute value of a normal variable of standard deviation 1.
const MEDIAN: f64 = 0.674_489_750_196_081_7;

/// An interval of a recording in which the residual torque of a wheel is far above its usual size.
#[derive(Clone, Debug, PartialEq)]
pub struct Interval {
    /// Number of the recording.
    pub recording: usize,
    /// Wheel, 0 or 1.
    pub wheel: usize,
    /// Time of its first row \[s\].
    pub from: f64,
    /// Time of its last row \[s\].
    pub to: f64,
    /// Mean residual torque, in the unit of the input.
    pub torque: f64,
    /// Number of its blocks of 1 s.
    pub blocks: usize,
}

/// The residual torque of a recording [in the unit of the input], NaN where it is not known.
#[derive(Clone, Debug)]
pub struct Residual<'a> {
    /// Time of its rows \[s\].
    pub t: &'a [f64],
    /// Residual torque by wheel.
    pub torque: Vec<[f64; 2]>,
    /// The same with only every other row of the input, for both choices of them.
    pub halves: [Vec<[f64; 2]>; 2],
}

/// The intervals of several recordings in which the mean residual torque of a block of 1 s is larger than any stationary
/// noise explains and than the unknown input between the rows can cause, in the order of time, recording by recording. A
/// block of less than half a second, or unknown for more than half of its rows, is left out.
///
/// ```text
/// s = median |m_b|/0.674,   t_b = (|m_b| - h_b)/s of 0.37 n degrees of freedom,   listed if n P(|t| > t_b) < exp(-surely)
/// ```
/// m_b: mean of block b, h_b: mean absolute change of its rows with only every other row of the input, n: number of blocks
/// of the wheel. Coloured noise of the input makes the means normal with one variance; an event leaves their median as it
/// is.
#[must_use]
pub fn intervals(recordings: &[Residual], surely: f64) -> Vec<Interval> {
    let far = |wheel: usize| {
        let of = |(r, residual): (usize, &Residual)| blocks(r, wheel, residual);
        let all: Vec<Block> = recordings.iter().enumerate().flat_map(of).collect();
        let usual = median(all.iter().map(|block| block.interval.torque.abs())) / MEDIAN;
        let count = all.len() as f64;
        let is_far = move |block: &Block| {
            let beyond = block.interval.torque.abs() - block.between_rows;
            let p = 2.0 * t_survival(beyond / usual, EFFICIENCY * count);
            -(count * p).ln() > surely
        };
        joined(all.into_iter().filter(is_far).map(|block| block.interval))
    };
    let mut found: Vec<Interval> = [0, 1].into_iter().flat_map(far).collect();
    found.sort_by(|a, b| a.recording.cmp(&b.recording).then(a.from.total_cmp(&b.from)));
    found
}

/// A block of 1 s.
struct Block {
    interval: Interval,
    /// Mean absolute change of its rows with only every other row of the input.
    between_rows: f64,
}

/// The blocks of a wheel in a recording, without rows near rest, where the residual torque is not known.
fn blocks(recording: usize, wheel: usize, residual: &Residual) -> Vec<Block> {
    let Residual { t, torque: all, halves } = residual;
    let mut out = Vec::new();
    let mut first = 0;
    while first < t.len() {
        let end = first + t[first..].partition_point(|now| now - t[first] < BLOCK_S);
        let known: Vec<usize> =
            (first..end.min(all.len())).filter(|&k| all[k][wheel].is_finite()).collect();
        let is_whole = t[end - 1] - t[first] >= 0.5 * BLOCK_S;
        if is_whole && 2 * known.len() > end - first {
            let torque = mean(known.iter().map(|&k| all[k][wheel]));
            let (from, to) = (t[first], t[end - 1]);
            let apart = |half: &[[f64; 2]]| {
                mean(known.iter().map(|&k| (half[k][wheel] - all[k][wheel]).abs()))
            };
            let between_rows = halves.iter().map(|half| apart(half)).fold(0.0, f64::max);
            let interval = Interval { recording, wheel, from, to, torque, blocks: 1 };
            out.push(Block { interval, between_rows });
        }
        first = end.max(first + 1);
    }
    out
}

/// Blocks of a wheel that follow each other, of one sign, as one interval.
fn joined(blocks: impl Iterator<Item = Interval>) -> Vec<Interval> {
    let mut out: Vec<Interval> = Vec::new();
    for block in blocks {
        let follows = |last: &&mut Interval| {
            let next = block.from >= last.to && block.from - last.to < 0.5 * BLOCK_S;
            last.recording == block.recording && next && last.torque * block.torque > 0.0
        };
        match out.last_mut().filter(follows) {
            Some(last) => {
                let count = last.blocks as f64;
                last.torque = (count * last.torque + block.torque) / (count + 1.0);
                last.to = block.to;
                last.blocks += 1;
            }
            None => out.push(block),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// 60 s at 100 Hz of noise with a correlation time of 1 s and standard deviation 0.02, with a torque beside it.
    fn noisy(seed: u64, beside: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<[f64; 2]>) {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let mut slow = [0.0; 2];
        let t: Vec<f64> = (0..6000).map(|k| 0.01 * f64::from(k)).collect();
        let torque = t.iter().map(|t| {
            slow = slow.map(|m: f64| {
                let normal: f64 = StandardNormal.sample(&mut rng);
                0.99 * m + 0.02 * (1.0 - 0.99_f64.powi(2)).sqrt() * normal
            });
            [slow[0], slow[1] + beside(*t)]
        });
        let torque = torque.collect();
        (t, torque)
    }

    #[test]
    fn a_push_of_two_seconds_is_found_with_its_time_and_size() {
        let push = |t: f64| if (30.0..32.0).contains(&t) { -0.3 } else { 0.0 };
        let (t, torque) = noisy(1, push);
        let of = |torque: &[[f64; 2]], half: &[[f64; 2]]| {
            let halves = [torque.to_vec(), half.to_vec()];
            intervals(&[Residual { t: &t, torque: torque.to_vec(), halves }], 10.0)
        };
        let found = of(&torque, &torque);
        let [pushed] = &found[..] else { panic!("{found:?}") };
        assert_eq!((pushed.recording, pushed.wheel, pushed.blocks), (0, 1, 2));
        // to the row
        assert!((pushed.from - 30.0).abs() < 0.011 && (pushed.to - 31.99).abs() < 0.011);
        // two standard deviations of the mean of two correlated seconds
        assert!((pushed.torque + 0.3).abs() < 0.03, "{pushed:?}");
        // the input between the rows could be as large
        assert!(of(&torque, &torque.iter().map(|m| [m[0], 0.0]).collect::<Vec<_>>()).is_empty());
        // rows near rest have no residual torque
        let unknown = vec![[f64::NAN; 2]; 6000];
        assert!(of(&unknown, &unknown).is_empty());
    }

    #[test]
    fn coloured_noise_has_no_interval() {
        // exp(-10) a wheel: none in 200 recordings of two wheels but for one in fifty such tests
        let alarms = (0..200).filter(|seed| {
            let (t, torque) = noisy(100 + seed, |_| 0.0);
            let halves = [torque.clone(), torque.clone()];
            !intervals(&[Residual { t: &t, torque, halves }], 10.0).is_empty()
        });
        assert_eq!(alarms.count(), 0);
    }
}
