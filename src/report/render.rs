//! A study as a page and pictures.

use rayon::prelude::*;

use super::ReportError;
use super::block::Block;
use super::figure_to_svg;
use super::page::{PageContent, SectionContent, render_page};
use super::{format, section};
use crate::study::Study;

/// A rendered report.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The page.
    pub html: String,
    /// File name and PNG of every figure, in the order of the page.
    pub figures: Vec<(String, Vec<u8>)>,
    /// File name and SVG of every figure, in the same order.
    pub drawings: Vec<(String, Vec<u8>)>,
}

/// Draws a study: every registered section that has something to show, in order.
///
/// # Errors
/// If a figure cannot be drawn.
pub fn render(study: &Study) -> Result<Rendered, ReportError> {
    let content = PageContent {
        title: study.title.clone(),
        subtitle: subtitle(study),
        sections: sections(study),
        footer: format!("{} {}", env!("CARGO_PKG_NAME"), study.version),
    };
    let page = render_page(&content)?;
    let figures: Vec<_> = content
        .sections
        .iter()
        .flat_map(|section| &section.blocks)
        .filter_map(|block| if let Block::Figure(figure) = block { Some(figure) } else { None })
        .collect();
    let drawings = figures
        .par_iter()
        .zip(&page.pictures)
        .map(|(figure, picture)| {
            let svg = figure_to_svg(figure)?;
            Ok((format!("{}.svg", picture.file_stem), svg.into_bytes()))
        })
        .collect::<Result<_, ReportError>>()?;
    let figures =
        page.pictures.into_iter().map(|p| (format!("{}.png", p.file_stem), p.png)).collect();
    Ok(Rendered { html: page.html, figures, drawings })
}

fn sections(study: &Study) -> Vec<SectionContent> {
    section::all()
        .par_iter()
        .map(|section| {
            let mut blocks = section.blocks(study);
            if !blocks.is_empty() {
                // a verdict stands first, before any aid to read it
                let is_verdict = |block: &Block| matches!(block, Block::Verdict { .. });
                let place = blocks.iter().take_while(|block| is_verdict(block)).count();
                blocks.insert(place, Block::HowToRead(section.how_to_read().to_owned()));
            }
            SectionContent {
                id: section.id().to_owned(),
                title: section.title().to_owned(),
                blocks,
            }
        })
        .filter(|section| !section.blocks.is_empty())
        .collect()
}

fn subtitle(study: &Study) -> String {
    let seconds: f64 = study.recordings.iter().map(|r| r.duration_s).sum();
    let recordings = match study.recordings.len() {
        1 => "1 recording".to_owned(),
        many => format!("{many} recordings"),
    };
    format!(
        "{} · {} · {recordings}, {} s in all · {} {} · seed {}",
        study.experiment,
        study.robot,
        format::significant(seconds, 3),
        env!("CARGO_PKG_NAME"),
        study.version,
        study.seed
    )
}
