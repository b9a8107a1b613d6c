//! The rim of a tube, on which a rod bears that leaves by an end.
//!
//! The rim is a circle, sharp. What it touches is not the polygon of the nodes but the smooth curve that goes with it: the quadratic
//! B-spline p(β) = Σ w_k(β) x_k through the middles of the edges, with the edges as tangents there. Between the middles of two edges that
//! meet in the node x₁ it is w = (½(1−β)², ½ + β − β², ½β²), and straight from an end of the rod to the middle of its first edge. So the
//! force of the rim turns with the tangent of the rod as the rod slides, not by leaps from edge to edge.
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
//! A frictionless rod without clearance, bent by the moment M at the mouth, is pushed out of the tube by M²/2EI (Bigoni, Dal Corso,
//! Bosi and Misseroni 2015, "Eshelby-like forces acting on elastic structures"). With clearance it is the sum M²/2EI + T of moment and tension T
//! that is the same on either side of the rim, since the force there is normal to the rod.
//!
//! # What counts once
//!
//! Two pieces that meet near the rim are both near it, and so is a node in the tube that is near the rim as well as the wall. That
//! energies neither count twice nor leap as the rod slides, some pairs count against others, with the same law and a negative sign: the
//! joints of pieces, so that Σ U(pieces) − Σ U(joints) is U of the nearest point where one is near, and for a node within the tube
//! its distance from the rim, so that U(wall) − U(rim) fades as it comes to the mouth, where the two are equal and so are their
//! gradients. (Li, Ferguson, Schneider et al. 2023, "Convergent incremental potential contact", count features of meshes so.)

use super::contacts::{
    CandidatePair, EdgeJacobian, Linearised, RIM, RIM_END, RIM_JOINT, RIM_JOINT_END, RIM_NODE,
    RIM_START,
};
use super::edge_contact::Sliding;
use super::foot::Points;
use super::normal_response::NormalResponse;
use super::surface::ContactSurface;
use crate::mechanics::{Matrix3, Vector3};

/// Most iterations of the search for the nearest point of a piece; Newton's method takes five, bisection all of them.
const ITERATIONS: usize = 80;

/// Slack of a path, in units of what it may use, at which a search along it ends, and the most advances of one.
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
    /// Which kind of piece, as the side of its pairs.
    pub side: i8,
    /// Edge of the rod by which it is known.
    pub edge: usize,
    /// Its nodes.
    pub nodes: [usize; 3],
}

/// The point of a piece that is nearest to a rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RimPoint {
    /// Weights w of the three nodes.
    weights: [f64; 3],
    /// Their rates a.
    rates: [f64; 3],
    /// Whether it may move along the piece.
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

/// Derivatives of the direction of a contact and of its place, rows by the coordinates of the nodes.
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
    /// The rim of a pair with one.
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

/// Weights of the nodes of a piece at β, their rates and the rates of these.
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
    /// The nearest point of the piece of a `side` with nodes at the first three of these places, felt or not. Pieces are taken to
    /// have one such point.
    pub fn nearest(side: i8, nodes: &[Vector3; 4], rim: &Rim) -> Self {
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

    /// The same where the rim is felt: by what is within the tube or in front of its mouth. What passes along the tube outside of it
    /// is not. A node counts against its contact with the wall, within the tube.
    pub fn of(side: i8, nodes: &[Vector3; 4], rim: &Rim) -> Option<Self> {
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
        // All points of the rim are as near to its axis.
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

    /// Derivative of ½Δ² along the piece, and of that, m².
    fn slope(&self) -> f64 {
        self.separation.dot(&self.slide)
    }

    fn curvature(&self) -> f64 {
        self.slide.dot(&self.turned(&self.slide)) + self.separation.dot(&self.bend)
    }

    /// Distance of the rod from the rim, m.
    pub fn distance(&self) -> f64 {
        self.separation.norm()
    }

    /// Unit normal, from the rim to the rod.
    pub fn normal(&self) -> Vector3 {
        self.separation / self.distance()
    }

    /// Weights of the three nodes and of the centre of the rim in the motion at the contact.
    pub fn all_weights(&self) -> [f64; 4] {
        let [a, b, c] = self.weights;
        [a, b, c, -1.0]
    }

    /// Rates of these along the piece.
    pub fn all_rates(&self) -> [f64; 4] {
        let [a, b, c] = self.rates;
        [a, b, c, 0.0]
    }

    /// Derivatives of direction and place by the coordinates of the rod.
    pub fn derivatives(&self) -> RimDerivatives {
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

    /// ∇Δ = w ⊗ n by the coordinates of the rod.
    fn gradient(&self) -> [f64; 12] {
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

/// Derivative of the force N w ⊗ (n + t) of a rim on a rod, N/m, for the friction law linearised at the slip given with
/// `sliding` (m/s); without that of normal and contact point unless the contact `turns`.
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
        let traction = sliding.law.traction_derivatives(&normal, &velocity, &at);
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

/// The part of the straight path of a piece between `start` and `end`, up to `longest`, along which it is certain to keep a distance of
/// `kept` (m) from a rim that moves between two places, and to where that is used up but for `tolerance` (m).
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

/// The part of the straight path of a piece by these displacements, up to `longest`, along which a rim that stands keeps a `part` of its gap
/// beyond the distance `touch` (m).
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

/// The pieces of all rods that move, in order: those that touch rims, and the joints between them.
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
mod tests {
    use super::super::edge_contact::contact_force;
    use super::super::friction::{FrictionLaw, slip};
    use super::super::test_support::{Random, relative_error};
    use super::*;

    const KINDS: [i8; 6] = [RIM, RIM_START, RIM_END, RIM_JOINT, RIM_JOINT_END, RIM_NODE];

    /// A rim about the origin, turned, and pieces of rods from its inside past it, of edges from a tenth of its radius to that.
    fn cases() -> Vec<(i8, [Vector3; 4], Rim)> {
        let mut random = Random::new(17);
        let mut cases = Vec::new();
        for index in 0..240 {
            let size = 10f64.powi(index as i32 % 4 - 3);
            let outwards = random.vector().normalize();
            let rim = Rim {
                centre: random.vector() * size,
                outwards,
                radius: size,
            };
            let side = KINDS[index % KINDS.len()];
            let across = outwards.cross(&random.vector()).normalize();
            let middle = rim.centre + across * (0.7 * size) + random.vector() * (0.15 * size);
            let length = size * (0.4 + 0.3 * random.symmetric());
            let along = (outwards + random.vector() * 0.5).normalize() * length;
            let mut nodes = [middle - along, middle, middle + along, rim.centre];
            for node in &mut nodes[..3] {
                *node += random.vector() * (0.2 * length);
            }
            cases.push((side, nodes, rim));
        }
        cases
    }

    fn nearest(side: i8, nodes: &[Vector3; 4], rim: &Rim) -> RimPoint {
        RimPoint::nearest(side, nodes, rim)
    }

    #[test]
    fn no_point_of_a_piece_is_nearer() {
        let mut free = 0;
        for (side, nodes, rim) in cases() {
            let found = nearest(side, &nodes, &rim);
            let nodes = [nodes[0], nodes[1], nodes[2]];
            for sample in 0..=100 {
                let ratio = f64::from(sample) / 100.0;
                let other = RimPoint::at(side, &nodes, &rim, ratio, true);
                let slack = 1e-12 * rim.radius;
                assert!(
                    found.distance() <= other.distance() + slack,
                    "{side} {ratio}"
                );
            }
            free += usize::from(found.free);
        }
        assert!(free > 30, "{free}");
    }

    #[test]
    fn force_and_jacobian_are_derivatives_of_the_energy() {
        let (force_of, slope) = (|gap: f64| (-3.0 * gap).exp(), -3.0);
        for (side, nodes, rim) in cases() {
            let point = nearest(side, &nodes, &rim);
            // In units of the rim, so that one law suits all sizes.
            let force = force_of(point.distance() / rim.radius);
            let response = NormalResponse {
                energy: -force / slope * rim.radius,
                force,
                force_slope: slope * force / rim.radius,
            };
            let found = rim_jacobian(&point, &response, None, true);
            let at = |nodes: &[Vector3; 4]| {
                let point = nearest(side, nodes, &rim);
                let force = force_of(point.distance() / rim.radius);
                let on_nodes = contact_force(
                    &point.all_weights(),
                    &point.normal(),
                    force,
                    &Vector3::zeros(),
                );
                (-force / slope * rim.radius, on_nodes)
            };
            let h = 1e-6 * rim.radius;
            let (mut gradient, mut jacobian) = (Vec::new(), vec![0.0; 81]);
            for column in 0..9 {
                let moved = |by: f64| {
                    let mut nodes = nodes;
                    nodes[column / 3][column % 3] += by;
                    at(&nodes)
                };
                let ((less, before), (more, after)) = (moved(-h), moved(h));
                gradient.push((less - more) / (2.0 * h));
                for row in 0..9 {
                    jacobian[9 * row + column] = (after[row] - before[row]) / (2.0 * h);
                }
            }
            let error = relative_error(&at(&nodes).1[..9], &gradient);
            assert!(error < 1e-7, "{side}: {error:e}");
            let rows: Vec<f64> = (0..81).map(|k| found.jacobian[k / 9][k % 9]).collect();
            let error = relative_error(&rows, &jacobian);
            assert!(error < 1e-5, "{side}: {error:e}");
            for k in 0..81 {
                let (entry, other) = (rows[k], rows[9 * (k % 9) + k / 9]);
                assert!((entry - other).abs() < 1e-9 * force / rim.radius * 1e3);
            }
        }
    }

    #[test]
    fn friction_and_its_jacobian() {
        const TIME_STEP: f64 = 1e-3;
        let mut random = Random::new(29);
        for (side, nodes, rim) in cases() {
            let law = FrictionLaw {
                coefficient: 0.3,
                slip_tolerance: rim.radius,
            };
            let speed = rim.radius * 10f64.powf(random.symmetric());
            let previous = nodes.map(|node| node - random.vector() * speed * TIME_STEP);
            let sliding_at = |nodes: &[Vector3; 4]| Sliding {
                law,
                velocities: std::array::from_fn(|k| match k {
                    3 => Vector3::zeros(),
                    _ => (nodes[k] - previous[k]) / TIME_STEP,
                }),
                time_step: TIME_STEP,
            };
            let slip_at = |point: &RimPoint, sliding: &Sliding| {
                let velocity = sliding.relative_velocity(&point.all_weights());
                slip(&point.normal(), &velocity)
            };
            let at = |nodes: &[Vector3; 4]| {
                let (point, sliding) = (nearest(side, nodes, &rim), sliding_at(nodes));
                let traction = law.traction_of_slip(&slip_at(&point, &sliding));
                contact_force(&point.all_weights(), &point.normal(), 1.0, &traction)
            };
            let response = NormalResponse {
                energy: 1.0,
                force: 1.0,
                force_slope: 0.0,
            };
            let (point, sliding) = (nearest(side, &nodes, &rim), sliding_at(&nodes));
            let slip = slip_at(&point, &sliding);
            let found = rim_jacobian(&point, &response, Some((&sliding, slip)), true);
            let h = 1e-7 * rim.radius;
            let mut jacobian = vec![0.0; 81];
            for column in 0..9 {
                let moved = |by: f64| {
                    let mut nodes = nodes;
                    nodes[column / 3][column % 3] += by;
                    at(&nodes)
                };
                let (before, after) = (moved(-h), moved(h));
                for row in 0..9 {
                    jacobian[9 * row + column] = (after[row] - before[row]) / (2.0 * h);
                }
            }
            let rows: Vec<f64> = (0..81).map(|k| found.jacobian[k / 9][k % 9]).collect();
            let error = relative_error(&rows, &jacobian);
            assert!(error < 1e-5, "{side}: {error:e}");
        }
    }

    #[test]
    fn pieces_follow_each_other_without_kinks() {
        let nodes = [0.0, 1.0, 2.5, 2.9].map(|x: f64| Vector3::new(x, x.sin(), 0.2 * x * x));
        let centreline = nodes.to_vec();
        for closed in [false, true] {
            let mut surface = ContactSurface::new();
            surface.add_rod(0, &centreline, closed, 0.1, false);
            let pieces = pieces_of(&surface);
            let (curves, joints): (Vec<_>, Vec<_>) = pieces
                .iter()
                .partition(|piece| matches!(piece.side, RIM | RIM_START | RIM_END));
            assert_eq!(
                (curves.len(), joints.len()),
                if closed { (4, 4) } else { (4, 3) }
            );
            let of = |piece: &RodPiece, ratio: f64| {
                let corners = piece.nodes.map(|node| nodes[node]);
                let [weights, rates, _] = weights(piece.side, ratio);
                (weighted(&corners, &weights), weighted(&corners, &rates))
            };
            let count = curves.len();
            for k in 0..if closed { count } else { count - 1 } {
                let (end, start) = (of(curves[k], 1.0), of(curves[(k + 1) % count], 0.0));
                assert!((end.0 - start.0).norm() < 1e-14, "{k}");
                let (before, after) = (end.1.normalize(), start.1.normalize());
                assert!((before - after).norm() < 1e-14, "{k}");
                let is_joint = |joint: &&&RodPiece| (of(joint, 0.0).0 - end.0).norm() < 1e-14;
                assert_eq!(joints.iter().filter(is_joint).count(), 1);
            }
        }
    }

    #[test]
    fn the_rim_is_felt_from_within_the_tube_and_from_in_front_of_it() {
        let rim = Rim {
            centre: Vector3::zeros(),
            outwards: Vector3::z(),
            radius: 1.0,
        };
        let at = |radial: f64, axial: f64| {
            let point = Vector3::new(1.0 + radial, 0.0, axial);
            let nodes = [point, point, point, Vector3::zeros()];
            [RIM, RIM_NODE].map(|side| RimPoint::of(side, &nodes, &rim).is_some())
        };
        assert_eq!(at(-0.1, -0.05), [true, true]);
        assert_eq!(at(-0.1, 0.05), [true, false], "beyond the mouth");
        assert_eq!(at(0.05, 0.1), [true, false], "hanging over the rim");
        assert_eq!(at(0.1, 0.05), [false, false], "passing outside");
        assert_eq!(at(0.1, -0.05), [false, false], "along the tube");
        assert_eq!(at(-1.0, 0.1), [true, false], "on the axis");
    }

    #[test]
    fn no_passage_through_a_rim_is_missed() {
        let mut random = Random::new(5);
        let (mut passed, mut free) = (0, 0);
        for (side, start, rim) in cases() {
            let shift = random.vector() * rim.radius;
            let end = [
                start[0] + shift,
                start[1] + shift,
                start[2] + shift,
                start[3],
            ];
            let kept = 0.05 * rim.radius;
            if nearest(side, &start, &rim).distance() < 2.0 * kept {
                continue;
            }
            let bounds = [kept, 0.1 * kept];
            let paths = [&start, &end];
            let fraction = fraction_beyond_rim(side, paths, [&rim, &rim], bounds, 1.0);
            let least = (0..=400)
                .map(|sample| {
                    let t = fraction * f64::from(sample) / 400.0;
                    let nodes = std::array::from_fn(|k| start[k] + (end[k] - start[k]) * t);
                    nearest(side, &nodes, &rim).distance()
                })
                .fold(f64::INFINITY, f64::min);
            assert!(least > kept, "{side}: {least:e}");
            if fraction < 1.0 {
                passed += 1;
            } else {
                free += 1;
            }
        }
        assert!(passed > 5 && free > 50, "{passed} {free}");
    }
}
