//! Source of a pattern: a formula or a drawing.

use super::{Circle, Line, Pattern, PatternError, Point, Sine, Stroke, bounds};

/// A formula or a drawing, not smoothed yet.
#[derive(Clone, Debug, PartialEq)]
pub enum PatternSource {
    /// A straight line.
    Line(Line),
    /// A circle, once around.
    Circle(Circle),
    /// A sine.
    Sine(Sine),
    /// Points of a drawing.
    Drawn {
        /// The points, m.
        points: Vec<Point>,
        /// Allowed deviation of the smooth curve from the points, m.
        deviation: f64,
    },
}

impl PatternSource {
    /// The drawn points, m; none for a formula.
    pub fn drawn_points(&self) -> &[Point] {
        match self {
            Self::Drawn { points, .. } => points,
            _ => &[],
        }
    }

    /// Length of the drawing, m; zero for a formula.
    pub fn drawn_length(&self) -> f64 {
        let pairs = self.drawn_points().windows(2);
        pairs.map(|pair| (pair[1] - pair[0]).norm()).sum()
    }

    /// The pattern, without a lead-in.
    ///
    /// # Errors
    /// The curve has no length, or is too sharp for the deviation.
    pub fn pattern(&self) -> Result<Pattern, PatternError> {
        match self {
            Self::Line(line) => Pattern::new(Box::new(*line), 0.0),
            Self::Circle(circle) => Pattern::new(Box::new(*circle), 0.0),
            Self::Sine(sine) => Pattern::new(Box::new(*sine), 0.0),
            Self::Drawn { points, deviation } => Pattern::along(points, *deviation),
        }
    }
}

/// Size and direction of a drawing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drawing {
    /// Length of its longer side, m; `None` keeps the drawn size.
    pub size: Option<f64>,
    /// Whether the pattern runs from its last point to the first.
    pub reverse: bool,
}

impl Drawing {
    /// The points of a drawing, with the given size and direction.
    ///
    /// # Errors
    /// The drawing has no extent that could be scaled.
    pub fn of(&self, mut points: Vec<Point>) -> Result<Vec<Point>, PatternError> {
        if self.reverse {
            points.reverse();
        }
        let (Some(size), false) = (self.size, points.is_empty()) else {
            return Ok(points);
        };
        let [low, high] = bounds(&points);
        let side = (high - low).max();
        if !(side > 0.0) {
            return Err(PatternError::Degenerate("it has no length"));
        }
        for point in &mut points {
            *point *= size / side;
        }
        Ok(points)
    }
}

/// The stroke with a number, counted from 1; without a number, the only stroke.
///
/// # Errors
/// There are several strokes and no number, or fewer than the number.
pub fn chosen_stroke(
    mut strokes: Vec<Stroke>,
    wanted: Option<usize>,
) -> Result<Vec<Point>, PatternError> {
    let count = strokes.len();
    match wanted {
        None if count == 1 => Ok(strokes.remove(0)),
        None => Err(PatternError::SeveralStrokes {
            count,
            list: String::new(),
        }),
        Some(wanted) if (1..=count).contains(&wanted) => Ok(strokes.remove(wanted - 1)),
        Some(wanted) => Err(PatternError::NoStroke { wanted, count }),
    }
}
