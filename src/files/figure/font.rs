//! Letters of figures: outlines of an embedded font, so that text looks the same everywhere.
//!
//! DejaVu Sans without hints, reduced to Latin, Greek, Cyrillic, mathematical symbols and arrows;
//! its licence is in the same folder. Missing letters are drawn as boxes.

use std::fmt::Write;
use std::sync::LazyLock;
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// Font units per em.
pub(super) const UNITS: f64 = 2048.0;

/// The font as a TrueType file.
pub const FONT_FILE: &[u8] = include_bytes!("font/DejaVuSans-subset.ttf");

static FONT: LazyLock<Face<'static>> =
    LazyLock::new(|| Face::parse(FONT_FILE, 0).expect("the font is whole"));

/// A letter of the font; lengths are in em.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Glyph {
    /// Number of the glyph in the font.
    pub number: u16,
    /// Advance to the next letter.
    pub advance: f64,
    /// Left, right and top of its outline.
    pub left: f64,
    pub right: f64,
    pub top: f64,
}

/// The letter of a character.
pub(super) fn glyph(character: char) -> Glyph {
    let id = FONT.glyph_index(character).unwrap_or_default();
    let em = |units: i16| f64::from(units) / UNITS;
    let advance = FONT.glyph_hor_advance(id).unwrap_or_default();
    let ink = FONT.glyph_bounding_box(id);
    let ink = ink.map_or([0; 3], |ink| [ink.x_min, ink.x_max, ink.y_max]);
    let [left, right, top] = ink.map(em);
    Glyph {
        number: id.0,
        advance: f64::from(advance) / UNITS,
        left,
        right,
        top,
    }
}

/// The outline of a letter as SVG path data in font units, y upwards; empty for a space.
pub(super) fn outline(number: u16) -> String {
    let mut pen = PathData::default();
    // Letters without outline, such as the space.
    let _ = FONT.outline_glyph(GlyphId(number), &mut pen);
    pen.0
}

/// Path data in integer font units.
#[derive(Default)]
struct PathData(String);

impl PathData {
    fn add(&mut self, command: char, numbers: &[f32]) {
        self.0.push(command);
        for (index, number) in numbers.iter().enumerate() {
            let number = number.round() as i32;
            // A minus sign separates numbers as well as a space.
            let space = if index > 0 && number >= 0 { " " } else { "" };
            write!(self.0, "{space}{number}").expect("a string takes all text");
        }
    }
}

impl OutlineBuilder for PathData {
    fn move_to(&mut self, x: f32, y: f32) {
        self.add('M', &[x, y]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.add('L', &[x, y]);
    }

    fn quad_to(&mut self, x0: f32, y0: f32, x: f32, y: f32) {
        self.add('Q', &[x0, y0, x, y]);
    }

    fn curve_to(&mut self, x0: f32, y0: f32, x1: f32, y1: f32, x: f32, y: f32) {
        self.add('C', &[x0, y0, x1, y1, x, y]);
    }

    fn close(&mut self) {
        self.0.push('Z');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_what_figures_write() {
        let needed = "AZaz09 .,;:=()[]/·−×±°²³µ‖√∂≈≤≥∞∝∫→–—…'\"ΑΩαωκτμθφεσνρ ēŁżéüЖя₀";
        for character in needed.chars() {
            assert_ne!(glyph(character).number, 0, "{character}");
        }
        assert_eq!(glyph('梁').number, 0);
    }

    #[test]
    fn letters_have_outlines_and_spaces_have_none() {
        assert!(outline(glyph('l').number).starts_with('M'));
        assert_eq!(outline(glyph(' ').number), "");
        assert!(glyph('m').advance > 2.0 * glyph('i').advance);
        let l = glyph('l');
        assert!(l.left > 0.0 && l.right < l.advance && l.top > 0.7);
    }
}
