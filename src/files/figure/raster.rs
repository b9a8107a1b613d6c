//! SVG as PNG. Figures contain outlines of letters instead of text, so that no fonts are needed.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

/// Pixels of a picture per pixel of the SVG: 300 per inch.
const FINENESS: f32 = 300.0 / 96.0;

/// Draws an SVG as PNG, 300 pixels per inch.
///
/// # Panics
/// If `svg` is not an SVG file; the figures of this crate are.
pub(super) fn png(svg: &str) -> Vec<u8> {
    let tree = Tree::from_str(svg, &Options::default()).expect("our figures are SVG");
    let size = tree.size().to_int_size().scale_by(FINENESS);
    let size = size.expect("figures have a size");
    let mut picture = Pixmap::new(size.width(), size.height()).expect("figures are not empty");
    resvg::render(
        &tree,
        Transform::from_scale(FINENESS, FINENESS),
        &mut picture.as_mut(),
    );
    picture.encode_png().expect("memory takes all bytes")
}

/// Draws an SVG at a width in pixels, on white; returns width, height and grey pixels row by row, or `None` if it is not an SVG file
/// or has no size.
pub fn grey_picture(svg: &str, width: u32) -> Option<(u32, u32, Vec<u8>)> {
    let tree = Tree::from_str(svg, &Options::default()).ok()?;
    let size = tree.size().to_int_size().scale_to_width(width)?;
    let scale = width as f32 / tree.size().width();
    let mut picture = Pixmap::new(size.width(), size.height())?;
    picture.fill(resvg::tiny_skia::Color::WHITE);
    resvg::render(
        &tree,
        Transform::from_scale(scale, scale),
        &mut picture.as_mut(),
    );
    let grey = picture.pixels().iter().map(|pixel| {
        let [red, green, blue] = [pixel.red(), pixel.green(), pixel.blue()].map(u16::from);
        u8::try_from((red + green + blue) / 3).unwrap_or(u8::MAX)
    });
    Some((size.width(), size.height(), grey.collect()))
}

#[cfg(test)]
mod tests {
    use super::super::drawing::{Anchor, Drawing, Words};
    use super::*;

    fn dark_pixels(text: &str) -> usize {
        let mut drawing = Drawing::new(96.0);
        drawing.text(Words {
            text,
            at: [5.0, 25.0],
            size: 16.0,
            anchor: Anchor::Start,
            upright: false,
        });
        let bytes = png(&drawing.finish(48.0));
        let picture = image::load_from_memory(&bytes).unwrap().to_rgb8();
        assert_eq!(picture.dimensions(), (300, 150));
        picture.pixels().filter(|pixel| pixel.0[0] < 100).count()
    }

    #[test]
    fn text_is_drawn_without_fonts_of_the_system() {
        assert_eq!(dark_pixels(""), 0);
        let (short, long) = (dark_pixels("μ"), dark_pixels("μ ≈ 0.3"));
        assert!(short > 50 && long > 2 * short, "{short} {long}");
    }
}
