//! Layers over names instead of numbers: bars and heat maps.

use super::ColourRole;

/// Bars over categories from top to bottom, so that long names fit; one bar per series and category.
#[derive(Clone, Debug, PartialEq)]
pub struct Bars {
    /// Names of the categories, first at the top.
    pub categories: Vec<String>,
    /// The series side by side within a category.
    pub series: Vec<BarSeries>,
    /// The category drawn in the highlight colour.
    pub highlight: Option<usize>,
}

/// One value per category.
#[derive(Clone, Debug, PartialEq)]
pub struct BarSeries {
    /// Legend entry.
    pub label: String,
    /// Meaning, hence colour.
    pub role: ColourRole,
    /// One value per category; missing ones are left out.
    pub values: Vec<f64>,
    /// Whiskers (lower, upper) per category; empty for none.
    pub intervals: Vec<(f64, f64)>,
    /// Text at the end of each bar; empty for none.
    pub text: Vec<String>,
}

impl BarSeries {
    /// A series without whiskers and text.
    pub fn new(label: impl Into<String>, role: ColourRole, values: Vec<f64>) -> Self {
        Self { label: label.into(), role, values, intervals: Vec::new(), text: Vec::new() }
    }
}

/// A table of coloured cells.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatMap {
    /// Row names, top to bottom.
    pub rows: Vec<String>,
    /// Column names, left to right.
    pub columns: Vec<String>,
    /// `values[row][column]`; NaN or missing: an empty cell.
    pub values: Vec<Vec<f64>>,
    /// Text in the cells, same shape; empty for none.
    pub text: Vec<Vec<String>>,
    /// Which colours.
    pub colors: ColorMap,
    /// Quantity shown by the colour.
    pub label: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// Values at the two ends of the colour bar; `None`: from the data.
    pub range: Option<(f64, f64)>,
}

/// The two kinds of colour map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ColorMap {
    /// Blue, white, red about zero: signed values.
    Diverging,
    /// Pale to dark: magnitudes.
    #[default]
    Sequential,
}
