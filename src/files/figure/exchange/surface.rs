//! Triangles around a rod, from the mesher of films.

use super::super::film::{DrawnRod, Mesh};
use super::super::motion::{MovieRod, Strip};
use nalgebra::Vector3;

/// Sides of a tube.
const SIDES: f32 = 16.0;
/// Radius of tubes, and half the thickness of strips, in the samples of the mesher. It gives tubes
/// of [`SIDES`] sides.
const SAMPLES: f32 = 6.2;
/// Distance of the sections of a straight rod, samples.
const SPACING: f32 = 4.0 * SAMPLES;

/// A triangle mesh with normals.
#[derive(Clone, Debug, Default)]
pub(super) struct Surface {
    /// Vertices, m.
    pub vertices: Vec<Vector3<f64>>,
    pub normals: Vec<Vector3<f64>>,
    /// Anticlockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Vertices of films lie around the circle, so that tubes have its width on average; here they are
/// on the circle. The factor is that of the mesher for tubes of [`SIDES`] sides.
fn inset() -> f32 {
    1.0 / (1.5 - 0.5 * libm::cosf(std::f32::consts::PI / SIDES))
}

/// Samples per metre for a rod.
fn scale(rod: &MovieRod) -> f64 {
    let half = match &rod.strip {
        Some(strip) => 0.5 * strip.thickness.min(strip.width),
        None => rod.radius * f64::from(inset()),
    };
    f64::from(SAMPLES) / half
}

/// Half the sides of the section and the radii at the nodes, in samples.
fn thickness(rod: &MovieRod) -> ([f32; 2], Vec<f32>) {
    let scale = scale(rod);
    match &rod.strip {
        Some(strip) => (
            [strip.width, strip.thickness].map(|side| (0.5 * scale * side) as f32),
            Vec::new(),
        ),
        None => {
            let radii = rod.radii.iter().map(|radius| radius / rod.radius);
            let radii = radii.map(|part| part as f32 * SAMPLES);
            ([SAMPLES; 2], radii.collect())
        }
    }
}

fn surface_of(mesh: &Mesh, place: impl Fn([f32; 3]) -> Vector3<f64>) -> Surface {
    let vector = |place: [f32; 3]| Vector3::from(place.map(f64::from));
    let mut surface = Surface::default();
    for [at, normal] in mesh.corners() {
        surface.vertices.push(place(at));
        surface.normals.push(vector(normal));
    }
    for &triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|corner| &surface.vertices[corner as usize]);
        let faces = (b - a).cross(&(c - a));
        let out: Vector3<f64> = triangle
            .map(|corner| surface.normals[corner as usize])
            .iter()
            .sum();
        let [a, b, c] = triangle;
        surface.triangles.push(if faces.dot(&out) < 0.0 {
            [a, c, b]
        } else {
            [a, b, c]
        });
    }
    surface
}

/// The surface of a rod at one time, around the spline through its nodes.
pub(super) fn in_place(rod: &MovieRod, points: &[Vector3<f64>]) -> Surface {
    let scale = scale(rod);
    let (half, radii) = thickness(rod);
    let origin = points.first().copied().unwrap_or_else(Vector3::zeros);
    let nodes: Vec<[f32; 3]> = points
        .iter()
        .map(|point| ((point - origin) * scale).map(|x| x as f32).into())
        .collect();
    let across = across(rod.strip.as_ref(), points, rod.closed);
    let mut mesh = Mesh::default();
    mesh.add_rod(&DrawnRod {
        nodes: &nodes,
        across: &across,
        closed: rod.closed,
        half,
        radii: &radii,
        material: 0,
    });
    surface_of(&mesh, |at| {
        origin + Vector3::from(at.map(f64::from)) / scale
    })
}

fn across(strip: Option<&Strip>, points: &[Vector3<f64>], closed: bool) -> Vec<[f32; 3]> {
    let Some(strip) = strip else {
        return Vec::new();
    };
    let across = (0..points.len()).map(|node| strip.across(node, points, closed));
    across
        .map(|across| across.map(|x| x as f32).into())
        .collect()
}

/// The surface of a rod without a place: for each vertex the number of its section, and its position
/// from the centre of the section along its axes, m. A closed rod has the section of its first node
/// twice.
pub(super) fn around_sections(rod: &MovieRod) -> (Surface, Vec<usize>) {
    let sections = rod.nodes + usize::from(rod.closed);
    let (half, mut radii) = thickness(rod);
    if rod.closed {
        radii.extend(radii.first().copied());
    }
    let nodes: Vec<[f32; 3]> = (0..sections)
        .map(|section| [0.0, 0.0, SPACING * section as f32])
        .collect();
    let across = match &rod.strip {
        Some(_) => vec![[1.0, 0.0, 0.0]; sections],
        None => Vec::new(),
    };
    let mut mesh = Mesh::default();
    mesh.add_rod(&DrawnRod {
        nodes: &nodes,
        across: &across,
        closed: false,
        half,
        radii: &radii,
        material: 0,
    });
    let section = |z: f32| ((z / SPACING).round().max(0.0) as usize).min(sections - 1);
    let owners: Vec<usize> = mesh.corners().map(|[at, _]| section(at[2])).collect();
    let scale = scale(rod);
    let mut surface = surface_of(&mesh, |at| Vector3::from(at.map(f64::from)));
    for (vertex, owner) in surface.vertices.iter_mut().zip(&owners) {
        vertex.z -= f64::from(SPACING * *owner as f32);
        *vertex /= scale;
    }
    if rod.closed {
        // A ring has no ends: leave out the caps and the ends of strips.
        let is_end = |corner: u32| {
            let along = surface.normals[corner as usize].z;
            along.abs() > 1e-3
        };
        surface
            .triangles
            .retain(|triangle| !triangle.iter().any(|corner| is_end(*corner)));
    }
    (surface, owners)
}

#[cfg(test)]
mod tests {
    use super::super::frames::{ranges, sections};
    use super::super::tests::scene;
    use super::*;

    #[test]
    fn vertices_of_tubes_have_the_radius_of_the_rod() {
        let case = scene();
        for (rod, _) in ranges(&case).filter(|(rod, _)| rod.strip.is_none()) {
            let (surface, owners) = around_sections(rod);
            for (vertex, owner) in surface.vertices.iter().zip(&owners) {
                let radius = rod.radius_at(owner % rod.nodes);
                assert!((vertex.norm() / radius - 1.0).abs() < 1e-5, "{vertex}");
            }
        }
    }

    /// Volume enclosed by a surface, by the divergence theorem; holes count for nothing if their
    /// fan around the origin of coordinates has no volume.
    fn volume(surface: &Surface) -> f64 {
        let at = |corner: u32| &surface.vertices[corner as usize];
        let cones = surface.triangles.iter();
        cones
            .map(|[a, b, c]| at(*a).dot(&at(*b).cross(at(*c))) / 6.0)
            .sum()
    }

    #[test]
    fn a_tube_in_place_encloses_its_volume_and_faces_outwards() {
        let rod = MovieRod {
            name: "rod".into(),
            nodes: 3,
            closed: false,
            radius: 1e-2,
            radii: Vec::new(),
            held: false,
            straight: false,
            strip: None,
        };
        let points = [0.0, 0.1, 0.2].map(|x| Vector3::new(x, 3.0 * x, 1.0));
        let length = (points[2] - points[0]).norm();
        let ball = 4.0 / 3.0 * std::f64::consts::PI * 1e-6;
        let exact = std::f64::consts::PI * 1e-4 * length + ball;
        let found = volume(&in_place(&rod, &points));
        // A polygon of 16 sides has 2.55 % less area than its circle.
        assert!((found / exact - 0.9745).abs() < 3e-3, "{}", found / exact);
    }

    #[test]
    fn sections_placed_by_their_axes_are_the_surface_in_place() {
        let case = scene();
        for (rod, nodes) in ranges(&case).filter(|(rod, _)| !rod.closed) {
            let points = &case.frames[0].positions[nodes];
            let (surface, owners) = around_sections(rod);
            let sections = sections(rod, points, None);
            let mut placed = surface.clone();
            for (vertex, owner) in placed.vertices.iter_mut().zip(&owners) {
                *vertex = sections[*owner].placed(vertex);
            }
            // The rods are straight at first.
            let found = volume(&placed) / volume(&in_place(rod, points));
            assert!((found - 1.0).abs() < 1e-3, "{} {found}", rod.name);
        }
    }
}
