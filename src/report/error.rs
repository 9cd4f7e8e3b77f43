/// Why a figure or a page could not be created.
///
/// Missing, infinite and extreme data are not errors: they are omitted from the figure.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// Error of the drawing library.
    #[error("figure `{figure}`: drawing failed: {cause}")]
    Draw {
        /// Id of the figure.
        figure: String,
        /// Message of the library.
        cause: String,
    },
    /// An embedded font could not be read.
    #[error(
        "the embedded font `{family}` could not be read; the program was built from a damaged copy of `assets/fonts`"
    )]
    Font {
        /// Family name.
        family: &'static str,
    },
    /// The drawing is not valid SVG.
    #[error("figure `{figure}`: the drawing could not be read back")]
    Svg {
        /// Id of the figure.
        figure: String,
        /// Error of the SVG reader.
        source: resvg::usvg::Error,
    },
    /// The picture could not be rendered from the drawing.
    #[error(
        "figure `{figure}`: no picture of {width} x {height} pixels could be made: {cause}; choose a smaller size"
    )]
    Raster {
        /// Id of the figure.
        figure: String,
        /// Width \[px\].
        width: u32,
        /// Height \[px\].
        height: u32,
        /// What failed.
        cause: String,
    },
    /// The data of an interactive figure could not be written.
    #[error("figure `{figure}`: its data could not be written to the page")]
    Data {
        /// Id of the figure.
        figure: String,
        /// Error of the JSON writer.
        source: serde_json::Error,
    },
}
