//! Conversion of SVG to PDF: the paths of a figure as a page of its size, in vectors.

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Pdf, Rect, Ref};
use resvg::tiny_skia::{PathSegment, Point, Transform};
use resvg::usvg::{
    Color, FillRule, Group, LineCap, LineJoin, Node, Options, Paint, Path, Stroke, Tree,
};
use std::io::Write;

/// Points of PDF per pixel of SVG.
const POINTS: f32 = 72.0 / 96.0;

/// Draws an SVG as a PDF of one page.
///
/// # Panics
/// If `svg` is not an SVG file, or has more than paths in plain colours; the figures of this crate
/// do not.
pub(super) fn pdf(svg: &str) -> Vec<u8> {
    let tree = Tree::from_str(svg, &Options::default()).expect("our figures are SVG");
    let size = tree.size();
    let (width, height) = (POINTS * size.width(), POINTS * size.height());
    let mut content = Content::new();
    // In PDF, y points upwards from the lower edge.
    content.transform([POINTS, 0.0, 0.0, -POINTS, 0.0, height]);
    draw(tree.root(), &mut content);
    let [catalog, pages, page, contents] = [1, 2, 3, 4].map(Ref::new);
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([page]).count(1);
    let mut leaf = pdf.page(page);
    leaf.media_box(Rect::new(0.0, 0.0, width, height));
    leaf.parent(pages);
    leaf.contents(contents);
    leaf.resources();
    leaf.finish();
    let packed = packed(&content.finish());
    pdf.stream(contents, &packed).filter(Filter::FlateDecode);
    pdf.finish()
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).expect("memory takes all bytes");
    encoder.finish().expect("memory takes all bytes")
}

fn draw(group: &Group, content: &mut Content) {
    for node in group.children() {
        match node {
            Node::Group(group) => draw(group, content),
            Node::Path(path) if path.is_visible() => draw_path(path, content),
            Node::Path(_) => {}
            Node::Image(_) | Node::Text(_) => unreachable!("figures are made of paths"),
        }
    }
}

fn draw_path(path: &Path, content: &mut Content) {
    let place = path.abs_transform();
    if let Some(fill) = path.fill() {
        let [red, green, blue] = rgb(plain(fill.paint()));
        content.set_fill_rgb(red, green, blue);
        trace(path, place, content);
        match fill.rule() {
            FillRule::NonZero => content.fill_nonzero(),
            FillRule::EvenOdd => content.fill_even_odd(),
        };
    }
    if let Some(stroke) = path.stroke() {
        set_stroke(stroke, place, content);
        trace(path, place, content);
        content.stroke();
    }
}

fn set_stroke(stroke: &Stroke, place: Transform, content: &mut Content) {
    let [red, green, blue] = rgb(plain(stroke.paint()));
    let scale = place.get_scale().0;
    content.set_stroke_rgb(red, green, blue);
    content.set_line_width(scale * stroke.width().get());
    content.set_line_cap(match stroke.linecap() {
        LineCap::Butt => LineCapStyle::ButtCap,
        LineCap::Round => LineCapStyle::RoundCap,
        LineCap::Square => LineCapStyle::ProjectingSquareCap,
    });
    content.set_line_join(match stroke.linejoin() {
        LineJoin::Round => LineJoinStyle::RoundJoin,
        LineJoin::Bevel => LineJoinStyle::BevelJoin,
        LineJoin::Miter | LineJoin::MiterClip => LineJoinStyle::MiterJoin,
    });
    let dashes = stroke.dasharray().unwrap_or_default();
    let dashes = dashes.iter().map(|dash| scale * dash);
    content.set_dash_pattern(dashes, scale * stroke.dashoffset());
}

fn trace(path: &Path, place: Transform, content: &mut Content) {
    let on_page = |mut point: Point| {
        place.map_point(&mut point);
        point
    };
    let mut last = Point::zero();
    for segment in path.data().segments() {
        match segment {
            PathSegment::MoveTo(to) => {
                last = on_page(to);
                content.move_to(last.x, last.y);
            }
            PathSegment::LineTo(to) => {
                last = on_page(to);
                content.line_to(last.x, last.y);
            }
            PathSegment::QuadTo(over, to) => {
                // Converts a quadratic curve to a cubic one.
                let (over, to) = (on_page(over), on_page(to));
                let towards = |end: Point| {
                    let part = |from: f32, over: f32| from + 2.0 / 3.0 * (over - from);
                    Point::from_xy(part(end.x, over.x), part(end.y, over.y))
                };
                let (a, b) = (towards(last), towards(to));
                content.cubic_to(a.x, a.y, b.x, b.y, to.x, to.y);
                last = to;
            }
            PathSegment::CubicTo(a, b, to) => {
                let (a, b) = (on_page(a), on_page(b));
                last = on_page(to);
                content.cubic_to(a.x, a.y, b.x, b.y, last.x, last.y);
            }
            PathSegment::Close => {
                content.close_path();
            }
        }
    }
}

fn plain(paint: &Paint) -> Color {
    match paint {
        Paint::Color(color) => *color,
        _ => unreachable!("figures have plain colours"),
    }
}

fn rgb(color: Color) -> [f32; 3] {
    [color.red, color.green, color.blue].map(|channel| f32::from(channel) / 255.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    /// The content of the page.
    fn operators(file: &[u8]) -> String {
        let find = |what: &[u8]| file.windows(what.len()).position(|bytes| bytes == what);
        let start = find(b"stream\n").unwrap() + 7;
        let end = find(b"\nendstream").unwrap();
        let mut text = String::new();
        let mut decoder = ZlibDecoder::new(&file[start..end]);
        decoder.read_to_string(&mut text).unwrap();
        text
    }

    #[test]
    fn a_page_has_the_size_and_the_paths_of_the_figure() {
        let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"96\" height=\"48\" viewBox=\"0 0 96 48\">\
                   <defs><path id=\"g1\" d=\"M0 0Q3 6 6 0z\"/></defs>\
                   <path d=\"M0 0L96 48\" stroke=\"#ff0000\" stroke-width=\"2\" stroke-dasharray=\"4 2\"/>\
                   <g transform=\"translate(10 20) scale(2 -2)\"><use href=\"#g1\" x=\"1\"/></g></svg>";
        let file = pdf(svg);
        assert!(file.starts_with(b"%PDF-1."));
        let head = String::from_utf8_lossy(&file);
        assert!(head.contains("/MediaBox [0 0 72 36]"), "{head}");
        let page = operators(&file);
        assert!(
            page.contains("1 0 0 RG\n2 w") && page.contains("[4 2] 0 d"),
            "{page}"
        );
        assert!(page.contains("0 0 m\n96 48 l\nS"), "{page}");
        // The quadratic curve from (0, 0) over (3, 6) to (6, 0), shifted by 1, then placed.
        assert!(
            page.contains("12 20 m\n16 12 20 12 24 20 c\nh\nf"),
            "{page}"
        );
    }
}
