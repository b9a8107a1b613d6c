//! Shapes of rigid obstacles: all points within a radius of some segments and triangles.

mod smooth;
mod surface;

pub use smooth::{NO_FACE, SmoothMesh};
pub use surface::neighbourhood;

use super::{UnitQuaternion, Vector3};
use std::collections::BTreeMap;

/// Sine of the angle between two faces up to which they count as one plane, so that their common
/// side makes no contact.
const FLAT: f64 = 1e-6;

/// A rigid body at time zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RigidBody {
    /// Vertices, m.
    pub vertices: Vec<Vector3>,
    /// Pairs of vertices; a pair of equal vertices is a point.
    pub segments: Vec<[usize; 2]>,
    /// For each side of a triangle, which are the first segments: the opposite vertices in its two
    /// triangles; `None` for a side of a single triangle.
    pub opposite: Vec<Option<[usize; 2]>>,
    /// Triangles, anticlockwise as seen from outside.
    pub faces: Vec<[usize; 3]>,
    /// Whether the faces enclose the body, so that it is touched from outside only; otherwise from
    /// both sides.
    pub closed: bool,
    /// Whether the body is a tube around its only segment, with rods inside.
    pub hollow: bool,
    /// Distance of the surface from segments and faces, m.
    pub radius: f64,
    /// The smooth surface that the faces stand for, see [`RigidBody::smoothed`].
    pub smooth: Option<SmoothMesh>,
}

/// Unit normal of a triangle.
fn normal_of([a, b, c]: &[Vector3; 3]) -> Vector3 {
    (b - a).cross(&(c - a)).normalize()
}

/// The triangles along each side, by its ends, the lower first, and whether each runs along it from
/// the lower to the higher end.
fn by_side(faces: &[[usize; 3]]) -> BTreeMap<[usize; 2], Vec<(usize, bool)>> {
    let mut sides: BTreeMap<[usize; 2], Vec<(usize, bool)>> = BTreeMap::new();
    for (triangle, face) in faces.iter().enumerate() {
        for k in 0..3 {
            let (from, to) = (face[k], face[(k + 1) % 3]);
            let ends = [from.min(to), from.max(to)];
            sides.entry(ends).or_default().push((triangle, from < to));
        }
    }
    sides
}

/// Fault of a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshFault {
    /// A mesh without triangles.
    #[error("it has no triangles")]
    Empty,
    /// A coordinate that is not finite.
    #[error("vertex {0} has a coordinate that is not finite")]
    NotFinite(usize),
    /// A corner that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are {vertices} vertices")]
    NoVertex {
        /// The triangle.
        triangle: usize,
        /// The vertex that it names.
        vertex: usize,
        /// Vertices there are.
        vertices: usize,
    },
    /// A triangle without area.
    #[error("triangle {0} has no area: two of its corners coincide, or all three are on one line")]
    Degenerate(usize),
    /// Neighbouring triangles have opposite orientations.
    #[error(
        "triangles {0} and {1} face opposite ways: one of the two has its corners in the wrong order"
    )]
    Flipped(usize, usize),
    /// More than two triangles along one side.
    #[error("{0} triangles meet along one side (triangle {1} is one of them); allowed: 2")]
    Branched(usize, usize),
    /// Sides with a triangle on one side only.
    #[error(
        "it has holes: {sides} of its sides belong to one triangle only (triangle {triangle} is the first of those)"
    )]
    Holes {
        /// Number of such sides.
        sides: usize,
        /// A triangle with one.
        triangle: usize,
    },
    /// All normals point inwards.
    #[error("its triangles face inwards: their corners run clockwise as seen from outside")]
    InsideOut,
}

impl RigidBody {
    /// All points within `radius` of a point, m.
    pub fn sphere(centre: Vector3, radius: f64) -> Self {
        Self {
            vertices: vec![centre],
            segments: vec![[0, 0]],
            radius,
            ..Self::default()
        }
    }

    /// All points within `radius` of the segment between two points, m.
    pub fn capsule(ends: [Vector3; 2], radius: f64) -> Self {
        Self {
            vertices: ends.to_vec(),
            segments: vec![[0, 1]],
            radius,
            ..Self::default()
        }
    }

    /// A cylinder around a line through a point along a unit vector, treated as endless: its ends
    /// are `half_length` (m) away, farther than any rod.
    pub fn cylinder(point: Vector3, axis: Vector3, radius: f64, half_length: f64) -> Self {
        let half = axis * half_length;
        Self::capsule([point - half, point + half], radius)
    }

    /// A tube of an inner radius (m) around the segment between two points, open at both ends.
    /// Rods inside stay inside, rods outside ignore it, and rods that leave through an end touch
    /// the rim.
    pub fn tube(ends: [Vector3; 2], radius: f64) -> Self {
        Self {
            hollow: true,
            ..Self::capsule(ends, radius)
        }
    }

    /// A rotated box of three side lengths (m) around a centre. The edges of the box are rounded to
    /// a radius (m) of less than half of the shortest side.
    pub fn cuboid(
        centre: Vector3,
        sides: Vector3,
        orientation: &UnitQuaternion,
        rounding: f64,
    ) -> Self {
        let half = sides * 0.5 - Vector3::repeat(rounding);
        let corner = |k: usize| {
            let side = |axis: usize| {
                if k >> axis & 1 == 1 {
                    half[axis]
                } else {
                    -half[axis]
                }
            };
            centre + orientation * Vector3::new(side(0), side(1), side(2))
        };
        // The four corners of each face, anticlockwise as seen from outside.
        let quads = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let faces = quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect();
        Self::of_mesh((0..8).map(corner).collect(), faces, true)
            .map(|body| Self {
                radius: rounding,
                ..body
            })
            .unwrap_or_default()
    }

    /// Typical side of a triangle, m: √(2A) of the mean area A; not a number without triangles.
    pub(crate) fn triangle_size(&self) -> f64 {
        let twice_area = |corners: &[usize; 3]| {
            let [a, b, c] = corners.map(|corner| self.vertices[corner]);
            (b - a).cross(&(c - a)).norm()
        };
        let sum: f64 = self.faces.iter().map(twice_area).sum();
        (sum / self.faces.len() as f64).sqrt()
    }

    /// Creates the body of a mesh. A `closed` mesh encloses a body that is touched from outside;
    /// otherwise it is a sheet that is touched from both sides. Vertices without a triangle are
    /// omitted.
    ///
    /// # Errors
    /// [`MeshFault`] names the faulty triangle.
    pub fn of_mesh(
        vertices: Vec<Vector3>,
        faces: Vec<[usize; 3]>,
        closed: bool,
    ) -> Result<Self, MeshFault> {
        if faces.is_empty() {
            return Err(MeshFault::Empty);
        }
        if let Some(vertex) = (vertices.iter()).position(|x| !x.iter().all(|c| c.is_finite())) {
            return Err(MeshFault::NotFinite(vertex));
        }
        let mut normals = Vec::with_capacity(faces.len());
        for (triangle, face) in faces.iter().enumerate() {
            if let Some(&vertex) = face.iter().find(|vertex| **vertex >= vertices.len()) {
                let vertices = vertices.len();
                return Err(MeshFault::NoVertex {
                    triangle,
                    vertex,
                    vertices,
                });
            }
            let [a, b, c] = face.map(|vertex| vertices[vertex]);
            let area = (b - a).cross(&(c - a));
            let longest = [b - a, c - b, a - c].map(|side| side.norm_squared());
            let longest = longest.into_iter().fold(0.0, f64::max);
            if area.norm() <= FLAT * FLAT * longest || longest == 0.0 {
                return Err(MeshFault::Degenerate(triangle));
            }
            normals.push(area.normalize());
        }
        let sides = by_side(&faces);
        let (mut segments, mut opposite) = (Vec::new(), Vec::new());
        let (mut open, mut first_open) = (0, usize::MAX);
        for (ends, around) in &sides {
            match around.as_slice() {
                [(triangle, _)] => {
                    open += 1;
                    first_open = first_open.min(*triangle);
                    segments.push(*ends);
                    opposite.push(None);
                }
                [(one, forwards), (other, too)] => {
                    if forwards == too {
                        return Err(MeshFault::Flipped(*one, *other));
                    }
                    if normals[*one].cross(&normals[*other]).norm() > FLAT {
                        segments.push(*ends);
                        // The third corner is the sum of all corners minus the two ends.
                        let third = |face: usize| {
                            let corners = faces[face];
                            corners.iter().sum::<usize>() - ends[0] - ends[1]
                        };
                        opposite.push(Some([third(*one), third(*other)]));
                    }
                }
                many => return Err(MeshFault::Branched(many.len(), many[0].0)),
            }
        }
        if closed && open > 0 {
            return Err(MeshFault::Holes {
                sides: open,
                triangle: first_open,
            });
        }
        let volume = |face: &[usize; 3]| {
            let [a, b, c] = face.map(|vertex| vertices[vertex]);
            a.dot(&b.cross(&c))
        };
        if closed && faces.iter().map(volume).sum::<f64>() < 0.0 {
            return Err(MeshFault::InsideOut);
        }
        Ok(Self {
            vertices,
            segments,
            opposite,
            faces,
            closed,
            ..Self::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_box() -> RigidBody {
        let sides = Vector3::new(1.0, 2.0, 3.0);
        RigidBody::cuboid(Vector3::zeros(), sides, &UnitQuaternion::identity(), 0.1)
    }

    #[test]
    fn a_box_has_twelve_edges_and_faces_outwards() {
        let body = unit_box();
        assert_eq!((body.segments.len(), body.faces.len()), (12, 12));
        assert!(body.closed && body.radius == 0.1);
        for face in &body.faces {
            let [a, b, c] = face.map(|vertex| body.vertices[vertex]);
            let outwards = (b - a).cross(&(c - a)).dot(&(a + b + c));
            assert!(outwards > 0.0);
        }
        assert!(body.vertices.contains(&Vector3::new(0.4, 0.9, 1.4)));
    }

    #[test]
    fn faults_of_meshes_are_named() {
        let RigidBody {
            vertices, faces, ..
        } = unit_box();
        let of = |faces: Vec<[usize; 3]>| RigidBody::of_mesh(vertices.clone(), faces, true);
        let without = faces[1..].to_vec();
        assert!(matches!(
            of(without.clone()),
            Err(MeshFault::Holes { sides: 3, .. })
        ));
        assert!(RigidBody::of_mesh(vertices.clone(), without, false).is_ok());
        let flipped: Vec<_> = (faces.iter().enumerate())
            .map(|(k, &[a, b, c])| if k == 5 { [a, c, b] } else { [a, b, c] })
            .collect();
        assert!(matches!(of(flipped), Err(MeshFault::Flipped(..))));
        let inwards = faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
        assert_eq!(of(inwards), Err(MeshFault::InsideOut));
        let twice = faces.iter().chain([&faces[3]]).copied().collect();
        assert!(matches!(of(twice), Err(MeshFault::Branched(3, _))));
        assert_eq!(of(vec![[0, 1, 1]]), Err(MeshFault::Degenerate(0)));
        assert_eq!(of(Vec::new()), Err(MeshFault::Empty));
        assert!(matches!(
            of(vec![[0, 1, 9]]),
            Err(MeshFault::NoVertex { vertex: 9, .. })
        ));
        let lost = vec![Vector3::zeros(), Vector3::x() * f64::NAN];
        assert_eq!(
            RigidBody::of_mesh(lost, vec![[0, 1, 0]], false),
            Err(MeshFault::NotFinite(1))
        );
    }
}
