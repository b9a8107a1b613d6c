//! Visible shapes of a drawing and their positions: `usvg` resolves styles, `<use>`, symbols,
//! nested pages, conditions and clips.
//!
//! The outlines of `usvg` have single precision, and its arcs deviate from circles by more than
//! patterns allow. The library therefore receives a copy of the drawing in which each shape is
//! replaced by a small one of the same kind at the origin, whose width encodes its index. The
//! outlines are computed here. Fills that depend on the box around a shape do not matter; such
//! clips are ignored. The outlines of letters are those of `usvg`.

use super::shape::SHAPES;
use super::units::Page;
use super::{Fault, PatternError};
use kurbo::{Affine, BezPath, PathEl, Point};
use resvg::usvg::fontdb::{Family, Source};
use resvg::usvg::{self, tiny_skia_path::PathSegment};
use rodlab_files::figure::FONT_FILE;
use roxmltree::{Document, Node};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::str::FromStr;
use std::sync::{Arc, LazyLock};
use svgtypes::Transform;

/// Stack size of the resolver, which recurses into groups, bytes.
const STACK: usize = 64 << 20;
/// Elements that are removed; the resolver would end the program if their sizes could not be
/// resolved.
const BOX: [(&str, &str); 8] = [
    ("x", "0"),
    ("y", "0"),
    ("width", "1"),
    ("height", "1"),
    ("patternUnits", "userSpaceOnUse"),
    ("maskUnits", "userSpaceOnUse"),
    ("filterUnits", "userSpaceOnUse"),
    ("viewBox", "0 0 1 1"),
];
/// Largest difference of transforms in single precision, relative to their size.
const SINGLE: f64 = 1e-5;

/// What draws a visible outline.
pub enum Form {
    /// A shape, by its index among all elements of [`shapes`].
    Shape(usize),
    /// Letters: the index of their element among [`texts`], and their outlines.
    Letters(usize, BezPath),
}

/// A visible shape.
pub struct Seen {
    /// Its outline.
    pub form: Form,
    /// Transformation of its coordinates to user units of the page.
    pub place: Affine,
    /// Whether it is filled and has no outline.
    pub is_filled: bool,
    /// Whether it has a line that is transparent.
    pub has_hidden_line: bool,
    /// Indices of the clips that apply to it, into [`Visible::clips`].
    pub clips: Vec<usize>,
}

/// The area inside a clip, in user units of the page.
#[derive(Default)]
pub struct Clip {
    /// Shapes of the drawing that form its area, with their transformations.
    pub shapes: Vec<(usize, Affine)>,
    /// Frames of nested pages.
    pub frames: Vec<BezPath>,
}

/// The visible parts of a drawing, in drawing order.
#[derive(Default)]
pub struct Visible {
    /// The shapes.
    pub seen: Vec<Seen>,
    /// The clips.
    pub clips: Vec<Clip>,
    /// Fonts of the letters: the index of the element among [`texts`], and the family.
    pub fonts: BTreeSet<(usize, String)>,
}

/// The text elements of a document, in its order.
pub fn texts<'a>(document: &'a Document<'a>) -> Vec<Node<'a, 'a>> {
    let elements = document.descendants().filter(Node::is_element);
    elements
        .filter(|node| node.tag_name().name() == "text")
        .collect()
}

/// The shapes of a document, in its order.
pub fn shapes<'a>(document: &'a Document<'a>) -> Vec<Node<'a, 'a>> {
    let elements = document.descendants().filter(Node::is_element);
    elements
        .filter(|node| SHAPES.contains(&node.tag_name().name()))
        .collect()
}

impl Visible {
    /// Resolves a drawing.
    ///
    /// # Errors
    /// The document is nested too deeply, or has too many elements after each `<use>` is replaced
    /// by its content.
    pub fn of(
        text: &str,
        document: &Document,
        shapes: &[Node],
        texts: &[Node],
        page: &Page,
    ) -> Result<Self, PatternError> {
        let copy = copy(text, document, shapes, texts, page);
        let names: Vec<String> = texts.iter().enumerate().map(name_of_text).collect();
        let resolve = || {
            let mut options = usvg::Options {
                // Embedded pictures are ignored, and other files are never read.
                image_href_resolver: usvg::ImageHrefResolver {
                    resolve_data: Box::new(|_, _, _| None),
                    resolve_string: Box::new(|_, _| None),
                },
                ..usvg::Options::default()
            };
            if !names.is_empty() {
                options.fontdb = fonts();
            }
            usvg::Tree::from_str(&copy, &options).map(|tree| {
                let mut reader = TreeReader {
                    names: &names,
                    fonts: tree.fontdb(),
                    visible: Self::default(),
                };
                reader.group(tree.root(), &mut Vec::new());
                reader.visible
            })
        };
        let resolved = std::thread::scope(|scope| {
            let resolver = std::thread::Builder::new().stack_size(STACK);
            let running = resolver.spawn_scoped(scope, resolve).map_err(drop)?;
            running.join().map_err(drop)
        });
        match resolved {
            Ok(Ok(visible)) => Ok(visible),
            Ok(Err(
                usvg::Error::ElementsLimitReached
                | usvg::Error::ParsingFailed(roxmltree::Error::NodesLimitReached),
            )) => Err(PatternError::Syntax(
                "it shows more than a million elements, or a <use> refers to itself".into(),
            )),
            Ok(Err(error)) => Err(PatternError::Syntax(error.to_string())),
            Err(()) => Err(PatternError::Syntax("it cannot be resolved".into())),
        }
    }
}

/// Reads a resolved drawing.
struct TreeReader<'a> {
    /// Ids of the text elements.
    names: &'a [String],
    fonts: &'a usvg::fontdb::Database,
    visible: Visible,
}

impl TreeReader<'_> {
    fn group(&mut self, group: &usvg::Group, clips: &mut Vec<usize>) {
        if group.opacity().get() == 0.0 {
            return;
        }
        let depth = clips.len();
        let mut clip = group.clip_path();
        while let Some(path) = clip {
            let place = affine(group.abs_transform()) * affine(path.transform());
            clip = path.clip_path();
            let mut area = Clip::default();
            area.add(path.root(), place);
            clips.push(self.visible.clips.len());
            self.visible.clips.push(area);
        }
        for node in group.children() {
            match node {
                usvg::Node::Group(below) => self.group(below, clips),
                usvg::Node::Path(path) => {
                    if let Some(shape) = shape_of(path) {
                        self.see(path, Form::Shape(shape), clips);
                    }
                }
                usvg::Node::Text(text) => {
                    let named = self.names.iter().position(|name| name == text.id());
                    let number = named.unwrap_or_default();
                    self.note_fonts(text, number);
                    self.letters(text.flattened(), number, clips);
                }
                _ => {}
            }
        }
        clips.truncate(depth);
    }

    /// Adds the outlines of letters.
    fn letters(&mut self, group: &usvg::Group, number: usize, clips: &[usize]) {
        for node in group.children() {
            match node {
                usvg::Node::Group(below) => self.letters(below, number, clips),
                usvg::Node::Path(path) => {
                    self.see(path, Form::Letters(number, bezier(path)), clips);
                }
                _ => {}
            }
        }
    }

    /// Adds an outline if it is visible.
    fn see(&mut self, path: &usvg::Path, form: Form, clips: &[usize]) {
        let has_fill = path.fill().is_some_and(|fill| fill.opacity().get() > 0.0);
        let has_line = path.stroke().is_some_and(|line| line.opacity().get() > 0.0);
        if path.is_visible() && (has_fill || has_line) {
            self.visible.seen.push(Seen {
                form,
                place: affine(path.abs_transform()),
                is_filled: !has_line,
                has_hidden_line: !has_line && path.stroke().is_some(),
                clips: clips.to_vec(),
            });
        }
    }

    fn note_fonts(&mut self, text: &usvg::Text, number: usize) {
        let glyphs = text
            .layouted()
            .iter()
            .flat_map(|span| &span.positioned_glyphs);
        for glyph in glyphs {
            let family = self
                .fonts
                .face(glyph.font)
                .and_then(|face| face.families.first());
            if let Some((family, _)) = family {
                self.visible.fonts.insert((number, family.clone()));
            }
        }
    }
}

/// The id of a text element: its own, or one that its copy gets.
fn name_of_text((number, node): (usize, &Node)) -> String {
    let own = node.attribute("id").filter(|id| !id.is_empty());
    own.map_or_else(|| format!("rodlab-text-{number}"), str::to_owned)
}

/// The fonts of this computer, and a built-in one that stands in for missing families.
fn fonts() -> Arc<usvg::fontdb::Database> {
    static FONTS: LazyLock<Arc<usvg::fontdb::Database>> = LazyLock::new(|| {
        let mut fonts = usvg::fontdb::Database::new();
        fonts.load_system_fonts();
        let own = fonts.load_font_source(Source::Binary(Arc::new(FONT_FILE)));
        let family = own.first().and_then(|id| fonts.face(*id));
        let family = family.and_then(|face| face.families.first());
        let family = family.map_or(String::new(), |(name, _)| name.clone());
        // The resolver takes the serif family in place of every missing one.
        let serif = usvg::fontdb::Query {
            families: &[Family::Serif],
            ..Default::default()
        };
        if fonts.query(&serif).is_none() {
            fonts.set_serif_family(family);
        }
        Arc::new(fonts)
    });
    FONTS.clone()
}

impl Clip {
    fn add(&mut self, group: &usvg::Group, place: Affine) {
        for node in group.children() {
            match node {
                usvg::Node::Group(below) => self.add(below, place),
                usvg::Node::Path(path) => {
                    let place = place * affine(path.abs_transform());
                    match shape_of(path) {
                        Some(shape) => self.shapes.push((shape, place)),
                        None => self.frames.push(place * bezier(path)),
                    }
                }
                _ => {}
            }
        }
    }
}

/// The shape of the drawing that corresponds to one of the copy; `None` for the frame of a nested
/// page, which is the only rectangle with sharp corners.
fn shape_of(path: &usvg::Path) -> Option<usize> {
    let is_line = |segment: &PathSegment| matches!(segment, PathSegment::LineTo(_));
    let is_curve = |segment: &PathSegment| {
        matches!(segment, PathSegment::QuadTo(..) | PathSegment::CubicTo(..))
    };
    let segments = || path.data().segments();
    if segments().filter(is_line).count() >= 3 && !segments().any(|segment| is_curve(&segment)) {
        return None;
    }
    let half = (0.5 * path.data().bounds().right()).round() as usize;
    half.checked_sub(1)
}

fn affine(transform: usvg::Transform) -> Affine {
    let usvg::Transform {
        sx,
        kx,
        ky,
        sy,
        tx,
        ty,
    } = transform;
    Affine::new([sx, ky, kx, sy, tx, ty].map(f64::from))
}

fn bezier(path: &usvg::Path) -> BezPath {
    let point = |at: usvg::tiny_skia_path::Point| Point::new(f64::from(at.x), f64::from(at.y));
    let elements = path.data().segments().map(|segment| match segment {
        PathSegment::MoveTo(to) => PathEl::MoveTo(point(to)),
        PathSegment::LineTo(to) => PathEl::LineTo(point(to)),
        PathSegment::QuadTo(by, to) => PathEl::QuadTo(point(by), point(to)),
        PathSegment::CubicTo(by, and, to) => PathEl::CurveTo(point(by), point(and), point(to)),
        PathSegment::Close => PathEl::ClosePath,
    });
    elements.collect()
}

/// The drawing with squares in place of shapes, on a page in user units.
fn copy(text: &str, document: &Document, shapes: &[Node], texts: &[Node], page: &Page) -> String {
    let mut edits: Vec<(usize, usize, String)> = Vec::new();
    let mut edit = |node: &Node, attributes: &[(&str, String)]| {
        let start = node.range().start;
        let name = text.get(start..).and_then(|tag| tag.strip_prefix('<'));
        let Some(name) = name.and_then(|tag| tag.split([' ', '\t', '\r', '\n', '/', '>']).next())
        else {
            return;
        };
        let mut added = String::new();
        for (attribute, value) in attributes {
            match node.attribute_node(*attribute) {
                Some(there) => {
                    let range = there.range_value();
                    edits.push((range.start, range.end, value.clone()));
                }
                None => {
                    let _ = write!(added, " {attribute}=\"{value}\"");
                }
            }
        }
        let behind = start + 1 + name.len();
        edits.push((behind, behind, added));
    };
    let [width, height] = page.viewport;
    let attributes = [
        ("width", format!("{width}")),
        ("height", format!("{height}")),
        ("viewBox", format!("0 0 {width} {height}")),
        ("preserveAspectRatio", "none".into()),
        ("transform", "scale(1)".into()),
    ];
    edit(&document.root_element(), &attributes);
    for (number, node) in texts.iter().enumerate() {
        edit(node, &[("id", name_of_text((number, node)))]);
    }
    for (index, node) in shapes.iter().enumerate() {
        let half = index + 1;
        let side = 2 * half;
        let is = |pairs: &[(&'static str, String)]| pairs.to_vec();
        let attributes = match node.tag_name().name() {
            "path" => is(&[("d", format!("M0 0H{side}V{side}z"))]),
            "line" => is(&[
                ("x1", "0".into()),
                ("y1", "0".into()),
                ("x2", format!("{side}")),
                ("y2", format!("{side}")),
            ]),
            "polyline" | "polygon" => is(&[("points", format!("0,0 {side},0 {side},{side}"))]),
            "circle" => is(&["cx", "cy", "r"].map(|name| (name, format!("{half}")))),
            "ellipse" => is(&["cx", "cy", "rx", "ry"].map(|name| (name, format!("{half}")))),
            _ => is(&[
                ("x", "0".into()),
                ("y", "0".into()),
                ("width", format!("{side}")),
                ("height", format!("{side}")),
                ("rx", "1".into()),
                ("ry", "1".into()),
            ]),
        };
        edit(node, &attributes);
    }
    for node in document.descendants() {
        match node.tag_name().name() {
            "pattern" | "mask" | "filter" => {
                edit(&node, &BOX.map(|(name, value)| (name, value.to_owned())))
            }
            "clipPath" if node.attribute("clipPathUnits") == Some("objectBoundingBox") => {
                edit(&node, &[("id", String::new())]);
            }
            _ => {}
        }
    }
    edits.sort_by_key(|(start, ..)| *start);
    let mut copy = String::with_capacity(2 * text.len());
    let mut at = 0;
    for (start, end, with) in edits {
        // Elements of an entity that is used twice have the same position in the text.
        if let Some(before) = text.get(at..start).filter(|_| start >= at && end >= start) {
            copy += before;
            copy += &with;
            at = end;
        }
    }
    copy += text.get(at..).unwrap_or_default();
    copy
}

/// The exact transformation of an element in double precision, from the transforms around it, if
/// it agrees with `found`.
///
/// # Errors
/// A transform around it cannot be read.
pub fn exact(node: Node, page: &Page, found: Affine) -> Result<Affine, Fault> {
    let mut place = Affine::IDENTITY;
    let root = node.document().root_element();
    for above in node.ancestors().take_while(|above| *above != root) {
        if let Some(text) = above.attribute("transform") {
            let Transform { a, b, c, d, e, f } = Transform::from_str(text)
                .map_err(|error| super::fault(above, "transform", error))?;
            place = Affine::new([a, b, c, d, e, f]) * place;
        }
    }
    let (one, other) = (place.as_coeffs(), found.as_coeffs());
    let size = one
        .iter()
        .chain(&page.viewport)
        .fold(0.0, |size: f64, x| size.max(x.abs()));
    let agree = |range: std::ops::Range<usize>, size: f64| {
        range
            .into_iter()
            .all(|index| (one[index] - other[index]).abs() <= SINGLE * size)
    };
    let linear = one[..4].iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    Ok(if agree(0..4, linear) && agree(4..6, size) {
        place
    } else {
        found
    })
}
