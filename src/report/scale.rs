//! Scale of an axis: from values to positions, and ticks.

use super::figure::{Axis, AxisScale};
use super::format;

/// The range of an axis: finite, first before last, positive if logarithmic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    pub(super) kind: AxisScale,
    pub(super) first: f64,
    pub(super) last: f64,
}

/// A tick; an empty label marks a minor one.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    pub(super) at: f64,
    pub(super) label: String,
}

/// The ticks of an axis and the common power of ten of their labels.
#[derive(Clone, Debug, PartialEq, Default)]
pub(super) struct Ticks {
    pub(super) ticks: Vec<Tick>,
    pub(super) exponent: i32,
}

/// Above this, differences of values would overflow.
const LARGEST: f64 = 1e300;
/// Below this share of their size, differences are rounding errors.
const SMALLEST_SPAN: f64 = 1e-9;
/// Largest number of decades: smaller values are zero up to rounding.
const MOST_DECADES: f64 = 24.0;

impl Scale {
    /// Determines the range: that of the axis, or that of the values widened by `padding` on both sides.
    pub(super) fn new(axis: &Axis, values: impl Iterator<Item = f64>, padding: f64) -> Self {
        let kind = axis.scale;
        let usable = |v: &f64| v.is_finite() && (kind == AxisScale::Linear || *v > 0.0);
        if let Some((a, b)) = axis.range.filter(|(a, b)| usable(a) && usable(b) && a != b) {
            return Self::settled(kind, a.min(b), a.max(b), 0.0);
        }
        let (low, high) = values
            .filter(usable)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        match kind {
            _ if low > high && kind == AxisScale::Log => Self { kind, first: 0.1, last: 10.0 },
            _ if low > high => Self { kind, first: 0.0, last: 1.0 },
            _ => Self::settled(kind, low, high, padding),
        }
    }

    fn settled(kind: AxisScale, low: f64, high: f64, padding: f64) -> Self {
        let clamped = (low.clamp(-LARGEST, LARGEST), high.clamp(-LARGEST, LARGEST));
        let (low, high) = match kind {
            AxisScale::Linear => clamped,
            AxisScale::Log => {
                let high = clamped.1.max(1.0 / LARGEST).log10();
                (clamped.0.max(1.0 / LARGEST).log10().max(high - MOST_DECADES), high)
            }
        };
        let size = low.abs().max(high.abs());
        let (low, high) = if high - low > SMALLEST_SPAN * size {
            let margin = padding * (high - low);
            (low - margin, high + margin)
        } else {
            // a single value is placed in the middle
            let margin = match kind {
                AxisScale::Linear if size == 0.0 => 1.0,
                AxisScale::Linear => 0.1 * size,
                AxisScale::Log => 0.5,
            };
            (low - margin, high + margin)
        };
        match kind {
            AxisScale::Linear => Self { kind, first: low, last: high },
            AxisScale::Log => Self { kind, first: 10f64.powf(low), last: 10f64.powf(high) },
        }
    }

    /// Relative position of a value: 0 at the first, 1 at the last; NaN if it has none.
    pub(super) fn share(&self, value: f64) -> f64 {
        match self.kind {
            AxisScale::Linear => (value - self.first) / (self.last - self.first),
            AxisScale::Log if value > 0.0 => {
                (value / self.first).log10() / (self.last / self.first).log10()
            }
            AxisScale::Log => f64::NAN,
        }
    }

    /// The union of two scales of the same kind; otherwise the first.
    pub(super) fn union(self, other: Self) -> Self {
        if self.kind != other.kind {
            return self;
        }
        Self {
            kind: self.kind,
            first: self.first.min(other.first),
            last: self.last.max(other.last),
        }
    }

    /// About `count` labelled ticks.
    pub(super) fn ticks(&self, count: f64) -> Ticks {
        let decades = match self.kind {
            AxisScale::Log => (self.last / self.first).log10(),
            AxisScale::Linear => 0.0,
        };
        // with less than a factor of two, or no whole decade, a logarithmic scale is similar to a linear one
        if decades >= 1.0 { self.log_ticks(count) } else { self.linear_ticks(count) }
    }

    fn linear_ticks(&self, count: f64) -> Ticks {
        let step = nice_step((self.last - self.first) / count.max(1.0));
        let from = (self.first / step - 1e-6).ceil();
        let to = (self.last / step + 1e-6).floor();
        let size = self.first.abs().max(self.last.abs());
        let magnitude = (size * (1.0 + 1e-9)).log10().floor() as i32;
        let exponent = if (-3..5).contains(&magnitude) { 0 } else { 3 * magnitude.div_euclid(3) };
        // the step's own digits: 0.25 has one more than its magnitude says
        let step_exponent = step.log10().floor() as i32;
        let leading = step / 10f64.powi(step_exponent);
        let digits = i32::from((leading - 2.5).abs() < 1e-6);
        let decimals = (exponent - step_exponent + digits).clamp(0, 15) as usize;
        let steps = if (to - from).abs() < 1e4 { (to - from).max(-1.0) as i64 } else { -1 };
        let tick = |i: i64| {
            let at = (from + i as f64) * step;
            let half = -exponent / 2;
            let shown = at * 10f64.powi(half) * 10f64.powi(-exponent - half);
            Tick { at, label: format::fixed(shown, decimals) }
        };
        Ticks { ticks: (0..=steps).map(tick).collect(), exponent }
    }

    fn log_ticks(&self, count: f64) -> Ticks {
        let (low, high) = (self.first.log10(), self.last.log10());
        let (from, to) = ((low - 1e-6).ceil() as i32, (high + 1e-6).floor() as i32);
        let decades = to - from + 1;
        let stride = (f64::from(decades) / count.max(1.0)).ceil().max(1.0) as i32;
        let plain = from >= -3 && to <= 4;
        // with few decades intermediate ticks are labelled too
        let between = f64::from(decades) * 3.0 <= count + 1.0 || decades < 2;
        let mut ticks = Vec::new();
        for exponent in from - 1..=to {
            for digit in 1..10 {
                let at = f64::from(digit) * 10f64.powi(exponent);
                let inside = (self.first * (1.0 - 1e-9)..=self.last * (1.0 + 1e-9)).contains(&at);
                let labelled = if digit == 1 {
                    exponent.rem_euclid(stride) == 0
                } else {
                    between && matches!(digit, 2 | 5)
                };
                if !inside || digit > 1 && (stride > 1 || decades > 12) {
                    continue;
                }
                let label = match (labelled, plain) {
                    (false, _) => String::new(),
                    (true, true) => format::fixed(at, (-exponent).max(0) as usize),
                    (true, false) if digit == 1 => format::power_of_ten(exponent),
                    (true, false) => format!("{digit} × {}", format::power_of_ten(exponent)),
                };
                ticks.push(Tick { at, label });
            }
        }
        Ticks { ticks, exponent: 0 }
    }
}

impl Ticks {
    /// The axis label with its unit in square brackets and the common power of ten of the ticks.
    pub(super) fn axis_label(&self, axis: &Axis) -> String {
        let power =
            if self.exponent == 0 { String::new() } else { format::power_of_ten(self.exponent) };
        let unit = [power.as_str(), axis.unit.as_str()];
        let unit: Vec<&str> = unit.into_iter().filter(|part| !part.is_empty()).collect();
        let mut label = axis.label.clone();
        if !unit.is_empty() {
            if !label.is_empty() {
                label.push(' ');
            }
            label.push_str(&format!("[{}]", unit.join("\u{2009}")));
        }
        label
    }
}

/// The next of 1, 2, 2.5, 5, 10 times a power of ten that is not smaller.
fn nice_step(rough: f64) -> f64 {
    if !(rough.is_finite() && rough > 0.0) {
        return 1.0;
    }
    let exponent = rough.log10().floor() as i32;
    let power = 10f64.powi(exponent);
    let lead = rough / power;
    let nice = [1.0, 2.0, 2.5, 5.0].into_iter().find(|nice| lead <= nice * (1.0 + 1e-9));
    match nice {
        // dividing by 10ⁿ is exact to rounding where multiplying by 10⁻ⁿ is not: 0.1, not 0.1000…01
        Some(nice) if exponent < 0 && exponent > -300 => nice / 10f64.powi(-exponent),
        Some(nice) => nice * power,
        None => 10.0 * power,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, range: (f64, f64), count: f64) -> Vec<String> {
        let scale = Scale::new(axis, [range.0, range.1].into_iter(), 0.0);
        let ticks = scale.ticks(count).ticks;
        ticks.into_iter().map(|tick| tick.label).filter(|label| !label.is_empty()).collect()
    }

    #[test]
    fn linear_ticks_are_round_numbers() {
        let linear = Axis::linear("t", "s");
        assert_eq!(labels(&linear, (0.0, 10.0), 5.0), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels(&linear, (-0.5, 0.5), 4.0), ["−0.50", "−0.25", "0.00", "0.25", "0.50"]);
        assert_eq!(labels(&linear, (0.97, 1.03), 3.0), ["0.98", "1.00", "1.02"]);
        assert_eq!(labels(&linear, (20_000.0, 40_000.0), 2.0), ["20000", "30000", "40000"]);
    }

    #[test]
    fn small_and_large_values_take_out_a_power_of_ten() {
        let axis = Axis::linear("residual", "rad/s");
        let scale = Scale::new(&axis, [0.0, 4e-5].into_iter(), 0.0);
        let ticks = scale.ticks(4.0);
        assert_eq!(ticks.axis_label(&axis), "residual [10⁻⁶\u{2009}rad/s]");
        let shown: Vec<&str> = ticks.ticks.iter().map(|tick| tick.label.as_str()).collect();
        assert_eq!(shown, ["0", "10", "20", "30", "40"]);
        // one rounding of the product 3 * 10⁻⁵
        assert!((ticks.ticks[3].at - 3e-5).abs() < 1e-20);
    }

    #[test]
    fn log_ticks_are_decades_with_superscripts_where_many() {
        let log = Axis::log("cost", "");
        assert_eq!(labels(&log, (1e-6, 1e2), 5.0), ["10⁻⁶", "10⁻⁴", "10⁻²", "10⁰", "10²"]);
        assert_eq!(labels(&log, (0.01, 100.0), 5.0), ["0.01", "0.1", "1", "10", "100"]);
        assert_eq!(labels(&log, (1.0, 20.0), 8.0), ["1", "2", "5", "10", "20"]);
    }

    #[test]
    fn a_scale_is_settled_for_any_values() {
        let cases: [&[f64]; 8] = [
            &[],
            &[f64::NAN, f64::INFINITY],
            &[5.0],
            &[0.0, 0.0],
            &[-1e308, 1e308],
            &[1e-320, 1.0],
            &[1.0, 1.0 + 1e-15],
            &[-3.0, -2.0],
        ];
        for axis in [Axis::linear("", ""), Axis::log("", "")] {
            for values in cases {
                let scale = Scale::new(&axis, values.iter().copied(), 0.05);
                assert!(scale.first < scale.last, "{values:?} {scale:?}");
                assert!((scale.last - scale.first).is_finite(), "{values:?} {scale:?}");
                let ticks = scale.ticks(6.0).ticks;
                assert!((1..200).contains(&ticks.len()), "{values:?} {scale:?} {ticks:?}");
                assert!(ticks.iter().all(|tick| (-0.01..1.01).contains(&scale.share(tick.at))));
            }
        }
    }
}
