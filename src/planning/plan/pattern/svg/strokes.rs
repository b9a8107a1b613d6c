//! Selection of the stroke of a drawing, and joining of strokes across gaps.

use super::{DrawnStroke, SvgDrawing};
use crate::plan::pattern::{PatternError, Point};
use std::convert::Infallible;
use std::fmt::{self, Write};
use std::str::FromStr;

/// Maximum number of strokes listed in a message.
const LISTED: usize = 10;

/// Selection of a stroke of a drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum StrokeChoice {
    /// The only stroke, apart from the background of the page.
    #[default]
    Only,
    /// The stroke with a number, counted from 1.
    Number(usize),
    /// The stroke of an element with this `id`.
    Id(String),
    /// The longest one.
    Longest,
}

impl StrokeChoice {
    /// Maximum number of strokes that are joined.
    pub const MOST_JOINED: usize = 5000;
}

impl FromStr for StrokeChoice {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        let text = text.trim();
        Ok(match (text.parse(), text) {
            (Ok(number), _) => Self::Number(number),
            (_, "longest") => Self::Longest,
            _ => Self::Id(text.into()),
        })
    }
}

impl fmt::Display for StrokeChoice {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Only => formatter.write_str("only"),
            Self::Number(number) => write!(formatter, "{number}"),
            Self::Id(id) => formatter.write_str(id),
            Self::Longest => formatter.write_str("longest"),
        }
    }
}

impl DrawnStroke {
    /// Length, m.
    pub fn length(&self) -> f64 {
        let pairs = self.points.windows(2);
        pairs.map(|pair| (pair[1] - pair[0]).norm()).sum()
    }

    /// First and last point, m.
    pub(super) fn ends(&self) -> [Point; 2] {
        [self.points[0], self.points[self.points.len() - 1]]
    }
}

impl SvgDrawing {
    /// The number of the selected stroke, counted from 1.
    ///
    /// # Errors
    /// There are several strokes, or none is selected.
    pub fn choose(&self, choice: &StrokeChoice) -> Result<usize, PatternError> {
        let count = self.strokes.len();
        let numbered = || self.strokes.iter().zip(1..);
        let drawn = || numbered().filter(|(stroke, _)| !stroke.is_background);
        match choice {
            StrokeChoice::Number(number) if (1..=count).contains(number) => Ok(*number),
            StrokeChoice::Number(wanted) => Err(PatternError::NoStroke {
                wanted: *wanted,
                count,
            }),
            StrokeChoice::Only => {
                let mut candidates = drawn().map(|(_, number)| number);
                match (candidates.next(), candidates.next()) {
                    (Some(only), None) => Ok(only),
                    _ if count == 1 => Ok(1),
                    _ => Err(PatternError::SeveralStrokes {
                        count,
                        list: self.list(),
                    }),
                }
            }
            StrokeChoice::Longest => {
                let mut lengths: Vec<_> = drawn().collect();
                if lengths.is_empty() {
                    lengths = numbered().collect();
                }
                // The first of equal ones.
                let longest = lengths
                    .iter()
                    .rev()
                    .max_by(|(one, _), (other, _)| one.length().total_cmp(&other.length()));
                Ok(longest.map_or(1, |(_, number)| *number))
            }
            StrokeChoice::Id(id) => {
                let found: Vec<usize> = numbered()
                    .filter(|(stroke, _)| stroke.id.as_deref() == Some(id))
                    .map(|(_, number)| number)
                    .collect();
                let found = match found[..] {
                    [only] => return Ok(only),
                    [] => format!("no stroke has this id; the strokes:{}", self.list()),
                    _ => format!(
                        "{} strokes have this id; choose one by its number: {}",
                        found.len(),
                        enumerated(&found)
                    ),
                };
                Err(PatternError::StrokeId {
                    id: id.clone(),
                    found,
                })
            }
        }
    }

    /// Joins strokes whose ends are at most `gap` apart, m, in any order and direction, starting
    /// with the first stroke. If several ends are near, the nearest one is joined.
    ///
    /// # Errors
    /// There are too many strokes.
    pub fn joined(mut self, gap: f64) -> Result<Self, PatternError> {
        if self.strokes.len() > StrokeChoice::MOST_JOINED {
            return Err(PatternError::TooManyToJoin(self.strokes.len()));
        }
        let (mut rest, background): (Vec<_>, Vec<_>) = std::mem::take(&mut self.strokes)
            .into_iter()
            .partition(|stroke| !stroke.is_background);
        rest.reverse();
        while let Some(mut chain) = rest.pop() {
            while let Some((index, at_end, turned)) = nearest(&chain, &rest, gap) {
                let mut next = rest.remove(index);
                if turned {
                    next.points.reverse();
                }
                if !at_end {
                    std::mem::swap(&mut chain.points, &mut next.points);
                }
                chain.is_outline &= next.is_outline;
                let meets = chain.points.last() == next.points.first();
                chain
                    .points
                    .extend_from_slice(&next.points[usize::from(meets)..]);
            }
            self.strokes.push(chain);
        }
        self.strokes.extend(background);
        Ok(self)
    }

    /// The smallest gap, m, that joins all strokes to one; `None` if they are too far apart, or
    /// too many.
    pub fn gap_that_joins(&self) -> Option<f64> {
        const MOST: usize = 200;
        if self.strokes.len() > MOST {
            return None;
        }
        let lengths = self.strokes.iter().filter(|stroke| !stroke.is_background);
        let whole: f64 = lengths.map(DrawnStroke::length).sum();
        let count = |gap: f64| {
            let joined = self.clone().joined(gap).ok()?;
            Some(
                joined
                    .strokes
                    .iter()
                    .filter(|stroke| !stroke.is_background)
                    .count(),
            )
        };
        // Candidates for the gap: 1, 2 and 5 times powers of ten, m, up to a tenth of the drawing.
        let gaps = (-5..0)
            .flat_map(|power| [1.0, 2.0, 5.0].map(|first| first * libm::exp10(f64::from(power))));
        gaps.take_while(|gap| *gap <= 0.1 * whole)
            .find(|gap| count(*gap) == Some(1))
    }

    /// The longest strokes, one per line, with a count of the rest.
    pub fn list(&self) -> String {
        let mut longest: Vec<(f64, usize, &DrawnStroke)> = self
            .strokes
            .iter()
            .zip(1..)
            .map(|(stroke, number)| (stroke.length(), number, stroke))
            .collect();
        longest.sort_by(|one, other| other.0.total_cmp(&one.0));
        let mut text = String::new();
        for (length, number, stroke) in longest.iter().take(LISTED) {
            let [from, to] = stroke.ends().map(|end| {
                let [x, y] = [end.x, end.y].map(millimetres);
                format!("({x}, {y})")
            });
            let id = stroke
                .id
                .as_ref()
                .map_or(String::new(), |id| format!(", id `{id}`"));
            let kind = match (stroke.is_background, stroke.is_outline) {
                (true, _) => ", background",
                (_, true) => ", outline of a filled area",
                _ => "",
            };
            let _ = write!(
                text,
                "\n  {number}: {} mm long, from {from} to {to} mm, line {}, <{}>{id}{kind}",
                millimetres(*length),
                stroke.line,
                stroke.element
            );
        }
        if let Some(more) = longest.len().checked_sub(LISTED).filter(|more| *more > 0) {
            let _ = write!(text, "\n  and {more} more, each at most as long as these");
        }
        text
    }
}

/// The end of another stroke that is nearest to an end of a chain. Returns its index, whether the
/// end is at the last point of the chain, and whether the stroke must be reversed.
fn nearest(chain: &DrawnStroke, rest: &[DrawnStroke], gap: f64) -> Option<(usize, bool, bool)> {
    let [first, last] = chain.ends();
    let mut best: Option<(f64, (usize, bool, bool))> = None;
    // The remaining strokes are in reverse order. Of equally near strokes the first one in the
    // drawing is used, after the chain if possible.
    for (index, stroke) in rest.iter().enumerate().rev() {
        let [start, end] = stroke.ends();
        for (distance, place) in [
            (start - last, (index, true, false)),
            (end - last, (index, true, true)),
            (end - first, (index, false, false)),
            (start - first, (index, false, true)),
        ] {
            let distance = distance.norm();
            if distance <= gap && best.is_none_or(|(least, _)| distance < least) {
                best = Some((distance, place));
            }
        }
    }
    best.map(|(_, place)| place)
}

/// A length in millimetres, with one decimal or three significant digits.
fn millimetres(metres: f64) -> String {
    let value = 1e3 * metres + 0.0;
    match value.abs() {
        size if size >= 0.1 || size == 0.0 => format!("{value:.1}"),
        _ => format!("{value:.1e}"),
    }
}

fn enumerated(numbers: &[usize]) -> String {
    let listed = numbers.iter().take(LISTED).map(ToString::to_string);
    let mut text = listed.collect::<Vec<_>>().join(", ");
    if numbers.len() > LISTED {
        text += ", …";
    }
    text
}
