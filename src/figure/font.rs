//! The letters of figures: outlines of a font of our own, so that text looks the same everywhere.
//!
//! DejaVu Sans without hints, cut down to Latin, Greek, Cyrillic, signs of mathematics and arrows; its licence lies
//! beside it. Letters that it lacks are drawn as boxes.

use skrifa::instance::{LocationRef, Size};
use skrifa::metrics::GlyphMetrics;
use skrifa::outline::{DrawSettings, OutlineGlyphCollection, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider};
use std::fmt::Write;
use std::sync::LazyLock;

/// Font units per em.
pub(super) const UNITS: f64 = 2048.0;

static FONT: LazyLock<FontRef<'static>> = LazyLock::new(|| {
    FontRef::new(include_bytes!("font/DejaVuSans-subset.ttf")).expect("the font is whole")
});

/// A letter of the font; lengths are in em.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Glyph {
    /// Its number in the font.
    pub number: u32,
    /// How far the next letter is.
    pub advance: f64,
    /// Left, right and top of its ink.
    pub left: f64,
    pub right: f64,
    pub top: f64,
}

/// The letter of a character.
pub(super) fn glyph(character: char) -> Glyph {
    let id = FONT.charmap().map(character).unwrap_or(GlyphId::NOTDEF);
    let metrics: GlyphMetrics = FONT.glyph_metrics(Size::unscaled(), LocationRef::default());
    let em = |units: f32| f64::from(units) / UNITS;
    let advance = em(metrics.advance_width(id).unwrap_or_default());
    let ink = metrics.bounds(id).unwrap_or_default();
    Glyph {
        number: id.to_u32(),
        advance,
        left: em(ink.x_min),
        right: em(ink.x_max),
        top: em(ink.y_max),
    }
}

/// The outline of a letter as SVG path data in font units, y upwards; empty for a space.
pub(super) fn outline(number: u32) -> String {
    let outlines: OutlineGlyphCollection = FONT.outline_glyphs();
    let mut pen = PathData::default();
    if let Some(glyph) = outlines.get(GlyphId::new(number)) {
        let settings = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
        glyph.draw(settings, &mut pen).expect("the font is whole");
    }
    pen.0
}

/// Path data as the font draws it; coordinates are whole font units.
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

impl OutlinePen for PathData {
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
