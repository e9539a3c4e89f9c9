//! Small PNG files: few colours, by index.

use std::io::BufWriter;
use std::path::Path;

use plotters::prelude::{BitMapBackend, IntoDrawingArea};

use super::{Figure, draw};

/// Levels of red, green and blue that are kept; what lies between is the smoothing of edges.
const LEVELS: u32 = 12;

/// Draws a figure and writes it.
pub(super) fn write(path: &Path, figure: &Figure) -> Result<(), String> {
    let (width, height) = figure.size;
    let mut pixels = vec![0; 3 * width as usize * height as usize];
    draw::figure(&BitMapBackend::with_buffer(&mut pixels, figure.size).into_drawing_area(), figure)?;
    let (palette, indices) = reduce(&pixels);
    let file = std::fs::File::create(path).map_err(|error| error.to_string())?;
    let mut encoder = ::png::Encoder::new(BufWriter::new(file), width, height);
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_compression(::png::Compression::High);
    let data = if palette.len() <= 3 * 256 {
        encoder.set_color(::png::ColorType::Indexed);
        encoder.set_filter(::png::Filter::NoFilter);
        encoder.set_palette(palette);
        indices
    } else {
        encoder.set_color(::png::ColorType::Rgb);
        pixels
    };
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&data));
    written.map_err(|error| error.to_string())
}

/// The colours of a picture, rounded, and the index of each pixel's; of no use with more than 256 colours.
fn reduce(pixels: &[u8]) -> (Vec<u8>, Vec<u8>) {
    let step = |level: u32| (level * 255 / (LEVELS - 1)) as u8;
    let mut known: Vec<[u8; 3]> = Vec::new();
    let mut index_of = vec![usize::MAX; (LEVELS * LEVELS * LEVELS) as usize];
    let indices = (pixels.as_chunks::<3>().0.iter())
        .map(|pixel| {
            let levels = pixel.map(|value| (u32::from(value) * (LEVELS - 1) + 127) / 255);
            let key = (levels[0] * LEVELS + levels[1]) * LEVELS + levels[2];
            let index = &mut index_of[key as usize];
            if *index == usize::MAX {
                *index = known.len();
                known.push(levels.map(step));
            }
            *index as u8
        })
        .collect();
    (known.concat(), indices)
}
