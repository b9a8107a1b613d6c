//! Options of the commands that draw figures.

use super::prelude::*;
use rodlab_files::figure::{FigureOptions, Format, Paper};
use rodlab_lab::scenario::metres;

/// Formats of figures.
const FORMATS: [Named<Format>; 3] = [
    ("svg", Format::Svg, "Scalable vector graphics"),
    ("png", Format::Png, "Pixels, 300 per inch"),
    ("pdf", Format::Pdf, "Vectors for LaTeX"),
];

/// Style and formats of figures.
#[derive(Clone, Debug, Default, Args)]
pub struct FigureArguments {
    /// Formats of the figures, separated by commas [default: svg,png; of reproduced pages svg]
    #[arg(long, value_name = "FORMATS", value_delimiter = ',', value_parser = named(&FORMATS))]
    pub format: Vec<Format>,
    /// Width of the figures, such as 85mm for a journal column [default: 211.7mm]
    #[arg(long, value_name = "LENGTH", value_parser = metres)]
    pub width: Option<f64>,
    /// Size of the letters in points; lines and marks follow it [default: 10]
    #[arg(long, value_name = "POINTS")]
    pub font_size: Option<f64>,
}

impl FigureArguments {
    /// The options, with default formats.
    pub fn options(&self, usual: &[Format]) -> Result<FigureOptions, Failure> {
        let paper = Paper::default();
        let width = self.width.unwrap_or(paper.width());
        let font_size = self.font_size.unwrap_or(paper.font_size());
        let paper = Paper::new(width, font_size).ok_or_else(|| {
            let (widths, sizes) = (Paper::WIDTHS, Paper::FONT_SIZES);
            Failure::Input(format!(
                "a figure {:.4} m wide with letters of {font_size} points cannot be drawn: --width is from {} to {} m, \
                 --font-size from {} to {} points, with room for at least {} letters side by side",
                width,
                widths.start(),
                widths.end(),
                sizes.start(),
                sizes.end(),
                Paper::FEWEST_LETTERS
            ))
        })?;
        let mut formats: Vec<Format> = Vec::new();
        for format in &self.format {
            if !formats.contains(format) {
                formats.push(*format);
            }
        }
        if formats.is_empty() {
            formats = usual.to_vec();
        }
        Ok(FigureOptions { paper, formats })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_sizes_are_rejected_with_the_allowed_ones() {
        let arguments = |width, font_size| FigureArguments {
            format: vec![Format::Pdf, Format::Svg, Format::Pdf],
            width: Some(width),
            font_size: Some(font_size),
        };
        let options = arguments(0.085, 8.0).options(&[]).unwrap();
        assert_eq!(options.formats, [Format::Pdf, Format::Svg]);
        for (width, font_size) in [(1e-4, 8.0), (f64::NAN, 8.0), (0.085, 500.0), (0.03, 20.0)] {
            let message = arguments(width, font_size).options(&[]).unwrap_err();
            let Failure::Input(message) = message else {
                panic!("{message:?}");
            };
            assert!(
                message.contains("--width") && message.contains("--font-size"),
                "{message}"
            );
        }
        let usual = FigureArguments::default().options(&[Format::Svg]).unwrap();
        assert_eq!(
            (usual.paper, usual.formats),
            (Paper::default(), vec![Format::Svg])
        );
    }
}
