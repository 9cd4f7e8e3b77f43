//! PNG with a palette: a figure has few colours and shades, so one byte per pixel is sufficient and the file
//! is a third as large.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::io::Write;

use flate2::{Compression, write::ZlibEncoder};
use png::{BitDepth, ColorType, Encoder, EncodingError, PixelDimensions, Unit, chunk};

/// Largest number of colours in a palette.
const COLORS: usize = 256;
/// Number of entries for the most frequent colours; the others are the colours farthest from all entries.
const FREQUENT: usize = 192;
/// Compression level: two thirds of the time of the default 6, with files 6 % larger.
const LEVEL: u32 = 4;
/// Filter type of a line of pixels: none, since neighbouring numbers of a palette are not neighbouring colours.
const NO_FILTER: u8 = 0;

type Color = [u8; 3];
type ByColor<T> = HashMap<u32, T, BuildHasherDefault<Mixed>>;

/// Hash of a colour, which is one number: the default hash took a tenth of the time of a picture.
#[derive(Default)]
struct Mixed(u64);

impl Hasher for Mixed {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.write_u32(u32::from(*byte)));
    }

    fn write_u32(&mut self, number: u32) {
        self.0 = (self.0 ^ u64::from(number)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}

/// Encodes an opaque picture with a resolution [1/in], given as four bytes per pixel. Up to 256 colours are
/// kept exactly; with more, colours outside the palette are replaced by the nearest in it.
///
/// # Errors
/// If the encoder fails, as it does for a picture without pixels.
pub(super) fn indexed(
    width: u32,
    height: u32,
    dpi: f64,
    rgba: &[u8],
) -> Result<Vec<u8>, EncodingError> {
    let lines = lines(width, rgba);
    let mut counts: ByColor<usize> = HashMap::default();
    for line in &lines {
        for (color, length) in &line.runs {
            *counts.entry(*color).or_default() += length * line.count;
        }
    }
    let mut colors: Vec<(u32, usize)> = counts.into_iter().collect();
    // sorted by colour for equal counts, so that the same picture gives the same file
    colors.sort_unstable_by_key(|(color, count)| (std::cmp::Reverse(*count), *color));
    let colors: Vec<u32> = colors.into_iter().map(|(color, _)| color).collect();
    let palette = palette(&colors.iter().map(|color| parts(*color)).collect::<Vec<Color>>());
    let places: ByColor<u8> =
        colors.iter().map(|color| (*color, nearest(&palette, parts(*color)))).collect();
    let mut out = Vec::new();
    let mut encoder = Encoder::new(&mut out, width, height);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_palette(palette.concat());
    let per_metre = (dpi / 0.0254).round() as u32;
    encoder.set_pixel_dims(Some(PixelDimensions {
        xppu: per_metre,
        yppu: per_metre,
        unit: Unit::Meter,
    }));
    let mut writer = encoder.write_header()?;
    writer.write_chunk(chunk::IDAT, &compressed(&lines, &places, rgba.len() / 4 + lines.len())?)?;
    writer.finish()?;
    Ok(out)
}

/// Lines of pixels that follow each other and are equal.
struct Lines {
    /// Runs of one colour and their lengths.
    runs: Vec<(u32, usize)>,
    count: usize,
}

/// The lines of a picture: a drawing consists of long runs of one colour and of equal lines, each of which is looked
/// up once.
fn lines(width: u32, rgba: &[u8]) -> Vec<Lines> {
    let mut lines: Vec<Lines> = Vec::new();
    let mut before: &[u8] = &[];
    for line in rgba.chunks_exact(4 * (width as usize).max(1)) {
        match lines.last_mut() {
            Some(equal) if line == before => equal.count += 1,
            _ => {
                let runs = line.as_chunks::<4>().0.chunk_by(|a, b| a == b);
                let runs = runs.map(|run| (number(run[0]), run.len())).collect();
                lines.push(Lines { runs, count: 1 });
            }
        }
        before = line;
    }
    lines
}

/// An opaque colour as a number, of which the order is that of its parts.
fn number([r, g, b, _]: [u8; 4]) -> u32 {
    u32::from_be_bytes([0, r, g, b])
}

fn parts(color: u32) -> Color {
    let [_, r, g, b] = color.to_be_bytes();
    [r, g, b]
}

/// The compressed numbers in the palette, in one piece: the encoder's own method clears its output buffer for every
/// line, which took a tenth of the time of a run.
fn compressed(
    lines: &[Lines],
    places: &ByColor<u8>,
    size: usize,
) -> Result<Vec<u8>, EncodingError> {
    let mut indices: Vec<u8> = Vec::with_capacity(size);
    for line in lines {
        let first = indices.len();
        indices.push(NO_FILTER);
        for (color, length) in &line.runs {
            indices.resize(indices.len() + length, places[color]);
        }
        let end = indices.len();
        (1..line.count).for_each(|_| indices.extend_from_within(first..end));
    }
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(LEVEL));
    encoder.write_all(&indices)?;
    Ok(encoder.finish()?)
}

/// A palette for colours that are sorted by how frequent they are.
fn palette(colors: &[Color]) -> Vec<Color> {
    if colors.len() <= COLORS {
        return colors.to_vec();
    }
    let mut palette = colors[..FREQUENT].to_vec();
    let rest = &colors[FREQUENT..];
    let far = |color: &Color| palette.iter().map(|p| distance(*p, *color)).min().unwrap_or(0);
    let mut distances: Vec<u32> = rest.iter().map(far).collect();
    while palette.len() < COLORS {
        let farthest = (0..rest.len()).rev().max_by_key(|&i| distances[i]).unwrap_or(0);
        let taken = rest[farthest];
        palette.push(taken);
        for (d, color) in distances.iter_mut().zip(rest) {
            *d = (*d).min(distance(taken, *color));
        }
    }
    palette
}

fn nearest(palette: &[Color], color: Color) -> u8 {
    let place = (0..palette.len()).min_by_key(|&i| distance(palette[i], color));
    place.unwrap_or(0) as u8
}

fn distance(a: Color, b: Color) -> u32 {
    (0..3).map(|i| u32::from(a[i].abs_diff(b[i])).pow(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(png: &[u8]) -> Vec<Color> {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(png));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        bytes.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect()
    }

    fn picture(colors: &[Color]) -> Vec<u8> {
        colors.iter().flat_map(|c| [c[0], c[1], c[2], 255]).collect()
    }

    #[test]
    fn few_colours_come_back_as_they_are() {
        let colors: Vec<Color> = (0..=255).map(|i| [i, 255 - i, 7]).collect();
        let png = indexed(16, 16, 300.0, &picture(&colors)).unwrap();
        assert_eq!(decoded(&png), colors);
    }

    #[test]
    fn many_colours_come_back_nearly_and_a_rare_one_is_not_lost() {
        // a ramp of greys in 4096 shades of blue, and one red pixel
        let mut colors: Vec<Color> =
            (0..4096_u32).map(|i| [(i >> 4) as u8, (i >> 4) as u8, 16 * (i & 15) as u8]).collect();
        colors[77] = [255, 0, 0];
        let back = decoded(&indexed(64, 64, 300.0, &picture(&colors)).unwrap());
        assert_eq!(back[77], [255, 0, 0]);
        // 256 places for an area of 256 x 256 shades leave steps of about 16 in each direction
        let worst = back.iter().zip(&colors).map(|(a, b)| distance(*a, *b)).max().unwrap();
        assert!(worst < 40 * 40, "{worst}");
    }

    #[test]
    fn a_picture_without_pixels_is_refused() {
        assert!(indexed(0, 0, 300.0, &[]).is_err());
    }
}
