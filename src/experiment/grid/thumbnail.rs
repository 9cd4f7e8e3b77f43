//! Thumbnail of a grid, for a list of experiments.

use super::competitors::Competitor;
use super::curves::MOST_SERIES;
use crate::report::figure::{Axis, ColourRole, Figure, Layer, Panel, Size};
use crate::report::{ReportError, figure_to_png};

/// Largest number of dots per alternative: more would overlap at this size.
const MOST_DOTS: usize = 120;

/// Ratio of error to noise floor for the runs of every alternative, as PNG; `None` without runs.
///
/// # Errors
/// If the figure cannot be drawn.
pub(super) fn thumbnail(competitors: &[Competitor]) -> Result<Option<Vec<u8>>, ReportError> {
    if competitors.is_empty() {
        return Ok(None);
    }
    let panel = Panel::new(Axis::linear("run", ""), Axis::linear("error over floor", ""))
        .with(Layer::hline(1.0, "", ColourRole::NoiseFloor));
    let dots = competitors.iter().take(MOST_SERIES).enumerate().map(|(n, one)| dots(one, n));
    let mut figure = Figure::new("thumbnail", "").with_panel(dots.fold(panel, Panel::with));
    figure.size = Size { width: 240.0, height: Some(130.0) };
    figure_to_png(&figure).map(Some)
}

fn dots(competitor: &Competitor, n: usize) -> Layer {
    let every = competitor.runs.len().div_ceil(MOST_DOTS);
    let points = competitor.runs.iter().step_by(every);
    let points = points.map(|run| (run.cell as f64 + 1.0, run.error / run.floor));
    Layer::Points {
        points: points.filter(|(_, ratio)| ratio.is_finite()).collect(),
        label: String::new(),
        role: ColourRole::Series(n),
        radius: 2.0,
        alpha: 0.8,
    }
}
