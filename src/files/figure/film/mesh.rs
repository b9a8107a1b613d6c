//! Surfaces as triangles in picture axes: tubes, strips and rigid bodies.
//!
//! The arrays are reused from picture to picture, so that a film allocates them once.

use super::samples::{Corner, Samples};
use std::ops::Range;

/// A vector in samples: right, down, towards the eye.
pub(in crate::figure) type Place = [f32; 3];

/// Minimum drawn thickness, samples: thinner objects would be invisible.
const LEAST_RADIUS: f32 = 1.4;
/// Tolerance of the outline of a tube, samples.
const SAGITTA: f32 = 0.12;
/// Rotation of a tube from ring to ring, rad, and maximum number of rings of a segment.
const TURN: f32 = 0.16;
const MOST_RINGS: usize = 10;

/// Triangles of one material.
struct Part {
    triangles: Range<usize>,
    material: u8,
    one_sided: bool,
}

/// The surface of a scene at one time.
#[derive(Default)]
pub(in crate::figure) struct Mesh {
    corners: Vec<Corner>,
    triangles: Vec<[u32; 3]>,
    parts: Vec<Part>,
    /// Centres, tangents and widths of the rings of a rod; cosines and sines around them.
    rings: Vec<Ring>,
    around: Vec<[f32; 2]>,
}

/// A cross-section of a rod.
#[derive(Clone, Copy)]
struct Ring {
    centre: Place,
    tangent: Place,
    across: Place,
    /// Radius of a tube, relative to that of the rod.
    part: f32,
}

/// A rod in the axes of the picture.
pub(in crate::figure) struct DrawnRod<'a> {
    pub nodes: &'a [Place],
    /// Directions along the width of a strip at each node; empty for a tube.
    pub across: &'a [Place],
    pub closed: bool,
    /// Radius of a tube, or half the width and half the thickness of a strip.
    pub half: [f32; 2],
    /// Radii of a tube at its nodes, if they vary.
    pub radii: &'a [f32],
    pub material: u8,
}

impl Mesh {
    /// Removes all triangles.
    pub fn clear(&mut self) {
        self.corners.clear();
        self.triangles.clear();
        self.parts.clear();
    }

    /// Whether the mesh is empty.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Positions of the corners.
    pub fn places(&self) -> impl Iterator<Item = Place> {
        self.corners.iter().map(|corner| corner.at)
    }

    /// Position and normal of each corner.
    pub fn corners(&self) -> impl Iterator<Item = [Place; 2]> {
        self.corners.iter().map(|corner| [corner.at, corner.normal])
    }

    /// Numbers of the corners of each triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Draws the triangles.
    pub(super) fn draw(&self, samples: &mut Samples) {
        for part in &self.parts {
            for triangle in &self.triangles[part.triangles.clone()] {
                let corners = triangle.map(|corner| &self.corners[corner as usize]);
                samples.fill(corners, part.material, part.one_sided);
            }
        }
    }

    /// Visits the positions of each triangle.
    pub fn each_triangle(&self, mut take: impl FnMut([Place; 3])) {
        for triangle in &self.triangles {
            take(triangle.map(|corner| self.corners[corner as usize].at));
        }
    }

    fn end_part(&mut self, first: usize, material: u8, one_sided: bool) {
        self.parts.push(Part {
            triangles: first..self.triangles.len(),
            material,
            one_sided,
        });
    }

    fn corner(&mut self, at: Place, normal: Place) {
        self.corners.push(Corner { at, normal });
    }

    /// Adds the surface of a rod around the Catmull–Rom spline through its nodes.
    pub fn add_rod(&mut self, rod: &DrawnRod) {
        if rod.nodes.len() < 2 {
            return;
        }
        let first = self.triangles.len();
        self.lay_rings(rod);
        if rod.across.is_empty() {
            self.add_tube(rod.half[0].max(LEAST_RADIUS), rod.closed);
        } else {
            self.add_strip(
                rod.half.map(|half| half.max(0.5 * LEAST_RADIUS)),
                rod.closed,
            );
        }
        self.end_part(first, rod.material, rod.across.is_empty());
    }

    /// Cross-sections along a rod, denser where it bends more. On tubes their first direction is
    /// transported without twist.
    fn lay_rings(&mut self, rod: &DrawnRod) {
        self.rings.clear();
        let count = rod.nodes.len();
        let segments = if rod.closed { count } else { count - 1 };
        for segment in 0..segments {
            let next = (segment + 1) % count;
            let [a, b] = [rod.nodes[segment], rod.nodes[next]];
            let chord = minus(b, a);
            let [leaving, arriving] = [segment, next].map(|node| slope(rod, node, chord));
            let bend = norm(minus(unit(arriving), unit(leaving)));
            let rings = (bend / TURN).min(norm(chord) / 3.0).ceil() as usize;
            let rings = rings.clamp(1, MOST_RINGS);
            let is_last = segment + 1 == segments;
            for ring in 0..rings + usize::from(is_last) {
                let s = ring as f32 / rings as f32;
                let r = 1.0 - s;
                let weights = [
                    r * r * (1.0 + 2.0 * s),
                    s * s * (3.0 - 2.0 * s),
                    s * r * r,
                    -s * s * r,
                ];
                let centre = sum(&[a, b, leaving, arriving], &weights);
                let weights = [6.0 * s * r, r * (1.0 - 3.0 * s), s * (3.0 * s - 2.0)];
                let tangent = unit(sum(&[chord, leaving, arriving], &weights));
                let across = match (rod.across.is_empty(), self.rings.last()) {
                    (false, _) => sum(&[rod.across[segment], rod.across[next]], &[r, s]),
                    (true, Some(before)) => before.across,
                    (true, None) if tangent[2].abs() < 0.8 => [0.0, 0.0, 1.0],
                    (true, None) => [1.0, 0.0, 0.0],
                };
                let square = minus(across, times(tangent, dot(across, tangent)));
                let part = match rod.radii {
                    [] => 1.0,
                    radii => (r * radii[segment] + s * radii[next]) / rod.half[0],
                };
                self.rings.push(Ring {
                    centre,
                    tangent,
                    across: unit(square),
                    part,
                });
            }
        }
    }

    /// Adds a tube around the rings, with round ends.
    fn add_tube(&mut self, radius: f32, closed: bool) {
        let count = (std::f32::consts::PI / (2.0 * SAGITTA / radius).sqrt()).ceil();
        let count = (count as usize).clamp(6, 64);
        self.turn_around(count);
        // The mean of the radii for an inscribed and a circumscribed polygon: the tube has the
        // width of the circle on average.
        let radius = radius * (1.5 - 0.5 * libm::cosf(std::f32::consts::PI / count as f32));
        let first = self.corners.len();
        let mut rows = 0;
        let caps = if closed { 0 } else { count.div_ceil(4).max(2) };
        let rings = std::mem::take(&mut self.rings);
        let ends = [rings[0], rings[rings.len() - 1]];
        for row in (1..=caps).rev() {
            self.add_ring(&ends[0], radius, -(row as f32) / caps as f32);
            rows += 1;
        }
        for ring in &rings {
            self.add_ring(ring, radius, 0.0);
            rows += 1;
        }
        for row in 1..=caps {
            self.add_ring(&ends[1], radius, row as f32 / caps as f32);
            rows += 1;
        }
        for row in 1..rows {
            for k in 0..count {
                let next = (k + 1) % count;
                let at = |row: usize, k: usize| (first + row * count + k) as u32;
                let [a, b, c, d] = [at(row - 1, k), at(row - 1, next), at(row, k), at(row, next)];
                self.triangles.extend([[a, b, c], [b, d, c]]);
            }
        }
        self.rings = rings;
    }

    /// The directions around a tube.
    fn turn_around(&mut self, count: usize) {
        if self.around.len() != count {
            let angle = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
            self.around.clear();
            self.around.extend((0..count).map(|k| {
                let (sine, cosine) = libm::sincos(angle(k));
                [cosine as f32, sine as f32]
            }));
        }
    }

    /// Adds a ring of corners. `cap` is its position on the round end, from −1 at the first point
    /// to 1 at the last.
    fn add_ring(&mut self, ring: &Ring, radius: f32, cap: f32) {
        let other = cross(ring.tangent, ring.across);
        // Rows of a cap are evenly spaced along its meridians.
        let (along, out) = libm::sincosf(cap * std::f32::consts::FRAC_PI_2);
        for k in 0..self.around.len() {
            let [cosine, sine] = self.around[k];
            let weights = [out * cosine, out * sine, along];
            let normal = sum(&[ring.across, other, ring.tangent], &weights);
            self.corner(plus(ring.centre, times(normal, radius * ring.part)), normal);
        }
    }

    /// Adds a strip along the rings: two faces, two edges and two ends, each with normals of its
    /// own.
    fn add_strip(&mut self, half: [f32; 2], closed: bool) {
        let rings = std::mem::take(&mut self.rings);
        for side in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0f32]] {
            let first = self.corners.len();
            for ring in &rings {
                let axes = [ring.across, cross(ring.tangent, ring.across)];
                let normal = sum(&axes, &side);
                // The face extends to both sides of its middle.
                for end in [-1.0, 1.0] {
                    let (x, y) = (side[0] - end * side[1], side[1] + end * side[0]);
                    let corner = sum(&axes, &[half[0] * x, half[1] * y]);
                    self.corner(plus(ring.centre, corner), normal);
                }
            }
            for ring in 1..rings.len() {
                let [a, b, c, d] =
                    [2, 1, 0, -1].map(|back| (first as isize + 2 * ring as isize - back) as u32);
                self.triangles.extend([[a, b, c], [b, d, c]]);
            }
        }
        let ends: &[(usize, f32)] = if closed {
            &[]
        } else {
            &[(0, -1.0), (rings.len() - 1, 1.0)]
        };
        for (ring, sign) in ends {
            let first = self.corners.len() as u32;
            let ring = &rings[*ring];
            let axes = [ring.across, cross(ring.tangent, ring.across)];
            for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
                let corner = sum(&axes, &[half[0] * x, half[1] * y]);
                self.corner(plus(ring.centre, corner), times(ring.tangent, *sign));
            }
            self.triangles
                .extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        self.rings = rings;
    }

    /// Adds triangles with a normal at each corner.
    pub(super) fn add_body(&mut self, corners: impl Iterator<Item = [Corner; 3]>, material: u8) {
        let first = self.triangles.len();
        for triangle in corners {
            let number = self.corners.len() as u32;
            self.corners.extend(triangle);
            self.triangles.push([number, number + 1, number + 2]);
        }
        self.end_part(first, material, false);
    }
}

/// Slope of the spline at a node: half the difference of the neighbours, the chord at an open end.
fn slope(rod: &DrawnRod, node: usize, chord: Place) -> Place {
    let last = rod.nodes.len() - 1;
    let (before, after) = match (rod.closed, node) {
        (false, 0) => return chord,
        (false, node) if node == last => return chord,
        (_, 0) => (last, 1),
        (_, node) => (node - 1, if node == last { 0 } else { node + 1 }),
    };
    times(minus(rod.nodes[after], rod.nodes[before]), 0.5)
}

pub(super) fn plus(a: Place, b: Place) -> Place {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn minus(a: Place, b: Place) -> Place {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn times(a: Place, factor: f32) -> Place {
    a.map(|x| factor * x)
}

pub(super) fn dot(a: Place, b: Place) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: Place, b: Place) -> Place {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub(super) fn norm(a: Place) -> f32 {
    dot(a, a).sqrt()
}

/// The vector with length one; zero stays zero.
pub(super) fn unit(a: Place) -> Place {
    times(a, 1.0 / norm(a).max(1e-20))
}

fn sum<const N: usize>(vectors: &[Place; N], weights: &[f32; N]) -> Place {
    let parts = vectors.iter().zip(weights);
    parts.fold([0.0; 3], |sum, (vector, weight)| {
        plus(sum, times(*vector, *weight))
    })
}

#[cfg(test)]
mod tests {
    use super::super::samples::{NOTHING, unpacked};
    use super::*;
    use std::f64::consts::PI;

    /// A drawn rod.
    fn drawn(nodes: &[Place], across: &[Place], half: [f32; 2], closed: bool) -> Samples {
        let mut mesh = Mesh::default();
        mesh.add_rod(&DrawnRod {
            nodes,
            across,
            closed,
            half,
            radii: &[],
            material: 1,
        });
        let mut samples = Samples::new(600, 400);
        mesh.draw(&mut samples);
        samples
    }

    /// Samples that a rod covers.
    fn covered(nodes: &[Place], across: &[Place], half: [f32; 2], closed: bool) -> f64 {
        let samples = drawn(nodes, across, half, closed);
        samples
            .depth
            .iter()
            .filter(|depth| **depth > NOTHING)
            .count() as f64
    }

    #[test]
    fn the_front_of_a_rod_is_seen_and_faces_the_eye() {
        let nodes = [[200.0, 200.0, 10.0], [400.0, 200.0, 10.0]];
        for (across, half, front) in [
            (vec![], [50.0; 2], 60.0),
            (vec![[0.0, 1.0, 0.0]; 2], [80.0, 5.0], 15.0),
        ] {
            let samples = drawn(&nodes, &across, half, false);
            let middle = 200 * samples.width + 300;
            assert!(
                (samples.depth[middle] - front).abs() < 0.3,
                "{}",
                samples.depth[middle]
            );
            let (_, normal) = unpacked(samples.surface[middle]);
            assert!(normal[2] > 0.99, "{normal:?}");
            // Above the middle the tube faces upwards, towards smaller rows.
            if across.is_empty() {
                let (_, normal) = unpacked(samples.surface[170 * samples.width + 300]);
                assert!(normal[1] < -0.5, "{normal:?}");
            }
        }
    }

    #[test]
    fn a_rod_has_its_projected_width_and_round_ends() {
        for radius in [4.0f32, 17.0, 60.0] {
            let nodes = [
                [150.3, 100.2, 0.0],
                [301.6, 193.9, 40.0],
                [452.9, 287.6, 80.0],
            ];
            // In an oblique view the cylinder is shorter; the ends are still half circles with its
            // radius.
            let length = (302.6f64 * 302.6 + 187.4 * 187.4).sqrt();
            let radius_m = f64::from(radius);
            let area = 2.0 * radius_m * length + PI * radius_m * radius_m;
            let seen = covered(&nodes, &[], [radius; 2], false);
            assert!((seen / area - 1.0).abs() < 0.015, "{radius}: {seen} {area}");
        }
    }

    #[test]
    fn a_rod_shorter_than_thick_is_seen_as_a_capsule_and_nearly_as_a_sphere() {
        for (length, direction) in [
            (0.01, [1.0, 0.0, 0.0]),
            (0.01, [0.0, 0.0, 1.0]),
            (30.0, [0.0, 1.0, 0.0]),
        ] {
            let radius = 120.0;
            let half = times(direction, 0.5 * length);
            let middle = [300.0, 200.0, 0.0];
            let nodes = [minus(middle, half), plus(middle, half)];
            let seen = covered(&nodes, &[], [radius; 2], false);
            let across = f64::from(length * (direction[0] + direction[1]));
            let area = PI * 120.0 * 120.0 + 240.0 * across;
            assert!((seen / area - 1.0).abs() < 0.005, "{length}: {seen} {area}");
        }
    }

    #[test]
    fn a_ring_covers_the_area_between_its_circles() {
        let point = |k: usize| {
            let (sine, cosine) = (2.0 * PI * k as f64 / 40.0).sin_cos();
            [
                (300.0 + 130.0 * cosine) as f32,
                (200.0 + 130.0 * sine) as f32,
                0.0,
            ]
        };
        let nodes: Vec<Place> = (0..40).map(point).collect();
        let seen = covered(&nodes, &[], [20.0; 2], true);
        let area = PI * (150.0 * 150.0 - 110.0 * 110.0);
        assert!((seen / area - 1.0).abs() < 0.01, "{seen} {area}");
    }

    #[test]
    fn a_strip_is_as_wide_as_it_is_turned_towards_the_eye() {
        let nodes = [
            [100.0, 200.0, 0.0],
            [300.0, 200.0, 0.0],
            [500.0, 200.0, 0.0],
        ];
        for angle in [0.0f64, 0.6, 1.2] {
            let across = [0.0, angle.cos() as f32, angle.sin() as f32];
            let seen = covered(&nodes, &[across; 3], [80.0, 3.0], false);
            let area = 400.0 * 2.0 * (80.0 * angle.cos() + 3.0 * angle.sin());
            assert!((seen / area - 1.0).abs() < 0.01, "{angle}: {seen} {area}");
        }
    }
}
