//! Rooted rods: clamped where they overlap, as placed, with a body that does not move relative to
//! the clamp.
//!
//! Examples are a stalk in a floor, a hair in a scalp, several hairs at one root, and a rod
//! clamped on a post. Contact ignores the overlap there, within a reach that is reported
//! ([`crate::mechanics::contact::Root`], and for two rods that of a joint at the same angle). A
//! root must itself be within the other body, and move with it: contact is never ignored at a
//! clamp with its own motion.

use super::Assembly;
use super::centreline::{arc_length, directions};
use crate::mechanics::Vector3;
use crate::mechanics::contact::{ContactPair, ContactSystem, Proximity, Root, RootBody};
use crate::mechanics::scene::{Motion, Scene};

/// Surfaces at a root count as overlapping or touching if they are nearer than this fraction of
/// the radius.
const TOUCHING: f64 = 1e-6;

/// A node whose position is prescribed by a clamp, or by a joint with a held node.
struct PrescribedNode {
    node: usize,
    rod: usize,
    along: usize,
    motion: Motion,
}

/// Ignores contact of overlaps at roots; returns a sentence for each.
pub(super) fn pass_over_roots(
    contact: &mut ContactSystem,
    scene: &Scene,
    assembly: &Assembly,
    positions: &[Vector3],
) -> Vec<String> {
    let overlaps = contact.initial_overlaps(positions);
    if overlaps.is_empty() {
        return Vec::new();
    }
    let nodes = prescribed_nodes(scene, assembly);
    let mut notes = Vec::new();
    for node in &nodes {
        for body in bodies_around(contact, scene, &overlaps, node, positions) {
            let root = root_in(contact, scene, &overlaps, node, body);
            contact.pass_over_root(&root);
            notes.push(note(scene, node, &root));
        }
    }
    for (index, second) in nodes.iter().enumerate() {
        for first in &nodes[..index] {
            if have_common_root(contact, scene, &overlaps, [first, second], positions) {
                let pair = [first, second];
                let arcs = pair.map(|at| arc_length(&scene.rods[at.rod].centreline, at.along));
                let angle = angle_between(scene, pair);
                let reach = contact.pass_over_common_root(pair.map(|at| at.rod), arcs, angle);
                notes.push(note_of_common(scene, pair, reach));
            }
        }
    }
    notes
}

/// All prescribed nodes of rods that are not held.
fn prescribed_nodes(scene: &Scene, assembly: &Assembly) -> Vec<PrescribedNode> {
    let owner = |node: usize| {
        let mut points = assembly.joints.points.iter();
        let point = points.find(|point| point[0] == node);
        point.map_or(node, |point| point[1])
    };
    let motion_at = |node: usize| {
        let (rod, along) = assembly.locate(node);
        let mut clamps = scene.clamps.iter();
        let clamp = clamps.find(|clamp| clamp.rod == rod && clamp.node == along);
        clamp.map_or_else(Motion::default, |clamp| clamp.motion.clone())
    };
    let nodes = assembly.prescribed_nodes().into_iter().enumerate();
    nodes
        .filter(|&(node, is_prescribed)| is_prescribed && !assembly.obstacle[node])
        .map(|(node, _)| {
            let (rod, along) = assembly.locate(node);
            PrescribedNode {
                node,
                rod,
                along,
                motion: motion_at(owner(node)),
            }
        })
        .collect()
}

/// The bodies that contain the node, overlap with its rod, and do not move relative to it.
fn bodies_around(
    contact: &ContactSystem,
    scene: &Scene,
    overlaps: &[Proximity],
    at: &PrescribedNode,
    positions: &[Vector3],
) -> Vec<RootBody> {
    let mut bodies: Vec<RootBody> = Vec::new();
    for overlap in overlaps {
        if let Some((_, body)) = on_rod(contact, scene, overlap, at.rod)
            && !bodies.contains(&body)
        {
            bodies.push(body);
        }
    }
    let radius = scene.rods[at.rod].radius_at(at.along);
    bodies.retain(|body| {
        let still = Motion::default();
        let motion = match body {
            RootBody::Obstacle(obstacle) => &scene.obstacles[*obstacle].motion,
            RootBody::Plane(_) | RootBody::HeldRod(_) => &still,
        };
        let is_within = || {
            let point = &positions[at.node];
            contact.gap_to(*body, point, radius, positions) <= TOUCHING * radius
        };
        move_together(&at.motion, motion) && is_within()
    });
    bodies
}

/// The root of a rod in a body, with its reach.
fn root_in(
    contact: &ContactSystem,
    scene: &Scene,
    overlaps: &[Proximity],
    at: &PrescribedNode,
    body: RootBody,
) -> Root {
    let rod = &scene.rods[at.rod];
    let place = arc_length(&rod.centreline, at.along);
    let ways = overlaps.iter().filter_map(|overlap| {
        let (along, other) = on_rod(contact, scene, overlap, at.rod)?;
        let way = (along[0] - place).max(place - along[1]).max(0.0);
        (other == body).then_some(way)
    });
    // Overlaps beyond the reach of a root are independent of it.
    let reach = Root::reach_of(rod.radius, f64::INFINITY);
    let overlap = ways.filter(|way| *way < reach).fold(0.0, f64::max);
    Root {
        rod: at.rod,
        arc_length: place,
        reach: Root::reach_of(rod.radius, overlap),
        body,
    }
}

/// The part of a rod, by the arc lengths of both ends (m), that overlaps with a rigid body, and
/// that body.
fn on_rod(
    contact: &ContactSystem,
    scene: &Scene,
    overlap: &Proximity,
    rod: usize,
) -> Option<([f64; 2], RootBody)> {
    let surface = contact.surface();
    match overlap.pair {
        ContactPair::NodeAndPlane { node, plane } => {
            let edges = surface.rod_edges().iter();
            let mut own = edges.filter(|edge| edge.rod == rod && edge.nodes.contains(&node));
            let edge = own.next()?;
            let end = usize::from(edge.nodes[1] == node);
            Some(([edge.arc_length[end]; 2], RootBody::Plane(plane)))
        }
        ContactPair::Edges([first, second]) => {
            if let Some(obstacle) = surface.obstacle_of(second) {
                let edge = &surface.edges()[first];
                let body = RootBody::Obstacle(obstacle);
                return (edge.rod == rod).then_some((edge.arc_length, body));
            }
            if second >= surface.edges().len() {
                return None;
            }
            let pair = [first, second].map(|edge| &surface.edges()[edge]);
            let own = pair.iter().find(|edge| edge.rod == rod && !edge.held)?;
            let other = pair.iter().find(|edge| edge.held)?;
            let is_rod = other.rod < scene.rods.len();
            is_rod.then_some((own.arc_length, RootBody::HeldRod(other.rod)))
        }
    }
}

/// Whether two prescribed nodes are within each other's rods and have no relative motion, and the
/// rods overlap beside them.
fn have_common_root(
    contact: &ContactSystem,
    scene: &Scene,
    overlaps: &[Proximity],
    [first, second]: [&PrescribedNode; 2],
    positions: &[Vector3],
) -> bool {
    let radii: f64 = [first, second]
        .map(|at| scene.rods[at.rod].radius_at(at.along))
        .iter()
        .sum();
    let apart = (positions[first.node] - positions[second.node]).norm();
    if apart > (1.0 + TOUCHING) * radii || !move_together(&first.motion, &second.motion) {
        return false;
    }
    let edges = contact.surface().edges();
    overlaps.iter().any(|overlap| match overlap.pair {
        ContactPair::Edges(pair) => {
            let at = |edge: usize, node: usize| {
                (edges.get(edge)).is_some_and(|edge| edge.nodes.contains(&node))
            };
            let [one, other] = pair;
            at(one, first.node) && at(other, second.node)
                || at(one, second.node) && at(other, first.node)
        }
        ContactPair::NodeAndPlane { .. } => false,
    })
}

/// Least angle between two rods as they leave two nodes, rad.
fn angle_between(scene: &Scene, pair: [&PrescribedNode; 2]) -> f64 {
    let [from, to] = pair.map(|at| directions(&scene.rods[at.rod].centreline, at.along));
    let cosines = from.iter().flat_map(|a| to.iter().map(|b| a.dot(b)));
    libm::acos(cosines.fold(-1.0, f64::max).min(1.0))
}

/// Whether two motions are both at rest, or are the same translation without rotation.
fn move_together(first: &Motion, second: &Motion) -> bool {
    let turns = |motion: &Motion| {
        motion.angular_velocity != 0.0 || !motion.angle.is_empty() || !motion.orientation.is_empty()
    };
    !turns(first) && !turns(second) && first.translation == second.translation
}

fn note(scene: &Scene, at: &PrescribedNode, root: &Root) -> String {
    let body = match root.body {
        RootBody::Plane(plane) => format!("plane {plane}"),
        RootBody::Obstacle(obstacle) => format!("obstacle `{}`", scene.obstacles[obstacle].name),
        RootBody::HeldRod(rod) => format!("rod `{}`", scene.rods[rod].name),
    };
    format!(
        "rod `{}` starts inside {body} at its clamped node {}: contact between them is ignored within {:.3e} m of that node along the rod",
        scene.rods[at.rod].name, at.along, root.reach
    )
}

fn note_of_common(scene: &Scene, [first, second]: [&PrescribedNode; 2], reach: f64) -> String {
    let [one, other] = [first, second].map(|at| &scene.rods[at.rod].name);
    format!(
        "node {} of rod `{one}` and node {} of rod `{other}` are clamped inside each other: contact is ignored between edges less than {reach:.3e} m apart along the rods through these nodes",
        first.along, second.along
    )
}
