//! A figure as plain data, independent of its rendering.

mod categories;

pub use super::palette::ColourRole;
pub use categories::{BarSeries, Bars, ColorMap, HeatMap};

/// One picture: a heading and panels, drawn to SVG, PNG or a page.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// File stem and anchor; characters other than letters, digits, `-` and `_` are replaced.
    pub id: String,
    /// Message of the figure in one line.
    pub title: String,
    /// Smaller grey line under the title: conditions, sample size.
    pub subtitle: String,
    /// Text under the figure on the page.
    pub caption: String,
    /// Reading aid for this kind of figure; collapsed on the page.
    pub how_to_read: String,
    /// The panels, row by row.
    pub panels: Vec<Panel>,
    /// Number of panels side by side; the others are placed below. Zero counts as one.
    pub columns: usize,
    /// All panels have the same x range, and only the lowest of a column has tick labels.
    pub shared_x: bool,
    /// Whether the page allows zooming (panels with numeric axes only; bars and heat maps are static).
    pub interactive: bool,
    /// Figures with the same link zoom together and share the cursor; empty: none.
    pub link: String,
    /// Width and height; the height may be left to the panels.
    pub size: Size,
}

/// Default width \[px\].
pub const WIDTH: f64 = 820.0;

/// Size of a figure in CSS pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Width \[px\].
    pub width: f64,
    /// Height \[px\]; `None`: determined by the panels.
    pub height: Option<f64>,
}

impl Default for Size {
    fn default() -> Self {
        Self { width: WIDTH, height: None }
    }
}

impl Figure {
    /// A figure without panels, one column, x shared between the panels.
    pub fn new(id: impl Into<String>, title: impl Into<String>) -> Self {
        Self {
            id: id.into(),
            title: title.into(),
            subtitle: String::new(),
            caption: String::new(),
            how_to_read: String::new(),
            panels: Vec::new(),
            columns: 1,
            shared_x: true,
            interactive: false,
            link: String::new(),
            size: Size::default(),
        }
    }

    /// Sets the line under the title.
    pub fn with_subtitle(mut self, text: impl Into<String>) -> Self {
        self.subtitle = text.into();
        self
    }

    /// Sets the text under the figure.
    pub fn with_caption(mut self, text: impl Into<String>) -> Self {
        self.caption = text.into();
        self
    }

    /// Sets the reading aid.
    pub fn with_how_to_read(mut self, text: impl Into<String>) -> Self {
        self.how_to_read = text.into();
        self
    }

    /// Adds a panel.
    pub fn with_panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// Sets the number of panels side by side; their x axes are then independent.
    pub fn with_columns(mut self, columns: usize) -> Self {
        self.columns = columns;
        self.shared_x = false;
        self
    }

    /// Lets the reader zoom on the page.
    pub fn interactive(mut self) -> Self {
        self.interactive = true;
        self
    }

    /// Zooms together with all figures linked by the same name.
    pub fn linked(mut self, name: impl Into<String>) -> Self {
        self.link = name.into();
        self.interactive()
    }

    /// Sets the height \[px\].
    pub fn with_height(mut self, height: f64) -> Self {
        self.size.height = Some(height);
        self
    }

    /// The id with everything but ASCII letters, digits, `-` and `_` replaced by `-`.
    pub fn file_stem(&self) -> String {
        let keep = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' };
        let stem: String = self.id.chars().map(keep).collect();
        let stem = stem.trim_matches('-');
        if stem.is_empty() { "figure".to_owned() } else { stem.to_owned() }
    }

    /// Description for readers who cannot see the figure.
    pub fn description(&self) -> String {
        let mut parts = vec![self.subtitle.as_str(), self.caption.as_str()];
        parts.retain(|part| !part.is_empty());
        parts.join(". ")
    }

    /// Whether zooming is requested and every panel has numeric axes.
    pub fn is_interactive(&self) -> bool {
        let numeric = |layer: &Layer| !matches!(layer, Layer::Bars(_) | Layer::HeatMap(_));
        self.interactive && self.panels.iter().all(|panel| panel.layers.iter().all(numeric))
    }
}

/// One pair of axes and its layers.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Heading of the panel; empty for none.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Layers in the order of drawing, shades and bands first.
    pub layers: Vec<Layer>,
    /// Equal scales in x and y (maps); the range of one axis is widened accordingly.
    pub equal_units: bool,
}

impl Panel {
    /// A panel without layers.
    pub fn new(x: Axis, y: Axis) -> Self {
        Self { title: String::new(), x, y, layers: Vec::new(), equal_units: false }
    }

    /// Sets the heading.
    pub fn with_title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// Uses equal scales in x and y.
    pub fn with_equal_units(mut self) -> Self {
        self.equal_units = true;
        self
    }

    /// Adds a layer.
    pub fn with(mut self, layer: Layer) -> Self {
        self.layers.push(layer);
        self
    }
}

/// Label, unit, scale and range of an axis.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Axis {
    /// What is shown.
    pub label: String,
    /// Its unit, without brackets; empty for none.
    pub unit: String,
    /// Linear or logarithmic.
    pub scale: AxisScale,
    /// First and last value; `None`: from the data.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), ..Self::default() }
    }

    /// A logarithmic axis; values that are not positive are omitted.
    pub fn log(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { scale: AxisScale::Log, ..Self::linear(label, unit) }
    }

    /// An axis of categories, or one without a label.
    pub fn unlabelled() -> Self {
        Self::default()
    }

    /// Fixes the range.
    pub fn with_range(mut self, first: f64, last: f64) -> Self {
        self.range = Some((first, last));
        self
    }
}

/// Mapping of values to positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum AxisScale {
    /// Equal steps for equal differences.
    #[default]
    Linear,
    /// Equal steps for equal ratios.
    Log,
}

/// How a line is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Dash {
    /// Unbroken.
    #[default]
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
}

/// One layer of a panel. Labels appear in the legend unless they are empty. Non-finite values interrupt a
/// line and omit a point.
#[derive(Clone, Debug, PartialEq)]
pub enum Layer {
    /// A polyline.
    Line {
        /// Corners (x, y).
        points: Vec<(f64, f64)>,
        /// Legend entry.
        label: String,
        /// Meaning, which determines the colour.
        role: ColourRole,
        /// Stroke width \[px\].
        width: f64,
        /// Dash pattern.
        dash: Dash,
    },
    /// Dots.
    Points {
        /// Centres (x, y).
        points: Vec<(f64, f64)>,
        /// Legend entry.
        label: String,
        /// Meaning, hence colour.
        role: ColourRole,
        /// Radius \[px\].
        radius: f64,
        /// Opacity, 0 to 1.
        alpha: f64,
    },
    /// The area between two curves over the same x.
    Band {
        /// Places.
        x: Vec<f64>,
        /// Lower edge.
        lower: Vec<f64>,
        /// Upper edge.
        upper: Vec<f64>,
        /// Legend entry.
        label: String,
        /// Meaning, hence colour.
        role: ColourRole,
    },
    /// Bars over categories.
    Bars(Bars),
    /// Coloured cells.
    HeatMap(HeatMap),
    /// A horizontal reference line.
    HLine {
        /// Value on the y axis.
        at: f64,
        /// Legend entry.
        label: String,
        /// Meaning, hence colour.
        role: ColourRole,
        /// Dash pattern.
        dash: Dash,
    },
    /// A vertical reference line.
    VLine {
        /// Value on the x axis.
        at: f64,
        /// Legend entry.
        label: String,
        /// Meaning, hence colour.
        role: ColourRole,
        /// Dash pattern.
        dash: Dash,
    },
    /// Ranges of x with a pale background: regimes.
    Shade {
        /// Ranges (from, to).
        ranges: Vec<(f64, f64)>,
        /// Legend entry.
        label: String,
        /// Meaning, hence colour.
        role: ColourRole,
    },
    /// Values with whiskers; an infinite whisker runs to the edge.
    ErrorBars {
        /// The values.
        points: Vec<ErrorBar>,
        /// Legend entry.
        label: String,
        /// Meaning, hence colour.
        role: ColourRole,
    },
}

impl Layer {
    /// A solid line, 1.8 px.
    pub fn line(points: Vec<(f64, f64)>, label: impl Into<String>, role: ColourRole) -> Self {
        Self::Line { points, label: label.into(), role, width: 1.8, dash: Dash::Solid }
    }

    /// Dots of 1.6 px radius, 45 % opaque: overlapping measurements darken.
    pub fn points(points: Vec<(f64, f64)>, label: impl Into<String>, role: ColourRole) -> Self {
        Self::Points { points, label: label.into(), role, radius: 1.6, alpha: 0.45 }
    }

    /// A dashed horizontal reference line.
    pub fn hline(at: f64, label: impl Into<String>, role: ColourRole) -> Self {
        Self::HLine { at, label: label.into(), role, dash: Dash::Dashed }
    }

    /// Removes it from the legend.
    pub fn unlabel(&mut self) {
        match self {
            Self::Line { label, .. }
            | Self::Points { label, .. }
            | Self::Band { label, .. }
            | Self::HLine { label, .. }
            | Self::VLine { label, .. }
            | Self::Shade { label, .. }
            | Self::ErrorBars { label, .. } => label.clear(),
            Self::Bars(_) | Self::HeatMap(_) => {}
        }
    }

    /// Order of drawing: shades lowest, bands above them.
    pub(super) fn height(&self) -> u8 {
        match self {
            Self::Shade { .. } | Self::HeatMap(_) => 0,
            Self::Band { .. } => 1,
            _ => 2,
        }
    }

    /// A dashed vertical reference line.
    pub fn vline(at: f64, label: impl Into<String>, role: ColourRole) -> Self {
        Self::VLine { at, label: label.into(), role, dash: Dash::Dashed }
    }
}

/// A value with an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorBar {
    /// Place.
    pub x: f64,
    /// Value.
    pub y: f64,
    /// Lower end of the whisker.
    pub lower: f64,
    /// Upper end of the whisker.
    pub upper: f64,
}
