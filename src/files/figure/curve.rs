//! Curves of a plot, distinguished by colour, and by marks or dashes for readers without colours.

use super::axis::AxisScale;
use super::colour_field::ColourField;
use super::drawing::number;
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
    /// Curves over the name and unit of their vertical axis.
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
    /// Name in the legend; no legend is drawn for a single curve.
    pub name: String,
    /// The points; the curve is interrupted where there is no value.
    pub points: Vec<(f64, Option<f64>)>,
    /// Its style.
    pub look: Look,
    /// Index of its colour and its mark; by default its position among the curves.
    pub style_index: Option<usize>,
}

/// Style of a curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Look {
    /// A line; several lines have a few marks that distinguish them.
    #[default]
    Line,
    /// A line that never has marks: an outline, of which marks would seem to be a part.
    Bare,
    /// A line with a mark at each point: few points, joined by straight lines.
    Marked,
    /// A mark at each point and no line: data compared with a curve, or without values between its
    /// points.
    Marks,
    /// The same with open marks: results of others.
    OpenMarks,
    /// A dashed line: a law, a prediction, unstable states.
    Dashed,
    /// A broad pale line below the others: their reference.
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

    /// The same curve with the colour and the mark of number `style_index`.
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
    /// Its colour.
    pub color: Color,
    /// Its mark.
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
    /// The same in white and wider, to be drawn below it.
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
/// Fading of the latter towards white.
const PALE: f64 = 0.72;

/// Points of a curve with marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Marked {
    None,
    Few,
    All,
}

/// Dashes and gaps of dashed curves, one after the other, em.
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

/// The shape of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    Disc,
    Square,
    Triangle,
    Diamond,
    TriangleDown,
    Star,
    Pentagon,
    Plus,
}

impl Mark {
    const ALL: [Self; 8] = [
        Self::Disc,
        Self::Square,
        Self::Triangle,
        Self::Diamond,
        Self::TriangleDown,
        Self::Star,
        Self::Pentagon,
        Self::Plus,
    ];

    /// Path data of the mark about a point; all shapes have approximately the area of a disc of the
    /// given radius.
    pub fn path(self, [x, y]: [f64; 2], radius: f64) -> String {
        let polygon = |corners: &[(f64, f64)]| {
            let corner = |(index, (turn, distance)): (usize, &(f64, f64))| {
                // Angles are clockwise from above, in fractions of a turn.
                let (sine, cosine) = libm::sincos(std::f64::consts::TAU * turn);
                let command = if index == 0 { 'M' } else { 'L' };
                let [x, y] =
                    [x + radius * distance * sine, y - radius * distance * cosine].map(number);
                format!("{command}{x} {y}")
            };
            corners.iter().enumerate().map(corner).collect::<String>() + "Z"
        };
        let regular = |count: usize, from: f64, size: f64| {
            let corner = |k: usize| (from + k as f64 / count as f64, size);
            polygon(&(0..count).map(corner).collect::<Vec<_>>())
        };
        match self {
            Self::Disc => {
                let (left, r) = (number(x - radius), number(radius));
                let (y, d) = (number(y), number(2.0 * radius));
                format!("M{left} {y}a{r} {r} 0 1 1 {d} 0a{r} {r} 0 1 1 -{d} 0Z")
            }
            Self::Square => regular(4, 0.125, 1.25),
            Self::Diamond => regular(4, 0.0, 1.3),
            Self::Triangle => regular(3, 0.0, 1.45),
            Self::TriangleDown => regular(3, 0.5, 1.45),
            Self::Pentagon => regular(5, 0.0, 1.2),
            Self::Star => {
                let corner =
                    |k: usize| (0.1 * k as f64, if k.is_multiple_of(2) { 1.6 } else { 0.65 });
                polygon(&(0..10).map(corner).collect::<Vec<_>>())
            }
            Self::Plus => {
                let (long, short) = (1.3, 0.42);
                let [reach, inner] = [libm::hypot(long, short), libm::hypot(short, short)];
                let turn = libm::atan(short / long) / std::f64::consts::TAU;
                let arm = |k: usize| {
                    let middle = 0.25 * k as f64;
                    [
                        (middle - turn, reach),
                        (middle + turn, reach),
                        (middle + 0.125, inner),
                    ]
                };
                polygon(&(0..4).flat_map(arm).collect::<Vec<_>>())
            }
        }
    }
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

    #[test]
    fn marks_stand_about_their_point() {
        for mark in Mark::ALL {
            let path = mark.path([50.0, 20.0], 3.0);
            assert!(path.starts_with('M') && path.ends_with('Z') && !path.contains("NaN"));
        }
        assert_eq!(
            Mark::Square.path([0.0, 0.0], 1.6),
            "M1.41 -1.41L1.41 1.41L-1.41 1.41L-1.41 -1.41Z"
        );
    }
}
