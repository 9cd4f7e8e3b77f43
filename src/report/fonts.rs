//! The typeface of figures and pages: Inter (SIL Open Font License 1.1, see `assets/fonts`), cut
//! down to Latin, Greek, sub- and superscripts, arrows and mathematics.

/// Family name, as written in the font files.
pub(super) const FAMILY: &str = "Inter";
/// Regular weight.
pub(super) const REGULAR: &[u8] = include_bytes!("../../assets/fonts/Inter-Regular.ttf");
/// Semi-bold weight.
pub(super) const SEMI_BOLD: &[u8] = include_bytes!("../../assets/fonts/Inter-SemiBold.ttf");
