//! Residual analysis of the one-step prediction errors (innovations).

use super::horizon::{Horizon, summary};
use crate::filter::{Likelihood, prepare};
use crate::math::distribution::normal_quantile;
use crate::model::{Model, ModelError};
use crate::recording::Recording;
use crate::simulate::Hold;

/// Lags of the correlations \[rows\].
const LAGS: usize = 25;
/// Confidence level of the bounds.
const LEVEL: f64 = 0.99;
/// Bins of the histogram, from -4 to 4 standard deviations.
const BINS: usize = 32;
const REACH: f64 = 4.0;
/// Rows per segment of the spectrum.
const SEGMENT: usize = 128;

/// The innovations of one wheel in sequence, with its input.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Innovations {
    /// Innovations divided by their predicted standard deviation, one list per stretch without a gap.
    pub scaled: Vec<Vec<f64>>,
    /// Input of the same rows [N m].
    pub input: Vec<Vec<f64>>,
}

/// Tests of the innovations of both wheels.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Whiteness {
    /// The channel that was predicted: true for speeds, false for angles.
    pub speeds: bool,
    /// Median time between innovations \[s\].
    pub step_s: f64,
    /// Autocorrelation at lags of 0, 1, … rows, by wheel.
    pub auto: [Vec<f64>; 2],
    /// Cross-correlation with the input of the same wheel; the middle is lag 0, at positive lags the
    /// innovation is later.
    pub cross: [Vec<f64>; 2],
    /// 99 % bound of the autocorrelation of white innovations.
    pub auto_bound: [f64; 2],
    /// 99 % bound of the cross-correlation of innovations that are independent of the input.
    pub cross_bound: [f64; 2],
    /// Density of the scaled innovations in equal bins from -4 to 4 standard deviations.
    pub density: [Vec<f64>; 2],
    /// Frequencies of the spectrum \[Hz\].
    pub frequency_hz: Vec<f64>,
    /// Spectrum of the scaled innovations relative to white noise of the same variance.
    pub spectrum: [Vec<f64>; 2],
    /// Mean square of the scaled innovations: one if the noise is as assumed.
    pub mean_square: [f64; 2],
    /// Error and fit of the prediction over one row; `None` if angles are predicted.
    pub one_row: Option<Horizon>,
}

/// Residual analysis of a model with parameters `p` on recordings, with noise levels computed from the
/// channels.
///
/// # Errors
/// The mass matrix is not positive definite.
pub fn whiteness(
    model: &Model,
    p: &[f64],
    recordings: &[Recording],
    hold: Hold,
) -> Result<Whiteness, ModelError> {
    let prepared = recordings.iter().map(prepare).collect();
    let likelihood =
        Likelihood { prepared, hold, slow_moment: false, timing: false, step_scatter: 1.0 };
    let all = likelihood.innovations(model, p, &likelihood.initial_noise())?;
    let speeds = likelihood.prepared.iter().all(|p| p.used[2]);
    let mut wheels = [Innovations::default(), Innovations::default()];
    let mut pairs: [Vec<(f64, f64)>; 2] = [vec![], vec![]];
    for (recording, innovations) in recordings.iter().zip(&all) {
        for (i, wheel) in wheels.iter_mut().enumerate() {
            // one axis written down twice is predicted once
            let own = if recording.is_single_axis() { 0 } else { i };
            let channel = if speeds { 2 + own } else { own };
            for piece in recording.pieces() {
                let inside = innovations.iter().filter(|v| v.channel == channel);
                let rows: Vec<_> = inside.filter(|v| piece.contains(&v.row)).collect();
                wheel.scaled.push(rows.iter().map(|v| v.value / v.variance.sqrt()).collect());
                wheel.input.push(rows.iter().map(|v| recording.torque()[v.row][i]).collect());
                let omega = |v: &&_| recording.omega()[row(v)][i];
                pairs[i].extend(rows.iter().map(|v| (omega(v), omega(v) - v.value)));
            }
        }
    }
    let step = recordings.iter().map(Recording::reading_interval).fold(0.0, f64::max);
    let one_row = speeds.then(|| summary(0.0, &pairs));
    Ok(Whiteness { speeds, one_row, ..analysed(&wheels, step) })
}

fn row(v: &crate::filter::Innovation) -> usize {
    v.row
}

/// Tests of given innovations with sampling interval `step` \[s\].
#[must_use]
pub fn analysed(wheels: &[Innovations; 2], step: f64) -> Whiteness {
    let scaled = [0, 1].map(|i| Centred::new(&wheels[i].scaled));
    let input = [0, 1].map(|i| Centred::new(&wheels[i].input));
    let own =
        |x: &Centred| -> Vec<f64> { (0..=LAGS).map(|lag| lagged_correlation(x, x, lag)).collect() };
    let (auto, inputs) = (scaled.each_ref().map(own), input.each_ref().map(own));
    let cross = [0, 1].map(|i| -> Vec<f64> {
        let (e, u) = (&scaled[i], &input[i]);
        let early = (1..=LAGS).rev().map(|lag| lagged_correlation(e, u, lag));
        early.chain((0..=LAGS).map(|lag| lagged_correlation(u, e, lag))).collect()
    });
    let count = |i: usize| wheels[i].scaled.iter().map(Vec::len).sum::<usize>() as f64;
    let z = normal_quantile(0.5 + 0.5 * LEVEL);
    let all = |i: usize| wheels[i].scaled.iter().flatten();
    let mean_square = [0, 1].map(|i| all(i).map(|e| e * e).sum::<f64>() / count(i));
    // Ljung 1999, section 16.6: the variance holds the correlations of both signals
    let joint = |i: usize| {
        let both = |lag: usize| auto[i][lag] * inputs[i][lag];
        (both(0) + 2.0 * (1..=LAGS).map(both).sum::<f64>()).max(1.0)
    };
    Whiteness {
        speeds: true,
        step_s: step,
        auto_bound: [0, 1].map(|i| z / count(i).sqrt()),
        cross_bound: [0, 1].map(|i| z * (joint(i) / count(i)).sqrt()),
        density: [0, 1].map(|i| density(all(i))),
        frequency_hz: (1..=SEGMENT / 2).map(|n| n as f64 / (SEGMENT as f64 * step)).collect(),
        spectrum: [0, 1].map(|i| spectrum(&wheels[i].scaled)),
        mean_square,
        auto,
        cross,
        one_row: None,
    }
}

/// A signal without its mean, stretch by stretch.
struct Centred {
    stretches: Vec<Vec<f64>>,
    /// Sum of the squares.
    square: f64,
}

impl Centred {
    fn new(signal: &[Vec<f64>]) -> Self {
        let count = signal.iter().map(Vec::len).sum::<usize>() as f64;
        let mean = signal.iter().flatten().sum::<f64>() / count;
        let without = |stretch: &Vec<f64>| stretch.iter().map(|v| v - mean).collect();
        let stretches: Vec<Vec<f64>> = signal.iter().map(without).collect();
        let square = stretches.iter().flatten().map(|v| v * v).sum();
        Self { stretches, square }
    }
}

/// Correlation of `a` with `b` at a delay of `lag` rows, over stretches.
///
/// ```text
/// r(lag) = Σ a(k) b(k + lag)/sqrt(Σ a² Σ b²)
/// ```
fn lagged_correlation(a: &Centred, b: &Centred, lag: usize) -> f64 {
    let pairs = |(a, b): (&Vec<f64>, &Vec<f64>)| {
        a.iter().zip(b.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>()
    };
    let product: f64 = a.stretches.iter().zip(&b.stretches).map(pairs).sum();
    product / (a.square * b.square).sqrt().max(f64::MIN_POSITIVE)
}

fn density<'a>(values: impl Iterator<Item = &'a f64>) -> Vec<f64> {
    let width = 2.0 * REACH / BINS as f64;
    let (mut counts, mut all) = (vec![0.0; BINS], 0.0);
    for v in values {
        all += 1.0;
        if v.abs() < REACH {
            counts[((v + REACH) / width) as usize] += 1.0;
        }
    }
    counts.iter().map(|c| c / (all * width)).collect()
}

/// Spectrum by Welch's method: Hann window, segments that overlap by half.
///
/// ```text
/// S(n) = mean |Σ h(k) e(k) exp(-2πi n k/N)|²/Σ h²
/// ```
/// One for white noise of unit variance.
fn spectrum(stretches: &[Vec<f64>]) -> Vec<f64> {
    let turn = std::f64::consts::TAU / SEGMENT as f64;
    let window: Vec<f64> = (0..SEGMENT).map(|k| 0.5 * (1.0 - (turn * k as f64).cos())).collect();
    let norm: f64 = window.iter().map(|h| h * h).sum();
    let table: Vec<(f64, f64)> =
        (0..SEGMENT).map(|k| (turn * k as f64).sin_cos()).map(|(s, c)| (c, s)).collect();
    let (mut sum, mut count) = (vec![0.0; SEGMENT / 2], 0.0);
    for stretch in stretches {
        for start in (0..=stretch.len().saturating_sub(SEGMENT)).step_by(SEGMENT / 2) {
            let Some(segment) = stretch.get(start..start + SEGMENT) else { break };
            let mean = segment.iter().sum::<f64>() / SEGMENT as f64;
            count += 1.0;
            for (n, out) in sum.iter_mut().enumerate() {
                let (mut re, mut im) = (0.0, 0.0);
                for (k, (e, h)) in segment.iter().zip(&window).enumerate() {
                    let (c, s) = table[(n + 1) * k % SEGMENT];
                    re += h * (e - mean) * c;
                    im += h * (e - mean) * s;
                }
                *out += (re * re + im * im) / norm;
            }
        }
    }
    sum.iter().map(|v| if count > 0.0 { v / count } else { f64::NAN }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    fn white(count: usize, seed: u64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        (0..count).map(|_| StandardNormal.sample(&mut rng)).collect()
    }

    #[test]
    fn a_correlation_of_a_worked_example_is_its_sum() {
        // means 0: products at lag 1 are 1·(-1) + (-1)·2 + 2·(-2) = -7, squares 10
        let a = Centred::new(&[vec![1.0, -1.0, 2.0, -2.0]]);
        assert!((lagged_correlation(&a, &a, 1) + 0.7).abs() < 1e-12);
        // no product across the end of a stretch
        let b = Centred::new(&[vec![1.0, -1.0], vec![2.0, -2.0]]);
        assert!((lagged_correlation(&b, &b, 1) + 0.5).abs() < 1e-12);
    }

    #[test]
    fn white_innovations_stay_within_the_bounds_and_coloured_ones_do_not() {
        let e = white(20_000, 1);
        let u: Vec<f64> = white(20_000, 2).windows(5).map(|w| w.iter().sum()).collect();
        let e = e[..u.len()].to_vec();
        let late: Vec<f64> = (0..u.len()).map(|k| e[k] + 0.1 * u[k.saturating_sub(3)]).collect();
        let wheel = |e: Vec<f64>| Innovations { scaled: vec![e], input: vec![u.clone()] };
        let out = analysed(&[wheel(e), wheel(late)], 0.01);
        // of 25 + 51 correlations at 99 % some two may lie outside
        let outside = |i: usize| {
            let auto = out.auto[i][1..].iter().filter(|r| r.abs() > out.auto_bound[i]).count();
            auto + out.cross[i].iter().filter(|r| r.abs() > out.cross_bound[i]).count()
        };
        assert!(outside(0) <= 4 && outside(1) > 10, "{} {}", outside(0), outside(1));
        // the innovation follows the input by three rows
        let strongest = (0..out.cross[1].len())
            .max_by(|a, b| out.cross[1][*a].total_cmp(&out.cross[1][*b]))
            .unwrap();
        assert_eq!(strongest, LAGS + 3);
        // 156 segments, half of them independent: a deviation of a tenth a frequency
        let mean = out.spectrum[0].iter().sum::<f64>() / out.spectrum[0].len() as f64;
        assert!((mean - 1.0).abs() < 0.03, "{mean}");
        let normal = 1.0 / std::f64::consts::TAU.sqrt();
        assert!((out.density[0][BINS / 2] - normal).abs() < 0.03);
    }
}
