//! Study to blocks to HTML and PNG.
//!
//! A section returns [`block::Block`]s; [`page()`] turns sections into one self-contained HTML file,
//! [`figure_to_png`] and [`figure_to_svg`] turn a [`figure::Figure`] into a picture. Everything here
//! is a pure function to strings and bytes: writing files is another module's work.

pub mod block;
mod dead_time;
mod error;
pub mod figure;
mod fonts;
pub mod format;
pub mod page;
pub mod palette;
mod plot;
mod png;
mod polyline;
mod raster;
mod render;
mod results;
mod scale;
pub mod section;
mod sign_of_speed;
mod verdict;
pub mod what_if;
mod words;

pub(crate) use dead_time::is_determined;
pub use dead_time::{dead_time, dead_time_advice, no_dead_time};
pub(crate) use dead_time::{dead_time_name, dead_time_with};
pub use error::ReportError;
pub use page::{Page, PageContent, Picture, SectionContent, page, render_page};
pub use raster::{figure_to_png, figure_to_svg};
pub use render::{Rendered, render, thumbnail};
pub use results::{SCHEMA, results};
pub use section::Section;
pub use sign_of_speed::sign_of_speed;
pub(crate) use verdict::title;
pub use verdict::{evidence, not_determined, recommendation, sentence};
pub use words::simulation_error;
