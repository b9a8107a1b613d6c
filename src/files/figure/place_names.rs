//! Names below a horizontal axis without numbers: scenarios, patterns, trials.

use super::drawing::{Anchor, Drawing, Words};
use super::text::Line;

/// Space beside a name, and between lines of names, em.
const BESIDE: f64 = 0.5;
const LINE: f64 = 1.15;
/// Space between the axis and the names, em.
const GAP: f64 = 0.5;
/// Maximum number of lines of a horizontal name.
const MOST_LINES: usize = 3;

/// Names at the positions 1, 2, 3, ... of an axis, broken into lines if they fit, otherwise
/// rotated.
pub(super) struct PlaceNames {
    /// Lines of each name.
    names: Vec<Vec<String>>,
    is_upright: bool,
    em: f64,
}

impl PlaceNames {
    /// Names for positions of equal width on an axis of the given width, pixels.
    pub fn within(width: f64, names: &[String], em: f64) -> Self {
        let room = width / (names.len().max(1) as f64 * em) - BESIDE;
        let broken: Option<Vec<_>> = names.iter().map(|name| broken_into(name, room)).collect();
        Self {
            is_upright: broken.is_none(),
            names: broken.unwrap_or_else(|| names.iter().map(|name| vec![name.clone()]).collect()),
            em,
        }
    }

    /// Height from the axis to the lower end of the names, pixels.
    pub fn height(&self) -> f64 {
        let height = if self.is_upright {
            let widths = self.names.iter().flatten().map(|name| Line::of(name).width);
            widths.fold(0.0, f64::max)
        } else {
            let lines = self.names.iter().map(Vec::len).max().unwrap_or(0);
            LINE * lines as f64
        };
        (GAP + height) * self.em
    }

    /// Draws the names below an axis; `x` returns the position of an index.
    pub fn draw(&self, axis: f64, x: impl Fn(f64) -> f64, drawing: &mut Drawing) {
        for (index, lines) in self.names.iter().enumerate() {
            let middle = x(index as f64 + 1.0);
            for (row, text) in lines.iter().enumerate() {
                let (at, anchor) = if self.is_upright {
                    let base = [middle + 0.36 * self.em, axis + GAP * self.em];
                    (base, Anchor::End)
                } else {
                    let base = axis + (GAP + 0.85 + LINE * row as f64) * self.em;
                    ([middle, base], Anchor::Middle)
                };
                drawing.text(Words {
                    text,
                    at,
                    size: self.em,
                    anchor,
                    upright: self.is_upright,
                });
            }
        }
    }
}

/// Breaks a name into lines no wider than `room` (em), after commas or else at spaces; `None` if a
/// word is wider or there are too many lines.
fn broken_into(name: &str, room: f64) -> Option<Vec<String>> {
    let parts = name.split_inclusive(", ").map(str::trim_end);
    let after_commas = lines_of(parts, room);
    after_commas.or_else(|| lines_of(name.split(' '), room))
}

fn lines_of<'a>(words: impl Iterator<Item = &'a str>, room: f64) -> Option<Vec<String>> {
    let mut lines: Vec<String> = Vec::new();
    for word in words {
        let longer = lines.last().map(|line| format!("{line} {word}"));
        match longer.filter(|line| Line::of(line).width <= room) {
            Some(longer) => *lines.last_mut()? = longer,
            None if Line::of(word).width <= room => lines.push(word.into()),
            None => return None,
        }
    }
    (lines.len() <= MOST_LINES).then_some(lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_broken_after_commas_or_at_spaces_or_stand_upright() {
        let names = ["A4, half", "cardboard, C = 0.20 m"].map(str::to_owned);
        let broken = PlaceNames::within(200.0, &names, 10.0);
        assert!(!broken.is_upright);
        assert_eq!(broken.names[0], ["A4, half"]);
        assert_eq!(broken.names[1], ["cardboard,", "C = 0.20 m"]);
        assert_eq!(
            broken_into("jitter of 2 mm", 5.0).unwrap(),
            ["jitter of 2", "mm"]
        );
        let narrow = PlaceNames::within(60.0, &names, 10.0);
        assert!(narrow.is_upright && narrow.height() > broken.height());
        assert_eq!(narrow.names[1], ["cardboard, C = 0.20 m"]);
    }
}
