//! A rod as a one-dimensional flex.

use super::super::refusals::{clamps_of, end_tangent};
use super::list;
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::Scene;
use rodlab_files::figure::escape;
use std::f64::consts::PI;
use std::fmt::Write;

/// Length of the edge before a clamp over that of the first edge.
pub(super) const SHORT: f64 = 1e-3;
/// Radius of gyration of a body that follows a clamp, over the length of the rod. MuJoCo attaches no
/// elastic flex to a clamp itself.
const HELD: f64 = 0.1;
/// Damping ratio ζ with which it follows: it lags by 2 ζ² times the time constant.
const FOLLOWING: f64 = 0.5;

/// A vertex of a flex.
struct Vertex {
    at: Vector3,
    holder: Holder,
}

/// What holds a vertex.
#[derive(Clone, Debug, PartialEq)]
enum Holder {
    /// A body of its own with a mass, kg.
    Free(String, f64),
    World,
    /// A body that follows a moving clamp, by the name and the place of the clamp.
    Moving(String, Vector3),
}

/// A rod in a model.
pub(super) struct Flex {
    name: String,
    vertices: Vec<Vertex>,
    radius: f64,
    young: f64,
    shear: f64,
    /// Damping time, s.
    pub damping: f64,
    /// Mass, kg, and length, m, of the rod.
    mass: f64,
    length: f64,
    /// Moment of inertia of each edge about the rod, kg m².
    spins: Vec<f64>,
}

impl Flex {
    /// The flex of a rod.
    pub fn of(scene: &Scene, index: usize, damping: f64) -> Self {
        let rod = &scene.rods[index];
        let clamps = clamps_of(scene, index);
        let fourth = rod.radius.powi(4);
        let mut flex = Self {
            name: escape(&rod.name),
            vertices: Vec::new(),
            radius: rod.radius,
            young: 4.0 * rod.stiffness.bending[0] / (PI * fourth),
            shear: 2.0 * rod.stiffness.twisting / (PI * fourth),
            damping,
            mass: 0.0,
            length: 0.0,
            spins: Vec::new(),
        };
        let nodes = &rod.centreline;
        let last = nodes.len() - 1;
        let length = |edge: usize| (nodes[edge + 1] - nodes[edge]).norm();
        flex.length = (0..last).map(length).sum();
        flex.mass = rod.mass_per_length * flex.length;
        for (node, at) in nodes.iter().enumerate() {
            let before = if node > 0 { length(node - 1) } else { 0.0 };
            let after = if node < last { length(node) } else { 0.0 };
            let held = clamps
                .iter()
                .find(|clamp| clamp.node == node && clamp.holds_position);
            let holder = match held {
                None => {
                    let carried = scene.bodies.iter().filter(|body| {
                        body.at.rod == index && body.at.node == node && body.inertia.is_none()
                    });
                    let carried: f64 = carried.map(|body| body.mass).sum();
                    let mass = 0.5 * rod.mass_per_length * (before + after) + carried;
                    Holder::Free(format!("{}_{node}", flex.name), mass)
                }
                Some(clamp) if clamp.motion.moves() => {
                    Holder::Moving(format!("{}_clamp_{node}", flex.name), *at)
                }
                Some(_) => Holder::World,
            };
            let is_framed = held.is_some_and(|clamp| clamp.holds_frame);
            let ghost = |tangent: Vector3, beside: f64| Vertex {
                at: at + tangent * (SHORT * beside),
                holder: holder.clone(),
            };
            if is_framed && node == 0 {
                flex.vertices.push(ghost(-end_tangent(rod, 0), after));
                flex.spins.push(0.0);
            }
            flex.vertices.push(Vertex {
                at: *at,
                holder: holder.clone(),
            });
            if node < last {
                flex.spins.push(rod.rotational_inertia_per_length * after);
            }
            if is_framed && node == last {
                flex.vertices.push(ghost(end_tangent(rod, 1), before));
                flex.spins.push(0.0);
            }
        }
        flex
    }

    /// Names and places of the bodies that a program moves.
    pub fn moving(&self) -> Vec<(&str, &Vector3)> {
        let mut clamps: Vec<(&str, &Vector3)> = Vec::new();
        for vertex in &self.vertices {
            if let Holder::Moving(name, place) = &vertex.holder
                && clamps.last().is_none_or(|(last, _)| last != name)
            {
                clamps.push((name, place));
            }
        }
        clamps
    }

    /// Writes the bodies of the nodes and of the twist of edges. MuJoCo finds the latter by their
    /// names: that of the flex, and the number of the edge unless it is the last.
    pub fn write_bodies(&self, text: &mut String) {
        for (name, place) in self.moving() {
            let (place, mass) = (list(place.iter()), self.mass);
            let inertia = mass * (HELD * self.length).powi(2);
            _ = writeln!(
                text,
                "    <body name=\"{name}\" mocap=\"true\" pos=\"{place}\"/>\n    \
                 <body name=\"{name}_held\" pos=\"{place}\" gravcomp=\"1\">\n      <freejoint/>\n      \
                 <inertial pos=\"0 0 0\" mass=\"{mass}\" diaginertia=\"{inertia} {inertia} {inertia}\"/>\n    \
                 </body>"
            );
        }
        for vertex in &self.vertices {
            let Holder::Free(name, mass) = &vertex.holder else {
                continue;
            };
            let inertia = mass * self.radius * self.radius;
            _ = writeln!(
                text,
                "    <body name=\"{name}\" pos=\"{}\">\n      \
                 <inertial pos=\"0 0 0\" mass=\"{mass}\" diaginertia=\"{inertia} {inertia} {inertia}\"/>\n      \
                 <joint type=\"slide\" axis=\"1 0 0\"/>\n      <joint type=\"slide\" axis=\"0 1 0\"/>\n      \
                 <joint type=\"slide\" axis=\"0 0 1\"/>\n    </body>",
                list(vertex.at.iter())
            );
        }
        for (edge, ends) in self.vertices.windows(2).enumerate() {
            if ends
                .iter()
                .all(|end| !matches!(end.holder, Holder::Free(..)))
            {
                continue;
            }
            let is_last = edge + 2 == self.vertices.len();
            let number = if is_last {
                String::new()
            } else {
                format!("_{edge}")
            };
            let name = format!("{}_twist{number}", self.name);
            let spin = self.spins[edge];
            _ = writeln!(
                text,
                "    <body name=\"{name}\">\n      \
                 <inertial pos=\"0 0 0\" mass=\"1e-09\" diaginertia=\"{spin} {spin} {spin}\"/>\n      \
                 <joint name=\"{name}\" axis=\"1 0 0\"/>\n    </body>"
            );
        }
    }

    /// Writes the constraints that keep the lengths of edges, and that tie the rod to moving clamps.
    /// `time`: time constant of the constraints, s.
    pub fn write_constraints(&self, text: &mut String, time: f64) {
        let firm = "solimp=\".9999 .9999 .001\"";
        _ = writeln!(
            text,
            "    <flex flex=\"{}\" solref=\"{time} 1\" {firm}/>",
            self.name
        );
        for (name, _) in self.moving() {
            _ = writeln!(
                text,
                "    <weld body1=\"{name}\" body2=\"{name}_held\" solref=\"{time} {FOLLOWING}\" {firm}/>"
            );
        }
    }

    /// Writes the flex.
    pub fn write(&self, text: &mut String, friction: f64) {
        let bodies: Vec<String> = (self.vertices.iter())
            .map(|vertex| match &vertex.holder {
                Holder::Free(name, _) => name.clone(),
                Holder::Moving(name, _) => format!("{name}_held"),
                Holder::World => "world".into(),
            })
            .collect();
        let places = self.vertices.iter().map(|vertex| match &vertex.holder {
            Holder::Free(..) => Vector3::zeros(),
            Holder::World => vertex.at,
            Holder::Moving(_, place) => vertex.at - place,
        });
        let places: Vec<String> = places.map(|place| list(place.iter())).collect();
        let edges = (1..self.vertices.len()).map(|end| format!("{} {end}", end - 1));
        let edges: Vec<String> = edges.collect();
        _ = writeln!(
            text,
            "    <flex name=\"{}\" dim=\"1\" radius=\"{}\" body=\"{}\" vertex=\"{}\" element=\"{}\">\n      \
             <contact selfcollide=\"none\" friction=\"{friction} 0.005 0.0001\"/>\n      \
             <elasticity young=\"{}\" shear=\"{}\" damping=\"{}\"/>\n    </flex>",
            self.name,
            self.radius,
            bodies.join(" "),
            places.join(" "),
            edges.join(" "),
            self.young,
            self.shear,
            self.damping
        );
    }
}
