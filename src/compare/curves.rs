//! The residual torque as a function of speeds, angles, accelerations, inputs and time.

use super::acting::Acting;
use super::low_pass::smooth_motion;
use super::mean::{Mean, Sample, clustered_factor};
use super::residual_torque::{motion_of, residual_torque};
use super::split_noise::with_split_noise;
use super::unexplained_torque::Variable;
use crate::math;
use crate::math::distribution::chi2_log_survival;
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::Hold;

/// Length of the blocks whose sums are treated as independent \[s\].
const BLOCK: f64 = 1.0;
/// Number of bins per variable.
const BINS: usize = 12;
/// No bin crosses a gap between neighbouring values longer than this share of their range.
const GAP: f64 = 0.08;
/// Smallest number of rows in a bin.
const FEWEST: usize = 10;

/// The residual torque in one bin of a variable.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct CurveBin {
    /// Mean of the variable.
    pub at: f64,
    /// Whether there is no gap between this bin and the previous one.
    pub joined: bool,
    /// Residual torque of the model as given, by wheel [N m; a share of the input if it acts as a gain].
    pub before: [Mean; 2],
    /// Residual torque of the model with the effects found, by wheel, in the same unit.
    pub after: Option<[Mean; 2]>,
}

/// How the residual torque depends on a variable.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Curve {
    /// Variable of the abscissa.
    pub variable: Variable,
    /// How the torque of the bins acts.
    pub acting: Acting,
    /// Bins in order.
    pub bins: Vec<CurveBin>,
    /// Share of the mean square of the residual torque that the bins explain, of the model as given.
    pub share_before: f64,
    /// The same for the model with the effects found, as a share of the mean square of the model as given.
    pub share_after: Option<f64>,
    /// -ln of the p-value of the dependence of the model as given.
    pub log_significance: f64,
}

impl Curve {
    /// The remaining share: of the model with the effects found if there are any, otherwise of the model as
    /// given.
    #[must_use]
    pub fn left(&self) -> f64 {
        self.share_after.unwrap_or(self.share_before)
    }

    /// The largest absolute mean of the remaining residual torque \[N m; a share of the input if it acts as a
    /// gain\].
    #[must_use]
    pub fn largest_left(&self) -> f64 {
        let means = self.bins.iter().flat_map(|b| b.after.unwrap_or(b.before));
        means.map(|m| m.value.abs()).filter(|v| v.is_finite()).fold(0.0, f64::max)
    }

    /// -ln of the p-value of the remaining dependence if only the blocks of 1 s are independent, as under coloured noise
    /// of the input. Bins of one or two blocks are left out.
    ///
    /// ```text
    /// T = Σ z² ~ χ²,   z: normal quantile of the p-value of t = (mean - c)/se, of B - 1 degrees of freedom in B blocks
    /// ```
    /// c is zero for a torque; for a resistance or a gain it is the mean of all bins, weighted by 1/se², which does not depend
    /// on the variable.
    ///
    /// Source of z: Wallace, Ann. Math. Stat. 30 (1959).
    #[must_use]
    pub fn clustered_significance(&self) -> f64 {
        let (mut statistic, mut count) = (0.0, 0.0);
        for i in 0..2 {
            let means = self.bins.iter().map(|b| b.after.unwrap_or(b.before)[i]);
            let known: Vec<Mean> = means.filter(|m| m.blocks > 2 && m.std_error > 0.0).collect();
            let weight = |m: &Mean| m.std_error.powi(-2);
            let common = match self.acting {
                Acting::Torque => 0.0,
                _ => {
                    known.iter().map(|m| weight(m) * m.value).sum::<f64>()
                        / known.iter().map(weight).sum::<f64>()
                }
            };
            let degrees = |m: &Mean| (m.blocks - 1) as f64;
            let square = |m: &Mean| {
                let t = (m.value - common) / m.std_error;
                let n = degrees(m);
                ((8.0 * n + 1.0) / (8.0 * n + 3.0)).powi(2) * n * (t * t / n).ln_1p()
            };
            statistic += known.iter().map(square).sum::<f64>();
            count += known.len() as f64 - f64::from(u8::from(self.acting != Acting::Torque));
        }
        if count > 0.0 { -chi2_log_survival(statistic, count) } else { 0.0 }
    }
}

/// Rows with their residual torques.
struct Row {
    block: usize,
    values: [f64; 12],
    before: [f64; 2],
    after: [f64; 2],
}

/// A model with its [`residual_torque()`] for every recording.
#[derive(Clone, Copy)]
pub struct Unexplained<'a> {
    /// The fitted model.
    pub model: &'a Model,
    /// Values of its parameters.
    pub p: &'a [f64],
    /// The input between the rows.
    pub hold: Hold,
    /// Residual torque, one list per recording [N m].
    pub torque: &'a [Vec<[f64; 2]>],
}

/// The residual torque over every variable, sorted by the share that the variable explains.
///
/// Bins contain equal numbers of rows.
///
/// ```text
/// share = 1 - (RSS₁/(n - k))/(RSS₀/n),   T = n ln(RSS₀/RSS₁) ~ χ²_k,   n = 2 fc T, k means
/// ```
/// n is the number of independent values after a low-pass with cut-off fc over the time T during which the wheels move.
///
/// Over the heading, the wheel angles and time the residual torque r may also act as a resistance or a gain;
/// for each variable the curve that explains most is returned ([`Acting`]):
///
/// ```text
/// r_i = c(x) φ_i,   φ_i = 1, sgn ω_i or M_i;   RSS₀ of the last two with one c for all x
/// ```
///
/// Noise of the speeds enters a measured acceleration and, multiplied by the inertia, the residual torque
/// with the opposite sign. Over its own acceleration the residual torque of a correct model would therefore
/// fall. For the accelerations the speeds are split into two copies with independent noise; one gives the
/// acceleration, the other the residual torque.
#[must_use]
pub fn curves(
    recordings: &[&Recording],
    cutoff: f64,
    before: Unexplained<'_>,
    after: Option<Unexplained<'_>>,
) -> Vec<Curve> {
    let measured = rows(recordings, cutoff, before, after);
    let split: Vec<[Recording; 2]> =
        recordings.iter().enumerate().map(|(n, r)| with_split_noise(r, n as u64)).collect();
    let [of_motion, of_torque] =
        [0, 1].map(|i| split.iter().map(|pair| &pair[i]).collect::<Vec<_>>());
    let again = |u: Unexplained<'_>| -> Vec<Vec<[f64; 2]>> {
        of_torque.iter().map(|r| residual_torque(u.model, u.p, r, u.hold, cutoff)).collect()
    };
    let (torque, torque_after) = (again(before), after.map(again));
    let after_split = after.zip(torque_after.as_deref());
    let independent_noise = rows(
        &of_motion,
        cutoff,
        Unexplained { torque: &torque, ..before },
        after_split.map(|(u, torque)| Unexplained { torque, ..u }),
    );
    let step = recordings.iter().map(|r| r.step()).fold(f64::INFINITY, f64::min);
    let independent = (2.0 * cutoff * step).min(1.0);
    let of = |v: usize| {
        let rows = if Variable::ALL[v].is_acceleration() { &independent_noise } else { &measured };
        as_it_acts(rows, v, independent, after.is_some())
    };
    let mut out: Vec<Curve> = (0..Variable::ALL.len()).filter_map(of).collect();
    out.sort_by(|a, b| b.share_before.total_cmp(&a.share_before));
    out
}

/// The curve over a variable for the way of acting that explains most of the remaining residual torque.
fn as_it_acts(rows: &[Row], v: usize, independent: f64, has_after: bool) -> Option<Curve> {
    let bins = binned(rows, v)?;
    let all = Acting::of(Variable::ALL[v]).iter();
    let all = all.map(|acting| curve(&bins, v, *acting, independent, has_after));
    all.reduce(|best, next| if next.left() > best.left() { next } else { best })
}

/// Rows in bins of a variable, and whether each bin follows the previous one without a gap.
type Bins<'a> = Vec<(bool, Vec<&'a Row>)>;

/// The rows in motion in bins of a variable; `None` if there are too few, or if the variable is constant.
fn binned(rows: &[Row], v: usize) -> Option<Bins<'_>> {
    let moves = |r: &&Row| r.before.iter().any(|m| m.is_finite()) && r.values[v].is_finite();
    let mut order: Vec<&Row> = rows.iter().filter(moves).collect();
    order.sort_by(|a, b| a.values[v].total_cmp(&b.values[v]));
    let varies = |order: &[&Row]| order[0].values[v] != order[order.len() - 1].values[v];
    (order.len() >= BINS * FEWEST && varies(&order)).then(|| cut(&order, v))
}

fn rows(
    recordings: &[&Recording],
    cutoff: f64,
    before: Unexplained<'_>,
    after: Option<Unexplained<'_>>,
) -> Vec<Row> {
    let (mut out, mut first_block) = (Vec::new(), 0);
    for (n, recording) in recordings.iter().enumerate() {
        let t = recording.t();
        let block = |k: usize| first_block + ((t[k] - t[0]) / BLOCK) as usize;
        for (k, m) in smooth_motion(recording, cutoff).iter().enumerate() {
            let x = motion_of(before.model, t[k] - t[0], m);
            let value = |v: &Variable| v.at(&x, &m.acceleration, &recording.torque()[k]);
            // both models on the same rows
            let after = after.map(|a| a.torque[n][k]);
            let known = |i: usize| after.is_none_or(|a| a[i].is_finite());
            let before = [0, 1].map(|i| if known(i) { before.torque[n][k][i] } else { f64::NAN });
            out.push(Row {
                block: block(k),
                values: std::array::from_fn(|v| value(&Variable::ALL[v])),
                before,
                after: after.unwrap_or([f64::NAN; 2]),
            });
        }
        first_block = block(recording.len() - 1) + 1;
    }
    out
}

fn curve(bins: &Bins<'_>, v: usize, acting: Acting, independent: f64, has_after: bool) -> Curve {
    let model = |of: fn(&Row) -> [f64; 2]| {
        let samples: Vec<[Vec<Sample>; 2]> =
            bins.iter().map(|(_, bin)| [0, 1].map(|i| samples(bin, acting, i, of))).collect();
        let means: Vec<[Mean; 2]> =
            samples.iter().map(|bin| [0, 1].map(|i| clustered_factor(&bin[i]))).collect();
        (explained(&samples, &means, acting, independent), means)
    };
    let (before, means) = model(|r| r.before);
    let after = has_after.then(|| model(|r| r.after));
    let made = bins.iter().enumerate().map(|(n, (joined, bin))| CurveBin {
        at: math::mean(bin.iter().map(|r| r.values[v])),
        joined: *joined,
        before: means[n],
        after: after.as_ref().map(|(_, means)| means[n]),
    });
    Curve {
        variable: Variable::ALL[v],
        acting,
        bins: made.collect(),
        share_before: before.share,
        share_after: after
            .as_ref()
            .map(|(after, _)| after.share * after.square / before.square.max(f64::MIN_POSITIVE)),
        log_significance: before.log_significance,
    }
}

/// The residual torques of wheel `i` in a bin, blocks in order.
fn samples(bin: &[&Row], acting: Acting, i: usize, of: fn(&Row) -> [f64; 2]) -> Vec<Sample> {
    let at = |r: &Row, of_wheel_1: Variable| r.values[of_wheel_1 as usize + i];
    let sample = |r: &&Row| Sample {
        block: r.block,
        per: acting.per(at(r, Variable::Omega1), at(r, Variable::Input1)),
        value: of(r)[i],
    };
    let mut out: Vec<Sample> = bin.iter().map(sample).filter(|s| s.value.is_finite()).collect();
    out.sort_by_key(|s| s.block);
    out
}

/// Rows sorted by a variable, divided into bins of equal counts that do not cross a gap; with each bin,
/// whether it follows the previous one without a gap.
fn cut<'a>(order: &[&'a Row], v: usize) -> Bins<'a> {
    let at = |n: usize| order[n].values[v];
    let (low, high) = (at(order.len() / 100), at(order.len() - 1 - order.len() / 100));
    let inside: Vec<&Row> =
        order.iter().copied().filter(|r| (low..=high).contains(&r.values[v])).collect();
    let size = inside.len().div_ceil(BINS).max(FEWEST);
    let is_gap = |a: &&Row, b: &&Row| b.values[v] - a.values[v] <= GAP * (high - low);
    let mut out = Vec::new();
    for stretch in inside.chunk_by(is_gap) {
        let count = ((stretch.len() as f64 / size as f64).round() as usize).max(1);
        let each = stretch.len().div_ceil(count);
        for (n, bin) in stretch.chunks(each).enumerate().filter(|(_, bin)| bin.len() >= FEWEST) {
            out.push((n > 0, bin.to_vec()));
        }
    }
    out
}

/// Variance explained by the bins.
struct Explained {
    /// Sum of the squares of all values.
    square: f64,
    /// Share of it explained by the bins.
    share: f64,
    /// -ln p.
    log_significance: f64,
}

/// Variance explained by the `means` of the bins. For a resistance or a gain, the part common to all bins
/// does not depend on the variable and is not counted.
fn explained(
    bins: &[[Vec<Sample>; 2]],
    means: &[[Mean; 2]],
    acting: Acting,
    independent: f64,
) -> Explained {
    // rows of an input that is zero have no factor, and nothing is explained of them
    let known = |c: f64| if c.is_finite() { c } else { 0.0 };
    let square_of = |s: &Sample, c: f64| (s.value - known(c) * s.per).powi(2);
    let (mut square, mut same, mut left, mut count, mut used) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for i in 0..2 {
        let of_wheel = || bins.iter().flat_map(|bin| &bin[i]);
        let constant = match acting {
            Acting::Torque => 0.0,
            _ => clustered_factor(&of_wheel().copied().collect::<Vec<_>>()).value,
        };
        square += of_wheel().map(|s| square_of(s, 0.0)).sum::<f64>();
        same += of_wheel().map(|s| square_of(s, constant)).sum::<f64>();
        for (bin, mean) in bins.iter().zip(means) {
            left += bin[i].iter().map(|s| square_of(s, mean[i].value)).sum::<f64>();
            count += bin[i].len() as f64;
            used += f64::from(mean[i].value.is_finite());
        }
    }
    let n = count * independent;
    if n <= used + 1.0 || square <= 0.0 {
        return Explained { square, share: 0.0, log_significance: 0.0 };
    }
    let left = left.max(1e-12 * square);
    let share = (same / n - left / (n - used)) / (square / n);
    let log_significance = -chi2_log_survival(n * (same / left).ln(), used);
    Explained { square, share: share.max(0.0), log_significance }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(block: usize, x: f64, torque: f64) -> Row {
        Row { block, values: [x; 12], before: [torque; 2], after: [f64::NAN; 2] }
    }

    #[test]
    fn no_bin_lies_across_a_gap_and_a_step_is_explained() {
        // values in -2..-1 and 1..2, torque the sign of the value plus a fast alternation of 0.1
        let rows: Vec<Row> = (0..1000)
            .map(|k| {
                let x = if k < 500 { -2.0 } else { 1.0 } + (k % 500) as f64 / 500.0;
                row(k / 100, x, x.signum() + if k % 2 == 0 { 0.1 } else { -0.1 })
            })
            .collect();
        let curve = curve(&binned(&rows, 0).unwrap(), 0, Acting::Torque, 1.0, false);
        let broken: Vec<f64> = curve.bins.iter().filter(|b| !b.joined).map(|b| b.at).collect();
        assert_eq!(broken.len(), 2);
        assert!(broken[0] < -1.0 && broken[1] > 1.0);
        assert!(curve.bins.iter().all(|b| (b.before[0].value - b.at.signum()).abs() < 0.02));
        // 1/(1 + 0.01) of the mean square is the step
        assert!((curve.share_before - 1.0 / 1.01).abs() < 1e-3, "{}", curve.share_before);
        assert!(curve.log_significance > 1000.0);
    }

    /// Rows of 300 s, 10 a second, over a heading that turns slowly, with directions and inputs that change faster.
    fn driven(torque: impl Fn(f64, f64, f64) -> f64) -> Vec<Row> {
        (0..3000)
            .map(|k| {
                let t = 0.1 * f64::from(k);
                let heading = (0.21 * t).rem_euclid(std::f64::consts::TAU);
                let (speed, input) = ((0.9 * t).sin(), 1.0 + (1.7 * t).cos());
                let mut values = [0.0; 12];
                values[Variable::Omega1 as usize] = speed;
                values[Variable::Omega2 as usize] = speed;
                values[Variable::Input1 as usize] = input;
                values[Variable::Input2 as usize] = input;
                values[Variable::Heading as usize] = heading;
                values[Variable::Time as usize] = t;
                let before = [torque(t, heading, speed), torque(t, heading, speed)];
                Row { block: t as usize, values, before, after: [f64::NAN; 2] }
            })
            .collect()
    }

    #[test]
    fn a_resistance_over_the_heading_is_told_from_a_torque() {
        let nap = driven(|_, heading, speed| speed.signum() * (2.0 * heading).cos());
        let found = as_it_acts(&nap, Variable::Heading as usize, 1.0, false).unwrap();
        assert_eq!(found.acting, Acting::Resistance);
        // twelve steps across a wave of two periods hold sinc²(π/6) of its square, 0.912
        assert!((found.share_before - 0.912).abs() < 0.02, "{}", found.share_before);
        let slope = driven(|_, heading, _| heading.cos());
        let found = as_it_acts(&slope, Variable::Heading as usize, 1.0, false).unwrap();
        assert_eq!(found.acting, Acting::Torque);
    }

    #[test]
    fn a_torque_constant_that_fades_is_a_share_of_the_input_over_the_time() {
        let fading = |t: f64| (t - 150.0) / 1000.0;
        let rows = driven(|t, _, _| fading(t) * (1.0 + (1.7 * t).cos()));
        let found = as_it_acts(&rows, Variable::Time as usize, 1.0, false).unwrap();
        assert_eq!(found.acting, Acting::Gain);
        assert!(found.bins.iter().all(|b| (b.before[0].value - fading(b.at)).abs() < 0.003));
        // a share that is the same at all times does not depend on the time
        let same = driven(|t, _, _| 0.3 * (1.0 + (1.7 * t).cos()));
        let bins = binned(&same, Variable::Time as usize).unwrap();
        let curve = curve(&bins, Variable::Time as usize, Acting::Gain, 1.0, false);
        assert!(curve.share_before < 1e-9, "{}", curve.share_before);
    }

    #[test]
    fn nothing_is_explained_of_a_bin_without_input() {
        let mut coasting = driven(|t, _, _| if t < 25.0 { 1.0 } else { 0.0 });
        for row in coasting.iter_mut().filter(|row| row.values[Variable::Time as usize] < 30.0) {
            [Variable::Input1, Variable::Input2].iter().for_each(|i| row.values[*i as usize] = 0.0);
        }
        let bins = binned(&coasting, Variable::Time as usize).unwrap();
        let curve = curve(&bins, Variable::Time as usize, Acting::Gain, 1.0, false);
        assert!(curve.share_before < 0.01, "{}", curve.share_before);
    }

    #[test]
    fn a_dependence_counts_blocks_and_not_rows() {
        // two bins of three blocks: means 1 and -1 with standard errors of 0.5, t = ±2 of two degrees of freedom, whose
        // p-value of 0.18350 (scipy.stats.t.sf(2, 2) * 2) is that of z² = 1.7691; Wallace's z² is 1.7590
        let mean = |value| Mean { value, std_error: 0.5, blocks: 3 };
        let bin = |value| CurveBin { at: 0.0, joined: true, before: [mean(value); 2], after: None };
        let of = |acting, bins| Curve {
            variable: Variable::Omega1,
            acting,
            bins,
            share_before: 0.0,
            share_after: None,
            log_significance: 0.0,
        };
        let torque = of(Acting::Torque, vec![bin(1.0), bin(-1.0)]).clustered_significance();
        let expected = -chi2_log_survival(4.0 * 1.7691, 4.0);
        assert!((torque - expected).abs() < 0.02, "{torque} {expected}");
        // what all bins of a gain have in common does not depend on the variable
        let gain = of(Acting::Gain, vec![bin(1.0), bin(1.0)]).clustered_significance();
        assert!(gain.abs() < 1e-12, "{gain}");
    }

    #[test]
    fn coloured_noise_is_no_dependence_and_a_torque_beside_it_is_one() {
        // noise with a correlation time of 0.3 s: three rows
        let noise = crate::math::least_squares::tests::lcg(3000, 5);
        let mut coloured = vec![0.0; 3000];
        for k in 1..3000 {
            coloured[k] = 0.72 * coloured[k - 1] + noise[k];
        }
        let of = |torque: &dyn Fn(usize, f64) -> f64| {
            let rows = driven(|t, _, speed| torque((10.0 * t).round() as usize, speed));
            let v = Variable::Omega1 as usize;
            as_it_acts(&rows, v, 1.0, false).unwrap()
        };
        let alone = of(&|k, _| coloured[k]);
        assert!(alone.clustered_significance() < 10.0, "{}", alone.clustered_significance());
        let beside = of(&|k, speed| coloured[k] + speed);
        assert!(beside.clustered_significance() > 30.0, "{}", beside.clustered_significance());
    }
}
