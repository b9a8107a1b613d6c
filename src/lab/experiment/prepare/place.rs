//! Places rods, clamps, loads and planes in the scene.

use super::curve::{SampledCurve, sample};
use super::gripper_motion::gripper_motion;
use super::natural_strains;
use super::round_rod::{relaxation, yielding};
use super::sections::lay_out;
use crate::experiment::places::{body_called, find_place, find_rod};
use crate::scenario::{
    Clamp, Hold, Inertia, Issue, KeyPath, Load, LoadFrame, LoadKind, Movement, NaturalShape, Place,
    Plane, Rod,
};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::contact::DirectedFriction;
use rodlab_engine::mechanics::scene as mechanics;

pub(super) fn place_rod(rod: &Rod, path: &KeyPath) -> Result<mechanics::RodDescription, Issue> {
    let SampledCurve {
        nodes: centreline,
        end_tangents,
    } = sample(&rod.shape, rod.edges, rod.closed);
    refuse_short_edges(&centreline, rod.closed, &path.key("shape"))?;
    let natural_shape = match &rod.natural_shape {
        NaturalShape::AsPlaced => mechanics::NaturalShape::AsPlaced,
        NaturalShape::Straight => mechanics::NaturalShape::Straight,
        NaturalShape::Curved { curvature, twist } => mechanics::NaturalShape::Curved {
            curvature: *curvature,
            twist: *twist,
        },
        NaturalShape::Curve(shape) => {
            let nodes = sample(shape, rod.edges, rod.closed).nodes;
            refuse_short_edges(&nodes, rod.closed, &path.key("natural_shape"))?;
            mechanics::NaturalShape::Centreline(nodes)
        }
        NaturalShape::Strains(strains) => {
            mechanics::NaturalShape::Strains(natural_strains::at_nodes(strains, rod.edges))
        }
    };
    let laid_out = match rod.sections.as_slice() {
        [] => None,
        _ => Some(lay_out(rod, &centreline, path)?),
    };
    let natural_shape = match laid_out
        .as_ref()
        .and_then(|laid_out| laid_out.natural.clone())
    {
        Some(strains) => mechanics::NaturalShape::Strains(strains),
        None => natural_shape,
    };
    let area = rod.cross_section.area(rod.radius);
    let [second_moment_1, second_moment_2] = rod.cross_section.second_moments(rod.radius);
    let density = rod.material.density;
    let description = mechanics::RodDescription {
        name: rod.name.clone(),
        centreline,
        closed: rod.closed,
        end_tangents,
        first_director: rod.director.map(Vector3::from),
        twist: rod.twist,
        natural_shape,
        pretension: rod.pretension,
        stiffness: mechanics::Stiffness {
            stretching: rod.stiffness.stretching,
            bending: [rod.stiffness.bending_1, rod.stiffness.bending_2],
            twisting: rod.stiffness.twisting,
        },
        radius: rod.radius,
        sections: Vec::new(),
        friction: rod.friction,
        mass_per_length: density * area,
        rotational_inertia_per_length: density * (second_moment_1 + second_moment_2),
        inertia: match rod.inertia {
            Inertia::Lumped => mechanics::Inertia::Lumped,
            Inertia::Consistent => mechanics::Inertia::Consistent,
        },
        retardation_time: rod.material.retardation_time(),
        relaxation: relaxation(&rod.material),
        yielding: yielding(&rod.cross_section, rod.radius, &rod.material),
        velocity: Vector3::from(rod.velocity),
        angular_velocity: Vector3::from(rod.angular_velocity),
        held: rod.held,
    };
    Ok(match laid_out {
        None => description,
        Some(laid_out) => description.with_sections(laid_out.edges, &laid_out.lengths),
    })
}

/// Edges shorter than this fraction of the mean edge are rejected: their direction is lost in
/// round-off.
const SHORTEST_EDGE: f64 = 1e-6;

fn refuse_short_edges(nodes: &[Vector3], closed: bool, path: &KeyPath) -> Result<(), Issue> {
    let edges = if closed { nodes.len() } else { nodes.len() - 1 };
    let length = |edge: usize| (nodes[(edge + 1) % nodes.len()] - nodes[edge]).norm();
    let mean = (0..edges).map(length).sum::<f64>() / edges as f64;
    if !mean.is_finite() {
        let message = "the coordinates are too large, or too close together, to measure the edges";
        return Err(Issue::new(path.clone(), message));
    }
    match (0..edges).find(|&edge| length(edge) <= SHORTEST_EDGE * mean) {
        None => Ok(()),
        Some(edge) => Err(Issue::new(
            path.clone(),
            format!(
                "edge {edge} has no length: nodes {edge} and {} lie in the same place",
                (edge + 1) % nodes.len()
            ),
        )),
    }
}

pub(super) fn place_clamp(
    clamp: &Clamp,
    rods: &[mechanics::RodDescription],
    path: &KeyPath,
) -> Result<mechanics::Clamp, Issue> {
    let rod = find_rod(&clamp.rod, rods, &path.key("rod"))?;
    Ok(mechanics::Clamp {
        rod,
        node: find_node(clamp.at, &rods[rod], path)?,
        holds_position: matches!(clamp.hold, Hold::Position | Hold::Both),
        holds_frame: matches!(clamp.hold, Hold::Frame | Hold::Both),
        motion: motion_of(&clamp.movement),
    })
}

pub(super) fn motion_of(movement: &Movement) -> mechanics::Motion {
    if !movement.poses.is_empty() {
        return gripper_motion(&movement.poses);
    }
    let translation = movement.translation.iter();
    mechanics::Motion {
        translation: translation
            .map(|&(time, displacement)| (time, Vector3::from(displacement)))
            .collect(),
        axis: movement.axis.map(Vector3::from),
        angle: movement.angle.clone(),
        angular_velocity: movement.angular_velocity,
        pivot: movement.pivot.map(Vector3::from),
        ..mechanics::Motion::default()
    }
}

pub(super) fn same_node(one: &mechanics::Clamp, other: &mechanics::Clamp) -> bool {
    (one.rod, one.node) == (other.rod, other.node)
}

pub(super) fn place_load(
    load: &Load,
    scene: &mechanics::Scene,
    path: &KeyPath,
) -> Result<mechanics::Load, Issue> {
    let rods = &scene.rods;
    let find_any = |name: &Option<String>| {
        name.as_ref()
            .map(|name| find_rod(name, rods, &path.key("rod")))
            .transpose()
    };
    let kind = match &load.kind {
        LoadKind::Gravity { acceleration } => mechanics::LoadKind::Gravity {
            acceleration: Vector3::from(*acceleration),
        },
        LoadKind::Force {
            rod,
            at,
            force,
            frame,
        } => {
            if let Some(body) = body_called(rod, scene) {
                return Ok(mechanics::Load {
                    kind: on_body(body, *at, force, *frame, path)?,
                    schedule: load.schedule.clone(),
                });
            }
            let rod = find_rod(rod, rods, &path.key("rod"))?;
            let node = find_node(*at, &rods[rod], path)?;
            let force = Vector3::from(*force);
            match frame {
                LoadFrame::Space => mechanics::LoadKind::Force { rod, node, force },
                LoadFrame::Material => mechanics::LoadKind::FollowerForce { rod, node, force },
            }
        }
        LoadKind::Moment {
            rod,
            at,
            moment,
            frame,
        } => {
            let rod = find_rod(rod, rods, &path.key("rod"))?;
            let edge = find_edge(*at, &rods[rod], path)?;
            let moment = Vector3::from(*moment);
            match frame {
                LoadFrame::Space => mechanics::LoadKind::Moment { rod, edge, moment },
                LoadFrame::Material => mechanics::LoadKind::FollowerMoment { rod, edge, moment },
            }
        }
        LoadKind::Distributed {
            rod,
            force_per_length,
            frame,
        } => {
            let rod = find_any(rod)?;
            let force_per_length = Vector3::from(*force_per_length);
            match frame {
                LoadFrame::Space => mechanics::LoadKind::Distributed {
                    rod,
                    force_per_length,
                },
                LoadFrame::Material => mechanics::LoadKind::FollowerDistributed {
                    rod,
                    force_per_length,
                },
            }
        }
        LoadKind::Drag {
            rod,
            translation,
            rotation,
        } => mechanics::LoadKind::Drag {
            rod: find_any(rod)?,
            translation: *translation,
            rotation: *rotation,
        },
    };
    Ok(mechanics::Load {
        kind,
        schedule: load.schedule.clone(),
    })
}

/// A force on the centre of mass of a free body.
fn on_body(
    body: usize,
    at: Place,
    force: &[f64; 3],
    frame: LoadFrame,
    path: &KeyPath,
) -> Result<mechanics::LoadKind, Issue> {
    if !matches!(at, Place::Start | Place::Number(0)) {
        let message = "a force on a free body acts on its centre of mass, at = 0";
        return Err(Issue::new(path.key("at"), message));
    }
    if frame == LoadFrame::Material {
        let message = "a force on a free body has a fixed direction, frame = \"space\"";
        return Err(Issue::new(path.key("frame"), message));
    }
    Ok(mechanics::LoadKind::Force {
        rod: body,
        node: 0,
        force: Vector3::from(*force),
    })
}

fn find_node(
    place: Place,
    rod: &mechanics::RodDescription,
    path: &KeyPath,
) -> Result<usize, Issue> {
    find_place(place, rod.centreline.len(), "node", rod, &path.key("at"))
}

fn find_edge(
    place: Place,
    rod: &mechanics::RodDescription,
    path: &KeyPath,
) -> Result<usize, Issue> {
    let edges = rod.centreline.len() - usize::from(!rod.closed);
    find_place(place, edges, "edge", rod, &path.key("at"))
}

pub(super) fn place_plane(plane: &Plane) -> mechanics::Plane {
    mechanics::Plane {
        point: Vector3::from(plane.point),
        normal: Vector3::from(plane.normal),
        friction: plane.friction,
        directed_friction: plane.directed_friction.map(|own| DirectedFriction {
            forwards: own.forwards,
            backwards: own.backwards,
            sideways: own.sideways,
        }),
    }
}
