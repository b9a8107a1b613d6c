//! Size and formats of figures.

use super::pdf::pdf;
use super::raster::png;

/// Pixels of an SVG per metre: 96 per inch.
const PIXELS_PER_METRE: f64 = 96.0 / 0.0254;
/// Pixels per point, which is a 72nd of an inch.
const PIXELS_PER_POINT: f64 = 96.0 / 72.0;

/// The size of a figure; all lengths follow from its width and font size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paper {
    /// Width of the figure, pixels.
    pub(super) width: f64,
    /// Size of the font, pixels.
    pub(super) em: f64,
}

impl Default for Paper {
    /// 800 pixels, 212 mm, with letters of 10 points.
    fn default() -> Self {
        Self {
            width: 800.0,
            em: 10.0 * PIXELS_PER_POINT,
        }
    }
}

impl Paper {
    /// Widths that can be drawn, m.
    pub const WIDTHS: std::ops::RangeInclusive<f64> = 0.03..=2.0;
    /// Sizes of letters that can be drawn, points.
    pub const FONT_SIZES: std::ops::RangeInclusive<f64> = 4.0..=48.0;

    /// Minimum width in letters.
    pub const FEWEST_LETTERS: f64 = 15.0;

    /// A figure of a width (m) with letters of a size (points); `None` if they are outside
    /// [`WIDTHS`](Self::WIDTHS) or [`FONT_SIZES`](Self::FONT_SIZES), or the width is below
    /// [`FEWEST_LETTERS`](Self::FEWEST_LETTERS) letters.
    pub fn new(width: f64, font_size: f64) -> Option<Self> {
        let paper = Self {
            width: width * PIXELS_PER_METRE,
            em: font_size * PIXELS_PER_POINT,
        };
        let fits = paper.width >= Self::FEWEST_LETTERS * paper.em;
        let inside = Self::WIDTHS.contains(&width) && Self::FONT_SIZES.contains(&font_size);
        (inside && fits).then_some(paper)
    }

    /// Width of the figure, m.
    pub fn width(&self) -> f64 {
        self.width / PIXELS_PER_METRE
    }

    /// Size of the letters, points.
    pub fn font_size(&self) -> f64 {
        self.em / PIXELS_PER_POINT
    }
}

/// A format of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Scalable vector graphics.
    Svg,
    /// Pixels, 300 per inch.
    Png,
    /// Portable document format, for LaTeX.
    Pdf,
}

impl Format {
    /// The extension of file names.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Pdf => "pdf",
        }
    }

    /// A figure, drawn as SVG, in this format.
    pub fn encode(self, svg: &str) -> Vec<u8> {
        match self {
            Self::Svg => svg.as_bytes().to_vec(),
            Self::Png => png(svg),
            Self::Pdf => pdf(svg),
        }
    }
}

/// Size and formats of figures.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureOptions {
    /// Size of the figures.
    pub paper: Paper,
    /// Formats in which each figure is written.
    pub formats: Vec<Format>,
}

impl Default for FigureOptions {
    /// Default: SVG and PNG of the default size.
    fn default() -> Self {
        Self {
            paper: Paper::default(),
            formats: vec![Format::Svg, Format::Png],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_of_a_journal_is_as_wide_as_it_says() {
        let paper = Paper::new(0.085, 8.0).unwrap();
        assert!((paper.width - 321.26).abs() < 0.01 && (paper.em - 10.667).abs() < 1e-3);
        assert!((paper.width() - 0.085).abs() < 1e-12 && (paper.font_size() - 8.0).abs() < 1e-12);
        for (width, font_size) in [(0.01, 8.0), (3.0, 8.0), (0.1, 2.0), (0.05, 48.0)] {
            assert_eq!(Paper::new(width, font_size), None);
        }
    }
}
