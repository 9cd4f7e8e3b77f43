//! A study as a page and pictures.

use super::ReportError;
use super::block::Block;
use super::page::{PageContent, SectionContent, render_page};
use super::section;
use crate::study::Study;

/// A rendered report.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The page.
    pub html: String,
    /// File name and PNG of every figure.
    pub figures: Vec<(String, Vec<u8>)>,
}

/// Draws a study: every registered section that has something to say.
///
/// # Errors
/// If a figure cannot be drawn.
pub fn render(study: &Study) -> Result<Rendered, ReportError> {
    let sections = section::all()
        .iter()
        .filter_map(|s| {
            let mut blocks = s.blocks(study);
            if blocks.is_empty() {
                return None;
            }
            if !s.how_to_read().is_empty() {
                blocks.push(Block::HowToRead(s.how_to_read().into()));
            }
            Some(SectionContent { id: s.id().into(), title: s.title().into(), blocks })
        })
        .collect();
    let effects = if study.effects.is_empty() {
        "base model".to_string()
    } else {
        format!("base model + {}", study.effects.join(" + "))
    };
    let page = render_page(&PageContent {
        title: study.title.clone(),
        subtitle: format!("{}: {effects}, {} recordings", study.robot, study.recordings.len()),
        sections,
        footer: format!("{} {}", env!("CARGO_PKG_NAME"), study.version),
    })?;
    let figures =
        page.pictures.into_iter().map(|p| (format!("{}.png", p.file_stem), p.png)).collect();
    Ok(Rendered { html: page.html, figures })
}
