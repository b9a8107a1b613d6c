//! Contact of smooth curves instead of polylines.
//!
//! The centreline of a rod with the nodes x_i is the quadratic B-spline
//!
//! c(u) = Σ_i B(u − i) p_i,   B(s) = ¾ − s² for |s| ≤ ½, ½ (3/2 − |s|)² for ½ ≤ |s| ≤ 3/2,
//!
//! p_i = x_i − a (x_{i−1} − 2 x_i + x_{i+1}),   p = x at free ends.
//!
//! It has continuous tangents. With a = ⅛ the curve reproduces straight lines and parabolas. On a
//! circle of radius 3 h, with nodes 2.08 h apart, the radius of the curve ripples by 0.6 % of h,
//! and that of the polyline by 18 %. Control points beyond a free end are reflections, p_{−1} = 2
//! p_0 − p_1, so that the curve begins at the end.
//!
//! Contact acts on m = [`PER_EDGE`] chords for each edge, from c(u) to c(u + 1/m). For edges of
//! length ℓ, the middle of a chord lies κ ℓ²/(8 m²) inside a bend of curvature κ, and the chord
//! lies two thirds of that inside on average. With a = ⅛ + 1/(12 m²) the average is zero, so chords
//! lie on both sides of the bend.
//!
//! These contact points y = W x are linear in the nodes with constant weights W. So all of contact
//! applies to y in place of x: closest points, laws, friction, collision detection, certificates.
//! Nodes that move along straight lines move the contact points along straight lines. Forces on
//! the nodes are Wᵀf and Jacobians WᵀJW, which keeps them exact.

use crate::mechanics::Vector3;
use std::ops::Range;

/// Chords of the curve for each edge; even, so that no chord contains a joint of two parabolas.
///
/// The steps of the traction of knots fall with the square of this number; the time for them grows
/// with it.
pub(crate) const PER_EDGE: usize = 4;
/// Nodes on which a parabola depends.
pub(crate) const WINDOW: usize = 5;
/// Weight a of the second difference in the control points.
const FILTER: f64 = 0.125 + 1.0 / (12 * PER_EDGE * PER_EDGE) as f64;

/// A rod as a row of nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowOfNodes {
    /// First node of the row.
    pub first_node: usize,
    /// Number of nodes.
    pub nodes: usize,
    /// Whether the last node is joined to the first.
    pub closed: bool,
}

impl RowOfNodes {
    /// Number of chords.
    fn chords(&self) -> usize {
        PER_EDGE * (self.nodes - usize::from(!self.closed))
    }

    /// Number of contact points.
    fn points(&self) -> usize {
        self.chords() + usize::from(!self.closed)
    }

    /// The weights of all nodes at the place u along the rod, in edges.
    fn weights(&self, place: f64) -> Vec<f64> {
        let mut weights = vec![0.0; self.nodes];
        let last = self.nodes as isize - 1;
        let mut control = |k: isize, weight: f64| {
            let (before, own, after) = if self.closed {
                let at = |k: isize| k.rem_euclid(last + 1) as usize;
                (at(k - 1), at(k), at(k + 1))
            } else if k <= 0 || k >= last {
                weights[k.clamp(0, last) as usize] += weight;
                return;
            } else {
                (k as usize - 1, k as usize, k as usize + 1)
            };
            weights[before] -= weight * FILTER;
            weights[own] += weight * (1.0 + 2.0 * FILTER);
            weights[after] -= weight * FILTER;
        };
        let near = place.round() as isize;
        for k in near - 1..=near + 1 {
            let weight = spline(place - k as f64);
            if self.closed || (0..=last).contains(&k) {
                control(k, weight);
            } else {
                let end = if k < 0 { 0 } else { last };
                control(end, 2.0 * weight);
                control(2 * end - k, -weight);
            }
        }
        weights
    }

    /// The chord with a given number.
    fn window(&self, chord: usize) -> Window {
        let place = |k: usize| k as f64 / PER_EDGE as f64;
        let middle = (place(chord) + 0.5 / PER_EDGE as f64).round() as isize;
        let first = if self.closed {
            middle - 2
        } else {
            (middle - 2)
                .min(self.nodes as isize - WINDOW as isize)
                .max(0)
        };
        let nodes: [usize; WINDOW] =
            std::array::from_fn(|k| (first + k as isize).rem_euclid(self.nodes as isize) as usize);
        let weights = [place(chord), place(chord + 1)].map(|place| {
            let all = self.weights(place);
            // A node of a short rod may be listed twice; only its first place counts.
            std::array::from_fn(|k| match nodes[..k].contains(&nodes[k]) {
                true => 0.0,
                false => all[nodes[k]],
            })
        });
        Window {
            nodes: nodes.map(|node| self.first_node + node),
            weights,
        }
    }
}

/// The centred quadratic B-spline.
fn spline(s: f64) -> f64 {
    let s = s.abs();
    if s <= 0.5 {
        0.75 - s * s
    } else {
        0.5 * (1.5 - s).max(0.0).powi(2)
    }
}

/// The nodes on which a chord depends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Window {
    /// Nodes, successive along the rod.
    pub nodes: [usize; WINDOW],
    /// Their weights in the two ends of the chord.
    pub weights: [[f64; WINDOW]; 2],
}

/// The contact points of all rods as linear functions of the nodes.
#[derive(Clone, Debug, Default)]
pub(crate) struct CurvePoints {
    /// Chords of all rods, one after the other.
    windows: Vec<Window>,
    /// Chord of each point, and which of its ends the point is.
    places: Vec<(usize, usize)>,
    /// The ends of the edge of each point.
    edges: Vec<[usize; 2]>,
    /// First point of each rod, and the number of points.
    firsts: Vec<usize>,
}

impl CurvePoints {
    /// The curves of all rods.
    pub(crate) fn of(rods: impl Iterator<Item = RowOfNodes>) -> Self {
        let mut curves = Self {
            firsts: vec![0],
            ..Self::default()
        };
        for rod in rods {
            let first = curves.windows.len();
            let chords = rod.chords();
            curves
                .windows
                .extend((0..chords).map(|chord| rod.window(chord)));
            for point in 0..rod.points() {
                let chord = point.min(chords - 1);
                curves.places.push((first + chord, point - chord));
                let node = chord / PER_EDGE;
                let ends = [node, (node + 1) % rod.nodes];
                curves.edges.push(ends.map(|node| rod.first_node + node));
            }
            curves.firsts.push(curves.places.len());
        }
        curves
    }

    /// The points of a rod.
    pub(crate) fn of_rod(&self, rod: usize) -> Range<usize> {
        self.firsts[rod]..self.firsts[rod + 1]
    }

    /// A chord, numbered like the edges of the contact surface.
    pub(crate) fn window(&self, chord: usize) -> &Window {
        &self.windows[chord]
    }

    /// The ends of the edge of a rod that contains a point.
    pub(super) fn edge_of(&self, point: usize) -> [usize; 2] {
        self.edges[point]
    }

    /// The chord of a point, and the end of it that is the point.
    pub(crate) fn place_of(&self, point: usize) -> (usize, usize) {
        self.places[point]
    }

    /// Nodes with their weights in the position of a point.
    pub(super) fn terms(&self, point: usize) -> impl Iterator<Item = (usize, f64)> {
        let (chord, end) = self.places[point];
        let window = &self.windows[chord];
        let terms = window.nodes.into_iter().zip(window.weights[end]);
        terms.filter(|(_, weight)| *weight != 0.0)
    }

    /// Positions of all points for given nodes, m, or other vectors of the nodes interpolated.
    pub(crate) fn place(&self, nodes: &[Vector3]) -> Vec<Vector3> {
        let points = 0..self.places.len();
        let of_point = |point| self.interpolated(point, |node| nodes[node]);
        points.map(of_point).collect()
    }

    /// The sum of the vectors of the nodes of a point with their weights.
    pub(super) fn interpolated(&self, point: usize, of_node: impl Fn(usize) -> Vector3) -> Vector3 {
        let terms = self.terms(point);
        terms.map(|(node, weight)| of_node(node) * weight).sum()
    }

    /// Mobilities of the points for those of the nodes, m/N.
    pub(super) fn mobilities(&self, of_nodes: &[f64]) -> Vec<f64> {
        let of_point = |point| {
            let terms = self.terms(point);
            terms
                .map(|(node, weight)| weight * weight * of_nodes[node])
                .sum()
        };
        (0..self.places.len()).map(of_point).collect()
    }

    /// Whether a property holds for all nodes of each point.
    pub(super) fn all(&self, of_nodes: &[bool]) -> Vec<bool> {
        let of_point = |point| self.terms(point).all(|(node, _)| of_nodes[node]);
        (0..self.places.len()).map(of_point).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(nodes: usize, closed: bool) -> RowOfNodes {
        RowOfNodes {
            first_node: 0,
            nodes,
            closed,
        }
    }

    fn placed(nodes: &[Vector3], closed: bool) -> Vec<Vector3> {
        CurvePoints::of(std::iter::once(row(nodes.len(), closed))).place(nodes)
    }

    /// The curve by its definition, at the place u along an open or closed row of nodes.
    fn curve(nodes: &[Vector3], closed: bool, place: f64) -> Vector3 {
        let count = nodes.len() as isize;
        let node = |k: isize| match closed {
            true => nodes[k.rem_euclid(count) as usize],
            false => nodes[k as usize],
        };
        let inner = |k: isize| {
            if !closed && (k == 0 || k == count - 1) {
                return node(k);
            }
            node(k) - (node(k - 1) - node(k) * 2.0 + node(k + 1)) * FILTER
        };
        let control = |k: isize| {
            if closed || (0..count).contains(&k) {
                return inner(k);
            }
            let end = if k < 0 { 0 } else { count - 1 };
            inner(end) * 2.0 - inner(2 * end - k)
        };
        // The parabola around the nearest control point, by its Bézier points.
        let near = place.round() as isize;
        let t = place - near as f64 + 0.5;
        let [a, b, c] = [-1, 0, 1].map(|k| control(near + k));
        let ends = [(a + b) * 0.5, (b + c) * 0.5];
        ends[0] * (1.0 - t).powi(2) + b * (2.0 * t * (1.0 - t)) + ends[1] * (t * t)
    }

    #[test]
    fn points_are_on_the_curve() {
        for (count, closed) in [
            (2, false),
            (3, false),
            (4, false),
            (9, false),
            (4, true),
            (9, true),
        ] {
            let nodes: Vec<Vector3> = (0..count)
                .map(|k| {
                    let k = f64::from(k);
                    Vector3::new(k.cos() * 2.0, (1.3 * k).sin(), 0.1 * k * k)
                })
                .collect();
            let points = placed(&nodes, closed);
            let edges = nodes.len() - usize::from(!closed);
            assert_eq!(points.len(), PER_EDGE * edges + usize::from(!closed));
            for (index, point) in points.iter().enumerate() {
                let expected = curve(&nodes, closed, index as f64 / PER_EDGE as f64);
                assert!(
                    (point - expected).norm() < 1e-14,
                    "{count} {closed} {index}"
                );
            }
            if !closed {
                assert!((points[0] - nodes[0]).norm() < 1e-15);
                assert!((points[points.len() - 1] - nodes[nodes.len() - 1]).norm() < 1e-15);
            }
        }
    }

    /// Ripple and mean shift of the distance of a polyline from the centre of a circle.
    fn on_circle(points: &[Vector3], radius: f64) -> [f64; 2] {
        let chords = points.windows(2);
        let all: Vec<f64> = chords
            .flat_map(|ends| {
                (0..100).map(|k| (ends[0] + (ends[1] - ends[0]) * (f64::from(k) * 0.01)).norm())
            })
            .collect();
        let least = all.iter().copied().fold(f64::INFINITY, f64::min);
        let most = all.iter().copied().fold(0.0, f64::max);
        [
            most - least,
            all.iter().sum::<f64>() / all.len() as f64 - radius,
        ]
    }

    #[test]
    fn a_bend_of_three_radii_ripples_by_a_tenth_of_that_of_the_polyline() {
        for (length, polyline, ripple, shift) in [
            (2.08, 0.178, 0.0157, -0.0133),
            (1.04, 0.045, 0.0031, -0.0009),
        ] {
            let nodes: Vec<Vector3> = (0..40)
                .map(|k| {
                    let angle = f64::from(k) * length / 3.0;
                    Vector3::new(3.0 * angle.cos(), 3.0 * angle.sin(), 0.0)
                })
                .collect();
            let points = placed(&nodes, false);
            let found = on_circle(&points[8 * PER_EDGE..=32 * PER_EDGE], 3.0);
            assert!(
                (found[0] - ripple).abs() < 0.1 * ripple,
                "{length}: {found:?}"
            );
            assert!((found[1] - shift).abs() < 2e-4, "{length}: {found:?}");
            let [rough, _] = on_circle(&nodes[8..=32], 3.0);
            assert!((rough - polyline).abs() < 2e-3, "{length}: {rough}");
        }
    }

    #[test]
    fn forces_spread_with_their_resultant_and_moment() {
        for (count, closed) in [(2, false), (3, false), (7, false), (5, true), (9, true)] {
            let curves = CurvePoints::of(std::iter::once(row(count, closed)));
            let nodes: Vec<Vector3> = (0..count)
                .map(|k| Vector3::new((k as f64).sin(), (2.0 * k as f64).cos(), k as f64))
                .collect();
            for (point, place) in curves.place(&nodes).iter().enumerate() {
                let terms: Vec<_> = curves.terms(point).collect();
                let sum: f64 = terms.iter().map(|(_, weight)| weight).sum();
                assert!((sum - 1.0).abs() < 1e-15);
                let moment: Vector3 = terms.iter().map(|(k, w)| nodes[*k] * *w).sum();
                assert!((moment - place).norm() < 1e-14);
            }
        }
    }
}
