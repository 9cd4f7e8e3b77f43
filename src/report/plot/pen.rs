//! Text: size, weight, colour and extent.

use std::sync::OnceLock;

use plotters::prelude::{RGBColor, TextStyle};
use plotters::style::{Color, FontFamily, FontStyle, FontTransform, register_font};

use crate::report::ReportError;
use crate::report::fonts::{FAMILY, REGULAR, SEMI_BOLD};
use crate::report::palette::{INK, MUTED, Rgb};

/// Opacity of bands.
pub(in crate::report) const BAND: f64 = 0.25;
/// Opacity of shaded ranges.
pub(in crate::report) const SHADE: f64 = 0.2;

/// Pixels between plot and tick labels.
pub(super) const GAP: f64 = 7.0;

/// plotters rounds coordinates to whole pixels; figures are drawn this much larger.
pub(super) const SUPERSAMPLING: f64 = 8.0;
/// plotters divides font sizes by this before it writes them.
const FONT_FACTOR: f64 = 1.24;

pub(super) const TITLE: Pen = Pen::new(17.0, INK).bold();
pub(super) const SUBTITLE: Pen = Pen::new(12.5, MUTED);
pub(super) const PANEL_TITLE: Pen = Pen::new(13.0, INK).bold();
pub(super) const AXIS_LABEL: Pen = Pen::new(12.0, INK);
pub(super) const TICK_LABEL: Pen = Pen::new(11.5, MUTED);
pub(super) const CATEGORY: Pen = Pen::new(12.0, INK);
pub(super) const LEGEND: Pen = Pen::new(12.0, INK);

/// Which end of a text is at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// Size \[px\], weight, colour and direction of a text.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pen {
    pub(super) size: f64,
    pub(super) bold: bool,
    pub(super) color: Rgb,
    pub(super) upright: bool,
}

impl Pen {
    pub(super) const fn new(size: f64, color: Rgb) -> Self {
        Self { size, bold: false, color, upright: false }
    }

    pub(super) const fn bold(mut self) -> Self {
        self.bold = true;
        self
    }

    pub(super) const fn with_color(mut self, color: Rgb) -> Self {
        self.color = color;
        self
    }

    /// Rotated, to be read from below.
    pub(super) const fn upright(mut self) -> Self {
        self.upright = true;
        self
    }

    /// Line spacing \[px\].
    pub(super) fn line_height(&self) -> f64 {
        1.3 * self.size
    }

    /// Distance from the middle of digits and capitals to the baseline \[px\].
    pub(super) fn half_capital(&self) -> f64 {
        0.36 * self.size
    }

    pub(super) fn style(&self) -> TextStyle<'static> {
        let weight = if self.bold { FontStyle::Bold } else { FontStyle::Normal };
        let size = self.size * SUPERSAMPLING * FONT_FACTOR;
        let font = (FontFamily::Name(FAMILY), size, weight);
        let mut style = TextStyle::from(font);
        style.color = rgb(self.color).to_backend_color();
        if self.upright { style.transform(FontTransform::Rotate270) } else { style }
    }

    /// Length of a text along its baseline \[px\].
    pub(super) fn width(&self, text: &str) -> f64 {
        let size = self.style().font.box_size(&printable(text));
        // without font metrics, half an em per letter is an estimate
        size.map_or(0.5 * self.size * text.chars().count() as f64, |(width, _)| {
            f64::from(width) / SUPERSAMPLING
        })
    }

    /// The text, shortened with "…" to this width.
    pub(super) fn shorten(&self, text: &str, width: f64) -> String {
        if self.width(text) <= width {
            return text.to_owned();
        }
        let letters: Vec<char> = text.chars().collect();
        let cut = |count: usize| {
            let kept: String = letters[..count].iter().collect();
            format!("{}…", kept.trim_end())
        };
        let (mut fits, mut too_long) = (0, letters.len());
        while too_long - fits > 1 {
            let middle = usize::midpoint(fits, too_long);
            if self.width(&cut(middle)) <= width { fits = middle } else { too_long = middle }
        }
        cut(fits)
    }

    /// The text, broken at spaces into lines of at most this width; longer words are shortened.
    pub(super) fn wrap(&self, text: &str, width: f64) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for word in text.split_whitespace() {
            match lines.last_mut() {
                Some(line) if self.width(&format!("{line} {word}")) <= width => {
                    line.push(' ');
                    line.push_str(word);
                }
                _ => lines.push(self.shorten(word, width)),
            }
        }
        lines
    }

    /// The text in at most `most` lines: broken if possible, otherwise shortened to one.
    pub(super) fn fit(&self, text: &str, width: f64, most: usize) -> Vec<String> {
        let lines = self.wrap(text, width);
        let whole = lines.iter().all(|line| !line.ends_with('…')) && lines.len() <= most;
        if whole { lines } else { vec![self.shorten(text, width)] }
    }
}

/// Registers the two font weights once per process; plotters keeps them in its own table.
pub(super) fn register_fonts() -> Result<(), ReportError> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let registered = *REGISTERED.get_or_init(|| {
        register_font(FAMILY, FontStyle::Normal, REGULAR).is_ok()
            && register_font(FAMILY, FontStyle::Bold, SEMI_BOLD).is_ok()
    });
    if registered { Ok(()) } else { Err(ReportError::Font { family: FAMILY }) }
}

/// Removes control characters, which XML does not allow.
pub(in crate::report) fn printable(text: &str) -> String {
    let forbidden = |c: char| c.is_control() || matches!(c, '\u{FFFE}' | '\u{FFFF}');
    text.chars().map(|c| if forbidden(c) { ' ' } else { c }).collect()
}

pub(super) fn rgb(color: Rgb) -> RGBColor {
    RGBColor(color.0, color.1, color.2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_measured_broken_and_shortened_to_its_room() {
        register_fonts().unwrap();
        let text = "Coulomb friction with a Stribeck curve";
        let whole = CATEGORY.width(text);
        // Inter's mean letter is a little over half an em
        assert!((0.4..0.7).contains(&(whole / CATEGORY.size / text.len() as f64)));
        for width in [10.0, 60.0, 120.0] {
            assert!(CATEGORY.width(&CATEGORY.shorten(text, width)) <= width.max(12.0));
            assert!(
                CATEGORY.wrap(text, width).iter().all(|l| CATEGORY.width(l) <= width.max(12.0))
            );
        }
        assert_eq!(CATEGORY.fit(text, whole + 1.0, 1), [text]);
        assert_eq!(CATEGORY.fit(text, 0.6 * whole, 2).len(), 2);
        assert!(CATEGORY.fit(text, 0.6 * whole, 1)[0].ends_with('…'));
    }
}
