//! Names of categories below a plot.

use super::pen::{CATEGORY, GAP};

/// Longest vertical name below a plot \[px\].
const UPRIGHT: f64 = 150.0;
/// Names up to this length are never rotated \[px\].
const SHORT: f64 = 44.0;

/// Layout of names below a plot: broken into lines if they fit, otherwise vertical, and only every n-th if
/// space is insufficient.
pub(super) struct NamesBelow {
    /// Lines of each name.
    pub(super) names: Vec<Vec<String>>,
    pub(super) upright: bool,
    /// Every n-th name is drawn.
    pub(super) stride: usize,
    /// Space below the plot \[px\].
    pub(super) height: f64,
}

/// The layout of `names` below a plot of this width \[px\].
pub(super) fn names_below(names: &[String], width: f64) -> NamesBelow {
    let slot = width / names.len().max(1) as f64;
    let room = slot - 8.0;
    let whole = |name: &String| {
        let lines = CATEGORY.wrap(name, room);
        lines.len() <= 3 && lines.iter().all(|line| !line.ends_with('…'))
    };
    if names.iter().all(whole) {
        let names: Vec<_> = names.iter().map(|name| CATEGORY.wrap(name, room)).collect();
        let most = names.iter().map(Vec::len).max().unwrap_or(0) as f64;
        let height = GAP + most * CATEGORY.line_height();
        return NamesBelow { names, upright: false, stride: 1, height };
    }
    let widest = names.iter().map(|name| CATEGORY.width(name)).fold(0.0, f64::max);
    if widest <= SHORT {
        // short names, such as numbers: omit some instead of rotating them
        let names: Vec<_> = names.iter().map(|name| vec![name.clone()]).collect();
        let stride = ((widest + 8.0) / slot).ceil().max(1.0) as usize;
        let height = GAP + CATEGORY.line_height();
        return NamesBelow { names, upright: false, stride, height };
    }
    let shortened: Vec<_> =
        names.iter().map(|name| vec![CATEGORY.shorten(name, UPRIGHT)]).collect();
    let longest = shortened.iter().map(|name| CATEGORY.width(&name[0])).fold(0.0, f64::max);
    let stride = (CATEGORY.line_height() / slot).ceil().max(1.0) as usize;
    NamesBelow { names: shortened, upright: true, stride, height: GAP + longest + 2.0 }
}
