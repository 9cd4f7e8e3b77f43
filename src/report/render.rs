//! A study as a page and pictures.

use super::ReportError;
use super::block::Block;
use super::page::{PageContent, SectionContent, render_page};
use crate::study::Study;

/// A rendered report.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The page.
    pub html: String,
    /// File name and PNG of every figure.
    pub figures: Vec<(String, Vec<u8>)>,
}

/// Draws a study.
///
/// # Errors
/// If a figure cannot be drawn.
pub fn render(study: &Study) -> Result<Rendered, ReportError> {
    let page = render_page(&PageContent {
        title: study.title.clone(),
        subtitle: study.experiment.clone(),
        sections: vec![SectionContent {
            id: "file".into(),
            title: "File".into(),
            blocks: vec![Block::Code(study.file.clone())],
        }],
        footer: study.version.clone(),
    })?;
    let figures =
        page.pictures.into_iter().map(|p| (format!("{}.png", p.file_stem), p.png)).collect();
    Ok(Rendered { html: page.html, figures })
}
