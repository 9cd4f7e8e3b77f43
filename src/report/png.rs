//! PNG with a palette: a figure has few colours and shades, so one byte per pixel is sufficient and the file
//! is a third as large.

use std::collections::HashMap;

use png::{
    BitDepth, ColorType, DeflateCompression, Encoder, EncodingError, Filter, PixelDimensions, Unit,
};

/// Largest number of colours in a palette.
const COLORS: usize = 256;
/// Number of entries for the most frequent colours; the others are the colours farthest from all entries.
const FREQUENT: usize = 192;
/// Compression level: two thirds of the time of the default 6, with files 6 % larger.
const LEVEL: u8 = 4;

type Color = [u8; 3];

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
    // a drawing consists of long runs of one colour: each run is looked up once
    let (pixels, _) = rgba.as_chunks::<4>();
    let color = |[r, g, b, _]: [u8; 4]| [r, g, b];
    let runs: Vec<(Color, usize)> =
        pixels.chunk_by(|a, b| a == b).map(|run| (color(run[0]), run.len())).collect();
    let mut counts: HashMap<Color, usize> = HashMap::new();
    for (color, length) in &runs {
        *counts.entry(*color).or_default() += length;
    }
    let mut colors: Vec<Color> = counts.keys().copied().collect();
    // sorted by colour for equal counts, so that the same picture gives the same file
    colors.sort_by_key(|color| (std::cmp::Reverse(counts[color]), *color));
    let palette = palette(&colors);
    let places: HashMap<Color, u8> =
        colors.iter().map(|color| (*color, nearest(&palette, *color))).collect();
    let mut indices: Vec<u8> = Vec::with_capacity(pixels.len());
    for (color, length) in &runs {
        indices.resize(indices.len() + length, places[color]);
    }
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
    encoder.set_deflate_compression(DeflateCompression::Level(LEVEL));
    // neighbouring numbers of a palette are not neighbouring colours
    encoder.set_filter(Filter::NoFilter);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&indices)?;
    writer.finish()?;
    Ok(out)
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
