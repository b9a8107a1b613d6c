//! Strokes of SVG drawings (SVG 1.1, chapters 7 to 9): visible paths and basic shapes, in metres.
//!
//! | file | what |
//! |---|---|
//! | `visible` | visible shapes and letters, and their positions |
//! | `shape`, `path_data` | the outline of a shape |
//! | `units` | lengths, and the size of the page |
//! | `styled` | transforms in styles that cannot be read |
//! | `area` | filled areas and their thickness |
//! | `clip` | parts of a stroke inside a clip |
//! | `strokes` | selection and joining of strokes |

mod area;
mod clip;
mod path_data;
mod shape;
mod strokes;
mod styled;
mod units;
mod visible;

use super::{PatternError, Point};
pub use area::FilledArea;
use kurbo::{BezPath, Shape};
use roxmltree::{Document, Node, ParsingOptions};
pub use strokes::StrokeChoice;
use units::Page;
use visible::{Form, Seen, Visible};

/// Largest deviation of chords from curves, relative to the size of the stroke.
const FLATNESS: f64 = 1e-6;
/// Largest gap across which strokes are joined, relative to the size of the drawing.
const GAP: f64 = 1e-6;
/// Largest size of a path, m.
const LARGEST: f64 = 1000.0;
/// Smallest drawing, m; smaller ones count as points.
const SMALLEST: f64 = 1e-9;
/// Maximum number of elements of a file.
const MOST_NODES: u32 = 1_000_000;
/// Maximum number of points of all strokes of a drawing: the ends of the chords of its curves.
const MOST_POINTS: usize = 1_000_000;
/// Maximum nesting of groups.
const DEEPEST: usize = 200;
/// Smallest fraction of the page that a background covers in each direction.
const BACKGROUND: f64 = 0.99;
/// Maximum number of messages about single elements.
const MOST_NOTES: usize = 10;

/// A line drawn without lifting the pen: points in metres, y upwards. Curves are replaced by chords
/// within a millionth.
pub type Stroke = Vec<Point>;

/// A stroke and the element that draws it.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnStroke {
    /// The points, m.
    pub points: Stroke,
    /// `id` of the element, or of a group around it.
    pub id: Option<String>,
    /// Line of the element in the file.
    pub line: u32,
    /// Name of the element.
    pub element: String,
    /// Whether it is the closed outline of a filled area without a line of its own.
    pub is_outline: bool,
    /// Whether it is filled and covers the whole page.
    pub is_background: bool,
}

/// The strokes of a drawing in the order of the file. Strokes that end at the start of the next
/// one are joined.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SvgDrawing {
    /// The strokes.
    pub strokes: Vec<DrawnStroke>,
    /// Messages about ignored parts and assumptions.
    pub notes: Vec<String>,
}

/// The strokes of a drawing, see [`SvgDrawing::read`].
///
/// # Errors
/// [`PatternError`]: not SVG, an attribute that cannot be read, no path, or an element that is not
/// a path.
pub fn read_svg(text: &str) -> Result<Vec<Stroke>, PatternError> {
    let drawing = SvgDrawing::read(text)?;
    Ok(drawing
        .strokes
        .into_iter()
        .map(|stroke| stroke.points)
        .collect())
}

impl SvgDrawing {
    /// Reads the visible strokes of a drawing.
    ///
    /// The size of the drawing (`width`, `height`, `viewBox`) gives the length of a unit; by
    /// default it is 1/96 inch. The origin is the lower left corner of the view box, or of the
    /// first unit. Elements that cannot be read are ignored with a message.
    ///
    /// # Errors
    /// [`PatternError`]: not SVG, a page without a length, no path, or none that can be read.
    pub fn read(text: &str) -> Result<Self, PatternError> {
        let options = ParsingOptions {
            // Editors write document types; entities in other files are never read.
            allow_dtd: true,
            nodes_limit: MOST_NODES,
            ..ParsingOptions::default()
        };
        let document = Document::parse_with_options(text, options)
            .map_err(|error| PatternError::Syntax(error.to_string()))?;
        let root = document.root_element();
        if root.tag_name().name() != "svg" {
            return Err(PatternError::Syntax(format!(
                "its root is <{}>, expected <svg>",
                root.tag_name().name()
            )));
        }
        let mut notes = Vec::new();
        let page = Page::of(root, &mut notes)?;
        let shapes = visible::shapes(&document);
        let is_deep = |node: &&Node| node.ancestors().nth(DEEPEST + 2).is_some();
        if let Some(deep) = shapes.iter().find(is_deep) {
            return Err(fault(*deep, "g", "groups are nested too deeply").into());
        }
        let texts = visible::texts(&document);
        let visible = Visible::of(text, &document, &shapes, &texts, &page)?;
        let mut reader = Reader {
            lines: Lines::new(text),
            page,
            shapes,
            texts,
            visible,
            strokes: Vec::new(),
            points: 0,
            faults: Vec::new(),
        };
        reader.draw_all()?;
        notes.extend(reader.choose_text());
        let Reader {
            strokes,
            faults,
            lines,
            ..
        } = reader;
        let elements = || document.descendants().filter(Node::is_element);
        if strokes.is_empty() {
            if let Some(fault) = faults.into_iter().next() {
                return Err(fault.into());
            }
            let mut hints = elements().filter_map(|node| hint(node.tag_name().name()));
            let hint = hints.next_back().unwrap_or_default();
            return Err(PatternError::NoPath { hint });
        }
        let count = faults.len();
        notes.extend(faults.into_iter().take(MOST_NOTES).map(|fault| {
            format!(
                "line {}: <{}>: {}; the rest of the element is ignored",
                fault.line, fault.element, fault.reason
            )
        }));
        if count > MOST_NOTES {
            notes.push(format!(
                "{} more elements cannot be read",
                count - MOST_NOTES
            ));
        }
        let ignored = elements().flat_map(|node| {
            let messages = styled::unreadable_transforms(node).into_iter();
            let (line, name) = (lines.of(node), node.tag_name().name());
            messages.map(move |message| format!("line {line}: <{name}>: {message}"))
        });
        notes.extend(ignored.take(MOST_NOTES));
        Ok(Self {
            strokes: joined(strokes),
            notes,
        })
    }
}

/// Advice for a drawing with only elements of this name.
fn hint(name: &str) -> Option<&'static str> {
    match name {
        "text" => Some("; its text has no visible letters"),
        "image" => Some("; rodlab trace finds lines in images"),
        _ => None,
    }
}

/// Starts of the lines of a text.
struct Lines(Vec<usize>);

impl Lines {
    fn new(text: &str) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        Self(ends.map(|(end, _)| end).collect())
    }

    /// The line of an element, from 1.
    fn of(&self, node: Node) -> u32 {
        let start = node.range().start;
        u32::try_from(self.0.partition_point(|end| *end < start) + 1).unwrap_or(u32::MAX)
    }
}

/// Whether a filled line surrounds an area that is visible at the size of its shape.
fn has_area(points: &[Point], size: f64) -> bool {
    let Some(first) = points.first() else {
        return false;
    };
    let sides = points.windows(2);
    let twice: f64 = sides
        .map(|side| (side[0] - first).perp(&(side[1] - first)))
        .sum();
    twice.abs() > FLATNESS * size * size
}

/// An unreadable part of an element.
#[derive(Clone, Debug, PartialEq)]
struct Fault {
    line: u32,
    element: String,
    reason: String,
}

impl From<Fault> for PatternError {
    fn from(fault: Fault) -> Self {
        let Fault {
            line,
            element,
            reason,
        } = fault;
        Self::Attribute {
            line,
            element,
            reason,
        }
    }
}

fn fault(node: Node, attribute: &str, reason: impl std::fmt::Display) -> Fault {
    let position = node.document().text_pos_at(node.range().start);
    Fault {
        line: position.row,
        element: node.tag_name().name().to_owned(),
        reason: format!("{attribute}: {reason}"),
    }
}

struct Reader<'a> {
    lines: Lines,
    page: Page,
    shapes: Vec<Node<'a, 'a>>,
    texts: Vec<Node<'a, 'a>>,
    visible: Visible,
    strokes: Vec<DrawnStroke>,
    /// Points of all strokes so far.
    points: usize,
    faults: Vec<Fault>,
}

impl Reader<'_> {
    fn draw_all(&mut self) -> Result<(), PatternError> {
        for seen in std::mem::take(&mut self.visible.seen) {
            let node = match &seen.form {
                Form::Shape(shape) => self.shapes.get(*shape),
                Form::Letters(text, _) => self.texts.get(*text),
            };
            let Some(node) = node.copied() else {
                continue;
            };
            let is_marker = |above: Node| above.tag_name().name() == "marker";
            if !node.ancestors().any(is_marker) {
                self.draw(node, &seen)?;
            }
        }
        Ok(())
    }

    /// Leaves out text beside other strokes, such as a label of a line; returns messages about text.
    fn choose_text(&mut self) -> Vec<String> {
        let is_text = |stroke: &DrawnStroke| stroke.element == "text";
        let mut strokes = self.strokes.iter();
        let is_beside = strokes.any(|stroke| !is_text(stroke) && !stroke.is_background);
        let mut letters = self.strokes.iter().filter(|stroke| is_text(stroke));
        if let (true, Some(first)) = (is_beside, letters.next()) {
            let note = format!(
                "line {}: <text> is left out beside other strokes; to follow it make it into paths (Inkscape: Path, Object to Path)",
                first.line
            );
            self.strokes.retain(|stroke| !is_text(stroke));
            return vec![note];
        }
        let fonts = self.visible.fonts.iter().filter_map(|(text, family)| {
            let line = self.lines.of(*self.texts.get(*text)?);
            Some(format!("line {line}: <text> is drawn in the font {family}"))
        });
        fonts.collect()
    }

    /// The outline of a shape or of letters on the page, m.
    fn outline(&mut self, node: Node, seen: &Seen) -> Option<BezPath> {
        let outline = match &seen.form {
            Form::Letters(_, letters) => return Some(self.page.to_metres * seen.place * letters),
            Form::Shape(_) => shape::outline(node).unwrap_or_else(|(fault, before)| {
                self.faults.push(fault);
                Some(before)
            }),
        };
        match visible::exact(node, &self.page, seen.place) {
            Ok(place) => Some(self.page.to_metres * place * outline?),
            Err(fault) => {
                self.faults.push(fault);
                None
            }
        }
    }

    /// Adds the strokes of a shape.
    fn draw(&mut self, node: Node, seen: &Seen) -> Result<(), PatternError> {
        let Some(path) = self.outline(node, seen) else {
            return Ok(());
        };
        let bounds = path.bounding_box();
        let size = bounds.size().max_side();
        if !path.is_finite() || !(size <= LARGEST) {
            self.faults
                .push(fault(node, "d", format!("it is larger than {LARGEST} m")));
            return Ok(());
        }
        // The shape is a point. If squares of the tolerance underflow, there would be endless
        // chords.
        if size < SMALLEST {
            return Ok(());
        }
        let is_background = seen.is_filled && {
            let [width, height] = self.page.viewport;
            let [x, y] = self.page.corner;
            let sheet = kurbo::Rect::new(x, y, x + width, y + height);
            let sheet = self.page.to_metres.transform_rect_bbox(sheet);
            let common = bounds.intersect(sheet).size();
            common.width >= BACKGROUND * sheet.width()
                && common.height >= BACKGROUND * sheet.height()
        };
        // Converts one subpath at a time, so that a drawing with too many points is rejected
        // before all of them are computed.
        for elements in path
            .elements()
            .chunk_by(|_, next| !matches!(next, kurbo::PathEl::MoveTo(_)))
        {
            let points = self.flattened(node, elements, FLATNESS * size)?;
            if seen.has_hidden_line && !has_area(&points, size) {
                continue;
            }
            for points in self.clipped(points, seen, FLATNESS * size) {
                // Arcs may end a rounding error beside their start.
                let gap = points[points.len() - 1] - points[0];
                let is_closed = gap.norm() <= FLATNESS * size;
                self.strokes.push(DrawnStroke {
                    id: id_of(node),
                    line: self.lines.of(node),
                    element: node.tag_name().name().to_owned(),
                    is_outline: seen.is_filled && is_closed,
                    is_background,
                    points,
                });
            }
        }
        Ok(())
    }

    /// A subpath as chords that deviate by at most `tolerance`; empty if the subpath has no
    /// length.
    fn flattened(
        &mut self,
        node: Node,
        elements: &[kurbo::PathEl],
        tolerance: f64,
    ) -> Result<Stroke, PatternError> {
        let mut stroke: Stroke = Vec::new();
        let room = MOST_POINTS.saturating_sub(self.points);
        let mut count = 0;
        kurbo::flatten(elements.iter().copied(), tolerance, |element| {
            count += 1;
            let point = match element {
                kurbo::PathEl::MoveTo(to) | kurbo::PathEl::LineTo(to) => Point::new(to.x, to.y),
                kurbo::PathEl::ClosePath if !stroke.is_empty() => stroke[0],
                _ => return,
            };
            if count <= room {
                stroke.push(point);
            }
        });
        self.points += count;
        if count > room {
            return Err(fault(
                node,
                "d",
                format!(
                    "the curves of the drawing need more than {MOST_POINTS} points; allowed: at \
                     most that. Simplify the drawing"
                ),
            )
            .into());
        }
        stroke.dedup();
        stroke.shrink_to_fit();
        Ok(stroke)
    }

    /// The parts of a shape's stroke inside the clips that apply to it.
    fn clipped(&self, stroke: Stroke, seen: &Seen, flatness: f64) -> Vec<Stroke> {
        let mut pieces = vec![stroke];
        pieces.retain(|piece| piece.len() > 1);
        for index in &seen.clips {
            let clip = &self.visible.clips[*index];
            let shapes = clip.shapes.iter().filter_map(|(shape, place)| {
                let node = *self.shapes.get(*shape)?;
                let outline = shape::outline(node).ok().flatten()?;
                Some(*place * outline)
            });
            let frames = clip.frames.iter().cloned();
            let area: Vec<BezPath> = shapes
                .chain(frames)
                .map(|path| self.page.to_metres * path)
                .collect();
            let cut = |piece: Stroke| {
                clip::clipped(&piece, &area, flatness).unwrap_or_else(|| vec![piece])
            };
            pieces = pieces.into_iter().flat_map(cut).collect();
        }
        pieces
    }
}

/// The `id` of an element, or of the innermost group around it that has one.
fn id_of(node: Node) -> Option<String> {
    let root = node.document().root_element();
    let mut inside = node.ancestors().take_while(|above| *above != root);
    inside
        .find_map(|above| above.attribute("id"))
        .map(str::to_owned)
}

/// Joins strokes that start at the end of the previous one.
fn joined(strokes: Vec<DrawnStroke>) -> Vec<DrawnStroke> {
    let first = strokes[0].points[0];
    let all = || strokes.iter().flat_map(|stroke| &stroke.points);
    let size = all().fold(0.0, |size: f64, point| size.max((point - first).norm()));
    let mut whole: Vec<DrawnStroke> = Vec::new();
    for stroke in strokes {
        match whole.last_mut() {
            Some(before)
                if before.is_background == stroke.is_background
                    && (before.points[before.points.len() - 1] - stroke.points[0]).norm()
                        <= GAP * size =>
            {
                before.points.extend_from_slice(&stroke.points[1..]);
                before.is_outline &= stroke.is_outline;
            }
            _ => whole.push(stroke),
        }
    }
    whole
}

#[cfg(test)]
mod tests;
