//! Stamps that scatter about the equidistant times at which the rows were sampled: those of a receiver, with a
//! variable delay by a bus, a scheduler or a radio.

use std::ops::Range;

use super::finding::{Channel, Finding, Kind};
use super::signal::{is_increasing, median_step, pieces};
use super::thresholds::TIMES;
use super::{Conditioned, Context, Settings};
use crate::math::rms;

/// Gain by which the clock that counts rows follows the stamps: over some twenty rows.
const FOLLOWED: f64 = 0.05;
/// Rows to either side over which the even times are a straight line: the drift of a clock takes longer.
const REACH: usize = 50;
/// Rows per block of errors, and smallest number of blocks.
const BLOCK: usize = 16;
const BLOCKS: usize = 8;

/// Puts rows on even times where the sensors move more smoothly on these than on the stamps.
///
/// ```text
/// e_k = (v_k - Σ_j w_j v_j)/√(1 + Σ_j w_j²),   w: cubic through two rows on either side, by either of the times
/// e_stamp = c (e_stamp - e_even) + u,          c - 1/2 > 5 se(c),   se: u correlated within blocks of 16 rows
/// ```
/// c is 1 where the motion on even times leaves noise alone, and 0 where that on the stamps does. Its error does not
/// grow with the share of the rows in which the speeds change, as that of a mean of squares over all blocks does. White
/// noise of the sensors alone gives c = 1/2. If another recording of the same log shows even rows, a recording whose
/// own motion does not contradict this as clearly is treated alike: recordings at other times would differ in their
/// inertia.
pub(super) fn even_times(work: &mut Conditioned, settings: &Settings, context: &Context) {
    if !settings.rows || in_batches(work) {
        return;
    }
    let t = &work.channels.t;
    let Some(values) = work.channels.alpha.as_ref().or(work.channels.omega.as_ref()) else {
        return;
    };
    let pieces = pieces(t);
    let counted = evened(t, &pieces);
    let times = counted.as_ref().map_or(t, |(even, _)| even);
    let is_by_number = |(even, _): &(Vec<f64>, f64)| {
        is_smoother(values, t, even, &pieces) && is_smoother(values, times, even, &pieces)
    };
    let is_even = |even: &[f64]| {
        let shown = context.even_times && !is_smoother(values, even, t, &pieces);
        shown || is_smoother(values, t, even, &pieces)
    };
    let Some((even, share)) = numbered(t, &pieces)
        .filter(is_by_number)
        .or(counted.clone().filter(|(even, _)| is_even(even)))
    else {
        return;
    };
    work.channels.t = even;
    let kind = Kind::Jitter { share };
    work.findings.push(Finding::corrected(Channel::Time, kind, "rows", true));
}

/// The even times of rows stamped at `t`, and the scatter of the stamps about them as a share of a row; `None` if it is
/// negligible. Where a row cannot be distinguished from the next by its stamp, lost rows cannot be recognised, and the
/// rows are counted as if there were none: it is for the motion to decide.
fn evened(t: &[f64], pieces: &[Range<usize>]) -> Option<(Vec<f64>, f64)> {
    let counted: Vec<f64> = pieces.iter().flat_map(|piece| even(&t[piece.clone()])).collect();
    let step = median_step(t);
    let far = off(t, &counted, step).filter(|o| o.abs() > TIMES.row_unknown).count() as f64;
    let even = if far <= TIMES.rows_unknown * t.len() as f64 { counted } else { on_numbers(t) };
    scattered(t, even, step)
}

/// The even times of rows by their number alone, where the stamps seem to show lost rows: a receiver that polls in
/// steps somewhat shorter than the rows stamps most of them one step apart and some of them two.
fn numbered(t: &[f64], pieces: &[Range<usize>]) -> Option<(Vec<f64>, f64)> {
    let long = TIMES.next_tick * median_step(t);
    let skips = t.windows(2).filter(|w| w[1] - w[0] > long).count();
    if skips as f64 <= TIMES.rows_unknown * t.len() as f64 {
        return None;
    }
    let even: Vec<f64> = pieces.iter().flat_map(|piece| on_numbers(&t[piece.clone()])).collect();
    let step = median_step(&even);
    scattered(t, even, step)
}

/// Even times with the scatter of the stamps about them as a share of a row; `None` if it is negligible.
fn scattered(t: &[f64], even: Vec<f64>, step: f64) -> Option<(Vec<f64>, f64)> {
    let share = rms(off(t, &even, step));
    (share > TIMES.scattered && is_increasing(&even)).then_some((even, share))
}

/// Distance of each stamp from its even time in steps.
fn off<'a>(t: &'a [f64], even: &'a [f64], step: f64) -> impl Iterator<Item = f64> + 'a {
    t.iter().zip(even).map(move |(t, even)| (t - even) / step)
}

/// Puts rows that a receiver stamped in batches, one shortly after the other, at even times by their number, where the
/// sensors move more smoothly there; whether it did.
fn in_batches(work: &mut Conditioned) -> bool {
    let t = &work.channels.t;
    let mean = (t[t.len() - 1] - t[0]) / (t.len() - 1) as f64;
    let starts: Vec<usize> = (0..t.len()).filter(|&k| k == 0 || t[k] - t[k - 1] >= mean).collect();
    let close = t.windows(2).filter(|w| w[1] - w[0] < TIMES.row_unknown * mean).count();
    if 2 * close < t.len() {
        return false;
    }
    let even = by_number(t, &starts);
    let Some(values) = work.channels.alpha.as_ref().or(work.channels.omega.as_ref()) else {
        return false;
    };
    if !is_increasing(&even) || !is_smoother(values, t, &even, &pieces(&even)) {
        return false;
    }
    let kind = Kind::Batches { rows: t.len() as f64 / starts.len() as f64 };
    work.channels.t = even;
    work.findings.push(Finding::corrected(Channel::Time, kind, "rows", true));
    true
}

/// The even times of a piece: rows counted by a clock that follows the stamps slowly, on a line through those around.
fn even(t: &[f64]) -> Vec<f64> {
    let h = median_step(t);
    if t.len() <= 2 || !(h > 0.0) {
        return t.to_vec();
    }
    let (mut clock, mut place) = (t[0], 0.0);
    let mut places: Vec<f64> = std::iter::once(0.0)
        .chain(t[1..].iter().map(|&now| {
            let rows = ((now - clock) / h).round();
            clock += rows * h;
            clock += FOLLOWED * (now - clock);
            place += rows;
            place
        }))
        .collect();
    // a stamp that is late by more than half a row looks as if a row were lost, until the next one is in time
    for k in (1..places.len()).rev() {
        places[k - 1] = places[k - 1].min(places[k] - 1.0);
    }
    on_lines(t, &places, h)
}

/// The even times of rows of which none is missing: their number alone on lines through the stamps around, from one gap
/// between the batches that `starts` begin to the next.
pub(super) fn by_number(t: &[f64], starts: &[usize]) -> Vec<f64> {
    let of_batches: Vec<f64> = starts.iter().map(|&k| t[k]).collect();
    let ends = pieces(&of_batches).into_iter().map(|piece| {
        let end = starts.get(piece.end).copied().unwrap_or(t.len());
        starts[piece.start]..end
    });
    ends.flat_map(|rows| on_numbers(&t[rows])).collect()
}

/// Each row on the line through the stamps around it, by its number.
fn on_numbers(t: &[f64]) -> Vec<f64> {
    let places: Vec<f64> = (0..t.len()).map(|k| k as f64).collect();
    let mean = (t[t.len() - 1] - t[0]) / (t.len().max(2) - 1) as f64;
    if t.len() > 2 { on_lines(t, &places, mean) } else { t.to_vec() }
}

/// Each row on the line through the stamps around it, over the places of the rows, of which one takes about `h` \[s\].
fn on_lines(t: &[f64], places: &[f64], h: f64) -> Vec<f64> {
    let on_line = |k: usize| {
        let around = k.saturating_sub(REACH)..(k + REACH + 1).min(t.len());
        let count = around.len() as f64;
        let x = |j: usize| places[j] - places[k];
        let y = |j: usize| t[j] - t[k] - h * x(j);
        let (mx, my) = around.clone().fold((0.0, 0.0), |(a, b), j| (a + x(j), b + y(j)));
        let (mx, my) = (mx / count, my / count);
        let sums = around.fold((0.0, 0.0), |(xx, xy), j| {
            (xx + (x(j) - mx).powi(2), xy + (x(j) - mx) * (y(j) - my))
        });
        t[k] + my - mx * sums.1 / sums.0
    };
    (0..t.len()).map(on_line).collect()
}

/// Whether the sensors move more smoothly over `even` than over the stamps `t`. `false` if the motion shows neither.
fn is_smoother(values: &[[f64; 2]], t: &[f64], even: &[f64], pieces: &[Range<usize>]) -> bool {
    let pair = |k: usize| {
        let (stamped, even) = (errors(values, t, k), errors(values, even, k));
        [0, 1].map(|i| (stamped[i], stamped[i] - even[i]))
    };
    let inner = |piece: &Range<usize>| {
        let inner: Vec<usize> = (piece.start + 2..piece.end.saturating_sub(2)).collect();
        inner
            .chunks_exact(BLOCK)
            .map(|block| block.iter().copied().flat_map(pair).collect())
            .collect()
    };
    let blocks: Vec<Vec<(f64, f64)>> = pieces.iter().flat_map::<Vec<_>, _>(inner).collect();
    let square: f64 = blocks.iter().flatten().map(|(_, d)| d * d).sum();
    if blocks.len() < BLOCKS || !(square > 0.0) {
        return false;
    }
    let share = blocks.iter().flatten().map(|(e, d)| e * d).sum::<f64>() / square;
    let of_block =
        |block: &Vec<(f64, f64)>| block.iter().map(|(e, d)| (e - share * d) * d).sum::<f64>();
    let std_error = blocks.iter().map(|b| of_block(b).powi(2)).sum::<f64>().sqrt() / square;
    share - 0.5 > TIMES.even_times_errors * std_error
}

/// Errors of row `k` against the cubic through its four neighbours, relative to those of white noise.
fn errors(values: &[[f64; 2]], t: &[f64], k: usize) -> [f64; 2] {
    let around = [k - 2, k - 1, k + 1, k + 2];
    let weight = |j: usize| {
        let others = around.iter().filter(|&&i| i != j);
        others.map(|&i| (t[k] - t[i]) / (t[j] - t[i])).product::<f64>()
    };
    let weights = around.map(weight);
    let noise = (1.0 + weights.iter().map(|w| w * w).sum::<f64>()).sqrt();
    [0, 1].map(|i| {
        let line: f64 = around.iter().zip(weights).map(|(&j, w)| w * values[j][i]).sum();
        (values[k][i] - line) / noise
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Channels;
    use rand::{Rng, SeedableRng};

    /// Rows of 10 ms read at `t + read` and stamped `t + stamped`, uniform in shares of a row; every fortieth row is
    /// lost.
    fn work(read: f64, stamped: f64, noise: f64) -> Conditioned {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(2);
        let mut uniform = |width: f64| width * (rng.random::<f64>() - 0.5);
        let rows = (0..2000).filter(|k| k % 40 != 7).map(|k| 0.01 * f64::from(k) * 1.0003);
        let rows: Vec<(f64, f64)> = rows
            .map(|t| {
                let (own, late) = (uniform(0.01 * read), uniform(0.01 * stamped));
                (t + own, t + if stamped > 0.0 { late } else { own })
            })
            .collect();
        let motion = |t: f64| [9.0 * t + 3.0 * (1.7 * t).sin(), 8.0 * t + 2.0 * (2.3 * t).cos()];
        let alpha = rows.iter().map(|(t, _)| motion(*t).map(|a| a + uniform(noise))).collect();
        let t: Vec<f64> = rows.iter().map(|(_, stamp)| *stamp).collect();
        let torque = vec![[0.1; 2]; t.len()];
        Conditioned {
            channels: Channels { t, alpha: Some(alpha), omega: None, torque },
            findings: vec![],
        }
    }

    #[test]
    fn scattered_stamps_of_even_rows_are_made_even() {
        let mut work = work(0.0, 0.3, 1e-3);
        even_times(&mut work, &Settings::default(), &Context::default());
        assert!(
            matches!(work.findings[0].kind, Kind::Jitter { share } if (0.08..0.095).contains(&share))
        );
        let true_times = (0..2000).filter(|k| k % 40 != 7).map(|k| 0.01 * f64::from(k) * 1.0003);
        // a line through a hundred stamps of 0.87 ms has its middle to 0.09 ms, its ends to twice that
        for (found, is) in work.channels.t.iter().zip(true_times) {
            assert!((found - is).abs() < 6e-4, "{found} {is}");
        }
    }

    #[test]
    fn a_few_short_accelerations_show_even_rows() {
        // changes of the speed within 0.2 s every 2.6 s, with noise of a hundredth of them
        let motion = |t: f64| [0, 1].map(|i| 3.0 * (10.0 * (1.2 * t + f64::from(i)).sin()).tanh());
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let mut late = work(0.0, 0.0, 1e-3);
        let even: Vec<f64> = (0..late.channels.t.len()).map(|k| 0.01 * k as f64).collect();
        let noisy = |t: &f64, rng: &mut rand_chacha::ChaCha8Rng| {
            motion(*t).map(|w| w + 0.06 * (rng.random::<f64>() - 0.5))
        };
        late.channels.omega = Some(even.iter().map(|t| noisy(t, &mut rng)).collect());
        late.channels.alpha = None;
        late.channels.t = even.iter().map(|t| t + 0.006 * rng.random::<f64>()).collect();
        let mut read = late.clone();
        read.channels.omega = Some(read.channels.t.iter().map(|t| noisy(t, &mut rng)).collect());
        even_times(&mut late, &Settings::default(), &Context::default());
        assert!(matches!(late.findings[..], [Finding { kind: Kind::Jitter { .. }, .. }]));
        even_times(&mut read, &Settings::default(), &Context::default());
        assert!(read.findings.is_empty());
    }

    /// Rows sampled every 10 ms, none of which is lost, delivered in order with delays of exponential tails and this mean
    /// \[s\]; and the times at which they were sampled.
    fn delivered(mean_s: f64) -> (Conditioned, Vec<f64>) {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let (mut late, mut last) = (work(0.0, 0.0, 1e-3), 0.0);
        let even: Vec<f64> = (0..late.channels.t.len()).map(|k| 0.01 * k as f64).collect();
        let motion = |t: f64| [9.0 * t + 3.0 * (1.7 * t).sin(), 8.0 * t + 2.0 * (2.3 * t).cos()];
        late.channels.alpha = Some(even.iter().map(|t| motion(*t)).collect());
        for (stamp, t) in late.channels.t.iter_mut().zip(&even) {
            last = (t - mean_s * (1.0 - rng.random::<f64>()).ln()).max(last + 1e-5);
            *stamp = last;
        }
        (late, even)
    }

    #[test]
    fn a_late_stamp_is_no_lost_row() {
        let (mut late, even) = delivered(0.002);
        even_times(&mut late, &Settings::default(), &Context::default());
        assert!(matches!(late.findings[..], [Finding { kind: Kind::Jitter { .. }, .. }]));
        // late by 2 ms on average; the ends of a line through a hundred stamps that scatter by as much
        for (found, is) in late.channels.t.iter().zip(&even) {
            assert!((found - is - 0.002).abs() < 1.2e-3, "{found} {is}");
        }
    }

    #[test]
    fn rows_whose_stamps_reach_the_next_rows_are_counted() {
        let (mut late, even) = delivered(0.005);
        even_times(&mut late, &Settings::default(), &Context::default());
        assert!(
            matches!(late.findings[..], [Finding { kind: Kind::Jitter { share }, .. }] if share > 0.4)
        );
        // 5 ms late on average and more where rows wait for one before; lines through a hundred stamps
        let off: Vec<f64> =
            late.channels.t.iter().zip(&even).map(|(found, is)| found - is).collect();
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        assert!(off.iter().all(|o| (o - mean).abs() < 4e-3), "{off:?}");
    }

    #[test]
    fn polls_in_steps_shorter_than_the_rows_lose_none() {
        // rows of 20 ms, every fourth of which is stamped two polls of 16 ms after the one before; and rows of 16 ms of
        // which every fifth is lost
        let motion = |t: f64| [9.0 * t + 3.0 * (1.7 * t).sin(), 8.0 * t + 2.0 * (2.3 * t).cos()];
        let even: Vec<f64> = (0..1000).map(|k| 0.02 * f64::from(k)).collect();
        let polled: Vec<f64> = even.iter().map(|t| 0.016 * ((t + 0.003) / 0.016).ceil()).collect();
        let of = |times: &[f64]| {
            let mut work = work(0.0, 0.0, 1e-3);
            work.channels.alpha = Some(times.iter().map(|t| motion(*t)).collect());
            work.channels.torque = vec![[0.1; 2]; times.len()];
            work.channels.t.clone_from(&polled);
            even_times(&mut work, &Settings::default(), &Context::default());
            work
        };
        let found = of(&even);
        assert!(
            matches!(found.findings[..], [Finding { kind: Kind::Jitter { share }, .. }] if (0.2..0.3).contains(&share))
        );
        // late by 3 ms and half a poll; the ends of a line through a hundred stamps that scatter by 4.6 ms
        for (found, is) in found.channels.t.iter().zip(&even) {
            assert!((found - is - 0.011).abs() < 3e-3, "{found} {is}");
        }
        assert!(of(&polled).findings.is_empty());
    }

    #[test]
    fn what_another_recording_of_the_log_shows_holds_unless_the_motion_contradicts() {
        let known = Context { even_times: true, ..Context::default() };
        // noise of the sensor hides the scatter of the stamps
        for context in [known, Context::default()] {
            let mut work = work(0.0, 0.3, 1.0);
            even_times(&mut work, &Settings::default(), &context);
            assert_eq!(!work.findings.is_empty(), context.even_times);
        }
        let mut uneven = work(0.3, 0.0, 1e-3);
        even_times(&mut uneven, &Settings::default(), &known);
        assert!(uneven.findings.is_empty());
    }

    #[test]
    fn rows_that_are_taken_in_batches_stand_at_even_times() {
        let mut work = work(0.0, 0.0, 1e-3);
        work.channels.t.iter_mut().enumerate().for_each(|(k, t)| *t = 0.01 * k as f64);
        let motion = |t: f64| [9.0 * t + 3.0 * (1.7 * t).sin(), 8.0 * t + 2.0 * (2.3 * t).cos()];
        let (mut polls, mut step) = (vec![0.0_f64], 0);
        while polls[polls.len() - 1] < 21.0 {
            step = (step + 7) % 11;
            polls.push(polls[polls.len() - 1] + 0.03 + 0.002 * f64::from(step));
        }
        let values = work.channels.t.iter().map(|t| motion(*t)).collect();
        let even = work.channels.t.clone();
        let late = |(k, t): (usize, &f64)| {
            let poll = polls.iter().copied().find(|poll| poll >= t).unwrap();
            poll + 1e-4 * (k % 7) as f64
        };
        work.channels.alpha = Some(values);
        work.channels.t = even.iter().enumerate().map(late).collect();
        even_times(&mut work, &Settings::default(), &Context::default());
        assert!(matches!(work.findings[0].kind, Kind::Batches { .. }), "{:?}", work.findings);
        // 20 ms late on average; the line through a hundred stamps that scatter by 13 ms
        let off: Vec<f64> = work.channels.t.iter().zip(&even).map(|(a, b)| a - b - 0.02).collect();
        assert!(off.iter().all(|o| o.abs() < 7e-3), "{off:?}");
    }

    #[test]
    fn rows_that_were_read_at_uneven_times_keep_their_stamps() {
        for noise in [1e-4, 1e-2] {
            let mut uneven = work(0.3, 0.0, noise);
            even_times(&mut uneven, &Settings::default(), &Context::default());
            assert!(uneven.findings.is_empty());
        }
        let mut exact = work(0.0, 0.0, 1e-3);
        even_times(&mut exact, &Settings::default(), &Context::default());
        assert!(exact.findings.is_empty());
        let off = Settings { rows: false, ..Settings::default() };
        let mut left = work(0.0, 0.3, 1e-3);
        even_times(&mut left, &off, &Context::default());
        assert!(left.findings.is_empty());
    }
}
