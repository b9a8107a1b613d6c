//! Patterns: smooth curves in the plane that a rod is to follow.
//!
//! | file | what |
//! |---|---|
//! | `svg` | the strokes of an SVG drawing, metres |
//! | `spline` | a smooth curve along drawn points, within a deviation |
//! | `analytic` | line, circle and sine |
//! | `curve` | arc length, tangent, curvature and its derivatives |
//! | `bounds` | the bounding box of points |
//! | `source` | a formula or a drawing, in its size and direction |
//! | `lead_in`, `lead_out` | a start whose curvature grows from zero, and an end where it returns to zero |
//! | `check` | requirements of a pattern, and its self-crossings |

mod analytic;
mod bounds;
mod check;
mod curve;
mod lead_in;
mod lead_out;
mod source;
mod spline;
mod svg;

pub use analytic::{Circle, Line, Sine};
pub use bounds::bounds;
pub use check::{Crossing, crossings, crossings_of_two};
pub use curve::{PatternPoint, PlaneCurve};
pub use lead_in::LeadBend;
pub use source::{Drawing, PatternSource, chosen_stroke};
pub use spline::SmoothCurve;
pub use svg::{DrawnStroke, FilledArea, Stroke, StrokeChoice, SvgDrawing, read_svg};

use curve::ArcLength;
use lead_in::LeadIn;
use lead_out::LeadOut;
use thiserror::Error;

/// A point of the plane, m.
pub type Point = nalgebra::Vector2<f64>;

/// Reason why a drawing is not a pattern.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PatternError {
    /// The file is not SVG.
    #[error("it is not an SVG file: {0}")]
    Syntax(String),
    /// An attribute cannot be read.
    #[error("line {line}: <{element}>: {reason}")]
    Attribute {
        /// Line in the file.
        line: u32,
        /// Name of the element.
        element: String,
        /// The error.
        reason: String,
    },
    /// There is no path.
    #[error("it has no path{hint}")]
    NoPath {
        /// Advice.
        hint: &'static str,
    },
    /// There are several strokes.
    #[error("it has {count} strokes that do not join; choose one, `stroke` 1 to {count}{list}")]
    SeveralStrokes {
        /// Number of strokes.
        count: usize,
        /// The longest of them, one per line.
        list: String,
    },
    /// Several strokes, or none, have an id.
    #[error("id `{id}`: {found}")]
    StrokeId {
        /// The requested value.
        id: String,
        /// The strokes found, as text.
        found: String,
    },
    /// Strokes cannot be joined.
    #[error("{0} strokes are too many to be joined; allowed: {most} at most", most = StrokeChoice::MOST_JOINED)]
    TooManyToJoin(usize),
    /// There is no such stroke.
    #[error("no stroke {wanted}: the drawing has {count}")]
    NoStroke {
        /// The requested number, counted from 1.
        wanted: usize,
        /// The number of strokes.
        count: usize,
    },
    /// The curve has no length, or its points are not finite numbers.
    #[error("{0}")]
    Degenerate(&'static str),
    /// No smooth curve is close enough.
    #[error(
        "no smooth curve stays within {allowed_m} m of the drawing; the nearest found deviates by {least_m:.2e} m: \
         draw its corners round, or allow a larger `deviation`"
    )]
    Deviation {
        /// The allowed deviation, m.
        allowed_m: f64,
        /// The smallest deviation found, m.
        least_m: f64,
    },
}

/// A curve parametrised by arc length, with an optional lead-in and lead-out.
pub struct Pattern {
    curve: Box<dyn PlaneCurve>,
    arc_length: ArcLength,
    lead_in: Option<LeadIn>,
    end: Option<f64>,
    lead_out: Option<LeadOut>,
    /// Largest distance of the curve from the drawn points, m; zero for analytic curves.
    pub deviation: f64,
}

impl Pattern {
    /// The pattern of a curve.
    ///
    /// # Errors
    /// The curve has no length, or its derivative is zero somewhere.
    pub fn new(curve: Box<dyn PlaneCurve>, deviation: f64) -> Result<Self, PatternError> {
        let arc_length = ArcLength::of(&*curve)?;
        Ok(Self {
            curve,
            arc_length,
            lead_in: None,
            end: None,
            lead_out: None,
            deviation,
        })
    }

    /// The pattern along drawn points, with at most the deviation `deviation`, m.
    ///
    /// # Errors
    /// The points have no length, or their corners are too sharp for this deviation.
    pub fn along(points: &[Point], deviation: f64) -> Result<Self, PatternError> {
        let (curve, reached) = SmoothCurve::along(points, deviation)?;
        Self::new(Box::new(curve), reached)
    }

    /// Adds a lead-in before the pattern. Over its length (m) the curvature and its first two
    /// derivatives change from zero to those of the first point (thesis 5.5.4.1).
    pub fn with_lead_in(self, length: f64) -> Self {
        self.with_straight_lead_in(0.0, length)
    }

    /// Adds a lead-in before the pattern that is straight over a length, m, before its curvature
    /// grows over the length `bent`, m.
    pub fn with_straight_lead_in(mut self, straight: f64, bent: f64) -> Self {
        (self.lead_in, self.lead_out) = (None, None);
        let start = self.at(0.0);
        self.lead_in = (straight + bent > 0.0).then(|| LeadIn::new(&start, straight, bent));
        self
    }

    /// Length of the lead-in, m.
    pub fn lead_in(&self) -> f64 {
        self.lead_in.as_ref().map_or(0.0, LeadIn::length)
    }

    /// Adds a lead-out with a length, m, after the end. The curvature decreases to zero over the
    /// length `bent`, m, in the same way as it grows in a lead-in; the rest is straight.
    pub fn with_lead_out(mut self, bent: f64, length: f64) -> Self {
        self.lead_out = None;
        let last = self.at(self.length());
        self.lead_out = (length > 0.0).then(|| LeadOut::new(&last, bent, length));
        self
    }

    /// Length of the lead-out, m.
    pub fn lead_out(&self) -> f64 {
        self.lead_out
            .as_ref()
            .map_or(0.0, |lead_out| lead_out.length)
    }

    /// Cuts the pattern at a length, m, which includes the lead-in, unless the pattern is shorter.
    /// The lead-out is removed.
    pub fn shortened(mut self, length: f64) -> Self {
        self.end = Some(length);
        self.lead_out = None;
        self
    }

    /// Total length including lead-in and lead-out, m.
    pub fn length(&self) -> f64 {
        let whole = self.lead_in() + self.arc_length.total();
        self.end.map_or(whole, |end| end.min(whole)) + self.lead_out()
    }

    /// The point at an arc length, m, from 0 to the length.
    pub fn at(&self, s: f64) -> PatternPoint {
        let lead = self.lead_in();
        match (&self.lead_in, &self.lead_out) {
            (_, Some(lead_out)) if s > self.length() - lead_out.length => lead_out.at(s),
            (Some(lead_in), _) if s < lead => lead_in.at(s),
            _ => {
                let mut point = self.arc_length.at(&*self.curve, s - lead);
                point.s = s;
                point
            }
        }
    }

    /// Points at equal distances of at most `step`, m, including both ends; angles are continuous.
    pub fn sampled(&self, step: f64) -> Vec<PatternPoint> {
        let length = self.length();
        let intervals = (length / step - 1e-9).ceil().max(1.0) as usize;
        let mut points: Vec<PatternPoint> = Vec::with_capacity(intervals + 1);
        for index in 0..=intervals {
            let mut point = self.at(length * index as f64 / intervals as f64);
            if let Some(before) = points.last() {
                let turns = ((before.angle - point.angle) / std::f64::consts::TAU).round();
                point.angle += turns * std::f64::consts::TAU;
            }
            points.push(point);
        }
        points
    }
}

#[cfg(test)]
mod tests;
