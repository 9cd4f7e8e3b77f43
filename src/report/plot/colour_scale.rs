//! Colour scale of a heat map.

use crate::report::figure::{Axis, AxisScale, ColorMap, HeatMap};
use crate::report::scale::Scale;

/// Room to the right of the plot for the colour bar and its labels \[px\].
pub(super) const BAR_ROOM: f64 = 82.0;

/// Label of the colour bar.
pub(super) fn label(map: &HeatMap) -> String {
    let axis = Axis::linear(map.label.clone(), map.unit.clone());
    scale(map).ticks(5.0).axis_label(&axis)
}

/// The values from one end of the colour scale to the other; diverging scales have zero in the middle.
pub(super) fn scale(map: &HeatMap) -> Scale {
    let axis = Axis { range: map.range, ..Axis::default() };
    let values = || map.values.iter().flatten().copied().filter(|v| v.is_finite());
    if map.colors == ColorMap::Sequential {
        return Scale::new(&axis, values(), 0.0);
    }
    let given = map.range.map(|(a, b)| a.abs().max(b.abs()));
    let largest = given.unwrap_or_else(|| values().fold(0.0, |most: f64, v| most.max(v.abs())));
    let largest = if largest.is_finite() && largest > 0.0 { largest.min(1e300) } else { 1.0 };
    Scale { kind: AxisScale::Linear, first: -largest, last: largest }
}
