//! Labels of a film: its scale bar and its time.

use super::super::drawing::{Anchor, Drawing, Stroke, Words, number};
use super::super::palette::Color;
use super::super::scale_bar::{length_label, round_length_below};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

/// A black stamp on white: transmitted light of each pixel, red, green, blue.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stamp {
    width: usize,
    light: Vec<u8>,
}

impl Stamp {
    /// A drawing as a stamp.
    fn of(drawing: Drawing, width: usize, height: usize) -> Self {
        let svg = drawing.finish(height as f64);
        let tree = Tree::from_str(&svg, &Options::default()).expect("our drawings are SVG");
        let mut picture = Pixmap::new(width as u32, height as u32).expect("stamps are not empty");
        resvg::render(&tree, Transform::identity(), &mut picture.as_mut());
        let pixels = picture.data().chunks_exact(4);
        Self {
            width,
            light: pixels
                .flat_map(|pixel| [pixel[0], pixel[1], pixel[2]])
                .collect(),
        }
    }

    /// Prints the stamp onto a picture; `left` and `top` are the pixel of its top left corner.
    pub fn print(&self, picture: &mut [u8], picture_width: usize, [left, top]: [usize; 2]) {
        let width = 3 * self.width.min(picture_width.saturating_sub(left));
        for (row, light) in self.light.chunks_exact(3 * self.width).enumerate() {
            let first = 3 * ((top + row) * picture_width + left);
            let Some(pixels) = picture.get_mut(first..first + width) else {
                return;
            };
            for (pixel, light) in pixels.iter_mut().zip(light) {
                *pixel = (u16::from(*pixel) * u16::from(*light) / 255) as u8;
            }
        }
    }
}

/// A line of text whose letters are `em` pixels high.
pub(super) fn text(text: &str, em: f64) -> Stamp {
    let width = (em * super::super::text::Line::of(text).width).ceil() + 4.0;
    let mut drawing = Drawing::new(width);
    drawing.text(Words {
        text,
        at: [2.0, 1.1 * em],
        size: em,
        anchor: Anchor::Start,
        upright: false,
    });
    Stamp::of(drawing, width as usize, (1.5 * em).ceil() as usize)
}

/// A bar of round length with its label, at most `widest` pixels wide. `scale` is in pixels per
/// metre.
pub(super) fn scale_bar(scale: f64, widest: f64, em: f64) -> Stamp {
    let length = round_length_below(widest / scale);
    let label = length_label(length);
    let bar = scale * length;
    let letters = em * super::super::text::Line::of(&label).width;
    let width = bar.max(letters).ceil() + 4.0;
    let middle = 0.5 * width;
    let mut drawing = Drawing::new(width);
    let (from, to) = (middle - 0.5 * bar, middle + 0.5 * bar);
    let path = format!("M{} {}H{}", number(from), number(1.85 * em), number(to));
    drawing.path(&path, &Stroke::solid(Color::BLACK, 0.16 * em), None);
    drawing.text(Words {
        text: &label,
        at: [middle, 1.2 * em],
        size: em,
        anchor: Anchor::Middle,
        upright: false,
    });
    Stamp::of(drawing, width as usize, (2.2 * em).ceil() as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_bar_is_as_long_as_it_says() {
        // At 3000 pixels per metre, 5 cm are 150 pixels.
        let stamp = scale_bar(3000.0, 200.0, 20.0);
        let row = 37;
        let pixels = stamp.light[3 * row * stamp.width..][..3 * stamp.width].chunks_exact(3);
        let dark = pixels.filter(|pixel| pixel[0] < 128).count() as f64;
        // Each round end extends the bar by half of its thickness.
        assert!((dark - 150.0 - 3.2).abs() < 2.5, "{dark}");
    }

    #[test]
    fn a_stamp_darkens_what_is_below_and_stays_in_the_picture() {
        let stamp = text("t = 1 s", 16.0);
        let mut picture = vec![200; 3 * 40 * 30];
        stamp.print(&mut picture, 40, [2, 2]);
        assert!(picture.iter().any(|light| *light < 60));
        assert_eq!(picture[0], 200);
        // Nothing is drawn outside the picture.
        stamp.print(&mut picture, 40, [39, 28]);
        stamp.print(&mut picture, 40, [60, 60]);
    }
}
