//! Text of a USD stage: rods as curves with a width, bodies and planes as meshes.
//!
//! A rod is a Catmull–Rom curve through its nodes, as films draw it; strips are ribbons with the
//! normal of their faces. Points have a time sample for each output.

use super::super::motion::{MovieCase, MovieObstacle, MovieRod};
use super::super::palette::Color;
use super::super::tube::rod_color;
use super::frames::{Section, motion, ranges};
use super::{Tempo, seconds, square};
use nalgebra::Vector3;
use std::collections::BTreeSet;
use std::fmt::{Display, Write};

/// Time codes per second of animation.
const CODES_PER_SECOND: f64 = 24.0;

/// The scene in motion as the text of a `.usda` file. `generator` is recorded in it.
pub fn usda(case: &MovieCase, tempo: Tempo, generator: &str) -> String {
    let codes: Vec<f64> = seconds(case, tempo)
        .iter()
        .map(|second| (1e6 * CODES_PER_SECOND * second).round() / 1e6)
        .collect();
    let last = codes.last().copied().unwrap_or(0.0);
    let mut text = format!(
        "#usda 1.0\n(\n    defaultPrim = \"World\"\n    doc = {}\n    endTimeCode = {last}\n    \
         framesPerSecond = {CODES_PER_SECOND}\n    metersPerUnit = 1\n    startTimeCode = 0\n    \
         timeCodesPerSecond = {CODES_PER_SECOND}\n    upAxis = \"Z\"\n)\n\ndef Xform \"World\"\n{{\n",
        quoted(generator)
    );
    let mut stage = Stage {
        text: &mut text,
        codes: &codes,
        names: BTreeSet::new(),
    };
    for (index, (rod, nodes)) in ranges(case).enumerate() {
        if rod.nodes >= 2 {
            let motion = motion(case, rod, nodes);
            stage.add_rod(rod, rod_color(index, rod.held), &motion);
        }
    }
    let grey = Color::BLACK.towards(Color::WHITE, 0.55);
    for (number, body) in case.obstacles.iter().enumerate() {
        stage.add_body(&format!("body_{}", number + 1), grey, body);
    }
    let pale = Color::BLACK.towards(Color::WHITE, 0.85);
    for (number, plane) in case.planes.iter().enumerate() {
        let corners = square(case, plane);
        let name = stage.name(&format!("plane_{}", number + 1));
        stage.add_mesh(&name, pale, &corners, 4, &[]);
    }
    text.push_str("}\n");
    text
}

struct Stage<'a> {
    text: &'a mut String,
    codes: &'a [f64],
    names: BTreeSet<String>,
}

impl Stage<'_> {
    /// An identifier that is not used yet.
    fn name(&mut self, wanted: &str) -> String {
        let allowed = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let mut name: String = wanted.chars().map(allowed).collect();
        if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
            name.insert(0, '_');
        }
        while !self.names.insert(name.clone()) {
            name.push('_');
        }
        name
    }

    fn line(&mut self, line: impl Display) {
        _ = writeln!(self.text, "        {line}");
    }

    fn begin(&mut self, kind: &str, name: &str, shown: &str) {
        let shown = quoted(shown);
        _ = writeln!(
            self.text,
            "    def {kind} \"{name}\" (\n        displayName = {shown}\n    )\n    {{"
        );
    }

    fn end(&mut self) {
        self.text.push_str("    }\n");
    }

    /// An attribute at each output, or once if it does not change.
    fn sampled(&mut self, attribute: &str, values: &[String], metadata: &str) {
        if values.iter().all(|value| *value == values[0]) {
            self.line(format_args!("{attribute} = {}{metadata}", values[0]));
            return;
        }
        if !metadata.is_empty() {
            self.line(format_args!("{attribute}{metadata}"));
        }
        self.line(format_args!("{attribute}.timeSamples = {{"));
        for (code, value) in self.codes.iter().zip(values) {
            _ = writeln!(self.text, "            {code}: {value},");
        }
        self.line("}");
    }

    fn colour(&mut self, colour: Color) {
        let [red, green, blue] = super::super::film::linear(colour);
        self.line(format_args!(
            "color3f[] primvars:displayColor = [({red}, {green}, {blue})]"
        ));
    }

    fn add_rod(&mut self, rod: &MovieRod, colour: Color, motion: &[Vec<Section>]) {
        let name = self.name(&rod.name);
        self.begin("BasisCurves", &name, &rod.name);
        self.line(format_args!("int[] curveVertexCounts = [{}]", rod.nodes));
        // A curve through two or three nodes is a polyline.
        if rod.nodes < 4 {
            self.line("uniform token type = \"linear\"");
        } else {
            self.line("uniform token type = \"cubic\"");
            self.line("uniform token basis = \"catmullRom\"");
        }
        self.line(match (rod.closed, rod.nodes < 4) {
            (true, _) => "uniform token wrap = \"periodic\"",
            (false, true) => "uniform token wrap = \"nonperiodic\"",
            (false, false) => "uniform token wrap = \"pinned\"",
        });
        let half = rod
            .strip
            .as_ref()
            .map_or(rod.radius, |strip| 0.5 * strip.width);
        let nodes = |sections: &'_ [Section]| -> Vec<Vector3<f64>> {
            let nodes = sections.iter().take(rod.nodes);
            nodes.map(|section| section.centre).collect()
        };
        let extents: Vec<String> = motion
            .iter()
            .map(|sections| list(&extent(&nodes(sections), half)))
            .collect();
        self.sampled("float3[] extent", &extents, "");
        let points: Vec<String> = motion
            .iter()
            .map(|sections| list(&nodes(sections)))
            .collect();
        self.sampled("point3f[] points", &points, "");
        if rod.strip.is_some() {
            let faces = |sections: &Vec<Section>| {
                let nodes = sections.iter().take(rod.nodes);
                list(
                    &nodes
                        .map(|section| section.axes.column(1).into())
                        .collect::<Vec<_>>(),
                )
            };
            let faces: Vec<String> = motion.iter().map(faces).collect();
            let metadata = " (\n            interpolation = \"vertex\"\n        )";
            self.sampled("normal3f[] normals", &faces, metadata);
        }
        let (widths, interpolation) = if rod.radii.is_empty() || rod.strip.is_some() {
            (vec![2.0 * half], "constant")
        } else {
            (
                rod.radii.iter().map(|radius| 2.0 * radius).collect(),
                "vertex",
            )
        };
        let widths: Vec<String> = widths
            .iter()
            .map(|width| (*width as f32).to_string())
            .collect();
        self.line(format_args!(
            "float[] widths = [{}] (\n            interpolation = \"{interpolation}\"\n        )",
            widths.join(", ")
        ));
        self.colour(colour);
        self.end();
    }

    fn add_body(&mut self, name: &str, colour: Color, body: &MovieObstacle) {
        if body.triangles.is_empty() {
            return;
        }
        let name = self.name(name);
        let corners: Vec<Vector3<f64>> = body.triangles.iter().flatten().copied().collect();
        self.add_mesh(&name, colour, &corners, 3, &body.poses);
    }

    /// Faces with `sides` corners each.
    fn add_mesh(
        &mut self,
        name: &str,
        colour: Color,
        corners: &[Vector3<f64>],
        sides: usize,
        poses: &[[f64; 16]],
    ) {
        self.begin("Mesh", name, name);
        self.line(format_args!(
            "float3[] extent = {}",
            list(&extent(corners, 0.0))
        ));
        let counts = vec![sides.to_string(); corners.len() / sides];
        self.line(format_args!(
            "int[] faceVertexCounts = [{}]",
            counts.join(", ")
        ));
        let numbers: Vec<String> = (0..corners.len())
            .map(|number| number.to_string())
            .collect();
        self.line(format_args!(
            "int[] faceVertexIndices = [{}]",
            numbers.join(", ")
        ));
        self.line(format_args!("point3f[] points = {}", list(corners)));
        self.line("uniform token subdivisionScheme = \"none\"");
        self.line("uniform bool doubleSided = 1");
        self.colour(colour);
        if !poses.is_empty() {
            let poses: Vec<String> = poses.iter().map(matrix).collect();
            self.sampled("matrix4d xformOp:transform", &poses, "");
            self.line("uniform token[] xformOpOrder = [\"xformOp:transform\"]");
        }
        self.end();
    }
}

/// A string of USD.
fn quoted(text: &str) -> String {
    let escaped = text.replace('\\', "\\\\").replace('"', "\\\"");
    format!("\"{}\"", escaped.replace(char::is_control, " "))
}

fn list(vectors: &[Vector3<f64>]) -> String {
    let entry = |vector: &Vector3<f64>| {
        let [x, y, z]: [f32; 3] = vector.map(|x| x as f32 + 0.0).into();
        format!("({x}, {y}, {z})")
    };
    let entries: Vec<String> = vectors.iter().map(entry).collect();
    format!("[{}]", entries.join(", "))
}

/// Corners of the box around points with a reach, m.
fn extent(points: &[Vector3<f64>], reach: f64) -> [Vector3<f64>; 2] {
    let lower = points
        .iter()
        .fold(Vector3::repeat(f64::INFINITY), |a, b| a.inf(b));
    let upper = points
        .iter()
        .fold(Vector3::repeat(f64::NEG_INFINITY), |a, b| a.sup(b));
    [lower.add_scalar(-reach), upper.add_scalar(reach)]
}

/// A matrix of USD, which multiplies rows from the right: its rows are the columns of `pose`.
fn matrix(pose: &[f64; 16]) -> String {
    let row = |row: usize| {
        let [x, y, z, w] = [0, 1, 2, 3].map(|k| pose[4 * row + k] + 0.0);
        format!("({x}, {y}, {z}, {w})")
    };
    format!("( {} )", [row(0), row(1), row(2), row(3)].join(", "))
}

#[cfg(test)]
mod tests {
    use super::super::tests::scene;
    use super::*;

    /// The text between a name and the end of its block.
    fn block<'a>(text: &'a str, start: &str) -> &'a str {
        let from = text.find(start).unwrap_or_else(|| panic!("{start}"));
        let end = text[from..].find("\n    }").unwrap();
        &text[from..from + end]
    }

    /// Numbers of a list of tuples.
    fn numbers(list: &str) -> Vec<f64> {
        list.split(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c)))
            .filter_map(|word| word.parse().ok())
            .collect()
    }

    #[test]
    fn points_are_the_nodes_at_every_output() {
        let case = scene();
        let text = usda(&case, Tempo { speed: 0.5 }, "test");
        for (name, (rod, nodes)) in ["tip__a_", "_2nd_ring", "sheet"].iter().zip(ranges(&case)) {
            let curve = block(&text, &format!("def BasisCurves \"{name}\""));
            assert!(curve.contains(&format!("curveVertexCounts = [{}]", rod.nodes)));
            let samples = curve.split_once("points.timeSamples = {\n").unwrap().1;
            let lines: Vec<&str> = samples.lines().take(3).collect();
            for (line, (frame, code)) in lines.iter().zip(case.frames.iter().zip([0.0, 24.0, 96.0]))
            {
                let (time, points) = line.split_once(": [").unwrap();
                assert_eq!(time.trim().parse::<f64>().unwrap(), code);
                let nodes = &frame.positions[nodes.clone()];
                let written = numbers(points);
                let expected = nodes.iter().flat_map(|node| node.iter().copied());
                let expected: Vec<f64> = expected.map(|x| f64::from(x as f32)).collect();
                let written: Vec<f64> = written.iter().map(|x| f64::from(*x as f32)).collect();
                assert_eq!(written, expected);
            }
        }
        for line in [
            "metersPerUnit = 1",
            "upAxis = \"Z\"",
            "timeCodesPerSecond = 24",
            "endTimeCode = 96",
        ] {
            assert!(text.contains(line), "{line}");
        }
        let depth =
            |open: char, close: char| text.matches(open).count() == text.matches(close).count();
        assert!(depth('{', '}') && depth('[', ']') && depth('(', ')'));
    }

    #[test]
    fn widths_are_diameters_and_rings_are_periodic() {
        let text = usda(&scene(), Tempo { speed: 1.0 }, "test");
        let widths = |name: &str| {
            let curve = block(&text, &format!("def BasisCurves \"{name}\""));
            let line = curve
                .lines()
                .find(|line| line.contains("widths = "))
                .unwrap();
            numbers(line.split_once('=').unwrap().1)
        };
        assert_eq!(widths("tip__a_"), [0.004, 0.0035, 0.003, 0.0025, 0.002]);
        assert_eq!(widths("_2nd_ring"), [0.004]);
        assert_eq!(widths("sheet"), [0.04]);
        assert!(block(&text, "def BasisCurves \"_2nd_ring\"").contains("\"periodic\""));
        assert!(block(&text, "def BasisCurves \"sheet\"").contains("normal3f[] normals"));
        assert!(text.contains("displayName = \"tip \\\"a\\\"\""));
    }

    #[test]
    fn a_body_moves_by_matrices_that_multiply_rows() {
        let text = usda(&scene(), Tempo { speed: 1.0 }, "test");
        let body = block(&text, "def Mesh \"body_1\"");
        let poses = body
            .split_once("xformOp:transform.timeSamples = {\n")
            .unwrap()
            .1;
        let last = poses.lines().nth(2).unwrap();
        assert_eq!(
            numbers(last.split_once(':').unwrap().1),
            [
                0., 1., 0., 0., -1., 0., 0., 0., 0., 0., 2., 0., 0.2, 0., 0.5, 1.
            ]
        );
        assert!(text.contains("def Mesh \"plane_1\""));
    }
}
