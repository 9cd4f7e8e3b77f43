/// Why a figure or a page could not be made.
///
/// Missing, infinite and absurd data are no errors: they are left out of the picture.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The drawing library refused.
    #[error("figure `{figure}`: drawing failed: {cause}")]
    Draw {
        /// Id of the figure.
        figure: String,
        /// What the library said.
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
    /// The drawing is no valid SVG.
    #[error("figure `{figure}`: the drawing could not be read back")]
    Svg {
        /// Id of the figure.
        figure: String,
        /// What the reader said.
        source: resvg::usvg::Error,
    },
    /// The picture could not be made from the drawing.
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
        /// What the writer said.
        source: serde_json::Error,
    },
}
