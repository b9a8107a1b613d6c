//! The contact model of a scene, and names of bodies in contact.

use super::centreline::{arc_length, directions};
use super::joined_bodies::pass_over_joined_bodies;
use super::roots::pass_over_roots;
use super::{Assembly, System, copy_positions};
use crate::mechanics::contact::{
    ContactPair, ContactPlane, ContactSurface, ContactSystem, CurvePoints, Geometry, PER_EDGE,
    Proximity, RowOfNodes,
};
use crate::mechanics::scene::{RodDescription, Scene};
use crate::mechanics::{Overlap, Vector3};

/// The contact model of a scene, and the pairs that it ignores.
pub(super) struct ContactOfScene {
    pub contact: ContactSystem,
    /// A message for every root at which a rod starts inside another body.
    pub roots: Vec<String>,
}

/// Creates the contact model of a scene with its first candidates; `None` if bodies do not
/// interact by contact.
///
/// # Errors
/// [`Overlap`] names two bodies that overlap as placed.
pub(super) fn contact_of(
    scene: &Scene,
    assembly: &Assembly,
) -> Result<Option<ContactOfScene>, Overlap> {
    let Some(parameters) = scene.contact else {
        return Ok(None);
    };
    let mut positions = vec![Vector3::zeros(); assembly.rods.nodes];
    for (range, rod) in assembly.rods.rods.iter().zip(&scene.rods) {
        positions[range.node_indices()].copy_from_slice(&rod.centreline);
    }
    let curves = (parameters.geometry == Geometry::Smooth).then(|| {
        let rods = assembly.rods.rods.iter().zip(&scene.rods);
        CurvePoints::of(rods.map(|(range, rod)| RowOfNodes {
            first_node: range.first_node,
            nodes: rod.centreline.len(),
            closed: rod.closed,
        }))
    });
    let placed = curves
        .as_ref()
        .map(|curves| (curves, curves.place(&positions)));
    let mut surface = surface_of(scene, assembly, placed);
    add_balls(&mut surface, scene, assembly);
    let bodies = &assembly.rods.rods[scene.rods.len()..];
    for (range, body) in bodies.iter().zip(&scene.free_bodies) {
        surface.add_body(range.first_node + 1, &body.shape, body.friction);
    }
    for obstacle in &scene.obstacles {
        surface.add_obstacle(obstacle.body.clone(), obstacle.friction);
    }
    let planes = scene.planes.iter().map(|plane| ContactPlane {
        point: plane.point,
        normal: plane.normal,
        friction: plane.own_friction(),
        directed_friction: plane.directed_friction,
    });
    let stiffness_per_force = parameters.stiffness_per_force(surface.largest_moving_radius());
    // The stiffness follows from the forces that bend each rod, so that a stiff post does not
    // stiffen the contacts of a soft rod.
    let least_of_rods = || {
        let rods = scene.rods.iter().map(|rod| rod.held);
        let held = rods.chain(scene.free_bodies.iter().map(|_| false));
        held.zip(&assembly.scales).map(|(is_held, scale)| {
            if is_held || scale.force <= f64::MIN_POSITIVE {
                f64::INFINITY
            } else {
                stiffness_per_force * scale.force
            }
        })
    };
    let least = least_of_rods().fold(f64::INFINITY, f64::min);
    let least = if least.is_finite() {
        least
    } else {
        stiffness_per_force * assembly.force_scale
    };
    let contact = ContactSystem::new(parameters, surface, planes.collect(), least);
    let mut contact = contact.with_curves(curves);
    let ranges = assembly.rods.rods.iter().zip(least_of_rods());
    contact.set_least_stiffness_of_nodes(
        ranges
            .flat_map(|(range, least)| std::iter::repeat_n(least, range.nodes))
            .collect(),
    );
    copy_positions(&assembly.unknowns, &mut positions);
    contact.set_prescribed(assembly.prescribed_nodes().into_iter());
    let roots = match contact.curves() {
        Some(_) => Vec::new(),
        None => pass_over_roots(&mut contact, scene, assembly, &positions),
    };
    pass_over_joined_bodies(&mut contact, scene, &positions);
    if let Some(overlap) = contact.initial_overlaps(&positions).first() {
        return Err(name_overlap(overlap, &contact, assembly));
    }
    contact.update_candidates(&positions);
    Ok(Some(ContactOfScene { contact, roots }))
}

/// The surfaces of all rods as polylines, with their joints.
pub(crate) fn surface_of_rods(scene: &Scene, assembly: &Assembly) -> ContactSurface {
    surface_of(scene, assembly, None)
}

/// The surfaces of all rods, with their joints: of chords of smooth curves with given places of
/// their ends (m), or of polylines.
fn surface_of(
    scene: &Scene,
    assembly: &Assembly,
    curves: Option<(&CurvePoints, Vec<Vector3>)>,
) -> ContactSurface {
    let mut surface = ContactSurface::new();
    for (index, (range, rod)) in assembly.rods.rods.iter().zip(&scene.rods).enumerate() {
        let (first, centreline) = match &curves {
            Some((curves, placed)) => {
                let own = curves.of_rod(index);
                (own.start, &placed[own])
            }
            None => (range.first_node, rod.centreline.as_slice()),
        };
        surface.add_rod(first, centreline, rod.closed, rod.radius, rod.held);
        let chords = if curves.is_some() { PER_EDGE } else { 1 };
        if !rod.sections.is_empty() {
            let (edges, nodes) = radii(rod, chords);
            surface.set_radii(&edges, &nodes);
        }
        let frictions = rod.frictions().into_iter();
        let of_chords = frictions.flat_map(|own| std::iter::repeat_n(own, chords));
        surface.set_frictions(&of_chords.collect::<Vec<_>>());
    }
    join(&mut surface, scene, assembly);
    surface
}

/// Radii (m) of the edges and of the nodes of a rod with sections, or of the `chords` into which
/// each edge is divided and of their ends.
fn radii(rod: &RodDescription, chords: usize) -> (Vec<f64>, Vec<f64>) {
    let along = |edge: usize, chord: f64| {
        let [start, end] = rod.sections[edge].end_radii;
        start + (end - start) * chord / chords as f64
    };
    let edges = 0..rod.sections.len();
    let of_edges = edges.clone().flat_map(|edge| {
        (0..chords).map(move |chord| match chords {
            1 => rod.sections[edge].radius,
            _ => along(edge, chord as f64 + 0.5),
        })
    });
    let of_nodes = edges.flat_map(|edge| {
        (0..chords).map(move |chord| match chord {
            0 => rod.radius_at(edge),
            _ => along(edge, chord as f64),
        })
    });
    let last = (!rod.closed).then(|| rod.radius_at(rod.sections.len()));
    (of_edges.collect(), of_nodes.chain(last).collect())
}

/// Passes the joints of rods, with their angles, to contact.
fn join(surface: &mut ContactSurface, scene: &Scene, assembly: &Assembly) {
    let points = &assembly.joints.points;
    for (index, &[node, owner]) in points.iter().enumerate() {
        let earlier = points[..index].iter().filter(|point| point[1] == owner);
        for other in earlier.map(|point| point[0]).chain([owner]) {
            let places = [node, other].map(|node| {
                let (rod, along) = assembly.locate(node);
                let nodes = &scene.rods[rod].centreline;
                (rod, arc_length(nodes, along), directions(nodes, along))
            });
            let [(first, one, from), (second, another, to)] = places;
            let cosines = from.iter().flat_map(|a| to.iter().map(|b| a.dot(b)));
            let steepest = cosines.fold(-1.0, f64::max);
            surface.add_joint(
                [first, second],
                [one, another],
                libm::acos(steepest.min(1.0)),
            );
        }
    }
    let slides = scene.joints.iter().filter(|joint| joint.kind.slides());
    for [node, start] in slides.map(|joint| joint.nodes) {
        let arc = arc_length(&scene.rods[node.rod].centreline, node.node);
        surface.add_slide([node.rod, start.rod], arc);
    }
}

/// Adds the bodies that contact treats as balls, if they are thicker than their rods.
fn add_balls(surface: &mut ContactSurface, scene: &Scene, assembly: &Assembly) {
    let owner = |node: usize| {
        let mut points = assembly.joints.points.iter();
        let point = points.find(|point| point[0] == node);
        point.map_or(node, |point| point[1])
    };
    let mut balls: Vec<[usize; 2]> = Vec::new();
    for body in &scene.bodies {
        let (range, rod) = (&assembly.rods.rods[body.at.rod], &scene.rods[body.at.rod]);
        let Some(radius) = body
            .ball
            .filter(|radius| *radius > rod.radius_at(body.at.node))
        else {
            continue;
        };
        let node = range.first_node + body.at.node;
        let point = owner(node);
        let here = (0..assembly.rods.nodes).filter(|other| owner(*other) == point);
        let rods = here.map(|other| {
            let (rod, along) = assembly.locate(other);
            (rod, arc_length(&scene.rods[rod].centreline, along))
        });
        let earlier = balls.iter().filter(|ball| ball[1] == point);
        let meeting: Vec<_> = rods.chain(earlier.map(|ball| (ball[0], 0.0))).collect();
        let ball = surface.add_ball(node, radius, rod.held, &meeting);
        balls.push([ball, point]);
    }
}

impl System {
    /// Messages on contact ignored at roots, where rods start inside other bodies, one sentence
    /// each.
    pub(crate) fn remarks_on_roots(&self) -> &[String] {
        &self.terms.contact.roots
    }

    /// Passes the prescribed nodes to contact, after a grasp or release.
    pub(super) fn note_prescribed_nodes(&mut self) {
        if let Some(contact) = &mut self.terms.contact.model {
            contact.set_prescribed(self.assembly.prescribed_nodes().into_iter());
        }
    }

    /// Returns the bodies that overlap by more than the allowed amount at `unknowns`, which may
    /// differ from the last evaluation; candidates are updated.
    pub(crate) fn excessive_penetration_at(&mut self, unknowns: &[f64]) -> Option<Overlap> {
        if !self.candidates_are_complete(unknowns) {
            self.update_candidates(unknowns);
        }
        let contact = self.terms.contact.model.as_mut()?;
        copy_positions(unknowns, &mut self.terms.contact.positions);
        let overlap = contact.excessive_penetration_at(&self.terms.contact.positions)?;
        Some(name_overlap(&overlap, contact, &self.assembly))
    }

    /// Whether a contact of the last evaluation is compressed further than by its design force. Contact by
    /// complementarity is rigid.
    pub(crate) fn is_contact_deep(&self) -> bool {
        let contact = self.contact();
        !self.has_constraints() && contact.is_some_and(ContactSystem::is_deep)
    }

    /// Whether, at the last evaluation, surfaces touch despite a barrier.
    pub(crate) fn touches_barrier(&self) -> bool {
        self.contact().is_some_and(ContactSystem::touches_barrier)
    }

    /// Names two edges that pass, or nearly pass, through each other on the straight paths of all
    /// nodes from one set of unknowns to another.
    pub(crate) fn passage(&mut self, from: &[f64], to: &[f64]) -> Option<[String; 2]> {
        let contact = self.terms.contact.model.as_mut()?;
        copy_positions(from, &mut self.terms.contact.positions);
        copy_positions(to, &mut self.terms.contact.displacements);
        let pair = contact.passage(
            &self.terms.contact.positions,
            &self.terms.contact.displacements,
        )?;
        Some(names(pair, contact, &self.assembly))
    }
}

/// Names the two bodies of `proximity` that are too close.
pub(crate) fn name_overlap(
    proximity: &Proximity,
    contact: &ContactSystem,
    assembly: &Assembly,
) -> Overlap {
    let [first, second] = names(proximity.pair, contact, assembly);
    Overlap {
        first,
        second,
        distance: proximity.distance,
        least: proximity.threshold,
        exclusive: contact.parameters().is_barrier(),
    }
}

/// Names two bodies.
fn names(pair: ContactPair, contact: &ContactSystem, assembly: &Assembly) -> [String; 2] {
    let edge_name = |edge: usize| {
        if let Some(obstacle) = contact.surface().obstacle_of(edge) {
            return format!("obstacle `{}`", assembly.obstacles[obstacle]);
        }
        let node = contact.surface().first_node_of(edge);
        let (rod, node) = assembly.locate(contact.node_of(node));
        if assembly.rods.rods[rod].rigid {
            return format!("body `{}`", assembly.names[rod]);
        }
        let what = if contact.surface().is_ball(edge) {
            "the ball at node"
        } else {
            "edge"
        };
        format!("{what} {node} of rod `{}`", assembly.names[rod])
    };
    match pair {
        ContactPair::Edges([a, b]) => [edge_name(a), edge_name(b)],
        ContactPair::NodeAndPlane { node, plane } => {
            let (rod, along) = assembly.locate(contact.node_of(node));
            let name = &assembly.names[rod];
            let first = match assembly.rods.rods[rod].rigid {
                true => format!("body `{name}`"),
                false => format!("node {along} of rod `{name}`"),
            };
            [first, format!("plane {plane}")]
        }
    }
}
