//! Number of ticks of an axis.

use crate::report::scale::{Scale, Ticks};

use super::pen::TICK_LABEL;

/// Smallest number of labels of a readable axis: two define the scale, the third shows whether it is linear.
const FEWEST_LABELS: usize = 3;

fn label_count(ticks: &Ticks) -> usize {
    ticks.ticks.iter().filter(|tick| !tick.label.is_empty()).count()
}

/// Ticks about 38 px apart; closer where fewer than three would be labelled.
pub(super) fn y_ticks(scale: &Scale, height: f64) -> Ticks {
    let count = (height / 38.0).clamp(2.0, 10.0);
    let closest = (height / TICK_LABEL.line_height()).max(count);
    apart(fewest_or_more(scale, count, closest, |_| true), scale, height)
}

/// Without the labels that would touch the one below, as between the decades of a log axis, or the label of the axis
/// above.
fn apart(mut ticks: Ticks, scale: &Scale, height: f64) -> Ticks {
    let line = TICK_LABEL.line_height();
    let mut last = f64::NEG_INFINITY;
    for tick in ticks.ticks.iter_mut().filter(|tick| !tick.label.is_empty()) {
        let place = scale.share(tick.at) * height;
        // an exponent is higher than a digit
        let is_high = tick.label.contains('⁻') && height - place < 0.25 * line;
        if place - last < 0.8 * line || is_high {
            tick.label.clear();
        } else {
            last = place;
        }
    }
    ticks
}

/// As many ticks as there is space for their labels.
pub(super) fn x_ticks(scale: &Scale, width: f64) -> Ticks {
    let fits = |ticks: &Ticks| {
        let labelled = ticks.ticks.iter().filter(|tick| !tick.label.is_empty());
        let half = |label: &str| TICK_LABEL.width(label) / 2.0;
        let places: Vec<(f64, f64)> =
            labelled.map(|t| (scale.share(t.at) * width, half(&t.label))).collect();
        places.windows(2).all(|p| p[1].0 - p[0].0 >= p[0].1 + p[1].1 + 10.0)
    };
    let mut count = (width / 70.0).clamp(1.0, 14.0);
    while !fits(&scale.ticks(count)) && count > 1.0 {
        count = (0.75 * count).max(1.0);
    }
    fewest_or_more(scale, count, (width / 20.0).max(count), fits)
}

/// About `count` ticks; if fewer than three of them are labelled, the first denser division with three labels
/// that fit, or else the one with the most labels that fit.
fn fewest_or_more(scale: &Scale, count: f64, most: f64, fits: impl Fn(&Ticks) -> bool) -> Ticks {
    let mut best = scale.ticks(count);
    let mut denser = count;
    while label_count(&best) < FEWEST_LABELS && denser < most {
        denser = (1.25 * denser).min(most);
        let ticks = scale.ticks(denser);
        if label_count(&ticks) > label_count(&best) && fits(&ticks) {
            best = ticks;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figure::AxisScale;

    #[test]
    fn a_short_axis_keeps_three_labels_where_they_fit() {
        let scale = Scale { kind: AxisScale::Linear, first: -0.027, last: 0.021 };
        for height in [48.0, 60.0, 170.0] {
            assert!(label_count(&y_ticks(&scale, height)) >= FEWEST_LABELS, "{height} px");
        }
        let percent = Scale { kind: AxisScale::Linear, first: -4.1, last: 4.1 };
        assert!(label_count(&x_ticks(&percent, 260.0)) >= FEWEST_LABELS);
        // labels never touch
        assert!(label_count(&x_ticks(&percent, 40.0)) <= 2);
    }
}
