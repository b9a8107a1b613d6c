//! The rim of a tube in contact with a rod that leaves the tube through an end.
//!
//! The rim is a sharp circle. The rim touches a smooth curve along the polygon of the nodes, not
//! the polygon itself: the quadratic B-spline p(β) = Σ w_k(β) x_k through the middles of the edges,
//! with the edges as tangents there. Between the middles of two edges that meet in the node x₁ the
//! weights are w = (½(1−β)², ½ + β − β², ½β²); from an end of the rod to the middle of its first
//! edge the curve is straight. So the force of the rim turns continuously with the tangent of the
//! rod as the rod slides, without jumps from edge to edge.
//!
//! With the centre c of the rim, its axis t out of the tube, and p − c = ρ u + z t, the separation of the rod from its rim is
//!
//! r = p − q = (ρ − R) u + z t,   ∂r/∂p = H = 1 − (R/ρ) τ τᵀ,   τ = t × u,
//!
//! where q is the point of the rim that is nearest to p. The distance Δ = ‖r‖ is least where r·s = 0 for s = p′(β), so that the force is
//! normal to the rod. With n = r/Δ, a = w′ and Q = s·Hs + r·p″,
//!
//! - ∇Δ = w ⊗ n,
//! - ∂β = −(w ⊗ Hs + a ⊗ r)/Q, nothing at an end of a piece,
//! - ∂n = ((H − n nᵀ)(w ⊗ ·) + Hs ∂β)/Δ.
//!
//! A frictionless rod without clearance, bent by the moment M at the mouth, is pushed out of the
//! tube by M²/2EI (Bigoni, Dal Corso, Bosi and Misseroni 2015, "Eshelby-like forces acting on
//! elastic structures"). With clearance, the sum M²/2EI + T with the tension T is the same on
//! either side of the rim, since the force of the rim is normal to the rod.
//!
//! # What counts once
//!
//! Two pieces that meet near the rim are both near it, and a node in the tube near the rim is also
//! near the wall. Energies must neither count twice nor jump as the rod slides. So there are
//! counter-pairs, with the same law and a negative sign. Counter-pairs for the joints of pieces
//! make Σ U(pieces) − Σ U(joints) equal to U of the nearest point where only one is near. A
//! counter-pair for a node in the tube uses its distance from the rim. It makes U(wall) − U(rim)
//! fade as the node comes to the mouth, where the two energies and their gradients are equal. (Li,
//! Ferguson, Schneider et al. 2023, "Convergent incremental potential contact", count features of
//! meshes in this way.)

use super::contacts::{
    CandidatePair, EdgeJacobian, Linearised, RIM, RIM_END, RIM_JOINT, RIM_JOINT_END, RIM_NODE,
    RIM_START,
};
use super::edge_contact::Sliding;
use super::foot::Points;
use super::normal_response::NormalResponse;
use super::surface::ContactSurface;
use crate::mechanics::{Matrix3, Vector3};

/// Maximum number of iterations of the search for the nearest point of a piece; Newton's method
/// takes five, bisection all of them.
const ITERATIONS: usize = 80;

/// Remaining slack of a path at which a search along it ends, in units of its tolerance; below,
/// the maximum number of advances.
const USED_UP: f64 = 0.1;
const ADVANCES: usize = 1000;

/// The circle in which a tube ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rim {
    centre: Vector3,
    /// Unit vector along the axis out of the tube.
    outwards: Vector3,
    radius: f64,
}

/// A piece of a rod, or a point of it, that may be near a rim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RodPiece {
    /// Kind of the piece, as the side of its pairs.
    pub side: i8,
    /// Edge of the rod that identifies it.
    pub edge: usize,
    /// Nodes of the piece.
    pub nodes: [usize; 3],
}

/// The point of a piece that is nearest to a rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RimPoint {
    /// Weights w of the three nodes.
    weights: [f64; 3],
    /// Their rates a.
    rates: [f64; 3],
    /// Whether the point is free to move along the piece.
    free: bool,
    /// s = p′ and p″, m.
    slide: Vector3,
    bend: Vector3,
    /// r, m.
    separation: Vector3,
    /// ρ − R and z, m.
    radial: f64,
    axial: f64,
    /// τ, and R/ρ.
    around: Vector3,
    part: f64,
}

/// Derivatives of the direction of a contact and of its position on the piece; rows are
/// coordinates of the nodes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RimDerivatives {
    /// ∂n, 1/m.
    pub normal: [[f64; 12]; 3],
    /// ∂β, 1/m.
    pub ratio: [f64; 12],
}

impl Rim {
    /// A unit vector across the axis.
    fn any_direction(&self) -> Vector3 {
        let other = if self.outwards.x.abs() < 0.9 {
            Vector3::x()
        } else {
            Vector3::y()
        };
        self.outwards.cross(&other).normalize()
    }
}

impl ContactSurface {
    /// The rim of a pair that has one.
    pub(super) fn rim_of(&self, pair: &CandidatePair, points: &Points) -> Rim {
        let tube = &self.edges()[pair.edges[1]];
        let end = pair.nodes[3];
        let [first, second] = tube.nodes;
        let other = if first == end { second } else { first };
        let (centre, inside) = (points.at(end), points.at(other));
        Rim {
            centre,
            outwards: (centre - inside).normalize(),
            radius: tube.radius,
        }
    }
}

/// Weights of the nodes of a piece at β, with their first and second derivatives.
fn weights(side: i8, ratio: f64) -> [[f64; 3]; 3] {
    let (b, rest) = (ratio, 1.0 - ratio);
    match side {
        RIM => [
            [0.5 * rest * rest, 0.5 + b * rest, 0.5 * b * b],
            [-rest, rest - b, b],
            [1.0, -2.0, 1.0],
        ],
        RIM_START => [[1.0 - 0.5 * b, 0.5 * b, 0.0], [-0.5, 0.5, 0.0], [0.0; 3]],
        RIM_END => [
            [0.0, 0.5 * rest, 0.5 * (1.0 + b)],
            [0.0, -0.5, 0.5],
            [0.0; 3],
        ],
        RIM_JOINT => [[0.5, 0.5, 0.0], [0.0; 3], [0.0; 3]],
        RIM_JOINT_END => [[0.0, 0.5, 0.5], [0.0; 3], [0.0; 3]],
        _ => [[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]],
    }
}

fn weighted(nodes: &[Vector3; 3], weights: &[f64; 3]) -> Vector3 {
    nodes[0] * weights[0] + nodes[1] * weights[1] + nodes[2] * weights[2]
}

impl RimPoint {
    /// The nearest point of the piece of a `side`, whose nodes are the first three of these
    /// positions, whether the rim acts there or not. Pieces are assumed to have a single nearest
    /// point.
    pub(crate) fn nearest(side: i8, nodes: &[Vector3; 4], rim: &Rim) -> Self {
        let nodes = &[nodes[0], nodes[1], nodes[2]];
        let start = Self::at(side, nodes, rim, 0.0, false);
        if matches!(side, RIM_JOINT | RIM_JOINT_END | RIM_NODE) {
            return start;
        }
        let end = Self::at(side, nodes, rim, 1.0, false);
        match (start.slope() < 0.0, end.slope() > 0.0) {
            (true, true) => {}
            (true, false) => return end,
            (false, true) => return start,
            (false, false) => {
                let nearer = start.separation.norm_squared() <= end.separation.norm_squared();
                return if nearer { start } else { end };
            }
        }
        let (mut low, mut high, mut ratio) = (0.0, 1.0, 0.5);
        for _ in 0..ITERATIONS {
            let here = Self::at(side, nodes, rim, ratio, true);
            let (slope, curvature) = (here.slope(), here.curvature());
            if slope < 0.0 {
                low = ratio;
            } else {
                high = ratio;
            }
            let next = ratio - slope / curvature;
            let next = if curvature > 0.0 && low < next && next < high {
                next
            } else {
                0.5 * (low + high)
            };
            if (next - ratio).abs() <= f64::EPSILON {
                break;
            }
            ratio = next;
        }
        Self::at(side, nodes, rim, ratio, true)
    }

    /// The nearest point if the rim acts there: on rods within the tube or in front of its mouth.
    /// A rod that passes outside along the tube is ignored. For a node, the counter-pair to its
    /// contact with the wall acts only within the tube.
    pub(crate) fn of(side: i8, nodes: &[Vector3; 4], rim: &Rim) -> Option<Self> {
        let found = Self::nearest(side, nodes, rim);
        let is_felt = if side == RIM_NODE {
            found.radial < 0.0 && found.axial < 0.0
        } else {
            found.radial < 0.0 || found.axial >= found.radial
        };
        is_felt.then_some(found)
    }

    fn at(side: i8, nodes: &[Vector3; 3], rim: &Rim, ratio: f64, free: bool) -> Self {
        let [weights, rates, second] = weights(side, ratio);
        let from_centre = weighted(nodes, &weights) - rim.centre;
        let axial = from_centre.dot(&rim.outwards);
        let across = from_centre - rim.outwards * axial;
        let distance = across.norm();
        // All points of the rim are at the same distance from a point on the axis.
        let (outwards, part) = if distance > 0.0 {
            (across / distance, rim.radius / distance)
        } else {
            (rim.any_direction(), 0.0)
        };
        let radial = distance - rim.radius;
        Self {
            weights,
            rates,
            free,
            slide: weighted(nodes, &rates),
            bend: weighted(nodes, &second),
            separation: outwards * radial + rim.outwards * axial,
            radial,
            axial,
            around: rim.outwards.cross(&outwards),
            part,
        }
    }

    /// H times a vector.
    fn turned(&self, vector: &Vector3) -> Vector3 {
        vector - self.around * (self.part * self.around.dot(vector))
    }

    /// First and second derivative of ½Δ² along the piece, m².
    fn slope(&self) -> f64 {
        self.separation.dot(&self.slide)
    }

    fn curvature(&self) -> f64 {
        self.slide.dot(&self.turned(&self.slide)) + self.separation.dot(&self.bend)
    }

    /// Distance of the rod from the rim, m.
    pub(crate) fn distance(&self) -> f64 {
        self.separation.norm()
    }

    /// Unit normal, from the rim to the rod.
    pub(crate) fn normal(&self) -> Vector3 {
        self.separation / self.distance()
    }

    /// Weights of the three nodes and of the centre of the rim in the motion at the contact.
    pub(crate) fn all_weights(&self) -> [f64; 4] {
        let [a, b, c] = self.weights;
        [a, b, c, -1.0]
    }

    /// Derivatives of the weights along the piece.
    pub(crate) fn all_rates(&self) -> [f64; 4] {
        let [a, b, c] = self.rates;
        [a, b, c, 0.0]
    }

    /// Derivatives of direction and position with respect to the coordinates of the rod.
    pub(crate) fn derivatives(&self) -> RimDerivatives {
        let distance = self.distance();
        let normal = self.separation / distance;
        let turning = Matrix3::identity()
            - self.around * self.around.transpose() * self.part
            - normal * normal.transpose();
        let slide = self.turned(&self.slide);
        let inverse = if self.free {
            1.0 / self.curvature()
        } else {
            0.0
        };
        let mut found = RimDerivatives::default();
        for node in 0..3 {
            let (weight, rate) = (self.weights[node], self.rates[node]);
            for axis in 0..3 {
                let column = 3 * node + axis;
                let ratio = -inverse * (weight * slide[axis] + rate * self.separation[axis]);
                found.ratio[column] = ratio;
                for row in 0..3 {
                    let turned = weight * turning[(row, axis)] + slide[row] * ratio;
                    found.normal[row][column] = turned / distance;
                }
            }
        }
        found
    }

    /// ∇Δ = w ⊗ n with respect to the coordinates of the rod.
    pub(crate) fn gradient(&self) -> [f64; 12] {
        let normal = self.normal();
        std::array::from_fn(|column| {
            let node = column / 3;
            if node < 3 {
                self.weights[node] * normal[column % 3]
            } else {
                0.0
            }
        })
    }
}

/// Derivative of the force N w ⊗ (n + t) of a rim on a rod, N/m, for the friction law linearised
/// at the slip given with `sliding` (m/s). The derivatives of normal and contact point are
/// included only if the contact `turns`.
pub(super) fn rim_jacobian(
    point: &RimPoint,
    response: &NormalResponse,
    sliding: Option<(&Sliding, Vector3)>,
    turns: bool,
) -> Linearised<EdgeJacobian> {
    let derivatives = if turns {
        point.derivatives()
    } else {
        RimDerivatives::default()
    };
    let (weights, rates) = (point.all_weights(), point.all_rates());
    let (normal, gradient) = (point.normal(), point.gradient());
    let mut direction = normal;
    let mut direction_jacobian = derivatives.normal;
    let mut traction_gradient = [[0.0; 12]; 3];
    if let Some((sliding, at)) = sliding {
        let velocity = sliding.relative_velocity(&weights);
        let traction = sliding.traction_derivatives(&normal, velocity, &at);
        direction += traction.value;
        let by_ratio = traction.by_velocity * sliding.relative_velocity(&rates);
        let by_position = traction.by_velocity / sliding.time_step;
        for row in 0..3 {
            for column in 0..9 {
                let turned: f64 = (0..3)
                    .map(|k| traction.by_normal[(row, k)] * derivatives.normal[k][column])
                    .sum();
                let rate = turned
                    + by_ratio[row] * derivatives.ratio[column]
                    + weights[column / 3] * by_position[(row, column % 3)];
                traction_gradient[row][column] = rate;
                direction_jacobian[row][column] += rate;
            }
        }
    }
    let mut jacobian = [[0.0; 12]; 12];
    for node in 0..3 {
        for axis in 0..3 {
            let row = &mut jacobian[3 * node + axis];
            for column in 0..9 {
                let pressed = weights[node] * response.force_slope * gradient[column]
                    + response.force * rates[node] * derivatives.ratio[column];
                row[column] = pressed * direction[axis]
                    + response.force * weights[node] * direction_jacobian[axis][column];
            }
        }
    }
    Linearised {
        jacobian,
        gap_gradient: gradient,
        traction_gradient,
    }
}

/// The part, at most `longest`, of the straight path of a piece from `start` to `end` along which
/// it is certain to stay at least `kept` (m) from a rim that moves between two positions. The path
/// may end up to `tolerance` (m) before that distance is reached.
pub(super) fn fraction_beyond_rim(
    side: i8,
    [start, end]: [&[Vector3; 4]; 2],
    [from, to]: [&Rim; 2],
    [kept, tolerance]: [f64; 2],
    longest: f64,
) -> f64 {
    let farthest = (0..3).map(|k| (end[k] - start[k]).norm());
    // The points of a rim that turns move farther than its centre.
    let rim = (to.centre - from.centre).norm() + (to.outwards - from.outwards).norm() * to.radius;
    let speed = farthest.fold(0.0, f64::max) + rim;
    let mut fraction = 0.0;
    for _ in 0..ADVANCES {
        let nodes = std::array::from_fn(|k| start[k] + (end[k] - start[k]) * fraction);
        let there = Rim {
            centre: from.centre + (to.centre - from.centre) * fraction,
            outwards: (from.outwards + (to.outwards - from.outwards) * fraction).normalize(),
            radius: to.radius,
        };
        let distance = RimPoint::nearest(side, &nodes, &there).distance();
        let slack = distance - kept;
        if slack <= tolerance {
            return fraction;
        }
        if slack >= speed * (longest - fraction) {
            return longest;
        }
        fraction += slack / speed;
    }
    fraction
}

/// The part, at most `longest`, of the straight path of a piece by these displacements along which
/// a rim at rest keeps a fraction `part` of its gap beyond the distance `touch` (m).
pub(super) fn safe_fraction_at_rim(
    side: i8,
    nodes: &[Vector3; 4],
    displacements: &[Vector3; 4],
    rim: &Rim,
    [touch, part]: [f64; 2],
    longest: f64,
) -> f64 {
    let Some(point) = RimPoint::of(side, nodes, rim) else {
        return longest;
    };
    let gap = point.distance() - touch;
    if !(gap > 0.0) {
        return 0.0;
    }
    let kept = part * gap;
    let end = std::array::from_fn(|k| nodes[k] + displacements[k]);
    let bounds = [touch + kept, USED_UP * kept];
    fraction_beyond_rim(side, [nodes, &end], [rim, rim], bounds, longest)
}

/// The pieces of all rods that move, in order: pieces that touch rims, and the joints between
/// them.
pub(super) fn pieces_of(surface: &ContactSurface) -> Vec<RodPiece> {
    let mut pieces = Vec::new();
    let all = surface.rod_edges();
    let mut first = 0;
    while first < all.len() {
        let rod = all[first].rod;
        let count = all[first..]
            .iter()
            .take_while(|edge| edge.rod == rod)
            .count();
        let edges = first..first + count;
        first += count;
        // A rod of one edge is a bar without a curve through the middles of edges.
        if count < 2 || all[edges.start].held {
            continue;
        }
        let is_closed = all[edges.end - 1].nodes[1] == all[edges.start].nodes[0];
        let mut add = |side: i8, edge: usize, next: usize| {
            let ([a, b], [_, c]) = (all[edge].nodes, all[next].nodes);
            pieces.push(RodPiece {
                side,
                edge,
                nodes: [a, b, c],
            });
        };
        if !is_closed {
            add(RIM_START, edges.start, edges.start + 1);
        }
        for edge in edges.clone() {
            let next = if edge + 1 < edges.end {
                edge + 1
            } else if is_closed {
                edges.start
            } else {
                break;
            };
            add(RIM, edge, next);
            add(RIM_JOINT, edge, next);
        }
        if !is_closed {
            let before_last = edges.end - 2;
            add(RIM_JOINT_END, before_last, before_last + 1);
            add(RIM_END, before_last, before_last + 1);
        }
    }
    pieces
}

#[cfg(test)]
mod tests;
