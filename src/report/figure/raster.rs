//! A picture behind a chart: a heat map with its colour bar, or a cloud of points too many for SVG.

use base64::Engine as _;
use sha2::{Digest, Sha256};

/// Pixels with the rectangle they cover.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    /// Row by row from the top: RGBA of a heat map, points per pixel of a cloud.
    pub pixels: Vec<u8>,
    /// Numbers of columns and rows.
    pub shape: (u32, u32),
    /// x from, x to in axis units.
    pub x: (f64, f64),
    /// y from (bottom), y to (top) in axis units.
    pub y: (f64, f64),
    /// Colour bar: label, low, high. Absent for clouds.
    pub bar: Option<(String, f64, f64)>,
    /// Meaning of the pixels, for the colour bar.
    pub shown: Shown,
}

/// The numbers behind a picture.
#[derive(Debug, Clone, PartialEq)]
pub enum Shown {
    /// A value a cell, rows from the bottom up.
    Cells(Vec<f64>),
    /// The points of a cloud.
    Points(Vec<(f64, f64)>),
}

impl Raster {
    /// A heat map of `values` (rows from the bottom up, `columns` each), coloured between `limits`;
    /// NaN stays clear.
    pub fn heat_map(
        values: &[f64],
        columns: usize,
        x: (f64, f64),
        y: (f64, f64),
        limits: (f64, f64),
        label: &str,
    ) -> Self {
        let columns = columns.max(1);
        let rows = values.len() / columns;
        let mut pixels = Vec::with_capacity(rows * columns * 4);
        for row in (0..rows).rev() {
            for value in &values[row * columns..(row + 1) * columns] {
                pixels.extend(colour((value - limits.0) / (limits.1 - limits.0)));
            }
        }
        let bar = Some((label.to_owned(), limits.0, limits.1));
        Self { pixels, shape: (columns as u32, rows as u32), x, y, bar, shown: Shown::Cells(values.to_vec()) }
    }

    /// A cloud: each pixel stronger the more points fall on it.
    pub fn cloud(points: impl Iterator<Item = (f64, f64)>, shape: (u32, u32), x: (f64, f64), y: (f64, f64)) -> Self {
        let mut counts = vec![0u8; (shape.0 * shape.1) as usize];
        let points: Vec<(f64, f64)> = points.collect();
        for (px, py) in &points {
            let column = ((px - x.0) / (x.1 - x.0) * f64::from(shape.0)).floor();
            let row = ((y.1 - py) / (y.1 - y.0) * f64::from(shape.1)).floor();
            if column >= 0.0 && row >= 0.0 && column < f64::from(shape.0) && row < f64::from(shape.1) {
                let count = &mut counts[row as usize * shape.0 as usize + column as usize];
                *count = count.saturating_add(1);
            }
        }
        Self { pixels: counts, shape, x, y, bar: None, shown: Shown::Points(points) }
    }

    /// A heat map as a PNG data URI.
    pub(super) fn data_uri(&self) -> String {
        uri(&self.pixels, self.shape, (png::ColorType::Rgba, png::BitDepth::Eight))
    }

    /// A cloud as a stencil, white where points are: a name of its own for it, and a PNG data URI
    /// of two bits a pixel.
    pub(super) fn stencil(&self) -> (String, String) {
        let columns = self.shape.0.max(1) as usize;
        let pack =
            |four: &[u8]| (0..4).fold(0, |byte, k| byte << 2 | four.get(k).map_or(0, |n| 2.min(*n) + u8::from(*n > 0)));
        let bytes: Vec<u8> = self.pixels.chunks(columns).flat_map(|row| row.chunks(4).map(pack)).collect();
        let uri = uri(&bytes, self.shape, (png::ColorType::Grayscale, png::BitDepth::Two));
        let digest = Sha256::digest(uri.as_bytes());
        (digest[..6].iter().fold("cloud-".to_owned(), |name, byte| name + &format!("{byte:02x}")), uri)
    }
}

/// Pixels as a PNG data URI.
fn uri(pixels: &[u8], shape: (u32, u32), (colours, depth): (png::ColorType, png::BitDepth)) -> String {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, shape.0.max(1), shape.1.max(1));
    encoder.set_color(colours);
    encoder.set_depth(depth);
    encoder.set_compression(png::Compression::High);
    // Writing into memory cannot fail for pixels of the right length; a mismatch gives an empty
    // picture.
    let written = encoder.write_header().and_then(|mut w| w.write_image_data(pixels));
    if written.is_err() {
        bytes.clear();
    }
    format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(&bytes))
}

/// The ramp from its high end to its low one, one pixel wide.
pub(super) fn ramp_uri() -> String {
    let pixels: Vec<u8> = (0..128).rev().flat_map(|k| colour(f64::from(k) / 127.0)).collect();
    uri(&pixels, (1, 128), (png::ColorType::Rgba, png::BitDepth::Eight))
}

/// A perceptually even ramp from dark blue over green to yellow (control points of viridis), 0 to
/// 1; NaN is clear.
fn colour(fraction: f64) -> [u8; 4] {
    const RAMP: [[f64; 3]; 6] =
        [[68., 1., 84.], [65., 68., 135.], [42., 120., 142.], [34., 168., 132.], [122., 209., 81.], [253., 231., 37.]];
    if fraction.is_nan() {
        return [0; 4];
    }
    let position = fraction.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let index = (position as usize).min(RAMP.len() - 2);
    let weight = position - index as f64;
    let channel = |c: usize| (RAMP[index][c] * (1.0 - weight) + RAMP[index + 1][c] * weight).round() as u8;
    [channel(0), channel(1), channel(2), 255]
}
