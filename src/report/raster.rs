//! Output formats of a drawing: SVG without fonts, and PNG.

use std::cell::RefCell;
use std::sync::{Arc, LazyLock};

use maud::html;
use resvg::tiny_skia::{PixmapMut, Transform};
use resvg::usvg::{Options, Tree, WriteOptions, fontdb::Database};

use super::ReportError;
use super::figure::Figure;
use super::fonts::{REGULAR, SEMI_BOLD};
use super::plot::{Purpose, draw, printable};
use super::png::indexed;

/// Resolution of a PNG as required by journals for line art with shades [1/in].
const DPI: f64 = 300.0;
/// Text width of a page, two columns of a journal, which a figure of the default width fills [in]: its text
/// is then 7.5 points high.
const TEXT_WIDTH_IN: f64 = 7.16;
/// CSS pixels to an inch of paper.
const PIXELS_PER_IN: f64 = super::figure::WIDTH / TEXT_WIDTH_IN;
/// Pixels of a PNG per CSS pixel.
const RESOLUTION: f32 = (DPI / PIXELS_PER_IN) as f32;

/// Largest size of a picture: 2 GB.
const LARGEST: usize = i32::MAX as usize;

thread_local! {
    /// The picture buffer: new memory pages for each figure took a tenth of the time of a run.
    static SHEET: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Draws a figure as SVG with all text converted to paths, so that it does not depend on installed fonts; its
/// size on paper is that of the PNG, and title and caption are included as text for screen readers.
///
/// # Errors
/// [`ReportError`] if a library fails; missing, infinite or extreme values are not errors.
pub fn figure_to_svg(figure: &Figure) -> Result<String, ReportError> {
    Ok(svg(figure, &tree(figure)?))
}

/// Draws a figure as PNG of 300 dpi; one of the default width fills the text width of a page.
///
/// # Errors
/// [`ReportError`] if a library fails or the picture is too large for the memory; missing,
/// infinite or extreme values are not errors.
pub fn figure_to_png(figure: &Figure) -> Result<Vec<u8>, ReportError> {
    png(figure, &tree(figure)?)
}

/// Both from one drawing.
pub(super) fn figure_to_both(figure: &Figure) -> Result<(Vec<u8>, String), ReportError> {
    let tree = tree(figure)?;
    Ok((png(figure, &tree)?, svg(figure, &tree)))
}

fn svg(figure: &Figure, tree: &Tree) -> String {
    let options = WriteOptions {
        preserve_text: false,
        coordinates_precision: 2,
        transforms_precision: 6,
        ..WriteOptions::default()
    };
    let (width, height) = (f64::from(tree.size().width()), f64::from(tree.size().height()));
    let inches = |pixels: f64| format!("{:.4}in", pixels / PIXELS_PER_IN);
    let drawn = format!("width=\"{width}\" height=\"{height}\"");
    let paper = format!(
        "width=\"{}\" height=\"{}\" viewBox=\"0 0 {width} {height}\"",
        inches(width),
        inches(height)
    );
    described(&tree.to_string(&options).replacen(&drawn, &paper, 1), figure)
}

/// A drawing with a description for screen readers.
pub(super) fn described(svg: &str, figure: &Figure) -> String {
    let Some((head, rest)) = svg.split_once("<svg ") else { return svg.to_owned() };
    let Some((attributes, drawing)) = rest.split_once('>') else { return svg.to_owned() };
    let words = html! {
        title { (printable(&figure.title)) }
        desc { (printable(&figure.description())) }
    };
    format!("{head}<svg role=\"img\" {attributes}>{}{drawing}", words.into_string())
}

fn png(figure: &Figure, tree: &Tree) -> Result<Vec<u8>, ReportError> {
    let size = tree.size();
    let (width, height) =
        ((size.width() * RESOLUTION).ceil() as u32, (size.height() * RESOLUTION).ceil() as u32);
    let failed =
        |cause: String| ReportError::Raster { figure: figure.id.clone(), width, height, cause };
    let too_large = || failed("too large".to_owned());
    let pixels = u64::from(width) * u64::from(height);
    let bytes = usize::try_from(4 * pixels).ok().filter(|bytes| *bytes <= LARGEST);
    let bytes = bytes.ok_or_else(too_large)?;
    SHEET.with_borrow_mut(|sheet| {
        sheet.clear();
        sheet.resize(bytes, u8::MAX);
        let mut pixmap = PixmapMut::from_bytes(sheet, width, height).ok_or_else(too_large)?;
        let transform = Transform::from_scale(RESOLUTION, RESOLUTION);
        resvg::render(tree, transform, &mut pixmap);
        indexed(width, height, DPI, sheet).map_err(|e| failed(e.to_string()))
    })
}

fn tree(figure: &Figure) -> Result<Tree, ReportError> {
    static FONTS: LazyLock<Arc<Database>> = LazyLock::new(|| {
        let mut fonts = Database::new();
        fonts.load_font_data(REGULAR.to_vec());
        fonts.load_font_data(SEMI_BOLD.to_vec());
        Arc::new(fonts)
    });
    let svg = draw(figure, Purpose::Standalone)?;
    let options = Options { fontdb: Arc::clone(&FONTS), ..Options::default() };
    Tree::from_str(&svg, &options)
        .map_err(|source| ReportError::Svg { figure: figure.id.clone(), source })
}

#[cfg(test)]
mod tests;
