//! Curves of a plot, distinguished by colour, and by marks or dashes for readers without colours.

use super::axis::AxisScale;
use super::colour_field::ColourField;
use super::mark::Mark;
use super::palette::Color;

/// A plot of one or more curves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinePlot {
    /// Name and unit of the vertical axis.
    pub label: String,
    /// The curves.
    pub curves: Vec<Curve>,
    /// Values below the curves, as colours.
    pub field: Option<ColourField>,
}

impl LinePlot {
    /// A plot of curves with the name and unit of the vertical axis.
    pub fn new(label: impl Into<String>, curves: impl IntoIterator<Item = Curve>) -> Self {
        Self {
            label: label.into(),
            curves: curves.into_iter().collect(),
            field: None,
        }
    }
}

/// A curve and its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Name in the legend, in which curves without a name are left out; no legend is drawn for a
    /// single curve.
    pub name: String,
    /// The points; the curve is interrupted at points without a value.
    pub points: Vec<(f64, Option<f64>)>,
    /// Style of the curve.
    pub look: Look,
    /// Index of its colour and its mark; by default its position among the curves.
    pub style_index: Option<usize>,
}

/// Style of a curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Look {
    /// A line. If there are several, a few marks on each distinguish them.
    #[default]
    Line,
    /// A line without marks, for outlines, of which marks would seem to be a part.
    Bare,
    /// A line with a mark at each point, for few points that straight lines join.
    Marked,
    /// A mark at each point and no line, for data that are compared with a curve or have no values
    /// between their points.
    Marks,
    /// Open marks and no line, for results of others.
    OpenMarks,
    /// A dashed line: a law, a prediction, unstable states.
    Dashed,
    /// A broad pale line below the other curves, which refer to it.
    Ground,
}

impl Curve {
    /// A curve drawn as a line.
    pub fn new(name: impl Into<String>, points: Vec<(f64, Option<f64>)>) -> Self {
        Self {
            name: name.into(),
            points,
            ..Self::default()
        }
    }

    /// The same curve in another style.
    pub fn looking(self, look: Look) -> Self {
        Self { look, ..self }
    }

    /// The same curve with the colour and mark of index `style_index`.
    pub fn like(self, style_index: usize) -> Self {
        Self {
            style_index: Some(style_index),
            ..self
        }
    }

    /// The stretches of the curve between its breaks, on axes of the given scales.
    pub(super) fn stretches(
        &self,
        [horizontal, vertical]: [AxisScale; 2],
    ) -> impl Iterator<Item = Vec<(f64, f64)>> {
        let stretches = self
            .points
            .split(move |(x, y)| !(horizontal.holds(*x) && y.is_some_and(|y| vertical.holds(y))));
        stretches.map(|stretch| {
            stretch
                .iter()
                .filter_map(|(x, y)| Some((*x, (*y)?)))
                .collect()
        })
    }
}

/// Appearance of a curve.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Style {
    /// Colour of the style.
    pub color: Color,
    /// Mark of the style.
    pub mark: Mark,
    /// Width of its line, em.
    pub width: f64,
    /// Dashes and gaps, em; empty for a solid line.
    pub dashes: Vec<f64>,
    /// Whether there is a line.
    pub is_joined: bool,
    /// Points with marks.
    pub marked: Marked,
    /// Whether marks are open.
    pub is_open: bool,
}

impl Style {
    /// The style of a wider white line, drawn below the curve.
    pub fn casing(&self) -> Self {
        Self {
            color: Color::WHITE,
            width: self.width + 0.16,
            ..self.clone()
        }
    }

    /// Whether it is drawn below the others.
    pub fn is_broad(&self) -> bool {
        self.width > WIDTH
    }
}

/// Width of a curve, and of a reference curve, em.
const WIDTH: f64 = 0.13;
const BROAD: f64 = 0.6;
/// Fading of a reference curve towards white.
const PALE: f64 = 0.72;

/// Which points of a curve have marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Marked {
    None,
    Few,
    All,
}

/// Dashes and gaps of dashed curves, used in turn, em.
const DASHES: [&[f64]; 4] = [
    &[0.55, 0.35],
    &[0.12, 0.28],
    &[0.8, 0.3, 0.12, 0.3],
    &[1.2, 0.4],
];

/// The styles of the curves of a plot.
pub(super) fn styles(curves: &[Curve]) -> Vec<Style> {
    let lines = curves.iter().filter(|curve| curve.look == Look::Line);
    let several = lines.count() > 1;
    let mut dashed = 0;
    let style = |(place, curve): (usize, &Curve)| {
        let number = curve.style_index.unwrap_or(place);
        let dashes = if curve.look == Look::Dashed {
            dashed += 1;
            DASHES[(dashed - 1) % DASHES.len()].to_vec()
        } else {
            Vec::new()
        };
        let is_ground = curve.look == Look::Ground;
        Style {
            color: if is_ground {
                Color::BLACK.towards(Color::WHITE, PALE)
            } else {
                Color::of(number)
            },
            width: if is_ground { BROAD } else { WIDTH },
            mark: Mark::ALL[number % Mark::ALL.len()],
            dashes,
            is_joined: !matches!(curve.look, Look::Marks | Look::OpenMarks),
            marked: match curve.look {
                Look::Line if several => Marked::Few,
                Look::Line | Look::Bare | Look::Dashed | Look::Ground => Marked::None,
                Look::Marked | Look::Marks | Look::OpenMarks => Marked::All,
            },
            is_open: curve.look == Look::OpenMarks,
        }
    };
    curves.iter().enumerate().map(style).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_differ_without_colours() {
        let curves: Vec<Curve> = (0..8).map(|k| Curve::new(format!("{k}"), vec![])).collect();
        let styles = styles(&curves);
        for (index, style) in styles.iter().enumerate() {
            assert_eq!(style.marked, Marked::Few);
            assert!(styles[..index].iter().all(|other| other.mark != style.mark));
        }
        let laws: Vec<Curve> = curves[..4]
            .iter()
            .map(|curve| curve.clone().looking(Look::Dashed))
            .collect();
        let laws = super::styles(&laws);
        for (index, law) in laws.iter().enumerate() {
            assert!(!law.dashes.is_empty() && law.marked == Marked::None);
            assert!(laws[..index].iter().all(|other| other.dashes != law.dashes));
        }
    }

    #[test]
    fn a_single_line_has_no_marks_and_equal_style_indices_share_a_colour() {
        let line = Curve::new("theory", vec![]);
        let points = Curve::new("rod", vec![]).looking(Look::Marks).like(0);
        let styles = styles(&[line, points]);
        assert_eq!(styles[0].marked, Marked::None);
        assert_eq!(styles[1].marked, Marked::All);
        assert!(styles[0].is_joined && !styles[1].is_joined);
        assert_eq!(styles[0].color, styles[1].color);
    }

    #[test]
    fn outlines_have_no_marks_beside_other_lines() {
        let pegs = Curve::new("pegs", vec![]).looking(Look::Bare);
        let lines = ["optimal", "intuitive"].map(|name| Curve::new(name, vec![]));
        let styles = styles(&[lines[0].clone(), lines[1].clone(), pegs]);
        assert_eq!(
            [&styles[0], &styles[1]].map(|line| line.marked),
            [Marked::Few; 2]
        );
        assert_eq!(styles[2].marked, Marked::None);
        assert!(styles[2].is_joined);
    }

    #[test]
    fn a_curve_is_broken_where_there_is_no_value() {
        let values = [Some(1.0), Some(2.0), None, Some(3.0), Some(0.0), Some(5.0)];
        let points = values.into_iter().enumerate();
        let curve = Curve::new("broken", points.map(|(k, y)| (k as f64, y)).collect());
        let lengths = |scale| -> Vec<usize> {
            let stretches = curve.stretches([AxisScale::Linear, scale]);
            stretches.map(|stretch| stretch.len()).collect()
        };
        assert_eq!(lengths(AxisScale::Linear), [2, 3]);
        assert_eq!(lengths(AxisScale::Logarithmic), [2, 1, 1]);
    }
}
