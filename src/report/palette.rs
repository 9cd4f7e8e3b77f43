//! The palette of all figures and pages: the colour-blind-safe colours of Okabe and Ito.
//!
//! Source: M. Okabe, K. Ito, "Color Universal Design", 2008 (the eight colours); the diverging map
//! follows ColorBrewer's RdBu, the sequential one its Blues (C. Brewer, 2003).

/// An opaque colour, 8 bits a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rgb(pub u8, pub u8, pub u8);

impl Rgb {
    /// The colour as `#RRGGBB`, upper case as the SVG writer prints it.
    pub fn hex(self) -> String {
        format!("#{:02X}{:02X}{:02X}", self.0, self.1, self.2)
    }

    /// Relative luminance between 0 (black) and 1 (white). Source: WCAG 2.1, relative luminance.
    pub fn luminance(self) -> f64 {
        let channel = |byte: u8| {
            let c = f64::from(byte) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * channel(self.0) + 0.7152 * channel(self.1) + 0.0722 * channel(self.2)
    }

    fn mix(self, other: Self, share: f64) -> Self {
        let channel =
            |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * share).round() as u8;
        Self(channel(self.0, other.0), channel(self.1, other.1), channel(self.2, other.2))
    }
}

/// Text and important marks.
pub const INK: Rgb = Rgb(0x1B, 0x20, 0x27);
/// Subtitles, tick labels, legends.
pub const MUTED: Rgb = Rgb(0x5A, 0x64, 0x72);
/// Axis lines and tick marks.
pub const AXIS: Rgb = Rgb(0x9A, 0xA3, 0xAF);
/// Grid lines.
pub const GRID: Rgb = Rgb(0xE4, 0xE7, 0xEB);
/// The paper.
pub const SURFACE: Rgb = Rgb(0xFF, 0xFF, 0xFF);
/// Dark text on a heat-map cell; different from [`INK`], which a dark page inverts.
pub const CELL_DARK: Rgb = Rgb(0x0B, 0x0E, 0x13);
/// Light text on a heat-map cell; different from [`SURFACE`], which a dark page inverts.
pub const CELL_LIGHT: Rgb = Rgb(0xFF, 0xFF, 0xFE);
/// A cell without a value.
pub const CELL_EMPTY: Rgb = Rgb(0xD9, 0xDD, 0xE3);

const BLUE: Rgb = Rgb(0x00, 0x72, 0xB2);
const VERMILION: Rgb = Rgb(0xD5, 0x5E, 0x00);
const GREEN: Rgb = Rgb(0x00, 0x9E, 0x73);
const PURPLE: Rgb = Rgb(0xCC, 0x79, 0xA7);
const ORANGE: Rgb = Rgb(0xE6, 0x9F, 0x00);
const SKY: Rgb = Rgb(0x56, 0xB4, 0xE9);
const GREY: Rgb = Rgb(0x8A, 0x92, 0x9E);

/// Light colours and their dark-mode partners, exchanged by the stylesheet of the page.
pub const DARK_PARTNERS: [(Rgb, Rgb); 12] = [
    (INK, Rgb(0xE8, 0xEB, 0xF0)),
    (MUTED, Rgb(0xA3, 0xAD, 0xBB)),
    (AXIS, Rgb(0x6B, 0x75, 0x83)),
    (GRID, Rgb(0x2C, 0x33, 0x3D)),
    (SURFACE, Rgb(0x16, 0x1A, 0x20)),
    (BLUE, Rgb(0x4E, 0xA8, 0xE6)),
    (VERMILION, Rgb(0xF4, 0x77, 0x2E)),
    (GREEN, Rgb(0x2F, 0xC0, 0x95)),
    (PURPLE, Rgb(0xE0, 0x9A, 0xC3)),
    (ORANGE, Rgb(0xF2, 0xB5, 0x2C)),
    (SKY, Rgb(0x7F, 0xCB, 0xF5)),
    (GREY, Rgb(0x93, 0x9C, 0xA9)),
];

/// Meaning of a mark; the palette assigns one colour to each meaning in all figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColourRole {
    /// A measured signal.
    Measured,
    /// The model; with the effects found, if the model as given is shown too.
    Model,
    /// The model as given, if shown together with the one with the effects found.
    Given,
    /// Wheel 1, the right one.
    Wheel1,
    /// Wheel 2, the left one.
    Wheel2,
    /// Level of the noise floor.
    NoiseFloor,
    /// The most important item.
    Highlight,
    /// Black ink: references and remarks.
    Ink,
    /// The n-th of several equivalent series.
    Series(usize),
}

impl ColourRole {
    /// The colour on white paper.
    pub fn color(self) -> Rgb {
        const SERIES: [Rgb; 7] = [BLUE, ORANGE, GREEN, VERMILION, PURPLE, SKY, MUTED];
        match self {
            Self::Measured => BLUE,
            Self::Model => VERMILION,
            Self::Given => INK,
            Self::Wheel1 => GREEN,
            Self::Wheel2 => PURPLE,
            Self::NoiseFloor => GREY,
            Self::Highlight => ORANGE,
            Self::Ink => INK,
            Self::Series(n) => SERIES[n % SERIES.len()],
        }
    }

    /// The name of the CSS variable that holds this colour on the page (it follows dark mode).
    pub fn css_variable(self) -> String {
        css_variable(self.color())
    }
}

/// The name of the CSS variable of a palette colour, e.g. `--c-0072b2`.
pub fn css_variable(color: Rgb) -> String {
    format!("--c-{:02x}{:02x}{:02x}", color.0, color.1, color.2)
}

/// Blue (−1) through white (0) to red (+1); the argument is clamped, NaN gives [`CELL_EMPTY`].
pub fn diverging(value: f64) -> Rgb {
    const STOPS: [Rgb; 7] = [
        Rgb(0x21, 0x66, 0xAC),
        Rgb(0x67, 0xA9, 0xCF),
        Rgb(0xD1, 0xE5, 0xF0),
        Rgb(0xF7, 0xF7, 0xF7),
        Rgb(0xFD, 0xDB, 0xC7),
        Rgb(0xEF, 0x8A, 0x62),
        Rgb(0xB2, 0x18, 0x2B),
    ];
    interpolate(&STOPS, (value + 1.0) / 2.0)
}

/// Near-white (0) to dark blue (1); the argument is clamped, NaN gives [`CELL_EMPTY`].
pub fn sequential(value: f64) -> Rgb {
    const STOPS: [Rgb; 6] = [
        Rgb(0xF3, 0xF8, 0xFD),
        Rgb(0xC6, 0xDB, 0xEF),
        Rgb(0x9E, 0xCA, 0xE1),
        Rgb(0x5B, 0xA3, 0xD0),
        Rgb(0x21, 0x71, 0xB5),
        Rgb(0x08, 0x30, 0x6B),
    ];
    interpolate(&STOPS, value)
}

fn interpolate(stops: &[Rgb], share: f64) -> Rgb {
    if share.is_nan() {
        return CELL_EMPTY;
    }
    let position = share.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
    let below = (position.floor() as usize).min(stops.len() - 2);
    stops[below].mix(stops[below + 1], position - below as f64)
}

/// The text colour that is legible on a cell of this colour.
pub fn text_on(cell: Rgb) -> Rgb {
    // where contrast against white equals contrast against the dark text (luminance 0.0044):
    // sqrt(1.05 * (0.0044 + 0.05)) - 0.05
    if cell.luminance() > 0.189 { CELL_DARK } else { CELL_LIGHT }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contrast(a: Rgb, b: Rgb) -> f64 {
        let (a, b) = (a.luminance(), b.luminance());
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn text_is_legible_on_both_pages() {
        // WCAG 2.1 AA asks 4.5 for text
        let dark = |color| DARK_PARTNERS.iter().find(|(light, _)| *light == color).unwrap().1;
        for color in [INK, MUTED] {
            assert!(contrast(color, SURFACE) > 4.5);
            assert!(contrast(dark(color), dark(SURFACE)) > 4.5);
        }
    }

    #[test]
    fn text_is_legible_on_every_cell_of_both_maps() {
        for step in 0..=100 {
            let share = f64::from(step) / 100.0;
            for cell in [diverging(2.0 * share - 1.0), sequential(share)] {
                // 4.3: where both texts do equally well, contrast is 1.05 / 0.239 = 4.39
                assert!(contrast(cell, text_on(cell)) > 4.3, "{cell:?}");
            }
        }
    }

    #[test]
    fn every_role_has_a_dark_partner_and_marks_stand_out_on_it() {
        let dark_paper = DARK_PARTNERS[4].1;
        let roles = [
            ColourRole::Measured,
            ColourRole::Model,
            ColourRole::Wheel1,
            ColourRole::Wheel2,
            ColourRole::NoiseFloor,
        ];
        for role in
            roles.into_iter().chain((0..9).map(ColourRole::Series)).chain([ColourRole::Highlight])
        {
            let partner = DARK_PARTNERS.iter().find(|(light, _)| *light == role.color());
            // WCAG 2.1 asks 3 for graphical objects
            assert!(contrast(partner.unwrap().1, dark_paper) > 3.0, "{role:?}");
        }
    }

    #[test]
    fn colour_maps_end_at_their_ends_and_mark_missing_values() {
        assert_eq!(diverging(0.0), Rgb(0xF7, 0xF7, 0xF7));
        assert_eq!(diverging(-5.0), diverging(-1.0));
        assert_eq!(sequential(f64::INFINITY), Rgb(0x08, 0x30, 0x6B));
        assert_eq!(sequential(f64::NAN), CELL_EMPTY);
    }
}
