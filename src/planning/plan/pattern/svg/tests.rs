//! Drawings as text, and their strokes.

use super::*;

#[test]
fn drawings_without_size_are_rejected_and_need_no_memory() {
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
        let nested = format!("<{name}>").repeat(100_000) + &format!("</{name}>").repeat(100_000);
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
    // In the drawing y points down: a quarter turn from x points down.
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
fn elements_that_are_not_paths_are_reported() {
    let message = |content: &str| drawing(content).unwrap_err().to_string();
    assert!(message("<text> </text>").contains("no visible letters"));
    assert!(message("").contains("no path"));
    assert!(message("<path d=\"M0 0\"/>").contains("no path"));
    assert!(message("<path d=\"M0 0 L0 0\"/>").contains("no path"));
    let broken = message("\n<path d=\"M0 0 L10 x\"/>");
    assert!(broken.contains("line 2: <path>: d:"), "{broken}");
    assert!(message("<path d=\"M0 0 L1e999 0\"/>").contains("line 1: <path>: d:"));
    assert!(message("<path d=\"M0 0 L1e308 1e308 L-1e308 0\"/>").contains("larger than 1000 m"));
    assert!(message("<path transform=\"turn(3)\" d=\"M0 0 L1 0\"/>").contains("transform"));
    assert!(message("<use href=\"#a\"/>").contains("no path"));
    assert!(
        read_svg("<html/>")
            .unwrap_err()
            .to_string()
            .contains("<html>")
    );
    assert!(read_svg("no xml").is_err());
    let entity =
        "<!DOCTYPE svg [<!ENTITY x SYSTEM \"file:///etc/passwd\">]><svg><path d=\"&x;\"/></svg>";
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

/// Lengths of the strokes of a drawing on a page of 100 mm with 100 units, mm.
fn lengths(content: &str) -> Vec<f64> {
    let text = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' width='100mm' \
         height='100mm' viewBox='0 0 100 100'>{content}</svg>"
    );
    let drawing = SvgDrawing::read(&text).unwrap_or_else(|error| panic!("{content}: {error}"));
    drawing
        .strokes
        .iter()
        .map(|stroke| 1e3 * stroke.length())
        .collect()
}

#[test]
fn drawings_are_read_as_browsers_show_them() {
    let line = "<path id='a' d='M10 50H50'/>";
    for (content, expected) in [
        // Referenced elements, each time they are used.
        (format!("<defs>{line}</defs><use xlink:href='#a'/>"), vec![40.0]),
        (format!("<defs>{line}</defs><use href='#a'/><use href='#a' y='5' transform='scale(.5)'/>"), vec![40.0, 20.0]),
        (format!("<symbol id='s' viewBox='0 0 50 50'>{line}</symbol><use href='#s' width='100' height='100'/>"), vec![80.0]),
        ("<use id='c' href='#c'/><path d='M0 0H7'/>".into(), vec![7.0]),
        ("<g id='g'><use href='#g'/><path d='M0 0H7'/></g>".into(), vec![7.0]),
        // Nested pages: their units, their own aspect ratio, clipping.
        (format!("<svg viewBox='0 0 50 50'>{line}</svg>"), vec![80.0]),
        ("<svg x='10' width='50' height='100' viewBox='0 0 10 10' preserveAspectRatio='none'><path d='M0 1H8M1 0V5'/></svg>".into(), vec![40.0, 50.0]),
        ("<svg width='20' height='100'><path d='M5 5H50'/></svg>".into(), vec![15.0]),
        // Styles that hide.
        ("<style>.h{display:none}</style><path class='h' d='M0 0H50'/><path d='M0 5H7'/>".into(), vec![7.0]),
        ("<g visibility='hidden'><path d='M0 0H50'/><path visibility='visible' d='M0 5H7'/></g>".into(), vec![7.0]),
        ("<g opacity='0'><path d='M0 0H50'/></g><path d='M0 5H7'/>".into(), vec![7.0]),
        ("<path fill='none' stroke='none' d='M0 0H50'/><path d='M0 5H7'/>".into(), vec![7.0]),
        ("<path style='fill:none' d='M0 0H50'/><path style='stroke:red;fill:none' d='M0 5H7'/>".into(), vec![7.0]),
        ("<path stroke='black' stroke-opacity='0' d='M0 0L50 5'/><path d='M0 5H7'/>".into(), vec![7.0]),
        ("<path stroke='black' stroke-opacity='0' fill='none' d='M0 0H50'/><path d='M0 5H7'/>".into(), vec![7.0]),
        ("<switch><path systemLanguage='xx' d='M0 0H50'/><path d='M0 5H7'/></switch>".into(), vec![7.0]),
        // Definitions are not strokes.
        (format!("<clipPath id='k'>{line}</clipPath><marker id='m'>{line}</marker><path marker-end='url(#m)' d='M0 5H7'/>"), vec![7.0]),
        // Clips.
        ("<clipPath id='k'><rect x='20' width='10' height='100'/></clipPath><path clip-path='url(#k)' d='M0 5H90'/>".into(), vec![10.0]),
        ("<clipPath id='k'><circle cx='50' cy='5' r='10'/></clipPath><g clip-path='url(#k)'><path d='M0 5H90M60 50V90'/></g>".into(), vec![20.0]),
        // Units and percentages.
        ("<line x1='1in' x2='2in' y1='1px' y2='1px'/>".into(), vec![96.0]),
        ("<line x1='10%' x2='60%' y1='5' y2='5'/>".into(), vec![50.0]),
        ("<rect x='10%' width='50%' height='10%' fill='none' stroke='red'/>".into(), vec![120.0]),
        ("<circle cx='50%' cy='50%' r='10%' stroke='red'/>".into(), vec![20.0 * std::f64::consts::PI]),
        // Round corners.
        ("<rect x='10' y='10' width='80' height='50' rx='20' fill='none' stroke='black'/>".into(), vec![100.0 + 40.0 * std::f64::consts::PI]),
        ("<rect width='80' height='50' ry='99' rx='1' stroke='black'/>".into(), vec![2.0 * 78.0 + 100.328_4]),
        // Path data are drawn up to an error.
        ("<path d='M10 50 L90 50 X'/>".into(), vec![80.0]),
        ("<path transform='turn(9)' d='M0 0H9'/><path d='M0 5H7'/>".into(), vec![7.0]),
        // Fills, masks and clips that depend on the box around a shape.
        ("<pattern id='p' width='.1' height='1e-9'><path d='M0 0H1'/></pattern><path fill='url(#p)' d='M0 5H7'/>".into(), vec![7.0]),
        ("<linearGradient id='l'><stop offset='0'/><stop offset='1'/></linearGradient><path stroke='url(#l)' d='M0 5H7'/>".into(), vec![7.0]),
        ("<mask id='m' width='1e-9'><path d='M0 0H1V1z'/></mask><filter id='f' width='1e-9'><feOffset/></filter><g mask='url(#m)'><path filter='url(#f)' d='M0 5H7'/></g>".into(), vec![7.0]),
        ("<clipPath id='k' clipPathUnits='objectBoundingBox'><rect width='.5' height='1'/></clipPath><path clip-path='url(#k)' d='M0 5H7'/>".into(), vec![7.0]),
        // A foreign namespace is not SVG.
        ("<i:path xmlns:i='http://i' d='M0 0H9'/><path d='M0 5H7'/>".into(), vec![7.0]),
    ] {
        let found = lengths(&content);
        assert_eq!(found.len(), expected.len(), "{content}: {found:?}");
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found / expected - 1.0).abs() < 1e-4, "{content}: {found}");
        }
    }
}

#[test]
fn a_page_has_its_size_in_every_form() {
    for (page, expected) in [
        ("width='100mm' height='100mm' viewBox='0 0 100 100'", 40.0),
        ("width='auto' height='10cm' viewBox='0 0 100 100'", 40.0),
        (
            "width='100%' height='100%' viewBox='0 0 96 96'",
            40.0 * 25.4 / 96.0,
        ),
        (
            "width='0' height='0' viewBox='0 0 100 100'",
            40.0 * 25.4 / 96.0,
        ),
        ("viewBox='0 0 0 0'", 40.0 * 25.4 / 96.0),
        ("", 40.0 * 25.4 / 96.0),
        ("width='200mm' height='50mm' viewBox='0 0 100 100'", 20.0),
        (
            "width='200mm' height='50mm' viewBox='0 0 100 100' preserveAspectRatio='none'",
            80.0,
        ),
        (
            "width='200mm' height='50mm' viewBox='0 0 100 100' preserveAspectRatio='xMidYMid slice'",
            80.0,
        ),
        (
            "width='10pc' viewBox='7 8 100 100'",
            40.0 * 0.01 * 160.0 * 25.4 / 96.0,
        ),
    ] {
        let text =
            format!("<svg xmlns='http://www.w3.org/2000/svg' {page}><path d='M10 50H50'/></svg>");
        let found = 1e3 * length(&read_svg(&text).unwrap()[0]);
        assert!((found / expected - 1.0).abs() < 1e-12, "{page}: {found}");
    }
}

#[test]
fn transforms_keep_double_precision() {
    let strokes = drawing(
        "<g transform='translate(1e6 0)'><path transform='translate(-1e6 .1)' d='M.1 0H40'/></g>",
    );
    let stroke = &strokes.unwrap()[0];
    assert!(
        (stroke[0] - Point::new(1e-4, 0.0999)).norm() < 1e-10,
        "{stroke:?}"
    );
}

#[test]
fn hostile_drawings_are_refused_or_read() {
    let mut bomb = String::from("<g id='a0'><path d='M0 0H1'/></g>");
    for level in 1..40 {
        bomb += &format!(
            "<g id='a{level}'>{}</g>",
            format!("<use href='#a{}'/>", level - 1).repeat(10)
        );
    }
    let mut odd = Vec::new();
    for element in [
        "pattern",
        "mask",
        "filter",
        "clipPath",
        "marker",
        "symbol",
        "svg",
        "linearGradient",
        "image",
        "use",
    ] {
        for size in ["0", "1e-9", "-1", "1e-38", "1e38", "nan"] {
            odd.push(format!(
                "<{element} id='e' x='{size}' y='1e9' width='{size}' height='{size}' viewBox='0 0 {size} 1' markerWidth='{size}' \
                 href='#p' gradientTransform='scale({size})' patternTransform='scale({size})'><path id='p' d='M0 0H1V1'/></{element}>\
                 <path fill='url(#e)' mask='url(#e)' filter='url(#e)' clip-path='url(#e)' marker-end='url(#e)' \
                 transform='scale({size})' d='M0 0H9V9'/><use href='#e' width='{size}' height='{size}'/>"
            ));
        }
    }
    for content in odd.into_iter().chain([
        bomb,
        "<use href='#b' id='a'/><use href='#a' id='b'/>".into(),
        "<path d='M1e38 0H-1e38V1e300'/>".into(),
        "<circle r='1e30' transform='scale(1e30)'/>".into(),
        "<clipPath id='c' clip-path='url(#c)'><path d='M0 0H1V1z'/></clipPath><path clip-path='url(#c)' d='M0 0H9'/>".into(),
        "<style>@import 'x'; path { } * > * { </style><path/>".into(),
        "<path stroke-width='1e30' stroke='red' d='M0 0H9'/>".into(),
        "<image href='/dev/zero'/><image href='data:image/svg+xml;utf8,&lt;svg/&gt;'/>".into(),
    ]) {
        if let Err(error) = drawing(&content) {
            assert!(!error.to_string().contains("cannot be resolved"), "{content}");
        }
    }
    let entities = "<!DOCTYPE svg [<!ENTITY a 'aaaaaaaaaa'><!ENTITY b '&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;'>\
        <!ENTITY c '&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;'><!ENTITY d '&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;'>]><svg><path d='M0 0H9' id='&d;&d;&d;'/></svg>";
    let _ = read_svg(entities);
    let shape = "<!DOCTYPE svg [<!ENTITY p '<path d=\"M0 0H9\"/>'>]><svg>&p;<g transform='scale(2)'>&p;</g></svg>";
    assert_eq!(read_svg(shape).map(|strokes| strokes.len()), Ok(2));
}

#[test]
fn strokes_are_chosen_listed_and_joined() {
    let read = |content: &str| {
        let text = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' viewBox='0 0 100 100'>\n{content}</svg>"
        );
        SvgDrawing::read(&text).unwrap()
    };
    let apart = read(
        "<rect width='100%' height='100%'/>\n<path id='a' d='M10 50H50'/><g id='b'><path d='M90 50H50.4'/></g>",
    );
    let choose = |text: &str| apart.choose(&text.parse().unwrap());
    assert_eq!(
        (choose("2"), choose("b"), choose("longest")),
        (Ok(2), Ok(3), Ok(2))
    );
    let message = choose("c").unwrap_err().to_string();
    assert!(
        message.contains("id `c`: no stroke has this id"),
        "{message}"
    );
    let message = apart.choose(&StrokeChoice::Only).unwrap_err().to_string();
    for part in [
        "3 strokes",
        "1: 400.0 mm long",
        "line 2, <rect>",
        "background",
        "2: 40.0 mm long, from (10.0, 50.0) to (50.0, 50.0) mm, line 3, <path>, id `a`",
    ] {
        assert!(message.contains(part), "{message}");
    }
    assert_eq!(apart.gap_that_joins(), Some(5e-4));
    let joined = apart.clone().joined(5e-4).unwrap();
    let number = joined.choose(&StrokeChoice::Only).unwrap();
    let [first, last] = joined.strokes[number - 1].ends();
    assert!(
        (first - Point::new(0.01, 0.05)).norm() + (last - Point::new(0.09, 0.05)).norm() < 1e-12
    );
    assert_eq!(apart.joined(3e-4).unwrap().strokes.len(), 3);
    // Any order and direction give the same length.
    let pieces =
        read("<path d='M30 5H20'/><path d='M0 5H10'/><path d='M30 5H40'/><path d='M20 5H10'/>");
    let joined = pieces.joined(0.0).unwrap();
    assert_eq!(joined.strokes.len(), 1);
    assert!((joined.strokes[0].length() - 0.04).abs() < 1e-12);
}

#[test]
fn outlines_and_what_cannot_be_read_are_noted() {
    let text = "<svg xmlns='http://www.w3.org/2000/svg'>\n<path d='M0 0H9V9z'/>\n<path d='M0 50H9 oops'/>\n\
                <path fill='none' stroke='red' d='M0 90H9V99z'/></svg>";
    let drawing = SvgDrawing::read(text).unwrap();
    let outlines: Vec<bool> = drawing
        .strokes
        .iter()
        .map(|stroke| stroke.is_outline)
        .collect();
    assert_eq!(outlines, [true, false, false]);
    assert!(
        drawing.notes[0].contains("line 3: <path>: d:"),
        "{:?}",
        drawing.notes
    );
}

#[test]
fn letters_have_outlines_at_their_places() {
    let read = |content: &str| {
        let text = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 100'>\n{content}</svg>"
        );
        SvgDrawing::read(&text).unwrap()
    };
    // An I and a D, 20 mm apart; the D has a hole.
    let two = "<text id='t' y='80' font-size='50' font-family='no such font'>\
               <tspan x='10'>I</tspan><tspan x='30'>D</tspan></text>";
    let drawing = read(two);
    let of: Vec<_> = drawing
        .strokes
        .iter()
        .map(|stroke| (stroke.id.as_deref(), stroke.line, stroke.is_outline))
        .collect();
    assert_eq!(of, [(Some("t"), 2, true); 3]);
    assert!(
        drawing.notes[0].starts_with("line 2: <text> is drawn in the font "),
        "{:?}",
        drawing.notes
    );
    let left = |stroke: &DrawnStroke| {
        let across = stroke.points.iter().map(|point| point.x);
        across.fold(f64::INFINITY, f64::min)
    };
    let [i, d] = [0, 1].map(|index| &drawing.strokes[index]);
    assert!((0.01..0.02).contains(&left(i)) && (0.03..0.04).contains(&left(d)));
    // Capital letters stand on the base line, 20 mm above the lower edge.
    let low = i
        .points
        .iter()
        .map(|point| point.y)
        .fold(f64::INFINITY, f64::min);
    assert!((low - 0.02).abs() < 1e-3, "{low}");
    let moved = read(&format!("<g transform='translate(10 -5)'>{two}</g>"));
    let shift = moved.strokes[1].points[0] - d.points[0];
    assert!((shift - Point::new(0.01, 0.005)).norm() < 1e-6, "{shift}");
    let labelled = read(&format!("{two}<path d='M10 90H90'/>"));
    assert_eq!(labelled.strokes.len(), 1);
    assert!(
        labelled.notes[0].starts_with("line 2: <text> is left out beside other strokes"),
        "{:?}",
        labelled.notes
    );
    let edges: Vec<_> = drawing.areas().into_iter().map(|area| area.edges).collect();
    // The hole of this D is drawn first.
    assert_eq!(edges, [vec![0], vec![2, 1]]);
    assert!(drawing.areas().iter().all(FilledArea::is_narrow));
}

#[test]
fn transforms_in_styles_that_cannot_be_read_are_reported() {
    let notes = |content: &str| {
        let text = format!("<svg xmlns='http://www.w3.org/2000/svg'>\n{content}</svg>");
        SvgDrawing::read(&text).unwrap().notes
    };
    for content in [
        "<path style='stroke:red;transform:rotate(30deg)' d='M0 0L9 5'/>",
        "<style>.a{fill:none;transform: rotate(30deg)}</style><path class='a' stroke='red' d='M0 0L9 5'/>",
    ] {
        let found = notes(content);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(
            found[0].starts_with("line 2: <") && found[0].contains("\"rotate(30deg)\""),
            "{found:?}"
        );
    }
    let readable = notes("<path style='transform:scale(.5);stroke:red' d='M0 0L9 5'/>");
    assert!(readable.is_empty(), "{readable:?}");
}
