//! Lines, unbroken or in dashes.

use super::canvas::Canvas;
use crate::report::ReportError;
use crate::report::figure::Dash;
use crate::report::palette::Rgb;
use crate::report::polyline::{Point, dashes};

/// A line, unbroken or in dashes.
pub(super) fn stroke(
    canvas: &Canvas<'_>,
    line: &[Point],
    color: Rgb,
    width: f64,
    dash: Dash,
) -> Result<(), ReportError> {
    let pattern = match dash {
        Dash::Solid => return canvas.line(line, color, width, 1.0),
        Dash::Dashed => (3.5 * width, 2.5 * width),
        Dash::Dotted => (width, 1.6 * width),
    };
    dashes(line, pattern).iter().try_for_each(|part| canvas.line(part, color, width, 1.0))
}
