//! From the drawing to what a reader opens: SVG without fonts to miss, and PNG.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree, WriteOptions, fontdb::Database};

use super::ReportError;
use super::figure::Figure;
use super::fonts::{REGULAR, SEMI_BOLD};
use super::plot::{Purpose, draw};
use super::png::indexed;

/// Pixels of a PNG per CSS pixel.
const RESOLUTION: f32 = 2.0;

/// Draws a figure as SVG in which all text is paths, so that it looks the same everywhere.
///
/// # Errors
/// [`ReportError`] if a library refuses; missing, infinite or absurd values are no errors.
pub fn figure_to_svg(figure: &Figure) -> Result<String, ReportError> {
    Ok(svg(&tree(figure)?))
}

/// Draws a figure as PNG, two pixels per CSS pixel.
///
/// # Errors
/// [`ReportError`] if a library refuses or the picture is too large for the memory; missing,
/// infinite or absurd values are no errors.
pub fn figure_to_png(figure: &Figure) -> Result<Vec<u8>, ReportError> {
    png(figure, &tree(figure)?)
}

/// Both from one drawing.
pub(super) fn figure_to_both(figure: &Figure) -> Result<(Vec<u8>, String), ReportError> {
    let tree = tree(figure)?;
    Ok((png(figure, &tree)?, svg(&tree)))
}

fn svg(tree: &Tree) -> String {
    let options = WriteOptions {
        preserve_text: false,
        coordinates_precision: 2,
        transforms_precision: 6,
        ..WriteOptions::default()
    };
    tree.to_string(&options)
}

fn png(figure: &Figure, tree: &Tree) -> Result<Vec<u8>, ReportError> {
    let size = tree.size();
    let (width, height) =
        ((size.width() * RESOLUTION).ceil() as u32, (size.height() * RESOLUTION).ceil() as u32);
    let failed =
        |cause: String| ReportError::Raster { figure: figure.id.clone(), width, height, cause };
    let mut pixmap = Pixmap::new(width, height).ok_or_else(|| failed("too large".to_owned()))?;
    pixmap.fill(Color::WHITE);
    let transform = Transform::from_scale(RESOLUTION, RESOLUTION);
    resvg::render(tree, transform, &mut pixmap.as_mut());
    indexed(width, height, pixmap.data()).map_err(|e| failed(e.to_string()))
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
