//! A page of SVG under construction: strokes, areas, and text as outlines of its letters.

use super::font::{UNITS, outline};
use super::markup::escape;
use super::palette::Color;
use super::text::Line;
use std::collections::BTreeSet;
use std::fmt::Write;

/// Thickness of the bar above a letter, em.
const BAR: f64 = 0.055;

/// Alignment of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// Text on the page.
#[derive(Clone, Copy, Debug)]
pub(super) struct Words<'a> {
    /// The text, see [`Line`].
    pub text: &'a str,
    /// Position of the text: x and its base line, pixels.
    pub at: [f64; 2],
    /// Height of the font, pixels.
    pub size: f64,
    /// Alignment of the text.
    pub anchor: Anchor,
    /// Whether the text is rotated, to be read upwards.
    pub upright: bool,
}

/// Style of a line.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stroke {
    /// Colour of the stroke.
    pub color: Color,
    /// Width of the stroke, pixels.
    pub width: f64,
    /// Lengths of dashes and gaps, pixels; empty for a solid line.
    pub dashes: Vec<f64>,
}

impl Stroke {
    pub fn solid(color: Color, width: f64) -> Self {
        Self {
            color,
            width,
            dashes: Vec::new(),
        }
    }
}

/// A page of SVG; lengths are in pixels, y downwards.
pub(super) struct Drawing {
    width: f64,
    body: String,
    letters: BTreeSet<u16>,
}

impl Drawing {
    pub fn new(width: f64) -> Self {
        Self {
            width,
            body: String::new(),
            letters: BTreeSet::new(),
        }
    }

    /// Adds elements unchanged.
    pub fn raw(&mut self, elements: &str) {
        self.body += elements;
    }

    /// Strokes a path, and fills it if a fill colour is given.
    pub fn path(&mut self, data: &str, stroke: &Stroke, fill: Option<Color>) {
        let fill = fill.map_or("none".into(), Color::hex);
        self.body += &format!("<path d=\"{data}\" fill=\"{fill}\"");
        if stroke.width > 0.0 {
            let (color, width) = (stroke.color.hex(), number(stroke.width));
            self.body += &format!(" stroke=\"{color}\" stroke-width=\"{width}\"");
        }
        if !stroke.dashes.is_empty() {
            let dashes: Vec<String> = stroke.dashes.iter().map(|dash| number(*dash)).collect();
            self.body += &format!(" stroke-dasharray=\"{}\"", dashes.join(" "));
        } else if stroke.width > 0.0 {
            self.body += " stroke-linejoin=\"round\" stroke-linecap=\"round\"";
        }
        self.body += "/>\n";
    }

    /// Fills a path.
    pub fn area(&mut self, data: &str, color: Color) {
        self.path(data, &Stroke::solid(color, 0.0), Some(color));
    }

    /// Writes text. The words of the text are also in the file, for screen readers and for search.
    pub fn text(&mut self, words: Words) {
        let line = Line::of(words.text);
        if line.letters.is_empty() {
            return;
        }
        let shift = match words.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * line.width,
            Anchor::End => -line.width,
        };
        let [x, y] = words.at.map(number);
        let turn = if words.upright { " rotate(-90)" } else { "" };
        let scale = words.size / UNITS;
        let label = escape(words.text);
        self.body += &format!(
            "<g aria-label=\"{label}\" transform=\"translate({x} {y}){turn} scale({scale:.6} {:.6})\">",
            -scale
        );
        for letter in &line.letters {
            self.letters.insert(letter.glyph);
            let [x, y] = [letter.at[0] + shift, letter.at[1]].map(|em| (em * UNITS).round());
            let name = letter.glyph;
            let place = if letter.size == 1.0 && y == 0.0 {
                format!("x=\"{x}\"")
            } else {
                format!("transform=\"translate({x} {y}) scale({})\"", letter.size)
            };
            write!(self.body, "<use href=\"#g{name}\" {place}/>").expect("text");
        }
        for [left, right, height] in &line.bars {
            let [left, right] = [left, right].map(|x| ((x + shift) * UNITS).round());
            let (height, thick) = ((height * UNITS).round(), (BAR * UNITS).round());
            write!(
                self.body,
                "<path d=\"M{left} {height}H{right}v{thick}H{left}z\"/>"
            )
            .expect("text");
        }
        self.body += "</g>\n";
    }

    /// The whole page, white, of a height in pixels.
    pub fn finish(self, height: f64) -> String {
        let (width, height) = (number(self.width), number(height));
        let mut letters = String::new();
        for letter in self.letters {
            let data = outline(letter);
            writeln!(letters, "<path id=\"g{letter}\" d=\"{data}\"/>").expect("text");
        }
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\">\n<defs>\n{letters}</defs>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{}</svg>\n",
            self.body
        )
    }
}

/// A number in SVG notation, to a hundredth of a pixel.
pub(super) fn number(value: f64) -> String {
    let rounded = (100.0 * value).round() / 100.0;
    // There is no −0 on a page.
    format!("{}", rounded + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Words<'_> {
        Words {
            text,
            at: [50.0, 20.0],
            size: 10.0,
            anchor: Anchor::Start,
            upright: false,
        }
    }

    #[test]
    fn text_is_outlines_and_its_words_are_in_the_file() {
        let mut drawing = Drawing::new(100.0);
        drawing.text(words("a < \"b\" & a"));
        let svg = drawing.finish(40.0);
        assert!(svg.contains("aria-label=\"a &lt; &quot;b&quot; &amp; a\""));
        assert!(!svg.contains("<text") && !svg.contains("font"));
        // Nine letters; the space and the `a` occur repeatedly.
        assert_eq!(svg.matches("<use").count(), 11);
        assert_eq!(svg.matches("<path id").count(), 6);
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [1.0, -0.001, 2.345_6, -7.1].map(number),
            ["1", "0", "2.35", "-7.1"]
        );
    }
}
