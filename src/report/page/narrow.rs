//! Figures for two screen widths: the size of the text is fixed, so phones get a separate drawing.

use crate::report::ReportError;
use crate::report::figure::{Figure, Size};
use crate::report::plot::{Purpose, draw};
use crate::report::raster::described;

/// Width of a drawing on a phone: a screen of 390 px minus the margins of the page \[px\].
const NARROW: f64 = 358.0;

/// The drawing for wide and the one for narrow screens.
///
/// # Errors
/// [`ReportError`] if a figure cannot be drawn.
pub(super) fn both(figure: &Figure) -> Result<[String; 2], ReportError> {
    let inline = |figure: &Figure| Ok(described(&draw(figure, Purpose::Inline)?, figure));
    Ok([inline(figure)?, inline(&narrowed(figure))?])
}

/// The figure with its panels below each other, at the width of a phone; a given height is reduced in
/// proportion, so that a map fits.
fn narrowed(figure: &Figure) -> Figure {
    let width = figure.size.width.min(NARROW);
    let shrunk = |height: f64| height * width / figure.size.width;
    let size = Size { width, height: figure.size.height.map(shrunk) };
    Figure { columns: 1, size, ..figure.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figure::{Axis, ColourRole, Layer, Panel};

    #[test]
    fn a_phone_gets_its_panels_below_each_other_at_the_size_of_text_that_others_have() {
        let line = Layer::line(vec![(0.0, 0.0), (1.0, 2.0)], "y", ColourRole::Model);
        let panel = || Panel::new(Axis::linear("x", ""), Axis::linear("y", "")).with(line.clone());
        let mut figure =
            Figure::new("two", "Two").with_panel(panel()).with_panel(panel()).with_columns(2);
        figure.size = Size { width: 716.0, height: Some(400.0) };
        let narrow = narrowed(&figure);
        assert_eq!(
            (narrow.columns, narrow.size.width, narrow.size.height),
            (1, 358.0, Some(200.0))
        );
        let [wide, narrow] = both(&figure).unwrap();
        assert!(wide.contains("width=\"716\"") && narrow.contains("width=\"358\""));
    }
}
