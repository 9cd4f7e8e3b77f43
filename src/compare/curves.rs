//! The residual torque as a function of anything that it may depend on.

use super::low_pass::smooth_motion;
use super::residual_torque::{motion_of, residual_torque};
use super::split_noise::with_split_noise;
use super::unexplained_torque::Variable;
use crate::math::distribution::chi2_log_survival;
use crate::model::Model;
use crate::recording::Recording;

/// Length of the blocks whose sums count as independent \[s\].
const BLOCK: f64 = 1.0;
/// Bins of a variable.
const BINS: usize = 12;
/// A gap between neighbouring values longer than this share of their range has no bin across it.
const GAP: f64 = 0.08;
/// Rows of a bin at least.
const FEWEST: usize = 10;

/// A mean with its standard error.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Mean {
    /// Mean; not a number without rows.
    pub value: f64,
    /// Standard error, from the sums over blocks of 1 s.
    pub std_error: f64,
    /// Blocks of 1 s that fall into the bin.
    pub blocks: usize,
}

/// Mean of values with the number of the block that each lies in, blocks in order.
///
/// ```text
/// se² = B/(B - 1) Σ_b (Σ_k in b (x_k - mean))²/n²
/// ```
#[must_use]
pub fn clustered_mean(values: &[(usize, f64)]) -> Mean {
    let n = values.len() as f64;
    let value = values.iter().map(|v| v.1).sum::<f64>() / n;
    let (mut square, mut blocks) = (0.0, 0);
    for block in values.chunk_by(|a, b| a.0 == b.0) {
        square += block.iter().map(|v| v.1 - value).sum::<f64>().powi(2);
        blocks += 1;
    }
    let small = blocks as f64 / (blocks as f64 - 1.0);
    let std_error = if blocks > 1 { (small * square).sqrt() / n } else { f64::NAN };
    Mean { value, std_error, blocks }
}

/// The residual torque in one bin of a variable.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct CurveBin {
    /// Mean of the variable.
    pub at: f64,
    /// Whether values lie without a gap between this bin and the one before it.
    pub joined: bool,
    /// Of the model as given, by wheel [N m].
    pub before: [Mean; 2],
    /// Of the model with what was found, by wheel [N m].
    pub after: Option<[Mean; 2]>,
}

/// How the residual torque depends on a variable.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Curve {
    /// What stands on the abscissa.
    pub variable: Variable,
    /// Bins in order.
    pub bins: Vec<CurveBin>,
    /// Share of the mean square of the residual torque that the bins explain, of the model as given.
    pub share_before: f64,
    /// The same of the model with what was found, as a share of the mean square of the model as given.
    pub share_after: Option<f64>,
    /// -ln of the p-value of the dependence of the model as given.
    pub log_significance: f64,
}

/// Rows with their residual torques.
struct Row {
    block: usize,
    values: [f64; 12],
    before: [f64; 2],
    after: [f64; 2],
}

/// A model with its [`residual_torque()`] of every recording.
#[derive(Clone, Copy)]
pub struct Unexplained<'a> {
    /// The fitted model of which it is the residual.
    pub model: &'a Model,
    /// Values of its parameters.
    pub p: &'a [f64],
    /// Residual torque, a list a recording [N m].
    pub torque: &'a [Vec<[f64; 2]>],
}

/// The residual torque over every variable, the one that explains most first.
///
/// Bins hold equal counts.
///
/// ```text
/// share = 1 - (RSS₁/(n - k))/(RSS₀/n),   T = n ln(RSS₀/RSS₁) ~ χ²_k,   n = 2 fc T, k means
/// ```
/// n is the number of independent values behind a low-pass of cut-off fc over the time T that wheels move.
///
/// Noise of the speeds is in a measured acceleration and, times the inertia, in the residual torque with the opposite
/// sign: over its own acceleration the residual torque of the right model falls. For the accelerations the speeds are
/// therefore split into two of which the noises are independent; one gives the acceleration, the
/// other the residual torque.
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
        of_torque.iter().map(|r| residual_torque(u.model, u.p, r, cutoff)).collect()
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
        curve(rows, v, independent, after.is_some())
    };
    let mut out: Vec<Curve> = (0..Variable::ALL.len()).filter_map(of).collect();
    out.sort_by(|a, b| b.share_before.total_cmp(&a.share_before));
    out
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

fn curve(rows: &[Row], v: usize, independent: f64, has_after: bool) -> Option<Curve> {
    let moves = |r: &&Row| r.before.iter().any(|m| m.is_finite()) && r.values[v].is_finite();
    let mut order: Vec<&Row> = rows.iter().filter(moves).collect();
    order.sort_by(|a, b| a.values[v].total_cmp(&b.values[v]));
    if order.len() < BINS * FEWEST || order[0].values[v] == order[order.len() - 1].values[v] {
        return None;
    }
    let bins: Vec<(bool, Vec<&Row>)> = cut(&order, v);
    let mean = |bin: &[&Row], of: &dyn Fn(&Row) -> [f64; 2]| -> [Mean; 2] {
        [0, 1].map(|i| {
            let mut values: Vec<(usize, f64)> =
                bin.iter().map(|r| (r.block, of(r)[i])).filter(|v| v.1.is_finite()).collect();
            values.sort_by_key(|v| v.0);
            clustered_mean(&values)
        })
    };
    let made: Vec<CurveBin> = bins
        .iter()
        .map(|(joined, bin)| CurveBin {
            at: bin.iter().map(|r| r.values[v]).sum::<f64>() / bin.len() as f64,
            joined: *joined,
            before: mean(bin, &|r| r.before),
            after: has_after.then(|| mean(bin, &|r| r.after)),
        })
        .collect();
    let explained = |of: &dyn Fn(&Row) -> [f64; 2], means: &dyn Fn(&CurveBin) -> [Mean; 2]| {
        explained(&bins, of, &made.iter().map(means).collect::<Vec<_>>(), independent)
    };
    let (square, share_before, log_significance) = explained(&|r| r.before, &|b| b.before);
    let after = has_after.then(|| {
        let (left, share, _) = explained(&|r| r.after, &|b| b.after.unwrap_or(b.before));
        share * left / square.max(f64::MIN_POSITIVE)
    });
    let variable = Variable::ALL[v];
    Some(Curve { variable, bins: made, share_before, share_after: after, log_significance })
}

/// Rows in the order of a variable cut into bins of equal counts, none across a gap; whether each follows
/// the one before without a gap.
fn cut<'a>(order: &[&'a Row], v: usize) -> Vec<(bool, Vec<&'a Row>)> {
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

/// Sum of squares, the share of it that the bins' means explain, and -ln p.
fn explained(
    bins: &[(bool, Vec<&Row>)],
    of: &dyn Fn(&Row) -> [f64; 2],
    means: &[[Mean; 2]],
    independent: f64,
) -> (f64, f64, f64) {
    let (mut whole, mut left, mut count, mut used) = (0.0, 0.0, 0.0, 0.0);
    for ((_, bin), mean) in bins.iter().zip(means) {
        for i in 0..2 {
            let values = || bin.iter().map(|r| of(r)[i]).filter(|v| v.is_finite());
            whole += values().map(|v| v * v).sum::<f64>();
            left += values().map(|v| (v - mean[i].value).powi(2)).sum::<f64>();
            count += values().count() as f64;
            used += f64::from(mean[i].value.is_finite());
        }
    }
    let n = count * independent;
    if n <= used + 1.0 || whole <= 0.0 {
        return (whole, 0.0, 0.0);
    }
    let left = left.max(1e-12 * whole);
    let share = 1.0 - (left / (n - used)) / (whole / n);
    (whole, share.max(0.0), -chi2_log_survival(n * (whole / left).ln(), used))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_a_mean_counts_blocks_and_not_rows() {
        // three blocks of two equal rows: as three values 1, 2, 6 of mean 3, whose standard error is
        // sqrt(((1-3)² + (2-3)² + (6-3)²)/2/3)
        let values = [(0, 1.0), (0, 1.0), (1, 2.0), (1, 2.0), (2, 6.0), (2, 6.0)];
        let mean = clustered_mean(&values);
        assert_eq!((mean.value, mean.blocks), (3.0, 3));
        assert!((mean.std_error - (14.0_f64 / 6.0).sqrt()).abs() < 1e-12);
    }

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
        let curve = curve(&rows, 0, 1.0, false).unwrap();
        let broken: Vec<f64> = curve.bins.iter().filter(|b| !b.joined).map(|b| b.at).collect();
        assert_eq!(broken.len(), 2);
        assert!(broken[0] < -1.0 && broken[1] > 1.0);
        assert!(curve.bins.iter().all(|b| (b.before[0].value - b.at.signum()).abs() < 0.02));
        // 1/(1 + 0.01) of the mean square is the step
        assert!((curve.share_before - 1.0 / 1.01).abs() < 1e-3, "{}", curve.share_before);
        assert!(curve.log_significance > 1000.0);
    }
}
