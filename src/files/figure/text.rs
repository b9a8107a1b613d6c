//! Text of a figure: positions of the letters, with subscripts, superscripts and bars.
//!
//! `l̄_{k}` is an l with a bar and the index k, `10^{-3}` a power of ten; everything else is
//! written unchanged.

use super::font::{Glyph, glyph};

/// Size of indices and powers relative to the line.
const SMALL: f64 = 0.7;
/// Their shift below and above the line, em.
const DOWN: f64 = -0.2;
const UP: f64 = 0.38;
/// Space between a letter and the bar above it, and the smallest length of that bar, em.
const ABOVE: f64 = 0.09;
const BAR: f64 = 0.34;
/// The combining macron: a bar above the previous letter.
const MACRON: char = '\u{304}';

/// A placed letter; lengths are in em, y upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    /// Number of the letter in the font.
    pub glyph: u16,
    /// Start of the text on the line.
    pub at: [f64; 2],
    /// Size of the text relative to the line.
    pub size: f64,
}

/// A line of text laid out; lengths are in em, y upwards, and the line begins at 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Line {
    /// The letters.
    pub letters: Vec<Placed>,
    /// Bars above letters: left and right end, and height.
    pub bars: Vec<[f64; 3]>,
    /// Position of the next letter.
    pub width: f64,
}

impl Line {
    /// Lays out a text.
    pub fn of(text: &str) -> Self {
        let mut line = Self::default();
        let mut last = None;
        let mut rest = text;
        while let Some(first) = rest.chars().next() {
            let shifted = [("_{", DOWN), ("^{", UP)]
                .into_iter()
                .find_map(|(mark, shift)| {
                    let (inside, after) = rest.strip_prefix(mark)?.split_once('}')?;
                    Some((inside, after, shift))
                });
            if let Some((inside, after, shift)) = shifted {
                for character in inside.chars() {
                    line.add(character, SMALL, shift, &mut last);
                }
                rest = after;
            } else {
                line.add(first, 1.0, 0.0, &mut last);
                rest = &rest[first.len_utf8()..];
            }
        }
        line
    }

    fn add(&mut self, character: char, size: f64, shift: f64, last: &mut Option<(Placed, Glyph)>) {
        if character == MACRON {
            if let Some((placed, glyph)) = last {
                let middle = 0.5 * (glyph.left + glyph.right);
                let half = 0.5 * (glyph.right - glyph.left).max(BAR);
                let along = |x: f64| placed.at[0] + placed.size * x;
                let height = placed.at[1] + placed.size * (glyph.top + ABOVE);
                self.bars
                    .push([along(middle - half), along(middle + half), height]);
            }
            return;
        }
        // A hyphen in a power is a minus sign.
        let is_minus = size < 1.0 && character == '-';
        let glyph = glyph(if is_minus { '−' } else { character });
        let placed = Placed {
            glyph: glyph.number,
            at: [self.width, shift],
            size,
        };
        self.letters.push(placed);
        self.width += size * glyph.advance;
        *last = Some((placed, glyph));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_and_powers_are_small_and_shifted() {
        let line = Line::of("x_{k}10^{-3}");
        let letters: Vec<(f64, f64)> = line.letters.iter().map(|l| (l.size, l.at[1])).collect();
        let (plain, low, high) = ((1.0, 0.0), (SMALL, DOWN), (SMALL, UP));
        assert_eq!(letters, [plain, low, plain, plain, high, high]);
        assert_eq!(line.letters[4].glyph, glyph('−').number);
        assert!(line.width < Line::of("xk10-3").width);
    }

    #[test]
    fn bars_stand_above_their_letter() {
        let line = Line::of("aF\u{304}");
        assert_eq!(line.letters.len(), 2);
        let [left, right, height] = line.bars[0];
        let before = Line::of("a").width;
        assert!(left > before && right < line.width && height > 0.7);
    }

    #[test]
    fn names_of_files_and_keys_are_written_as_they_stand() {
        for name in ["rods.left_arm", "a^b", "x_{k", "{}"] {
            assert_eq!(Line::of(name).letters.len(), name.chars().count(), "{name}");
        }
    }
}
