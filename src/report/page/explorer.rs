//! The explorer: recordings one at a time, with the robot on its path.

use maud::{Markup, PreEscaped, html};
use serde::Serialize;

use super::column::Column;
use super::data::{self, FigureData};
use crate::report::ReportError;
use crate::report::block::{Block, Track};

/// Resolution of the path in fractions of a second, a metre and a radian: a millimetre is less than a pixel.
const PATH_STEPS: f64 = 1e3;

#[derive(Serialize)]
struct TrackData<'a> {
    note: &'a str,
    figure: FigureData<'a>,
    /// Time, x, y and heading, one column each.
    path: [Column; 4],
}

impl<'a> TrackData<'a> {
    fn of(track: &'a Track) -> Self {
        let rounded = |v: f64| (v * PATH_STEPS).round() / PATH_STEPS;
        let column = |i: usize| Column(track.path.iter().map(|row| rounded(row[i])).collect());
        let path = std::array::from_fn(column);
        Self { note: &track.note, figure: data::of(&track.figure), path }
    }
}

/// The data of every explorer among blocks, in the order of the page.
///
/// # Errors
/// If data cannot be written as JSON.
pub(super) fn all<'a>(blocks: impl Iterator<Item = &'a Block>) -> Result<Vec<String>, ReportError> {
    let tracks = blocks.filter_map(|block| match block {
        Block::Explorer(tracks) => Some(tracks),
        _ => None,
    });
    tracks.map(|tracks| json(tracks)).collect()
}

fn json(tracks: &[Track]) -> Result<String, ReportError> {
    data::json(&tracks.iter().map(TrackData::of).collect::<Vec<_>>(), "explorer")
}

/// Empty elements that are filled by the script; without scripts there is no explorer.
pub(super) fn markup(tracks: &[Track], json: &str) -> Markup {
    html! {
        div.explorer hidden {
            p.tools {
                label {
                    "Recording "
                    select { @for track in tracks { option { (track.name) } } }
                }
                span.errors aria-live="polite" {}
            }
            div.replay {
                canvas role="img" aria-label="The robot on its path" {}
                p.tools {
                    button.reset type="button" { "Play" }
                    input type="range" min="0" value="0" step="1" aria-label="Time";
                    output {}
                }
            }
            figure { div.plot {} }
            script type="application/json" { (PreEscaped(json)) }
        }
    }
}
