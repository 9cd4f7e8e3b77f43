//! The elements of which sections of the report consist. All text is plain: the page escapes it.

use super::figure::Figure;
use super::format;
use super::what_if::WhatIf;

/// One element of a section.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// A heading within the section.
    Heading(String),
    /// Running text.
    Paragraph(Text),
    /// A finding in one sentence, with its basis.
    Verdict {
        /// Good, doubtful or bad.
        tone: Tone,
        /// The finding.
        sentence: String,
        /// Further findings; may be empty.
        rest: String,
        /// Basis of the finding; may be empty.
        detail: Text,
    },
    /// Key numbers, side by side.
    Numbers(Vec<Number>),
    /// Columns with units, rows of texts and numbers.
    Table(Table),
    /// A figure, interactive on the page if its data allow.
    Figure(Box<Figure>),
    /// Blocks that are collapsed until the reader opens them; not printed.
    Folded {
        /// Title of the collapsed blocks.
        title: String,
        /// The collapsed blocks.
        blocks: Vec<Block>,
    },
    /// A reading aid, collapsed.
    HowToRead {
        /// The aid, in a sentence.
        aid: String,
        /// The heading of the guide whose text follows; empty for none.
        guide: String,
    },
    /// List items, one per line.
    List(Vec<Text>),
    /// Verbatim text: commands, configuration.
    Code(String),
    /// Recordings to explore, one at a time; not printed.
    Explorer(Vec<Track>),
    /// The same recordings simulated with other values of the parameters; not printed.
    WhatIf(Box<WhatIf>),
}

/// A recording of a [`Block::Explorer`].
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Its name in the list.
    pub name: String,
    /// Remark below the list; empty for none.
    pub note: String,
    /// Signals over time; panels and layers are the same in all tracks.
    pub figure: Figure,
    /// Position of the robot: time \[s\], x \[m\], y \[m\], heading \[rad\]; empty if unknown.
    pub path: Vec<[f64; 4]>,
}

impl Block {
    /// A paragraph of plain text.
    pub fn paragraph(text: impl Into<Text>) -> Self {
        Self::Paragraph(text.into())
    }

    /// A finding.
    pub fn verdict(tone: Tone, sentence: impl Into<String>, detail: impl Into<Text>) -> Self {
        Self::findings(tone, [sentence.into()], detail)
    }

    /// Findings, the most important first.
    pub fn findings(
        tone: Tone,
        sentences: impl IntoIterator<Item = String>,
        detail: impl Into<Text>,
    ) -> Self {
        let mut sentences = sentences.into_iter();
        let sentence = sentences.next().unwrap_or_default();
        let rest = sentences.collect::<Vec<_>>().join(" ");
        Self::Verdict { tone, sentence, rest, detail: detail.into() }
    }

    /// The figures in it, in the order of the page.
    #[must_use]
    pub fn figures(&self) -> Vec<&Figure> {
        match self {
            Self::Figure(figure) => vec![figure],
            Self::Folded { blocks, .. } => blocks.iter().flat_map(Self::figures).collect(),
            _ => vec![],
        }
    }

    /// Collapsed blocks.
    pub fn folded(title: impl Into<String>, blocks: Vec<Self>) -> Self {
        Self::Folded { title: title.into(), blocks }
    }
}

impl From<Figure> for Block {
    fn from(figure: Figure) -> Self {
        Self::Figure(Box::new(figure))
    }
}

impl From<Table> for Block {
    fn from(table: Table) -> Self {
        Self::Table(table)
    }
}

/// One of the [`Block::Numbers`].
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Number {
    /// What it is.
    pub label: String,
    /// The number or word.
    pub value: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// A remark below it.
    pub note: String,
    /// Colour by meaning.
    pub tone: Tone,
}

/// Severity of a finding; the page shows a colour and a word, never the colour alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Tone {
    /// As expected.
    Good,
    /// Neither good nor bad.
    #[default]
    Neutral,
    /// Needs attention before it is relied on.
    Notice,
    /// Something is wrong.
    Bad,
}

/// Running text with optional emphasis.
///
/// ```
/// use amigo_ident::report::block::Text;
/// let text = Text::from("Indistinguishable: ").strong("a4").plain(" and ").strong("a5");
/// assert_eq!(text.0.len(), 4);
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Text(pub Vec<Span>);

/// A piece of running text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Span {
    /// As it is.
    Plain(String),
    /// Emphasised.
    Strong(String),
    /// Text to be typed: a key, a command, a file name.
    Code(String),
}

impl Text {
    /// Adds plain text.
    pub fn plain(mut self, text: impl Into<String>) -> Self {
        self.0.push(Span::Plain(text.into()));
        self
    }

    /// Adds emphasised text.
    pub fn strong(mut self, text: impl Into<String>) -> Self {
        self.0.push(Span::Strong(text.into()));
        self
    }

    /// Adds text to be typed.
    pub fn code(mut self, text: impl Into<String>) -> Self {
        self.0.push(Span::Code(text.into()));
        self
    }
}

impl From<&str> for Text {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl From<String> for Text {
    fn from(text: String) -> Self {
        if text.is_empty() { Self::default() } else { Self::default().plain(text) }
    }
}

/// A table with a caption. The reader can sort it by any column.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Table {
    /// What the table shows.
    pub caption: String,
    /// Headings with units, and alignment.
    pub columns: Vec<Column>,
    /// The rows; missing cells are empty, surplus cells are ignored.
    pub rows: Vec<Vec<Cell>>,
    /// Number of columns in addition to the first that together name a row.
    pub further_heads: usize,
}

impl Table {
    /// A table without rows.
    pub fn new(caption: impl Into<String>, columns: Vec<Column>) -> Self {
        Self { caption: caption.into(), columns, ..Self::default() }
    }

    /// Names a row by its first `heads` columns.
    #[must_use]
    pub fn with_heads(mut self, heads: usize) -> Self {
        self.further_heads = heads.saturating_sub(1);
        self
    }

    /// Adds a row.
    pub fn push(&mut self, row: Vec<Cell>) {
        self.rows.push(row);
    }
}

/// One column of a table.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Column {
    /// Heading.
    pub title: String,
    /// Unit, without brackets; empty for none.
    pub unit: String,
    /// Text to the left, numbers to the right.
    pub align: Align,
}

impl Column {
    /// A column of text.
    pub fn text(title: impl Into<String>) -> Self {
        Self { title: title.into(), ..Self::default() }
    }

    /// A column of numbers; `unit` may be empty.
    pub fn number(title: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { title: title.into(), unit: unit.into(), align: Align::Right }
    }
}

/// Side to which a column is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Align {
    /// Text.
    #[default]
    Left,
    /// Numbers.
    Right,
}

/// One cell of a table.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Cell {
    /// What is shown.
    pub text: String,
    /// Sort key; `None`: the text.
    pub sort_by: Option<f64>,
    /// A second, smaller line; empty for none.
    pub note: String,
    /// Stressed.
    pub strong: bool,
    /// Colour by meaning.
    pub tone: Option<Tone>,
    /// Length of a bar behind the text, 0 to 1.
    pub bar: Option<f64>,
    /// Link target, relative to the page.
    pub link: Option<String>,
    /// A picture (PNG) in place of text.
    pub picture: Option<Vec<u8>>,
    /// Text to be typed or copied; long ones are broken anywhere.
    pub code: bool,
}

impl Cell {
    /// A cell of text.
    pub fn text(text: impl Into<String>) -> Self {
        Self { text: text.into(), ..Self::default() }
    }

    /// With a second, smaller line.
    #[must_use]
    pub fn noted(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    /// A number with four significant digits.
    pub fn number(value: f64) -> Self {
        Self { text: format::number(value), sort_by: Some(value), ..Self::default() }
    }

    /// A whole number.
    pub fn count(value: usize) -> Self {
        Self { text: format::count(value), sort_by: Some(value as f64), ..Self::default() }
    }

    /// A value with its standard error, rounded according to the error.
    pub fn estimate(value: f64, std_error: f64) -> Self {
        let text = format::estimate(value, std_error);
        // what cannot be identified is sorted with the missing values
        let sort_by = if std_error.is_infinite() { f64::NAN } else { value };
        Self { text, sort_by: Some(sort_by), ..Self::default() }
    }

    /// A p-value without its "p =".
    pub fn p_value(p: f64) -> Self {
        let text = format::p_value(p);
        let text = text.trim_start_matches("p ").trim_start_matches("= ").to_owned();
        Self { text, sort_by: Some(p), ..Self::default() }
    }

    /// A number in a format of the caller, sorted by its value.
    pub fn formatted(text: impl Into<String>, value: f64) -> Self {
        Self { text: text.into(), sort_by: Some(value), ..Self::default() }
    }

    /// Links to an address relative to the page.
    pub fn link(mut self, address: impl Into<String>) -> Self {
        self.link = Some(address.into());
        self
    }

    /// Marks the text as to be typed or copied.
    pub fn code(mut self) -> Self {
        self.code = true;
        self
    }

    /// Emphasises the cell.
    pub fn strong(mut self) -> Self {
        self.strong = true;
        self
    }

    /// Colours the cell by meaning.
    pub fn tone(mut self, tone: Tone) -> Self {
        self.tone = Some(tone);
        self
    }

    /// Adds a bar behind the text; the length is clamped to 0 to 1, NaN gives none.
    pub fn bar(mut self, length: f64) -> Self {
        self.bar = (!length.is_nan()).then(|| length.clamp(0.0, 1.0));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_write_numbers_by_the_one_formatter() {
        assert_eq!(Cell::estimate(0.1234, 0.01).text, "0.123 ± 0.010");
        assert_eq!(Cell::number(f64::NAN).text, "–");
        assert_eq!(Cell::p_value(1e-12).text, "< 10⁻⁹");
        assert_eq!(Cell::p_value(0.25).text, "0.25");
        assert_eq!(Cell::number(1.0).bar(7.0).bar, Some(1.0));
        assert_eq!(Cell::number(1.0).bar(f64::NAN).bar, None);
    }

    #[test]
    fn a_figure_id_becomes_a_safe_file_stem() {
        assert_eq!(Figure::new("../a b/ω.png", "").file_stem(), "a-b---png");
        assert_eq!(Figure::new("", "").file_stem(), "figure");
    }
}
