//! What was found in a picture, drawn over it; the same as CSV and SVG.

use super::camera::Camera;
use super::centreline::Strand;
use super::marker::MarkerErrors;
use super::mask::Mask;
use super::sheet::Sheet;
use super::trace::Trace;
use super::{Point, VisionError};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, GrayImage, ImageEncoder, Rgb, RgbImage};
use std::fmt::Write;

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

/// The picture, dimmed, with the centrelines of its strands on it. The strand below is broken at a crossing; a disc
/// marks the first point of a strand, a ring its last one.
pub fn overlay(picture: &RgbImage, trace: &Trace) -> RgbImage {
    let mut image = dimmed(picture);
    let stroke = stroke_of(&image);
    for (number, strand) in trace.strands.iter().enumerate() {
        let broken: Vec<(Point, f64)> = trace
            .crossings
            .iter()
            .filter(|crossing| crossing.under.strand == number)
            .map(|crossing| {
                let over = &trace.strands[crossing.over.strand];
                (crossing.position, (0.8 * over.width()).max(2.0 * stroke))
            })
            .collect();
        draw_strand(
            &mut image,
            strand,
            strand_colour(number),
            stroke,
            &broken,
            trace,
        );
    }
    for (point, _, width) in &trace.rejected {
        draw_ring(
            &mut image,
            *point,
            width.max(4.0 * stroke),
            stroke,
            [255, 60, 60],
        );
    }
    image
}

/// The picture, dimmed, with the pixels of a mask in red: why nothing was found in it.
pub fn mask_overlay(picture: &RgbImage, mask: &Mask) -> RgbImage {
    let mut image = dimmed(picture);
    for (column, row, pixel) in image.enumerate_pixels_mut() {
        if mask.contains(column as usize, row as usize) {
            *pixel = Rgb([255, pixel[1] / 2, pixel[2] / 2]);
        }
    }
    image
}

/// The picture, dimmed, with the edges of a sheet on it; a disc marks its first corner.
pub fn sheet_overlay(picture: &RgbImage, sheet: &Sheet) -> RgbImage {
    let mut image = dimmed(picture);
    let stroke = stroke_of(&image);
    for edge in 0..4 {
        let ends = [
            sheet.corner_pixels[edge],
            sheet.corner_pixels[(edge + 1) % 4],
        ];
        let depth = |distance: f64| 0.5 * stroke - distance;
        paint(&mut image, ends, stroke, depth, strand_colour(edge));
    }
    let radius = 2.2 * stroke;
    let depth = |distance: f64| radius - distance;
    paint(
        &mut image,
        [sheet.corner_pixels[0]; 2],
        radius + 1.0,
        depth,
        strand_colour(0),
    );
    image
}

/// The picture, dimmed, with straight edges on it, from pixel to pixel.
pub fn edges_overlay(picture: &RgbImage, edges: &[[Point; 2]]) -> RgbImage {
    let mut image = dimmed(picture);
    let stroke = stroke_of(&image);
    for (number, ends) in edges.iter().enumerate() {
        let depth = |distance: f64| 0.5 * stroke - distance;
        paint(&mut image, *ends, stroke, depth, strand_colour(number));
    }
    image
}

/// The picture, dimmed, with rings about the spots that were found, discs where markers are expected, and a line from each
/// to the spot that was taken for it.
pub fn marker_overlay(picture: &RgbImage, spots: &[Point], errors: &MarkerErrors) -> RgbImage {
    let mut image = dimmed(picture);
    let stroke = stroke_of(&image);
    for spot in spots {
        draw_ring(&mut image, *spot, 4.0 * stroke, stroke, strand_colour(1));
    }
    for (expected, found) in errors.expected.iter().zip(&errors.found) {
        let Some(expected) = expected else {
            continue;
        };
        let depth = |distance: f64| 1.2 * stroke - distance;
        paint(
            &mut image,
            [*expected; 2],
            2.2 * stroke,
            depth,
            strand_colour(0),
        );
        if let Some(found) = found {
            let depth = |distance: f64| 0.5 * stroke - distance;
            paint(
                &mut image,
                [*expected, *found],
                stroke,
                depth,
                strand_colour(2),
            );
        }
    }
    image
}

/// Width of lines that are seen well.
fn stroke_of(image: &RgbImage) -> f64 {
    (f64::from(image.width().max(image.height())) / 450.0).max(1.5)
}

fn dimmed(picture: &RgbImage) -> RgbImage {
    let mut image = picture.clone();
    for channel in image.iter_mut() {
        *channel = (u16::from(*channel) * 11 / 20) as u8;
    }
    image
}

fn draw_strand(
    image: &mut RgbImage,
    strand: &Strand,
    colour: [u8; 3],
    stroke: f64,
    broken: &[(Point, f64)],
    trace: &Trace,
) {
    let hidden = |index: usize| {
        let point = strand.points[index];
        let near = broken
            .iter()
            .find(|(position, reach)| (point - position).norm() < *reach);
        near.is_some_and(|(position, _)| {
            // A strand that crosses itself is hidden on its lower passage only.
            trace.crossings.iter().any(|crossing| {
                crossing.position == *position
                    && (!std::ptr::eq(&trace.strands[crossing.over.strand], strand)
                        || (crossing.under.at - index as f64).abs()
                            < (crossing.over.at - index as f64).abs())
            })
        })
    };
    let count = strand.points.len();
    let segments = if strand.closed { count } else { count - 1 };
    for index in 0..segments {
        let next = (index + 1) % count;
        if !hidden(index) && !hidden(next) {
            let ends = [strand.points[index], strand.points[next]];
            paint(
                image,
                ends,
                stroke,
                |distance| 0.5 * stroke - distance,
                colour,
            );
        }
    }
    if !strand.closed {
        let radius = 2.2 * stroke;
        let first = [strand.points[0]; 2];
        paint(
            image,
            first,
            radius + 1.0,
            |distance| radius - distance,
            colour,
        );
        draw_ring(image, strand.points[count - 1], radius, stroke, colour);
    }
}

fn draw_ring(image: &mut RgbImage, centre: Point, radius: f64, stroke: f64, colour: [u8; 3]) {
    let depth = |distance: f64| 0.5 * stroke - (distance - radius).abs();
    paint(image, [centre; 2], radius + stroke, depth, colour);
}

/// Paints pixels near a segment; `depth` says by their distance how far they are inside, in pixels.
fn paint(
    image: &mut RgbImage,
    [from, to]: [Point; 2],
    reach: f64,
    depth: impl Fn(f64) -> f64,
    colour: [u8; 3],
) {
    let bounds = |a: f64, b: f64, size: u32| {
        let first = (a.min(b) - reach).floor().clamp(0.0, f64::from(size)) as u32;
        let last = (a.max(b) + reach + 1.0).ceil().clamp(0.0, f64::from(size)) as u32;
        first..last
    };
    let along = to - from;
    for row in bounds(from.y, to.y, image.height()) {
        for column in bounds(from.x, to.x, image.width()) {
            let point = Point::new(f64::from(column), f64::from(row)) - from;
            let t = (point.dot(&along) / along.norm_squared().max(1e-12)).clamp(0.0, 1.0);
            let cover = (depth((point - along * t).norm()) + 0.5).clamp(0.0, 1.0);
            if cover > 0.0 {
                let pixel = image.get_pixel_mut(column, row);
                for (old, new) in pixel.0.iter_mut().zip(colour) {
                    let mixed = f64::from(*old) * (1.0 - cover) + f64::from(new) * cover;
                    *old = mixed.round() as u8;
                }
            }
        }
    }
}

/// The centrelines as `strand,point,u_px,v_px,width_px`, with a camera also `x_m,y_m` on its table. Strands count
/// from 1, as in the label image, points from 0.
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

/// The centrelines as SVG paths in pixels, as wide as the strands.
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
    encode(
        picture.as_raw(),
        picture.dimensions(),
        ExtendedColorType::Rgb8,
    )
}

/// A label image as the bytes of a PNG file with one 8-bit channel.
pub fn encode_labels(labels: &GrayImage) -> Vec<u8> {
    encode(labels.as_raw(), labels.dimensions(), ExtendedColorType::L8)
}

fn encode(pixels: &[u8], (width, height): (u32, u32), colour: ExtendedColorType) -> Vec<u8> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(pixels, width, height, colour)
        .expect("an image of positive size is written to memory");
    bytes
}
