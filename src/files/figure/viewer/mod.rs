//! The 3-D page: a single HTML file that shows rods in motion, without a network or other files.
//!
//! `page/` holds the sources of the page; [`movie_page`] combines them with the packed movie.

mod packing;

use super::markup::{escape, fill, json_in_script};
use super::motion::{Field, Movie, MovieCase, Strip, room};
use super::palette::Color;
use crate::origin::version;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use packing::{Bounds, ColorRange, pack};
use serde_json::{Value, json};

const PAGE: &str = include_str!("page/page.html");

/// Replacements of the names in double braces in the page.
const PARTS: [(&str, &str); 9] = [
    ("style", include_str!("page/style.css")),
    ("tube.vert", include_str!("page/tube.vert")),
    ("tube.frag", include_str!("page/tube.frag")),
    ("plane.vert", include_str!("page/plane.vert")),
    ("plane.frag", include_str!("page/plane.frag")),
    ("obstacle.vert", include_str!("page/obstacle.vert")),
    ("obstacle.frag", include_str!("page/obstacle.frag")),
    ("contact.vert", include_str!("page/contact.vert")),
    ("contact.frag", include_str!("page/contact.frag")),
];

/// The program of the page, in the order of its parts.
const SCRIPTS: [&str; 10] = [
    include_str!("page/movie.js"),
    include_str!("page/colours.js"),
    include_str!("page/camera.js"),
    include_str!("page/renderer.js"),
    include_str!("page/player.js"),
    include_str!("page/gestures.js"),
    include_str!("page/chart.js"),
    include_str!("page/export.js"),
    include_str!("page/reload.js"),
    include_str!("page/page.js"),
];

/// Returns the page as HTML. Browsers need WebGL 2, which all have had since 2021.
///
/// # Panics
/// If a case has no frames, or arrays of different lengths.
pub fn movie_page(movie: &Movie) -> String {
    let (header, blobs) = data(movie);
    let data = format!("<script type=\"application/json\" id=\"movie\">{header}</script>\n{blobs}");
    let (title, script) = (escape(&movie.title), SCRIPTS.concat());
    let version = version();
    let own = [
        ("version", &version[..]),
        ("title", &title),
        ("script", &script),
        ("data", &data),
    ];
    fill(PAGE, &[&PARTS[..], &own].concat())
}

/// The description of the movie, and a script element with the packed bytes of each case.
fn data(movie: &Movie) -> (String, String) {
    let mut blobs = String::new();
    let mut cases = Vec::new();
    for (index, case) in movie.cases.iter().enumerate() {
        let bounds = Bounds::of(case);
        let fields: Vec<(&Field, ColorRange)> = case
            .fields
            .iter()
            .filter_map(|field| Some((field, ColorRange::of(field)?)))
            .collect();
        cases.push(describe(case, &bounds, &fields));
        let bytes = STANDARD.encode(pack(case, &bounds, &fields));
        blobs += &format!(
            "<script type=\"application/octet-stream\" id=\"case-{index}\">{bytes}</script>\n"
        );
    }
    let palette: Vec<String> = (0..7).map(|index| Color::of(index).hex()).collect();
    let header = json!({
        "title": movie.title,
        "subtitle": movie.subtitle,
        "palette": palette,
        "reload": movie.reload,
        "cases": cases,
    });
    (json_in_script(&header), blobs)
}

fn describe(case: &MovieCase, bounds: &Bounds, fields: &[(&Field, ColorRange)]) -> Value {
    let rods: Vec<Value> = case
        .rods
        .iter()
        .map(|rod| {
            json!({
                "name": rod.name,
                "nodes": rod.nodes,
                "closed": rod.closed,
                "radius": rod.radius,
                "radii": (!rod.radii.is_empty()).then_some(&rod.radii),
                "held": rod.held,
                "straight": rod.straight,
                "strip": rod.strip.as_ref().map(describe_strip),
            })
        })
        .collect();
    let planes: Vec<Value> = case
        .planes
        .iter()
        .map(|plane| json!({ "point": plane.point, "normal": plane.normal }))
        .collect();
    let obstacles: Vec<Value> = case
        .obstacles
        .iter()
        .map(|obstacle| {
            let corners = obstacle.triangles.iter().flatten();
            // Single precision, which graphics cards use.
            let numbers: Vec<f32> = corners.flat_map(|x| x.iter().map(|c| *c as f32)).collect();
            json!({ "corners": numbers, "poses": obstacle.poses, "carried": obstacle.is_carried })
        })
        .collect();
    let series: Vec<Value> = case
        .series
        .iter()
        .map(|series| json!({ "name": series.name, "unit": series.unit }))
        .collect();
    let fields: Vec<Value> = fields
        .iter()
        .map(|(field, range)| {
            json!({
                "name": field.name,
                "unit": field.unit,
                "signed": field.signed,
                "low": range.low,
                "high": range.high,
                "clips": range.clips,
            })
        })
        .collect();
    let [lower, size] = room(case);
    json!({
        "name": case.name,
        "distinction": case.distinction,
        "parameters": case.parameters,
        "rods": rods,
        "planes": planes,
        "obstacles": obstacles,
        "eye": case.view.raised().eye().as_slice(),
        "room": { "lower": lower.as_slice(), "size": size.as_slice() },
        "lower": bounds.lower.as_slice(),
        "size": bounds.size.as_slice(),
        "frames": case.frames.len(),
        "fields": fields,
        "series": series,
        "branches": case.branches,
    })
}

/// A strip: its extents, followed by tangent and width direction of each node as placed.
fn describe_strip(strip: &Strip) -> Value {
    let placed = strip.placed.iter().flatten();
    let placed: Vec<f32> = placed.flat_map(|v| v.iter().map(|c| *c as f32)).collect();
    json!({ "width": strip.width, "thickness": strip.thickness, "placed": placed })
}

#[cfg(test)]
mod tests {
    use super::super::View;
    use super::super::markup::is_page;
    use super::super::motion::{MovieFrame, MovieRod, MovieSeries};
    use super::*;
    use nalgebra::Vector3;

    /// Two rods of three nodes that rotate about the origin for five frames; they touch in the
    /// last.
    pub(super) fn spinning() -> MovieCase {
        let rod = |name: &str| MovieRod {
            name: name.into(),
            nodes: 3,
            closed: false,
            radius: 0.05,
            radii: Vec::new(),
            held: false,
            straight: false,
            strip: None,
        };
        let frame = |k: usize| {
            let angle = 0.4 * k as f64;
            let point = |node: usize, height| {
                let distance = node as f64 - 1.0;
                Vector3::new(distance * angle.cos(), distance * angle.sin(), height)
            };
            MovieFrame {
                time: 0.1 * k as f64,
                positions: (0..6).map(|n| point(n % 3, 0.1 * (n / 3) as f64)).collect(),
                contacts: if k == 4 {
                    vec![Vector3::z() * 0.05]
                } else {
                    vec![]
                },
            }
        };
        MovieCase {
            name: "main".into(),
            distinction: vec![],
            parameters: vec![("rod.radius".into(), "0.05".into())],
            rods: vec![rod("<one>"), rod("two")],
            planes: vec![],
            obstacles: vec![],
            view: View::oblique(),
            frames: (0..5).map(frame).collect(),
            fields: vec![Field {
                name: "Speed".into(),
                unit: "m/s".into(),
                signed: false,
                values: (0..5).map(|k| vec![f64::from(k); 6]).collect(),
            }],
            series: vec![MovieSeries {
                name: "Energy".into(),
                unit: "J".into(),
                values: vec![Some(0.5), None, Some(1.5), Some(2.0), Some(2.5)],
            }],
            branches: None,
        }
    }

    fn page() -> String {
        movie_page(&Movie {
            title: "Spin & <touch>".into(),
            subtitle: "scene".into(),
            cases: vec![spinning()],
            reload: None,
        })
    }

    #[test]
    fn the_page_is_whole_and_needs_no_other_file() {
        let page = page();
        assert!(!page.contains("{{"), "a part is missing");
        assert!(page.contains("<title>Spin &amp; &lt;touch&gt;"));
        // The version that wrote the page.
        let generator = format!("content=\"rodlab {}", crate::origin::VERSION);
        assert!(page.contains(&generator));
        assert!(is_page(page.as_bytes()));
        for reference in ["http://", "https://", "src=", "href=", "@import", "url("] {
            assert!(!page.contains(reference), "{reference}");
        }
    }

    #[test]
    fn names_cannot_end_the_data() {
        let page = page();
        let start = page.find("id=\"movie\">").unwrap() + "id=\"movie\">".len();
        let end = start + page[start..].find("</script>").unwrap();
        let header: Value = serde_json::from_str(&page[start..end]).unwrap();
        assert_eq!(header["title"], "Spin & <touch>");
        assert_eq!(header["cases"][0]["rods"][0]["name"], "<one>");
        assert_eq!(header["cases"][0]["frames"], 5);
        assert_eq!(header["cases"][0]["fields"][0]["high"], 4.0);
    }
}
