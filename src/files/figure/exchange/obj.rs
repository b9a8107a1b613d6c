//! Surfaces at one output as an OBJ file, in metres with z up.

use super::super::motion::{MovieCase, placed};
use super::frames::ranges;
use super::surface::in_place;
use nalgebra::Vector3;
use std::fmt::Write;

/// The scene at the output `frame` as the text of an OBJ file, an object for each rod and each body.
/// Planes are left out.
pub fn obj(case: &MovieCase, frame: usize, generator: &str) -> String {
    let mut text = format!(
        "# {generator}, t = {} s, in metres, z up\n",
        case.frames[frame].time
    );
    let mut written = Written::default();
    for (rod, nodes) in ranges(case) {
        if rod.nodes < 2 {
            continue;
        }
        let surface = in_place(rod, &case.frames[frame].positions[nodes]);
        let name = rod.name.replace(char::is_whitespace, "_");
        _ = writeln!(text, "o {name}");
        written.add(
            &mut text,
            &surface.vertices,
            &surface.normals,
            &surface.triangles,
        );
    }
    for (number, body) in case.obstacles.iter().enumerate() {
        let pose = body.poses.get(frame);
        let corners = body.triangles.iter().flatten();
        let corners = corners.map(|corner| pose.map_or(*corner, |pose| placed(pose, corner)));
        let corners: Vec<Vector3<f64>> = corners.collect();
        let triangles: Vec<[u32; 3]> = (0..body.triangles.len() as u32)
            .map(|triangle| [0, 1, 2].map(|corner| 3 * triangle + corner))
            .collect();
        _ = writeln!(text, "o body_{}", number + 1);
        written.add(&mut text, &corners, &[], &triangles);
    }
    text
}

/// Numbers of vertices and normals written so far; those of faces count on through the file.
#[derive(Default)]
struct Written {
    vertices: usize,
    normals: usize,
}

impl Written {
    fn add(
        &mut self,
        text: &mut String,
        vertices: &[Vector3<f64>],
        normals: &[Vector3<f64>],
        triangles: &[[u32; 3]],
    ) {
        for (letters, vectors) in [("v", vertices), ("vn", normals)] {
            for vector in vectors {
                let [x, y, z]: [f32; 3] = vector.map(|x| x as f32 + 0.0).into();
                _ = writeln!(text, "{letters} {x} {y} {z}");
            }
        }
        for triangle in triangles {
            text.push('f');
            for corner in triangle {
                let vertex = self.vertices + *corner as usize + 1;
                if normals.is_empty() {
                    _ = write!(text, " {vertex}");
                } else {
                    let normal = self.normals + *corner as usize + 1;
                    _ = write!(text, " {vertex}//{normal}");
                }
            }
            text.push('\n');
        }
        self.vertices += vertices.len();
        self.normals += normals.len();
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::scene;
    use super::*;
    use crate::mesh;

    #[test]
    fn the_file_is_read_back_with_vertices_on_the_tubes() {
        let mut case = scene();
        case.rods.truncate(1);
        case.obstacles.clear();
        case.frames
            .iter_mut()
            .for_each(|frame| frame.positions.truncate(5));
        let text = obj(&case, 2, "test");
        assert!(text.starts_with("# test, t = 2 s"));
        let mesh = mesh::parse(text.as_bytes(), "obj").unwrap();
        assert!(mesh.triangles.len() > 100);
        // Points of the spline are at most this far from the polyline of these nodes, m.
        let sagitta = 2.5e-3;
        let nodes = &case.frames[2].positions;
        let mut thickest: f64 = 0.0;
        for vertex in &mesh.vertices {
            let at = Vector3::from(*vertex);
            let distance = nodes
                .windows(2)
                .map(|ends| {
                    let along = ends[1] - ends[0];
                    let part = (at - ends[0]).dot(&along) / along.norm_squared();
                    (at - ends[0] - along * part.clamp(0.0, 1.0)).norm()
                })
                .fold(f64::INFINITY, f64::min);
            assert!(distance < 2e-3 + sagitta, "{at} {distance}");
            thickest = thickest.max(distance);
        }
        assert!(thickest > 1.9e-3);
        // The first section and its cap have the radius of the first node.
        let cap = mesh
            .vertices
            .iter()
            .map(|vertex| (Vector3::from(*vertex) - nodes[0]).norm());
        let nearest = cap.fold(f64::INFINITY, f64::min);
        assert!((nearest - 2e-3).abs() < 1e-8, "{nearest}");
    }

    #[test]
    fn every_rod_and_body_is_an_object_with_numbers_that_count_on() {
        let case = scene();
        let text = obj(&case, 1, "test");
        let objects: Vec<&str> = text
            .lines()
            .filter_map(|line| line.strip_prefix("o "))
            .collect();
        assert_eq!(objects, ["tip_\"a\"", "2nd_ring", "sheet", "body_1"]);
        let mesh = mesh::parse(text.as_bytes(), "obj").unwrap();
        let last = mesh.triangles.last().unwrap();
        assert_eq!(*last, [3, 2, 1].map(|back| mesh.vertices.len() - back));
        // The body has moved by 0.1 m along x and by half a metre along z.
        assert_eq!(mesh.vertices[last[0]], [0.1, 0.0, 0.5]);
    }
}
