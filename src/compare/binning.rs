//! The residual torque in bins of a variable, and the share that the bins explain.

use super::acting::Acting;
use super::circle::{self, opened};
use super::curve::{Curve, CurveBin};
use super::mean::{Mean, Sample, clustered_factor};
use super::unexplained_torque::Variable;
use crate::math;
use crate::math::distribution::chi2_log_survival;

/// Number of bins per variable.
const BINS: usize = 12;
/// No bin crosses a gap between neighbouring values longer than this share of their range.
const GAP: f64 = 0.08;
/// Smallest number of rows in a bin.
const FEWEST: usize = 10;

/// A row with the values of all variables and its residual torques.
pub(super) struct Row {
    /// Number of its block.
    pub(super) block: usize,
    /// In the order of [`Variable::ALL`].
    pub(super) values: [f64; 12],
    /// Residual torque of the model as given, by wheel [N m].
    pub(super) before: [f64; 2],
    /// The same of the model with the effects found; NaN without one.
    pub(super) after: [f64; 2],
}

/// The curve over a variable for the way of acting that explains most of the remaining residual torque.
pub(super) fn as_it_acts(
    rows: &[Row],
    v: usize,
    independent: f64,
    has_after: bool,
) -> Option<Curve> {
    let bins = binned(rows, v)?;
    let all = Acting::of(Variable::ALL[v]).iter();
    let all = all.map(|acting| curve(&bins, v, *acting, independent, has_after));
    all.reduce(|best, next| if next.left() > best.left() { next } else { best })
}

/// A bin of a variable.
struct Bin<'a> {
    /// Whether it follows the previous one without a gap.
    joined: bool,
    /// Mean of the variable.
    at: f64,
    /// Its rows, blocks in order.
    rows: Vec<&'a Row>,
}

/// The rows in motion in bins of a variable; `None` if there are too few, or if the variable is constant
/// or an angle that hardly changes.
fn binned(rows: &[Row], v: usize) -> Option<Vec<Bin<'_>>> {
    let moves = |r: &&Row| r.before.iter().any(|m| m.is_finite()) && r.values[v].is_finite();
    // the values beside the rows: a comparison reads no row
    let mut order: Vec<(f64, &Row)> = rows.iter().filter(moves).map(|r| (r.values[v], r)).collect();
    if Variable::ALL[v].is_cyclic() {
        let cut = circle::cut(order.iter().map(|(angle, _)| *angle))?;
        order.iter_mut().for_each(|(angle, _)| *angle = opened(*angle, cut));
    }
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let varies = |order: &[(f64, &Row)]| order[0].0 != order[order.len() - 1].0;
    (order.len() >= BINS * FEWEST && varies(&order)).then(|| cut(&order))
}

fn curve(bins: &[Bin<'_>], v: usize, acting: Acting, independent: f64, has_after: bool) -> Curve {
    let model = |of: fn(&Row) -> [f64; 2]| {
        let samples: Vec<[Vec<Sample>; 2]> =
            bins.iter().map(|bin| [0, 1].map(|i| samples(bin, acting, i, of))).collect();
        let means: Vec<[Mean; 2]> =
            samples.iter().map(|bin| [0, 1].map(|i| clustered_factor(&bin[i]))).collect();
        (explained(&samples, &means, acting, independent), means)
    };
    let (before, means) = model(|r| r.before);
    let after = has_after.then(|| model(|r| r.after));
    let made = bins.iter().enumerate().map(|(n, bin)| CurveBin {
        at: bin.at,
        joined: bin.joined,
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
fn samples(bin: &Bin, acting: Acting, i: usize, of: fn(&Row) -> [f64; 2]) -> Vec<Sample> {
    let at = |r: &Row, of_wheel_1: Variable| r.values[of_wheel_1 as usize + i];
    let sample = |r: &&Row| Sample {
        block: r.block,
        per: acting.per(at(r, Variable::Omega1), at(r, Variable::Input1)),
        value: of(r)[i],
    };
    bin.rows.iter().map(sample).filter(|s| s.value.is_finite()).collect()
}

/// Rows sorted by a variable, with its values, divided into bins of equal counts that do not cross a gap.
fn cut<'a>(order: &[(f64, &'a Row)]) -> Vec<Bin<'a>> {
    let at = |n: usize| order[n].0;
    let (low, high) = (at(order.len() / 100), at(order.len() - 1 - order.len() / 100));
    let inside: Vec<(f64, &Row)> =
        order.iter().copied().filter(|(value, _)| (low..=high).contains(value)).collect();
    let size = inside.len().div_ceil(BINS).max(FEWEST);
    let is_gap = |a: &(f64, &Row), b: &(f64, &Row)| b.0 - a.0 <= GAP * (high - low);
    let mut out = Vec::new();
    for stretch in inside.chunk_by(is_gap) {
        let count = ((stretch.len() as f64 / size as f64).round() as usize).max(1);
        let each = stretch.len().div_ceil(count);
        for (n, bin) in stretch.chunks(each).enumerate().filter(|(_, bin)| bin.len() >= FEWEST) {
            let at = math::mean(bin.iter().map(|(value, _)| *value));
            let mut rows: Vec<&Row> = bin.iter().map(|(_, row)| *row).collect();
            rows.sort_by_key(|row| row.block);
            out.push(Bin { joined: n > 0, at, rows });
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
    let [mut square, mut same, mut left, mut count, mut used, mut constants] = [0.0; 6];
    for i in 0..2 {
        let of_wheel = || bins.iter().flat_map(|bin| &bin[i]);
        let constant = match acting {
            Acting::Torque => 0.0,
            _ => clustered_factor(&of_wheel().copied().collect::<Vec<_>>()).value,
        };
        square += of_wheel().map(|s| square_of(s, 0.0)).sum::<f64>();
        let is_estimated = acting != Acting::Torque && constant.is_finite();
        constants += f64::from(u8::from(is_estimated));
        same += of_wheel().map(|s| square_of(s, constant)).sum::<f64>();
        for (bin, mean) in bins.iter().zip(means) {
            left += bin[i].iter().map(|s| square_of(s, mean[i].value)).sum::<f64>();
            count += bin[i].len() as f64;
            used += f64::from(mean[i].value.is_finite());
        }
    }
    let n = count * independent;
    if n <= used + 1.0 || used <= constants || square <= 0.0 {
        return Explained { square, share: 0.0, log_significance: 0.0 };
    }
    let left = left.max(1e-12 * square);
    let share = (same / (n - constants) - left / (n - used)) / (square / n);
    let log_significance = -chi2_log_survival(n * (same / left).ln(), used - constants);
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
    fn a_resistance_over_the_heading_is_distinguished_from_a_torque() {
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
