//! Results drawn over a picture, and as CSV and SVG.

use super::camera::Camera;
use super::centreline::Strand;
use super::marker::MarkerErrors;
use super::mask::Mask;
use super::order::StrandCrossing;
use super::passage::{segment, segments};
use super::pixels::between;
use super::sheet::Sheet;
use super::trace::Trace;
use super::{Point, VisionError};
use image::{GrayImage, ImageBuffer, ImageFormat, PixelWithColorType, Rgb, RgbImage};
use std::fmt::Write;
use std::io::Cursor;

/// Colours of strands, in turn.
const COLOURS: [[u8; 3]; 8] = [
    [255, 214, 10],
    [64, 196, 255],
    [255, 92, 138],
    [124, 252, 120],
    [255, 150, 60],
    [190, 150, 255],
    [60, 240, 220],
    [245, 245, 245],
];

/// Colour in which a strand is drawn.
pub fn strand_colour(strand: usize) -> [u8; 3] {
    COLOURS[strand % COLOURS.len()]
}

/// The picture, dimmed, with the centrelines of its strands. At a crossing, the lower strand is
/// interrupted. A disc marks the first point of a strand, a ring its last point.
pub fn overlay(picture: &RgbImage, trace: &Trace) -> RgbImage {
    let mut canvas = Canvas::over(picture);
    let stroke = canvas.stroke;
    for number in 0..trace.strands.len() {
        canvas.strand(trace, number);
    }
    for (point, _, width) in &trace.rejected {
        canvas.ring(*point, width.max(4.0 * stroke), [255, 60, 60]);
    }
    canvas.image
}

/// The picture, dimmed, with the pixels of a mask in red, to show why nothing was found.
pub fn mask_overlay(picture: &RgbImage, mask: &Mask) -> RgbImage {
    let mut image = Canvas::over(picture).image;
    for (column, row, pixel) in image.enumerate_pixels_mut() {
        if mask.contains(column as usize, row as usize) {
            *pixel = Rgb([255, pixel[1] / 2, pixel[2] / 2]);
        }
    }
    image
}

/// The picture, dimmed, with the edges of a sheet; a disc marks its first corner.
pub fn sheet_overlay(picture: &RgbImage, sheet: &Sheet) -> RgbImage {
    let mut canvas = Canvas::over(picture);
    let corners = sheet.corner_pixels;
    for edge in 0..4 {
        let ends = [corners[edge], corners[(edge + 1) % 4]];
        canvas.line(ends, strand_colour(edge));
    }
    canvas.disc(corners[0], 2.2 * canvas.stroke, strand_colour(0));
    canvas.image
}

/// The picture, dimmed, with straight edges between given pixels.
pub fn edges_overlay(picture: &RgbImage, edges: &[[Point; 2]]) -> RgbImage {
    let mut canvas = Canvas::over(picture);
    for (number, ends) in edges.iter().enumerate() {
        canvas.line(*ends, strand_colour(number));
    }
    canvas.image
}

/// The picture, dimmed, with rings around detected spots, discs at expected markers, and a line
/// from each expected marker to its assigned spot.
pub fn marker_overlay(picture: &RgbImage, spots: &[Point], errors: &MarkerErrors) -> RgbImage {
    let mut canvas = Canvas::over(picture);
    let stroke = canvas.stroke;
    for spot in spots {
        canvas.ring(*spot, 4.0 * stroke, strand_colour(1));
    }
    for (expected, found) in errors.expected.iter().zip(&errors.found) {
        let Some(expected) = expected else {
            continue;
        };
        canvas.disc(*expected, 1.2 * stroke, strand_colour(0));
        if let Some(found) = found {
            canvas.line([*expected, *found], strand_colour(2));
        }
    }
    canvas.image
}

/// A dimmed or, if it is dark, lightened picture, and a clearly visible line width for it.
struct Canvas {
    image: RgbImage,
    stroke: f64,
}

/// Whether most of a picture is nearly black.
fn is_dark(picture: &RgbImage) -> bool {
    const DARK: u8 = 48;
    let dark = picture
        .pixels()
        .filter(|pixel| pixel.0.iter().all(|channel| *channel < DARK));
    2 * dark.count() > picture.pixels().len()
}

impl Canvas {
    fn over(picture: &RgbImage) -> Self {
        let mut image = picture.clone();
        // Lines are visible on a dimmed picture; a dark one is lightened to show the scene.
        let (factor, shift) = if is_dark(picture) { (10, 60) } else { (11, 0) };
        for channel in image.iter_mut() {
            *channel = (u16::from(*channel) * factor / 20 + shift) as u8;
        }
        let size = image.width().max(image.height());
        Self {
            image,
            stroke: (f64::from(size) / 450.0).max(1.5),
        }
    }

    /// Draws a strand with gaps where it is under another strand.
    fn strand(&mut self, trace: &Trace, number: usize) {
        let (strand, colour) = (&trace.strands[number], strand_colour(number));
        let under = trace.crossings.iter();
        let under: Vec<&StrandCrossing> = under
            .filter(|crossing| crossing.under.strand == number)
            .collect();
        let stroke = self.stroke;
        let hidden = |index: usize| {
            let point = strand.points[index];
            let near = under.iter().find(|crossing| {
                let reach = 0.8 * trace.strands[crossing.over.strand].width();
                (point - crossing.position).norm() < reach.max(2.0 * stroke)
            });
            near.is_some_and(|near| {
                // A strand that crosses itself has a gap on its lower passage only.
                trace.crossings.iter().any(|crossing| {
                    let away = |at: f64| (at - index as f64).abs();
                    crossing.position == near.position
                        && (crossing.over.strand != number
                            || away(crossing.under.at) < away(crossing.over.at))
                })
            })
        };
        for index in 0..segments(strand) {
            let next = (index + 1) % strand.points.len();
            if !hidden(index) && !hidden(next) {
                self.line(segment(strand, index), colour);
            }
        }
        if !strand.closed {
            let (first, last) = (strand.points[0], strand.points[strand.points.len() - 1]);
            self.disc(first, 2.2 * stroke, colour);
            self.ring(last, 2.2 * stroke, colour);
        }
    }

    fn line(&mut self, ends: [Point; 2], colour: [u8; 3]) {
        let radius = 0.5 * self.stroke;
        paint(
            &mut self.image,
            ends,
            radius + 1.0,
            |distance| radius - distance,
            colour,
        );
    }

    fn disc(&mut self, centre: Point, radius: f64, colour: [u8; 3]) {
        let depth = |distance: f64| radius - distance;
        paint(&mut self.image, [centre; 2], radius + 1.0, depth, colour);
    }

    fn ring(&mut self, centre: Point, radius: f64, colour: [u8; 3]) {
        let stroke = self.stroke;
        let depth = |distance: f64| 0.5 * stroke - (distance - radius).abs();
        paint(&mut self.image, [centre; 2], radius + stroke, depth, colour);
    }
}

/// Paints pixels near a segment; `depth` returns, for a distance from the segment, how far a pixel
/// is inside, in pixels.
fn paint(
    image: &mut RgbImage,
    [from, to]: [Point; 2],
    reach: f64,
    depth: impl Fn(f64) -> f64,
    colour: [u8; 3],
) {
    let bounds = |a: f64, b: f64, size| between(a.min(b) - reach, a.max(b) + reach, size as usize);
    let along = to - from;
    for row in bounds(from.y, to.y, image.height()) {
        for column in bounds(from.x, to.x, image.width()) {
            let point = Point::new(column as f64, row as f64) - from;
            let t = (point.dot(&along) / along.norm_squared().max(1e-12)).clamp(0.0, 1.0);
            let cover = (depth((point - along * t).norm()) + 0.5).clamp(0.0, 1.0);
            if cover > 0.0 {
                let pixel = image.get_pixel_mut(column as u32, row as u32);
                for (old, new) in pixel.0.iter_mut().zip(colour) {
                    let mixed = f64::from(*old) * (1.0 - cover) + f64::from(new) * cover;
                    *old = mixed.round() as u8;
                }
            }
        }
    }
}

/// The centrelines as `strand,point,u_px,v_px,width_px`, and with a camera also `x_m,y_m` on its
/// table. Strands are counted from 1, as in the label image, and points from 0.
///
/// # Errors
/// A ray of the camera misses the table.
pub fn centrelines_csv(strands: &[Strand], camera: Option<&Camera>) -> Result<String, VisionError> {
    let mut text = String::from("strand,point,u_px,v_px,width_px");
    text.push_str(if camera.is_some() { ",x_m,y_m\n" } else { "\n" });
    for (number, strand) in strands.iter().enumerate() {
        for (index, (point, width)) in strand.points.iter().zip(&strand.widths).enumerate() {
            // Writing to a string does not fail.
            let _ = write!(
                text,
                "{},{index},{:.3},{:.3},{width:.3}",
                number + 1,
                point.x,
                point.y
            );
            if let Some(camera) = camera {
                let on_table = camera.on_table(*point)?;
                let _ = write!(text, ",{:.7},{:.7}", on_table.x, on_table.y);
            }
            text.push('\n');
        }
    }
    Ok(text)
}

/// The centrelines as SVG paths in pixels, with the width of the strands.
pub fn centrelines_svg(width: u32, height: u32, strands: &[Strand]) -> String {
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"-0.5 -0.5 {width} {height}\">\n"
    );
    for (number, strand) in strands.iter().enumerate() {
        let [red, green, blue] = strand_colour(number);
        let _ = write!(
            text,
            "<path id=\"strand-{}\" fill=\"none\" stroke=\"#{red:02x}{green:02x}{blue:02x}\" \
             stroke-width=\"{:.2}\" stroke-linejoin=\"round\" d=\"",
            number + 1,
            strand.width()
        );
        for (index, point) in strand.points.iter().enumerate() {
            let command = if index == 0 { "M" } else { " " };
            let _ = write!(text, "{command}{:.2},{:.2}", point.x, point.y);
        }
        text.push_str(if strand.closed { "Z\"/>\n" } else { "\"/>\n" });
    }
    text.push_str("</svg>\n");
    text
}

/// A picture as the bytes of a PNG file.
pub fn encode_picture(picture: &RgbImage) -> Vec<u8> {
    encode(picture)
}

/// A label image as the bytes of a PNG file with one 8-bit channel.
pub fn encode_labels(labels: &GrayImage) -> Vec<u8> {
    encode(labels)
}

fn encode<P>(image: &ImageBuffer<P, Vec<u8>>) -> Vec<u8>
where
    P: PixelWithColorType<Subpixel = u8>,
{
    let mut bytes = Cursor::new(Vec::new());
    image
        .write_to(&mut bytes, ImageFormat::Png)
        .expect("an image of positive size is written to memory");
    bytes.into_inner()
}
