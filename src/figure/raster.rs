//! SVG as PNG, with a font of our own: no font of the system is needed, and pictures are the same everywhere.

use epaint_default_fonts::UBUNTU_LIGHT;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use std::sync::Arc;

/// Pixels of a picture for each of the SVG.
const FINENESS: f32 = 2.0;

/// Draws an SVG as PNG at twice its size.
///
/// # Panics
/// Where `svg` is none: the figures of this room are.
pub fn png(svg: &str) -> Vec<u8> {
    let mut options = Options::default();
    let fonts = Arc::make_mut(&mut options.fontdb);
    fonts.load_font_data(UBUNTU_LIGHT.to_vec());
    let family = fonts.faces().next().map(|face| face.families[0].0.clone());
    fonts.set_sans_serif_family(family.expect("the font has a face with a name"));
    let tree = Tree::from_str(svg, &options).expect("our figures are SVG");
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

#[cfg(test)]
mod tests {
    use super::*;

    fn dark_pixels(svg: &str) -> usize {
        let bytes = png(svg);
        let picture = image::load_from_memory(&bytes).unwrap().to_rgb8();
        assert_eq!(picture.dimensions(), (200, 80));
        picture.pixels().filter(|pixel| pixel.0[0] < 100).count()
    }

    #[test]
    fn text_is_drawn_without_fonts_of_the_system() {
        let picture = |text: &str| {
            format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100\" height=\"40\">\
                 <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\
                 <text x=\"5\" y=\"25\" font-family=\"system-ui, sans-serif\">{text}</text></svg>"
            )
        };
        assert_eq!(dark_pixels(&picture("")), 0);
        let (short, long) = (dark_pixels(&picture("μ")), dark_pixels(&picture("μ ≈ 0.3")));
        assert!(short > 20 && long > 2 * short, "{short} {long}");
    }
}
