//! Renders a study as a page and figures.

use rayon::prelude::*;

use super::ReportError;
use super::block::Block;
use super::page::{PageContent, Picture, SectionContent, render_page};
use super::raster::figure_to_png;
use super::{format, section};
use crate::study::Study;

/// A rendered report.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The page.
    pub html: String,
    /// File name and bytes of every figure as PNG and as SVG, in the order of the page.
    pub figures: Vec<(String, Vec<u8>)>,
}

/// Renders a study: every registered section with content, in order.
///
/// # Errors
/// If a figure cannot be drawn.
pub fn render(study: &Study) -> Result<Rendered, ReportError> {
    let content = PageContent {
        title: study.title.clone(),
        subtitle: subtitle(study),
        sections: sections(study),
        versions: versions(study),
        footer: format!("{} {}", env!("CARGO_PKG_NAME"), study.version),
    };
    let page = render_page(&content)?;
    let figures = page.pictures.into_iter().flat_map(Picture::files).collect();
    Ok(Rendered { html: page.html, figures })
}

fn sections(study: &Study) -> Vec<SectionContent> {
    section::all()
        .par_iter()
        .map(|section| {
            let mut blocks = section.blocks(study);
            if !blocks.is_empty() {
                // nothing precedes the finding and its figure
                let is_summary = section.depth() == section::Depth::Summary;
                let place = if is_summary { blocks.len() } else { 0 };
                let aid = section.how_to_read().to_owned();
                let guide = section.title().to_owned();
                blocks.insert(place, Block::HowToRead { aid, guide });
            }
            SectionContent {
                id: section.id().to_owned(),
                title: section.title().to_owned(),
                blocks,
                folded: section.depth() == section::Depth::Details,
            }
        })
        .filter(|section| !section.blocks.is_empty())
        .collect()
}

/// Measured and simulated speeds as a small PNG without legend; `None` without a fit.
///
/// # Errors
/// If the figure cannot be drawn.
pub fn thumbnail(study: &Study) -> Result<Option<Vec<u8>>, ReportError> {
    section::thumbnail(study).map(|figure| figure_to_png(&figure)).transpose()
}

/// Names of the two models whose curves the reader can show or hide.
fn versions(study: &Study) -> Vec<String> {
    match study.completed {
        Some(_) => vec!["the model as given".to_owned(), "with what was found".to_owned()],
        None => vec![],
    }
}

fn subtitle(study: &Study) -> String {
    let seconds: f64 = study.recordings.iter().map(|r| r.duration_s).sum();
    let recordings = match study.recordings.len() {
        1 => "1 recording".to_owned(),
        many => format!("{many} recordings"),
    };
    let recordings = format!("{recordings}, {} s in all", format::significant(seconds, 3));
    let program = format!("{} {}", env!("CARGO_PKG_NAME"), study.version);
    let mut parts = vec![study.experiment.clone(), study.robot.clone(), recordings, program];
    let is_synthetic = study.recordings.iter().all(|r| r.sha256.is_none());
    // a name without information: unknown, or the default with measured data of another machine
    let is_named = is_synthetic || study.robot_is_given;
    parts.retain(|part| part != "unknown" && (is_named || *part != study.robot));
    // a seed that was not used
    if is_synthetic {
        parts.push(format!("seed {}", study.seed));
    }
    parts.join(" · ")
}
