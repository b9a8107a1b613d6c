//! Strokes of SVG drawings (SVG 1.1, chapters 7 to 9): paths and basic shapes, through transforms, in metres.

use super::path_data::bezier_path;
use super::{PatternError, Point};
use kurbo::{Affine, BezPath, Ellipse, Rect, Shape};
use roxmltree::{Document, Node, ParsingOptions};
use std::str::FromStr;
use svgtypes::{Length, LengthUnit, Transform, ViewBox};

/// A user unit without a size of the drawing, m: 1/96 inch.
const PIXEL: f64 = 0.0254 / 96.0;
/// Chords of curves miss them by at most this, over the size of the stroke.
const FLATNESS: f64 = 1e-6;
/// Gaps over which strokes join, over the size of the drawing.
const GAP: f64 = 1e-6;
/// Largest size of a path, m.
const LARGEST: f64 = 1000.0;
/// Smallest drawing, m; what is smaller is a point.
const SMALLEST: f64 = 1e-9;
/// Most elements of a file.
const MOST_NODES: u32 = 1_000_000;
/// Most points of all strokes of a drawing: the chords of its curves.
const MOST_POINTS: usize = 1_000_000;
/// Deepest nesting of groups.
const DEEPEST: usize = 200;

/// A line drawn without lifting the pen: points in metres, y upwards. Curves are chords that miss them by a millionth.
pub type Stroke = Vec<Point>;

/// The strokes of a drawing, in the order of the file; those that end where the next begins are joined.
///
/// The size of the drawing (`width`, `height`, `viewBox`) says how long a unit is; without, it is 1/96 inch. The origin
/// is the lower left corner of the view box, or of the first unit.
///
/// # Errors
/// [`PatternError`]: no SVG, an attribute that cannot be read, no path, or something that is no path.
pub fn read_svg(text: &str) -> Result<Vec<Stroke>, PatternError> {
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
    let mut reader = Reader {
        strokes: Vec::new(),
        points: 0,
        hint: "",
    };
    reader.children(root, view(root)?, 0)?;
    let Reader { strokes, hint, .. } = reader;
    if strokes.is_empty() {
        return Err(PatternError::NoPath { hint });
    }
    Ok(joined(strokes))
}

/// From user units to metres, y upwards.
fn view(root: Node) -> Result<Affine, PatternError> {
    let length = |name: &str| -> Result<Option<f64>, PatternError> {
        let Some(text) = root.attribute(name) else {
            return Ok(None);
        };
        let length = Length::from_str(text).map_err(|error| fault(root, name, error))?;
        let unit = match length.unit {
            LengthUnit::None | LengthUnit::Px => PIXEL,
            LengthUnit::In => 0.0254,
            LengthUnit::Cm => 0.01,
            LengthUnit::Mm => 0.001,
            LengthUnit::Pt => 0.0254 / 72.0,
            LengthUnit::Pc => 0.0254 / 6.0,
            LengthUnit::Percent => return Ok(None),
            LengthUnit::Em | LengthUnit::Ex => {
                return Err(fault(root, name, "font sizes are no sizes of a drawing"));
            }
        };
        let metres = length.number * unit;
        if metres > 0.0 && metres.is_finite() {
            Ok(Some(metres))
        } else {
            Err(fault(root, name, "must be above 0"))
        }
    };
    let (width, height) = (length("width")?, length("height")?);
    let Some(text) = root.attribute("viewBox") else {
        let bottom = height.unwrap_or(0.0);
        return Ok(Affine::new([PIXEL, 0.0, 0.0, -PIXEL, 0.0, bottom]));
    };
    let ViewBox { x, y, w, h } =
        ViewBox::from_str(text).map_err(|error| fault(root, "viewBox", error))?;
    if ![x, y, w, h].iter().all(|number| number.is_finite()) {
        return Err(fault(root, "viewBox", "its numbers must be finite"));
    }
    // As preserveAspectRatio has it unless it says otherwise.
    let scale = match (width, height) {
        (Some(width), Some(height)) => (width / w).min(height / h),
        (Some(width), None) => width / w,
        (None, Some(height)) => height / h,
        (None, None) => PIXEL,
    };
    Ok(Affine::new([
        scale,
        0.0,
        0.0,
        -scale,
        -scale * x,
        scale * (y + h),
    ]))
}

struct Reader {
    strokes: Vec<Stroke>,
    /// Points of all strokes so far.
    points: usize,
    hint: &'static str,
}

impl Reader {
    fn children(&mut self, node: Node, above: Affine, depth: usize) -> Result<(), PatternError> {
        if depth > DEEPEST {
            return Err(fault(node, "g", "groups are nested too deep"));
        }
        for child in node.children().filter(Node::is_element) {
            self.element(child, above, depth)?;
        }
        Ok(())
    }

    fn element(&mut self, node: Node, above: Affine, depth: usize) -> Result<(), PatternError> {
        let hidden = |style: &str| style.replace(' ', "").contains("display:none");
        if node.attribute("display") == Some("none") || node.attribute("style").is_some_and(hidden)
        {
            return Ok(());
        }
        let place = match node.attribute("transform") {
            None => above,
            Some(text) => {
                let Transform { a, b, c, d, e, f } =
                    Transform::from_str(text).map_err(|error| fault(node, "transform", error))?;
                above * Affine::new([a, b, c, d, e, f])
            }
        };
        let number = |name: &str| -> Result<f64, PatternError> {
            let text = node.attribute(name).unwrap_or("0");
            let length = Length::from_str(text).map_err(|error| fault(node, name, error))?;
            match length.unit {
                LengthUnit::None | LengthUnit::Px => Ok(length.number),
                _ => Err(fault(node, name, "only plain numbers are read here")),
            }
        };
        let path = match node.tag_name().name() {
            "g" | "a" | "switch" => return self.children(node, place, depth + 1),
            "path" => path(node, node.attribute("d").unwrap_or_default())?,
            "line" => {
                let mut path = BezPath::new();
                path.move_to((number("x1")?, number("y1")?));
                path.line_to((number("x2")?, number("y2")?));
                path
            }
            name @ ("polyline" | "polygon") => {
                let points = node.attribute("points").unwrap_or_default();
                let close = if name == "polygon" { " z" } else { "" };
                let empty = points.trim().is_empty();
                path(
                    node,
                    &if empty {
                        String::new()
                    } else {
                        format!("M {points}{close}")
                    },
                )?
            }
            "circle" => {
                let r = number("r")?;
                if !has_size(node, &[r])? {
                    return Ok(());
                }
                Ellipse::new((number("cx")?, number("cy")?), (r, r), 0.0).to_path(FLATNESS * r)
            }
            "ellipse" => {
                let radii = (number("rx")?, number("ry")?);
                if !has_size(node, &[radii.0, radii.1])? {
                    return Ok(());
                }
                let size = radii.0.max(radii.1);
                Ellipse::new((number("cx")?, number("cy")?), radii, 0.0).to_path(FLATNESS * size)
            }
            "rect" => {
                let (x, y) = (number("x")?, number("y")?);
                Rect::new(x, y, x + number("width")?, y + number("height")?).to_path(FLATNESS)
            }
            "text" => {
                self.hint = "; text must be made into paths first (Inkscape: Path, Object to Path)";
                return Ok(());
            }
            "image" => {
                self.hint = "; rodlab trace finds lines in images";
                return Ok(());
            }
            name @ ("use" | "svg") => {
                return Err(fault(
                    node,
                    name,
                    "is not followed; draw the path itself (Inkscape: Edit, Clone, Unlink)",
                ));
            }
            _ => return Ok(()),
        };
        self.draw(node, &(place * path))
    }

    /// Adds the strokes of a path.
    fn draw(&mut self, node: Node, path: &BezPath) -> Result<(), PatternError> {
        let size = path.bounding_box().size().max_side();
        if !path.is_finite() || !(size <= LARGEST) {
            return Err(fault(node, "d", format!("it is larger than {LARGEST} m")));
        }
        // A point; and so small that squares of the tolerance vanish, chords would be without number.
        if size < SMALLEST {
            return Ok(());
        }
        // Sub-path by sub-path, so that a drawing with too many points is refused before all of them are computed.
        for elements in path
            .elements()
            .chunk_by(|_, next| !matches!(next, kurbo::PathEl::MoveTo(_)))
        {
            self.draw_one(node, elements, FLATNESS * size)?;
        }
        Ok(())
    }

    /// Adds the strokes of a sub-path, with chords that miss it by at most `tolerance`.
    fn draw_one(
        &mut self,
        node: Node,
        elements: &[kurbo::PathEl],
        tolerance: f64,
    ) -> Result<(), PatternError> {
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
                    "the curves of the drawing need more than {MOST_POINTS} points; allowed: at most that. Simplify the drawing"
                ),
            ));
        }
        stroke.dedup();
        stroke.shrink_to_fit();
        if stroke.len() > 1 {
            self.strokes.push(stroke);
        }
        Ok(())
    }
}

/// Whether a circle or an ellipse of these radii is drawn: one without size is not.
fn has_size(node: Node, radii: &[f64]) -> Result<bool, PatternError> {
    // Squares of larger ones are no numbers.
    if !radii.iter().all(|radius| *radius < 1e100) {
        return Err(fault(node, "r", format!("it is larger than {LARGEST} m")));
    }
    Ok(radii.iter().all(|radius| *radius > 1e-100))
}

fn path(node: Node, data: &str) -> Result<BezPath, PatternError> {
    bezier_path(data).map_err(|error| fault(node, "d", error))
}

fn fault(node: Node, attribute: &str, reason: impl std::fmt::Display) -> PatternError {
    let position = node.document().text_pos_at(node.range().start);
    PatternError::Attribute {
        line: position.row,
        element: node.tag_name().name().to_owned(),
        reason: format!("{attribute}: {reason}"),
    }
}

/// Joins strokes that go on where the one before them ends.
fn joined(strokes: Vec<Stroke>) -> Vec<Stroke> {
    let all = || strokes.iter().flatten();
    let size = all().fold(0.0, |size: f64, point| {
        size.max((point - strokes[0][0]).norm())
    });
    let mut whole: Vec<Stroke> = Vec::new();
    for stroke in strokes {
        match whole.last_mut() {
            Some(before) if (before[before.len() - 1] - stroke[0]).norm() <= GAP * size => {
                before.extend_from_slice(&stroke[1..]);
            }
            _ => whole.push(stroke),
        }
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawings_without_size_are_no_drawings_and_take_no_memory() {
        for element in [
            "<path d='M0 0C1e-300 0 0 1e-300 1e-300 1e-300'/>",
            "<path d='M0 0a1e-320 1e-320 0 0 0 1e-320 0'/>",
            "<ellipse rx='-5' ry='0'/>",
            "<circle r='-1'/>",
            "<circle r='1e-200'/>",
        ] {
            let text = format!("<svg xmlns='http://www.w3.org/2000/svg'>{element}</svg>");
            assert!(
                matches!(read_svg(&text), Err(PatternError::NoPath { .. })),
                "{element}"
            );
        }
        let large = "<svg xmlns='http://www.w3.org/2000/svg'><ellipse rx='1e300' ry='1'/></svg>";
        let error = read_svg(large).unwrap_err().to_string();
        assert!(error.contains("larger than 1000 m"), "{error}");
    }
    #[test]
    fn drawings_with_too_many_points_and_deep_ones_are_refused() {
        let curve = "M0 0C900 100 100 900 1000 1000";
        let paths = format!("<path d='{}'/>", curve.repeat(20_000));
        let text = format!("<svg xmlns='http://www.w3.org/2000/svg'>{paths}</svg>");
        let error = read_svg(&text).unwrap_err().to_string();
        assert!(error.contains("more than 1000000 points"), "{error}");
        for name in ["g", "b"] {
            let nested =
                format!("<{name}>").repeat(100_000) + &format!("</{name}>").repeat(100_000);
            let text = format!("<svg xmlns='http://www.w3.org/2000/svg'>{nested}</svg>");
            assert!(read_svg(&text).is_err(), "{name}");
        }
    }

    use proptest::prelude::*;
    use std::f64::consts::TAU;

    fn drawing(content: &str) -> Result<Vec<Stroke>, PatternError> {
        read_svg(&format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"10cm\" height=\"10cm\" viewBox=\"0 0 100 100\">{content}</svg>"
        ))
    }

    fn length(stroke: &Stroke) -> f64 {
        stroke
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).norm())
            .sum()
    }

    #[test]
    fn units_and_the_view_box_say_how_long_a_unit_is() {
        let stroke = &drawing("<path d=\"M10,20 h30\"/>").unwrap()[0];
        assert!((stroke[0] - Point::new(0.01, 0.08)).norm() < 1e-15);
        assert!((stroke[1] - Point::new(0.04, 0.08)).norm() < 1e-15);
        let bare = "<svg xmlns=\"http://www.w3.org/2000/svg\"><line x2=\"96\"/></svg>";
        assert!((length(&read_svg(bare).unwrap()[0]) - 0.0254).abs() < 1e-15);
        let inches = "<svg width=\"2in\" viewBox=\"-5 0 4 4\"><line x2=\"1\"/></svg>";
        let stroke = &read_svg(inches).unwrap()[0];
        assert!((stroke[0] - Point::new(5.0 * 0.0127, 4.0 * 0.0127)).norm() < 1e-15);
    }

    #[test]
    fn arcs_beziers_and_shapes_have_their_lengths() {
        for (content, expected) in [
            ("<path d=\"M10 50 A 20 20 0 0 1 50 50\"/>", TAU * 0.01),
            ("<circle cx=\"50\" cy=\"50\" r=\"20\"/>", TAU * 0.02),
            ("<rect x=\"1\" y=\"2\" width=\"30\" height=\"10\"/>", 0.08),
            ("<polygon points=\"0,0 30,0 30,40\"/>", 0.12),
            // A parabola: ∫√(1 + 4x²) dx over [−1, 1], times 10 mm.
            ("<path d=\"M10 10 Q 20 -10 30 10\"/>", 0.029_578_857_150_89),
        ] {
            let strokes = drawing(content).unwrap();
            assert_eq!(strokes.len(), 1, "{content}");
            let found = length(&strokes[0]);
            assert!((found / expected - 1.0).abs() < 1e-5, "{content}: {found}");
        }
    }

    #[test]
    fn transforms_nest() {
        let strokes = drawing(
            "<g transform=\"translate(50 50)\"><g transform=\"rotate(90) scale(2)\"><path d=\"M0 0 L10 0\"/></g></g>",
        );
        let stroke = &strokes.unwrap()[0];
        // y points down in the drawing: a quarter turn from x there is down here.
        assert!((stroke[1] - Point::new(0.05, 0.03)).norm() < 1e-15);
    }

    #[test]
    fn strokes_that_touch_are_one() {
        let joined =
            "<path d=\"M0 0 L10 0 M10 0 L10 10\"/><line x1=\"10\" y1=\"10\" x2=\"0\" y2=\"20\"/>";
        assert_eq!(drawing(joined).unwrap().len(), 1);
        assert_eq!(
            drawing("<path d=\"M0 0 L10 0 M0 5 L10 10\"/>")
                .unwrap()
                .len(),
            2
        );
    }

    #[test]
    fn what_is_no_path_is_named() {
        let message = |content: &str| drawing(content).unwrap_err().to_string();
        assert!(message("<text>A</text>").contains("text must be made into paths"));
        assert!(message("").contains("no path"));
        assert!(message("<path d=\"M0 0\"/>").contains("no path"));
        assert!(message("<path d=\"M0 0 L0 0\"/>").contains("no path"));
        let broken = message("\n<path d=\"M0 0 L10 x\"/>");
        assert!(broken.contains("line 2: <path>: d:"), "{broken}");
        assert!(message("<path d=\"M0 0 L1e999 0\"/>").contains("line 1: <path>: d:"));
        assert!(
            message("<path d=\"M0 0 L1e308 1e308 L-1e308 0\"/>").contains("larger than 1000 m")
        );
        assert!(message("<path transform=\"turn(3)\" d=\"M0 0 L1 0\"/>").contains("transform"));
        assert!(message("<use href=\"#a\"/>").contains("not followed"));
        assert!(
            read_svg("<html/>")
                .unwrap_err()
                .to_string()
                .contains("<html>")
        );
        assert!(read_svg("no xml").is_err());
        let entity = "<!DOCTYPE svg [<!ENTITY x SYSTEM \"file:///etc/passwd\">]><svg><path d=\"&x;\"/></svg>";
        assert!(read_svg(entity).is_err());
        let hidden = "<path style=\"display: none\" d=\"M0 0 L9 0\"/>";
        assert!(drawing(hidden).is_err());
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "\\PC{0,200}") {
            let _ = read_svg(&text);
            let _ = drawing(&text);
            let escaped = text.replace(['<', '&', '"'], " ");
            let _ = drawing(&format!("<path d=\"{escaped}\"/>"));
            let _ = drawing(&format!("<path d=\"M0 0 L1 1\" transform=\"{escaped}\"/>"));
        }

        #[test]
        fn paths_of_lines_come_back(points in prop::collection::vec((-1e3..1e3f64, -1e3..1e3f64), 2..20)) {
            let mut data = String::from("M");
            for (x, y) in &points {
                data += &format!(" {x},{y}");
            }
            let strokes = drawing(&format!("<path d=\"{data}\"/>")).unwrap();
            prop_assert_eq!(strokes[0].len(), points.len());
            for (found, (x, y)) in strokes[0].iter().zip(&points) {
                let expected = Point::new(1e-3 * x, 0.1 - 1e-3 * y);
                prop_assert!((found - expected).norm() < 1e-12);
            }
        }
    }
}
